"""EM on single joints, and what a frame set adds to the trajectories."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import reference_fusion as reference
from fusion.somebody import MODEL, fitted
from trecsim.fusion import kernels
from trecsim.fusion.kernels.fitting_kernels import nis_ratio
from trecsim.fusion.kernels.locating import begin_em, locate_joint, moments
from trecsim.fusion.tuning import EM_STEPS

# Cameras whose calibration leaves a pixel.
CAMERAS = MODEL.cameras._replace(error_px2=np.ones(4))
NOTHING_LASTS = np.zeros((1, 4, 2)), np.zeros(3, bool)
OFF_M = np.array([0.03, -0.02, 0.04])
SEEDS = st.integers(0, 2**32 - 1)


def observed(rng, joint_m, spread_px=0.0, cameras=(0, 1, 2)):
    """Draw key points of a joint that was predicted `OFF_M` beside its place."""
    n = len(cameras)
    xy = np.array([reference.project(CAMERAS.P[c], joint_m) for c in cameras])
    return kernels.Observed(
        np.array(cameras), np.full(n, 1.5), np.zeros(n, np.int64), np.tile(joint_m + OFF_M, (n, 1)),
        xy + rng.normal(0, 1, (n, 2)) * spread_px, np.full(n, 0.03), np.ones(n), np.ones(n),
    )  # fmt: skip


def images(cam, xy_px):
    """Return one detection in each image, all of good key points."""
    return kernels.Measurements(cam, np.arange(len(cam) + 1), xy_px, np.ones(xy_px.shape[:2]))


def one_each(n, weight=1.0):
    """Return matches of one track with the only detection of each of `n` images."""
    shape = (1, n)
    return kernels.Matches(np.arange(n)[None], np.zeros(shape, np.int64), np.full(shape, weight))


def located(seen, prior_m2, steps):
    n, tmp = len(seen.cam), kernels.scratch(24)
    found = kernels.located(1, 1, n)
    begin_em(prior_m2, found, 0, tmp)
    for _ in range(steps // EM_STEPS):
        locate_joint(CAMERAS, MODEL.noise, seen, n, found, 0, tmp)
    return found.shift_m[0], found.cov_m2[0], found.inlier


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

    P = CAMERAS.P[seen.cam]
    sigma = [
        np.hypot(s * f / reference.depth(p, x + shift), MODEL.noise.floor_px)
        for p, f, s, x in zip(P, CAMERAS.focal_px, seen.sigma_m, seen.xyz_m, strict=False)
    ]

    def whitened(v, d):
        return (seen.xy_px[v] - reference.project(P[v], seen.xyz_m[v] + d)) / sigma[v]

    nu = MODEL.noise.tail
    worth = [
        inlier[v]
        / MODEL.noise.white_share
        * (nu + 2)
        / (nu + whitened(v, shift) @ whitened(v, shift))
        for v in range(3)
    ]

    def residuals(d):
        parts = [np.linalg.cholesky(np.linalg.inv(prior)).T @ d]
        return np.concatenate(parts + [np.sqrt(worth[v]) * whitened(v, d) for v in range(3)])

    # EM stops when a step is shorter than half a millimetre.
    np.testing.assert_allclose(shift, least_squares(residuals, np.zeros(3)).x, atol=5e-4)


def test_the_nis_ratio_of_shifts_as_predicted_is_one():
    """Shifts drawn from prior minus posterior covariance: what a fit without news would show."""
    rng = np.random.default_rng(5)
    prior = np.tile(np.diag([0.03, 0.02, 0.05]) ** 2, (17, 1, 1))
    after = 0.3 * prior
    found = np.ones(17, bool)
    found[3] = False
    located = kernels.located(17, 1, 0)
    located.cov_m2[:], located.is_known[:] = after, found

    def ratio(shift_m):
        located.shift_m[:] = shift_m
        return nis_ratio(located, prior)

    drawn = [ratio(rng.multivariate_normal(np.zeros(3), 0.7 * prior[0], 17)) for _ in range(400)]
    assert abs(np.mean(drawn) - 1.0) < 0.05
    assert ratio(np.zeros((17, 3))) == 0.0
    located.is_known[:] = False
    assert ratio(np.ones((17, 3))) == 0.0


@pytest.mark.parametrize("jumps", ["the body", "a joint"])
def test_a_jump_of_the_body_is_followed_and_one_of_a_joint_is_not(jumps):
    """By 25 cm: a body in all cameras has turned; a joint in one of them is something else."""
    n_joint, place = 17, 3.6
    rest = np.random.default_rng(1).normal([0, 0, 1.1], [0.2, 0.2, 0.4], (n_joint, 3))
    R, z, c = np.zeros((1, 17, 24, 24)), np.zeros((1, 17, 24)), np.zeros((1, 17, 24))
    kernels.start_all(
        R[0], z[0], c[0], rest, np.full(n_joint, 0.01), 0.005, np.full(n_joint, 200.0), 0
    )
    prior = np.empty((1, n_joint, 3, 3))
    kernels.covariance_all(R, place, prior)
    there = rest + ([0.25, 0.0, 0.0] if jumps == "the body" else 0.0)
    cam = np.array([0, 1, 2])
    xy = np.array([[reference.project(CAMERAS.P[k], x) for x in there] for k in cam])
    if jumps == "a joint":
        xy[2, 0] = reference.project(CAMERAS.P[2], rest[0] + [0.25, 0.0, 0.0])
    x, after, fits = np.empty((1, 17, 3)), np.empty((1, 17, 3, 3)), fitted(1, 3, 17)
    inlier = fits.inlier
    before = R.copy()
    kernels.fit_all(
        CAMERAS, MODEL.noise, images(cam, xy),
        kernels.Prediction(np.full(3, place), place, np.tile(rest, (3, 1, 1, 1)), prior,
            np.ones((3, 1))),
        one_each(3), kernels.Trajectories(R, z, c, x, after), NOTHING_LASTS, fits,
    )  # fmt: skip
    off = np.linalg.norm(x[0] - there, axis=1)
    assert off.max() < 0.03
    if jumps == "the body":
        assert (inlier > 0.5).all()
    else:
        assert inlier[0, 2, 0] < 0.01
        assert (np.delete(inlier[0], 0, axis=1) > 0.5).all()
        # What else was known of the body keeps its covariance.
        assert (np.abs(np.diagonal(R[0, 1])) >= np.abs(np.diagonal(before[0, 1])) - 1e-9).all()


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
        R[0], z[0], c[0], (joint + OFF_M)[None], np.array([0.1]), 0.05, np.array([15.0]), 0
    )
    prior = np.empty((1, 1, 3, 3))
    kernels.covariance_all(R, place, prior)
    cam = np.array([0, 1, 2])
    xy = np.array([reference.project(CAMERAS.P[k], joint) for k in cam]) + rng.normal(0, 2, (3, 2))
    seen = kernels.Observed(
        cam, np.full(3, place), np.zeros(3, np.int64), np.tile(joint + OFF_M, (3, 1)), xy,
        np.full(3, MODEL.noise.sigma_m[0]), np.full(3, 0.7), np.ones(3),
    )  # fmt: skip
    shift, cov, inlier = located(seen, prior[0, 0], 3)
    x, after, got = np.empty((1, 1, 3)), np.empty((1, 1, 3, 3)), fitted(1, 3, 1)
    kernels.fit_all(
        CAMERAS, MODEL.noise._replace(mirror=np.zeros(1, np.int64)), images(cam, xy[:, None]),
        kernels.Prediction(np.full(3, place), place, np.tile(joint + OFF_M, (3, 1, 1, 1)), prior,
            np.ones((3, 1))),
        one_each(3, 0.7), kernels.Trajectories(R, z, c, x, after), NOTHING_LASTS, got,
    )  # fmt: skip
    np.testing.assert_allclose(got.inlier[0, :, 0], inlier, rtol=1e-9)
    np.testing.assert_allclose(x[0, 0], joint + OFF_M + shift, atol=1e-9)
    np.testing.assert_allclose(after[0, 0], cov, rtol=1e-6, atol=1e-12)
    assert live * 3 == len(c[0, 0])
    # The control points are those of the changed information.
    np.testing.assert_allclose(R[0, 0] @ c[0, 0], z[0, 0], atol=1e-9)


def test_somebody_whom_nobody_sees_stays_as_predicted():
    R, z, c = np.zeros((1, 1, 24, 24)), np.zeros((1, 1, 24)), np.zeros((1, 1, 24))
    kernels.start_all(R[0], z[0], c[0], np.ones((1, 3)), np.array([0.1]), 0.05, np.array([15.0]), 0)
    before = R.copy()
    x, cov, fits = np.empty((1, 1, 3)), np.empty((1, 1, 3, 3)), fitted(1, 1, 1)
    fits.inlier[:] = 1.0
    kernels.fit_all(
        CAMERAS, MODEL.noise,
        kernels.Measurements(
            np.array([0]), np.array([0, 0]), np.empty((0, 1, 2)), np.empty((0, 1))
        ),
        kernels.Prediction(np.array([2.0]), 2.0, np.ones((1, 1, 1, 3)), np.eye(3)[None, None],
            np.ones((1, 1))),
        kernels.Matches(np.full((1, 1), -1), np.zeros((1, 1), np.int64), np.ones((1, 1))),
        kernels.Trajectories(R, z, c, x, cov), (np.zeros((1, 4, 2)), np.zeros(1, bool)), fits,
    )  # fmt: skip
    np.testing.assert_array_equal(R, before)
    np.testing.assert_allclose(x[0, 0], 1.0)
    assert fits.inlier[0, 0, 0] == 0.0
