"""EM on single joints, and what a frame set adds to the trajectories."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import reference_fusion as reference
from fusion.somebody import MODEL
from trecsim.fusion import kernels
from trecsim.fusion.kernels.fitting import nowhere, settle_turned
from trecsim.fusion.kernels.locating import FOUND, LOOSEN, TURNED, UNSEEN, moments, turned

OFF_M = np.array([0.03, -0.02, 0.04])
NO_LIMBS = (
    np.full((1, 1), 2), kernels.Limbs(np.empty((0, 2), np.int64), np.empty(0)), np.empty((1, 0)),
    np.empty((1, 0)), 1.0,
)  # fmt: skip
SEEDS = st.integers(0, 2**32 - 1)


def observed(rng, joint_m, spread_px=0.0, cameras=(0, 1, 2)):
    """Draw key points of a joint that was predicted `OFF_M` beside its place."""
    n = len(cameras)
    xy = np.array([reference.project(MODEL.P[c], joint_m) for c in cameras])
    return kernels.Observed(
        np.array(cameras), np.full(n, 1.5), np.zeros(n, np.int64), np.tile(joint_m + OFF_M, (n, 1)),
        xy + rng.normal(0, 1, (n, 2)) * spread_px, np.full(n, 0.03), np.ones(n),
    )  # fmt: skip


def located(seen, prior_m2, steps):
    n = len(seen.cam)
    shift, cov, inlier = np.empty(3), np.empty((3, 3)), np.empty(n)
    kernels.locate_joint(
        MODEL.P, MODEL.focal_px, seen, n, prior_m2, MODEL.noise, steps,
        kernels.sums(1, 1), 0, shift, cov, inlier, kernels.scratch(24),
    )  # fmt: skip
    return shift, cov, inlier


def test_em_finds_a_joint_and_leaves_out_the_image_that_disagrees():
    rng = np.random.default_rng(2)
    joint = np.array([0.2, -0.3, 1.1])
    seen = observed(rng, joint, 1.0)
    seen.xy_px[2] += 150.0
    shift, _, inlier = located(seen, np.eye(3) * 0.1**2, 6)
    assert np.linalg.norm(seen.xyz_m[0] + shift - joint) < 0.02
    assert inlier[0] > 0.9
    assert inlier[1] > 0.9
    assert inlier[2] < 0.01


def test_em_converges_to_the_weighted_least_squares_of_its_own_responsibilities():
    from scipy.optimize import least_squares

    rng = np.random.default_rng(4)
    joint = np.array([-0.4, 0.1, 1.3])
    seen = observed(rng, joint, 4.0)
    prior = np.diag([0.02, 0.03, 0.01])
    shift, _, inlier = located(seen, prior, 30)

    P = MODEL.P[seen.cam]
    sigma = [
        np.hypot(s * f / reference.depth(p, x + shift), MODEL.noise.floor_px)
        for p, f, s, x in zip(P, MODEL.focal_px, seen.sigma_m, seen.xyz_m, strict=False)
    ]

    def whitened(v, d):
        return (seen.xy_px[v] - reference.project(P[v], seen.xyz_m[v] + d)) / sigma[v]

    nu = MODEL.noise.tail
    worth = [
        inlier[v] * (nu + 2) / (nu + whitened(v, shift) @ whitened(v, shift)) for v in range(3)
    ]

    def residuals(d):
        parts = [np.linalg.cholesky(np.linalg.inv(prior)).T @ d]
        return np.concatenate(parts + [np.sqrt(worth[v]) * whitened(v, d) for v in range(3)])

    # EM stops when a step is shorter than half a millimetre.
    np.testing.assert_allclose(shift, least_squares(residuals, np.zeros(3)).x, atol=5e-4)


def test_a_joint_has_turned_sharply_only_when_its_key_points_agree():
    rng = np.random.default_rng(5)
    joint = np.array([0.0, 0.0, 1.0])
    tight = np.eye(3) * 0.01**2
    for agree in (True, False):
        seen = observed(rng, joint)
        seen.xyz_m[:] = joint + np.array([0.35, 0.0, 0.0])
        if not agree:
            seen.xy_px[:] += rng.normal(0, 300, (3, 2))
        shift, cov, inlier = np.zeros(3), np.empty((3, 3)), np.zeros(3)
        has_turned = turned(
            MODEL.P, MODEL.focal_px, seen, 3, tight, MODEL.noise, kernels.sums(1, 1), 0,
            shift, cov, inlier, np.empty(3), kernels.scratch(24),
        )  # fmt: skip
        assert has_turned == agree
        assert (np.linalg.norm(shift) > 0.2) == agree


@pytest.mark.parametrize("alone", [True, False])
def test_a_turn_is_believed_when_the_body_agrees(alone):
    """An elbow that jumps by 40 cm: by itself, or with shoulder and wrist."""
    limbs = kernels.Limbs(np.array([[0, 1], [1, 2]]), np.full(2, 0.01**2))
    found, total = nowhere(3), kernels.sums(3, 1)
    found.x_m[:] = [[0, 0, 1.4], [0.3, 0, 1.4], [0.55, 0, 1.4]]
    found.shift_m[:] = 0.0
    found.cov_m2[:] = np.eye(3) * 0.01**2
    jumped = [1] if alone else [0, 1, 2]
    found.x_m[jumped] += [0.0, 0.4, 0.0]
    found.shift_m[jumped] = [0.0, 0.4, 0.0]
    sought = np.full(3, FOUND)
    sought[jumped] = TURNED
    R, z, inlier = np.tile(np.eye(24), (3, 1, 1)), np.ones((3, 24)), np.ones((2, 3))
    settle_turned(
        R, z, found, sought, np.tile(np.eye(3), (3, 1, 1)), limbs, np.array([0.3, 0.25]),
        np.full(2, 0.01**2), total, inlier,
    )  # fmt: skip
    if alone:
        assert sought.tolist() == [FOUND, UNSEEN, FOUND]
        np.testing.assert_allclose(found.x_m[1], [0.3, 0, 1.4])
        assert inlier[:, 1].tolist() == [0, 0]
        assert R[1, 0, 0] == 1.0
        assert total.weight[1, 0] == 0.0
    else:
        assert (sought == TURNED).all()
        np.testing.assert_allclose(R[:, 0, 0], 1 / np.sqrt(LOOSEN))


def test_images_close_in_time_share_a_moment_counted_back_from_the_newest():
    moment = np.empty(5, np.int64)
    count = moments(np.array([5.0, 5.4, 4.95, 3.0, 5.3]), moment)
    assert moment.tolist() == [0, 0, 0, 4, 0]
    assert count == 5


@given(SEEDS)
def test_what_is_folded_is_what_was_located(seed):
    """The covariance after the fold is prior and images together, as EM had it, and so the place.

    One moment, and the joint's prior at that moment: then the two must agree exactly.
    """
    rng = np.random.default_rng(seed)
    live, place = 8, 3.6
    joint = rng.normal([0, 0, 1.1], 0.2)
    R, z, c = np.zeros((1, 1, 24, 24)), np.zeros((1, 1, 24)), np.zeros((1, 1, 24))
    kernels.start_all(
        R[0], z[0], c[0], (joint + OFF_M)[None], np.array([0.1]), 0.05, np.array([15.0])
    )
    prior = np.empty((1, 1, 3, 3))
    kernels.covariance_all(R, place, prior)
    cam = np.array([0, 1, 2])
    xy = np.array([reference.project(MODEL.P[k], joint) for k in cam]) + rng.normal(0, 2, (3, 2))
    seen = kernels.Observed(
        cam, np.full(3, place), np.zeros(3, np.int64), np.tile(joint + OFF_M, (3, 1)), xy,
        np.full(3, MODEL.noise.sigma_m[0]), np.full(3, 0.7),
    )  # fmt: skip
    shift, cov, inlier = located(seen, prior[0, 0], 3)
    x, after, got = np.empty((1, 1, 3)), np.empty((1, 1, 3, 3)), np.empty((1, 3, 1))
    found, found_m2 = np.empty_like(x), np.empty_like(after)
    kernels.fit_all(
        R, z, c, np.tile(joint + OFF_M, (3, 1, 1, 1)), prior, cam, MODEL.P, MODEL.focal_px,
        np.full(3, place), xy[:, None], np.ones((3, 1)), np.arange(3)[None],
        np.zeros((1, 3), np.int64), np.full((1, 3), 0.7),
        MODEL.noise._replace(mirror=np.zeros(1, np.int64)), place, *NO_LIMBS, got, found, found_m2,
        x, after,
    )  # fmt: skip
    np.testing.assert_allclose(got[0, :, 0], inlier, rtol=1e-9)
    np.testing.assert_allclose(found[0, 0], joint + OFF_M + shift, atol=1e-9)
    np.testing.assert_allclose(x, found, atol=1e-9)
    np.testing.assert_allclose(after[0, 0], cov, rtol=1e-6, atol=1e-12)
    assert live * 3 == len(c[0, 0])
    # The control points are those of the changed information.
    np.testing.assert_allclose(R[0, 0] @ c[0, 0], z[0, 0], atol=1e-9)


def test_somebody_whom_nobody_sees_stays_as_predicted():
    R, z, c = np.zeros((1, 1, 24, 24)), np.zeros((1, 1, 24)), np.zeros((1, 1, 24))
    kernels.start_all(R[0], z[0], c[0], np.ones((1, 3)), np.array([0.1]), 0.05, np.array([15.0]))
    before = R.copy()
    x, cov, inlier = np.empty((1, 1, 3)), np.empty((1, 1, 3, 3)), np.ones((1, 1, 1))
    kernels.fit_all(
        R, z, c, np.ones((1, 1, 1, 3)), np.eye(3)[None, None], np.array([0]), MODEL.P,
        MODEL.focal_px, np.array([2.0]), np.empty((0, 1, 2)), np.empty((0, 1)),
        np.full((1, 1), -1), np.zeros((1, 1), np.int64), np.ones((1, 1)), MODEL.noise, 2.0,
        *NO_LIMBS, inlier, np.empty_like(x), np.empty_like(cov), x, cov,
    )  # fmt: skip
    np.testing.assert_array_equal(R, before)
    np.testing.assert_allclose(x[0, 0], 1.0)
    assert inlier[0, 0, 0] == 0.0
