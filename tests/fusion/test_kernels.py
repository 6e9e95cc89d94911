"""Kernels of the mixture, the pairing and the assignment equal their twins."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import reference_fusion as reference
from trecsim.fusion import kernels
from trecsim.fusion.kernels.fitting import LOOSEN, LOOSEN_M2, loosen_if_turned
from trecsim.fusion.model import build
from trecsim.fusion.settings import FusionSettings
from trecsim.simulation.room import corner_rig
from trecsim.skeleton import COCO17

SETTINGS = FusionSettings()
MODEL = build(corner_rig(6.0, 5.0, 2.6, cameras=4), COCO17, SETTINGS)
OFF_M = np.array([0.03, -0.02, 0.04])
SEEDS = st.integers(0, 2**32 - 1)


def somebody(rng):
    """Draw a cloud of joints in the middle of the room, their covariance and key points."""
    xyz = rng.normal([0, 0, 1.0], [0.5, 0.5, 0.4], (17, 3))
    A = rng.normal(0, 0.03, (17, 3, 3))
    return xyz, A @ A.swapaxes(1, 2) + 1e-5 * np.eye(3)


def seen(rng, P, xyz, spread_px=8.0):
    xy = np.array([reference.project(P, x) for x in xyz]) + rng.normal(0, spread_px, (17, 2))
    xy[rng.random(17) < 0.2] = np.nan
    return xy, rng.uniform(0.2, 1.0, 17)


@given(SEEDS)
def test_log_ratio_equals_the_mixture_of_densities(seed):
    rng = np.random.default_rng(seed)
    A = rng.normal(0, 10, (2, 2))
    C, e, m_per_px = A @ A.T + np.eye(2), rng.normal(0, 20, 2), rng.uniform(1e-3, 1e-2)
    noise = MODEL.noise
    got = kernels.inlier_log_ratio(e, C, m_per_px, noise.log_inlier, noise.outlier_share)
    expected = reference.log_ratio(e, C, m_per_px, SETTINGS.outlier_share, SETTINGS.outlier_area_m2)
    np.testing.assert_allclose(got, expected, rtol=1e-8, atol=1e-9)


def test_a_residual_beyond_any_number_gives_the_outlier_floor_and_no_nan():
    noise = MODEL.noise
    ratio, inlier = kernels.inlier_log_ratio(
        np.array([1e8, 0.0]), np.eye(2), 1e-3, noise.log_inlier, noise.outlier_share
    )
    assert ratio == pytest.approx(np.log(SETTINGS.outlier_share))
    assert inlier == 0.0


@given(SEEDS)
def test_projection_and_jacobian_equal_their_twins(seed):
    rng = np.random.default_rng(seed)
    x, P = rng.normal([0, 0, 1], 0.8), MODEL.P[rng.integers(4)]
    uv, J = np.empty(2), np.empty((2, 3))
    assert kernels.project(P, x, uv, J) == pytest.approx(reference.depth(P, x))
    np.testing.assert_allclose(uv, reference.project(P, x), rtol=1e-10)
    np.testing.assert_allclose(J, reference.jacobian(P, x), rtol=1e-5, atol=1e-3)


@given(SEEDS)
def test_scores_of_a_view_equal_the_sum_over_joints(seed):
    rng = np.random.default_rng(seed)
    P, focal = MODEL.P[1], MODEL.focal_px[1]
    xyz, cov = map(np.stack, zip(*[somebody(rng) for _ in range(2)], strict=True))
    xy, score = map(np.stack, zip(*[seen(rng, P, x) for x in xyz], strict=True))
    out, flip = np.empty((2, 2)), np.empty((2, 2), np.int64)
    kernels.score_view(P, focal, xyz, cov, xy, score, MODEL.noise, np.inf, out, flip)
    for k in range(2):
        for d in range(2):
            both = [
                reference.score_pair(
                    P, focal, xyz[k], cov[k], xy[d], score[d], MODEL.noise,
                    SETTINGS.outlier_area_m2, f,
                )
                for f in range(2)
            ]  # fmt: skip
            assert out[k, d] == pytest.approx(max(both), rel=1e-6, abs=1e-6)
            assert flip[k, d] == np.argmax(both)


def test_a_mirrored_detection_is_read_mirrored():
    rng = np.random.default_rng(1)
    xyz, cov = somebody(rng)
    xy = np.array([reference.project(MODEL.P[0], x) for x in xyz])[MODEL.noise.mirror]
    out, flip = np.empty((1, 1)), np.empty((1, 1), np.int64)
    kernels.score_view(
        MODEL.P[0], MODEL.focal_px[0], xyz[None], cov[None] * 0.1, xy[None], np.ones((1, 17)),
        MODEL.noise, np.inf, out, flip,
    )  # fmt: skip
    assert flip[0, 0] == 1


@given(SEEDS, st.integers(1, 6), st.integers(1, 6))
def test_assignment_reaches_the_same_gain_as_scipys(seed, n_row, n_column):
    rng = np.random.default_rng(seed)
    gain = rng.normal(1.0, 3.0, (n_row, n_column))
    best = np.empty(n_row, np.int64)
    kernels.assign(gain, best)
    used = best[best >= 0]
    assert len(set(used)) == len(used)
    rows = np.flatnonzero(best >= 0)
    expected = reference.assign(gain)
    right = np.flatnonzero(expected >= 0)
    total = gain[rows, best[rows]].sum()
    assert total == pytest.approx(gain[right, expected[right]].sum())


@given(SEEDS)
def test_rays_meet_where_least_squares_says(seed):
    rng = np.random.default_rng(seed)
    target = rng.normal(size=3)
    p, q = target + rng.normal(size=3) * 4, target + rng.normal(size=3) * 4
    u = (target - p) / np.linalg.norm(target - p)
    v = target + rng.normal(0, 0.05, 3) - q
    v /= np.linalg.norm(v)
    point = np.empty(3)
    gap = kernels.ray_midpoint(p, u, q, v, point)
    if np.isnan(gap):
        return
    middle, distance = reference.midpoint(p, u, q, v)
    np.testing.assert_allclose(point, middle, atol=1e-7)
    assert gap == pytest.approx(distance, abs=1e-7)


def test_rays_that_meet_behind_a_camera_do_not_meet():
    ahead, origin = np.array([0.0, 0.0, 1.0]), np.zeros(3)
    beside = np.array([1.0, 0.0, 0.0])
    away = np.array([0.6, 0.0, 0.8])
    assert np.isnan(kernels.ray_midpoint(origin, ahead, beside, away, np.empty(3)))


def observed(rng, joint_m, spread_px=0.0, cameras=(0, 1, 2)):
    P, focal = MODEL.P[list(cameras)], MODEL.focal_px[list(cameras)]
    n = len(cameras)
    xy = np.array([reference.project(p, joint_m) for p in P]) + rng.normal(0, 1, (n, 2)) * spread_px
    return kernels.Observed(
        P, focal, np.zeros(n, np.int64), np.tile([0.0, 0.5, 0.5, 0.0], (n, 1)),
        np.tile(joint_m + OFF_M, (n, 1)), xy, np.full(n, 0.03), np.ones(n),
    )  # fmt: skip


def test_em_finds_a_joint_and_leaves_out_the_image_that_disagrees():
    rng = np.random.default_rng(2)
    joint = np.array([0.2, -0.3, 1.1])
    seen = observed(rng, joint, 1.0)
    seen.xy_px[2] += 150.0
    shift, cov, inlier = np.empty(3), np.empty((3, 3)), np.empty(3)
    kernels.locate_joint(
        seen, np.eye(3) * 0.1**2, MODEL.noise, 6, shift, cov, inlier, kernels.scratch(24)
    )
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
    shift, cov, inlier = np.empty(3), np.empty((3, 3)), np.empty(3)
    kernels.locate_joint(seen, prior, MODEL.noise, 30, shift, cov, inlier, kernels.scratch(24))

    sigma = [
        np.hypot(s * f / reference.depth(P, x + shift), MODEL.noise.floor_px)
        for P, f, s, x in zip(seen.P, seen.focal_px, seen.sigma_m, seen.xyz_m, strict=True)
    ]

    def whitened(v, d):
        return (seen.xy_px[v] - reference.project(seen.P[v], seen.xyz_m[v] + d)) / sigma[v]

    nu = MODEL.noise.tail
    worth = [
        inlier[v] * (nu + 2) / (nu + whitened(v, shift) @ whitened(v, shift)) for v in range(3)
    ]

    def residuals(d):
        parts = [np.linalg.cholesky(np.linalg.inv(prior)).T @ d]
        return np.concatenate(parts + [np.sqrt(worth[v]) * whitened(v, d) for v in range(3)])

    np.testing.assert_allclose(shift, least_squares(residuals, np.zeros(3)).x, atol=1e-6)


def test_a_sharp_turn_loosens_the_joint_only_when_key_points_agree():
    rng = np.random.default_rng(5)
    joint = np.array([0.0, 0.0, 1.0])
    tight = np.eye(3) * 0.01**2
    for agree in (True, False):
        seen = observed(rng, joint)
        seen.xyz_m[:] = joint + np.array([0.35, 0.0, 0.0])
        if not agree:
            seen.xy_px[:] += rng.normal(0, 300, (3, 2))
        R, z = np.eye(24), np.ones(24)
        shift, cov, inlier = np.zeros(3), np.empty((3, 3)), np.zeros(3)
        loosen_if_turned(
            R, z, seen, tight, MODEL.noise, shift, cov, inlier, np.empty(6), kernels.scratch(24)
        )
        expected = 1 / np.sqrt(LOOSEN) if agree else 1.0
        assert R[0, 0] == pytest.approx(expected)
        assert (np.linalg.norm(shift) > 0.2) == agree
    assert LOOSEN_M2 > 0
