"""Kernels that keep a root, a band or a sum, against the same with dense matrices; their laws."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import reference_fusion as reference
from fusion.somebody import MODEL, limbs_of
from trecsim.fusion import kernels, tuning
from trecsim.fusion.kernels import (
    body_motion,
    information,
    lengths,
    locating,
    small_matrices,
)
from trecsim.fusion.kernels.fitting_kernels import fold_moments
from trecsim.fusion.kernels.locating import newton_step

CAMERAS = MODEL.cameras
SEEDS = st.integers(0, 2**32 - 1)
N, LIVE = 24, 8


def positive(rng, scale=1.0):
    A = rng.normal(0, scale, (3, 3))
    return A @ A.T + 1e-3 * scale**2 * np.eye(3)


def placed(knot_time):
    weights = np.empty(4)
    return kernels.locate(knot_time, LIVE, weights), weights


@given(SEEDS, st.integers(0, 4))
def test_folding_three_rows_at_once_is_folding_one_after_the_other(seed, first):
    rng = np.random.default_rng(seed)
    R, z = reference.banded(rng), rng.normal(size=N)
    rows, y = np.zeros((3, N)), rng.normal(size=3)
    rows[:, 3 * first : 3 * first + 12] = rng.normal(size=(3, 12)) * rng.integers(0, 2, (3, 1))
    singly, z_singly = R.copy(), z.copy()
    for row, value in zip(rows, y, strict=True):
        kernels.fold_row(singly, z_singly, row.copy(), value, 3 * first)
    information.fold_block(R, z, rows.copy(), y.copy(), 3 * first)
    np.testing.assert_allclose(np.abs(R), np.abs(singly), atol=1e-9)
    np.testing.assert_allclose(R.T @ z, singly.T @ z_singly, atol=1e-9)


@given(SEEDS)
def test_back_substitution_solves_the_banded_equations(seed):
    rng = np.random.default_rng(seed)
    R, z, c = reference.banded(rng), rng.normal(size=N), np.empty(N)
    kernels.control_points(R, z, c)
    np.testing.assert_allclose(R @ c, z, atol=1e-6 * (1 + np.abs(c).max()))


@given(SEEDS, st.floats(0, 5))
def test_the_covariance_of_a_point_is_that_of_the_dense_inverse(seed, knot_time):
    rng = np.random.default_rng(seed)
    R = reference.banded(rng)
    B = reference.spread_over(*placed(knot_time), N)
    got = np.empty((1, 1, 3, 3))
    kernels.covariance_all(R[None, None], knot_time, got)
    expected = B @ np.linalg.inv(R.T @ R) @ B.T
    np.testing.assert_allclose(got[0, 0], expected, rtol=1e-6, atol=1e-9 * np.abs(expected).max())


@given(SEEDS, st.floats(0.0, 1.0), st.floats(0.1, 100.0))
def test_moving_on_takes_out_the_oldest_point_and_ties_the_newest(seed, memory, stiffness):
    rng = np.random.default_rng(seed)
    R, z, c = reference.banded(rng), rng.normal(size=N), np.empty(N)
    drift_m = rng.normal(0, 0.1, 3)
    kernels.control_points(R, z, c)
    past, vector = reference.marginalised(R.T @ R, R.T @ z, 3)
    rows, right = reference.motion_rows(N, stiffness, memory, drift_m)
    expected = np.pad(past, (0, 3)) + rows.T @ rows
    expected_vector = np.pad(vector, (0, 3)) + rows.T @ right
    body_motion.extend(R, z, c, stiffness, memory, drift_m, np.empty(N))
    scale = np.abs(expected).max()
    np.testing.assert_allclose(R.T @ R, expected, atol=1e-9 * scale)
    np.testing.assert_allclose(R.T @ z, expected_vector, atol=1e-8 * scale * (1 + np.abs(c).max()))
    np.testing.assert_allclose(R @ c, z, atol=1e-8 * scale * (1 + np.abs(c).max()))


def clear(located, j):
    locating.clear(located.info[j], located.rhs[j], located.knot_time[j], located.weight[j])


@given(SEEDS)
def test_a_step_to_the_best_shift_is_that_of_least_squares(seed):
    rng = np.random.default_rng(seed)
    prior, before = positive(rng, 0.1), rng.normal(0, 0.1, 3)
    total = kernels.located(2, 3, 0)
    clear(total, 1)
    A, b = [np.linalg.cholesky(np.linalg.inv(prior)).T], [np.zeros(3)]
    for m in range(3):
        rows, right = rng.normal(0, 30, (2, 3)), rng.normal(0, 3, 2)
        total.info[1, m], total.rhs[1, m] = rows.T @ rows, rows.T @ right
        A.append(rows)
        b.append(right)
    shift, cov = total.shift_m[1], total.cov_m2[1]
    shift[:] = before
    moved = newton_step(total.info[1], total.rhs[1], np.linalg.inv(prior), np.empty(3), shift, cov)
    stacked = np.vstack(A)
    expected = np.linalg.lstsq(stacked, np.concatenate(b), rcond=None)[0]
    np.testing.assert_allclose(shift, expected, atol=1e-8)
    np.testing.assert_allclose(cov, np.linalg.inv(stacked.T @ stacked), rtol=1e-6, atol=1e-12)
    assert moved == pytest.approx(((expected - before) ** 2).sum(), abs=1e-9)


@given(SEEDS, st.integers(1, 3))
def test_every_moment_enters_the_curve_at_its_mean_time(seed, moments):
    rng = np.random.default_rng(seed)
    R, z, c = reference.banded(rng), rng.normal(size=N), np.empty(N)
    kernels.control_points(R, z, c)
    expected, vector = R.T @ R, R.T @ z
    total = kernels.located(1, moments + 1, 0)  # the last one is empty
    clear(total, 0)
    for m in range(moments):
        knot_time, weight = rng.uniform(0, 5), rng.uniform(0.5, 9.0)
        info, shift = positive(rng, 3.0), rng.normal(0, 0.1, 3)
        total.info[0, m], total.rhs[0, m] = info, info @ shift
        total.knot_time[0, m], total.weight[0, m] = knot_time * weight, weight
        B = reference.spread_over(*placed(knot_time), N)
        expected = expected + B.T @ info @ B
        vector = vector + B.T @ info @ (B @ c + shift)
    fold_moments(R, z, c, total, 0, kernels.scratch(N))
    np.testing.assert_allclose(R.T @ R, expected, atol=1e-7)
    np.testing.assert_allclose(
        c, np.linalg.solve(expected, vector), atol=1e-6 * (1 + np.abs(c).max())
    )


def test_a_trajectory_stays_sound_through_thousands_of_frames():
    """Information from none to that of a micrometre, in any direction, at any time, for an hour."""
    rng = np.random.default_rng(12)
    R, z, c = np.zeros((1, 1, N, N)), np.zeros((1, 1, N)), np.zeros((1, 1, N))
    sigma_m, stiffness = np.array([0.4]), np.array([15.0])
    kernels.start_all(R[0], z[0], c[0], np.ones((1, 3)), sigma_m, 0.15, stiffness, 0)
    cov = np.empty((1, 1, 3, 3))
    for step in range(3000):
        if step % 3 == 0:
            body_motion.extend(R[0, 0], z[0, 0], c[0, 0], 15.0, 0.85, np.zeros(3), np.empty(N))
        direction = rng.normal(size=(rng.integers(0, 4), 3)) * 10 ** rng.uniform(-3, 6)
        info = direction.T @ direction
        span, weights = placed(rng.uniform(0, 5))
        kernels.fold_gaussian(
            R[0, 0], z[0, 0], info.copy(), info @ rng.normal(0, 0.01, 3),
            1e-6 * np.trace(info), np.ones(3), span, weights, np.empty((3, N)), np.empty(3),
        )  # fmt: skip
        assert (np.diag(R[0, 0]) > 0).all()
        assert not np.tril(R[0, 0], -1).any()
    kernels.control_points(R[0, 0], z[0, 0], c[0, 0])
    for knot_time in np.linspace(0, 5, 11):
        kernels.covariance_all(R, knot_time, cov)
        np.testing.assert_allclose(cov[0, 0], cov[0, 0].T, rtol=1e-9, atol=0)
        assert (np.linalg.eigvalsh(cov[0, 0]) > 0).all()
    assert np.abs(c - 1.0).max() < 1.0


def key_points(rng, cameras=4, spread_px=4.0):
    joint = rng.normal([0, 0, 1.1], 0.4)
    xy = np.array([reference.project(P, joint) for P in CAMERAS.P[:cameras]])
    xy += rng.normal(0, spread_px, (cameras, 2))
    if rng.random() < 0.5:  # one shows something else
        xy[rng.integers(cameras)] += rng.normal(0, 100, 2)
    return kernels.Observed(
        np.arange(cameras), np.full(cameras, 1.5), np.zeros(cameras, np.int64),
        np.tile(joint + rng.normal(0, 0.05, 3), (cameras, 1)), xy, np.full(cameras, 0.02),
        np.ones(cameras), np.ones(cameras),
    )  # fmt: skip


@pytest.mark.parametrize("seed", range(40))
def test_em_climbs_the_mixtures_log_density(seed):
    """It may lose a little on the way, as its E step reckons with what is uncertain yet."""
    rng = np.random.default_rng(seed)
    seen, prior, n = key_points(rng), positive(rng, 0.06) + 1e-3 * np.eye(3), 4
    found, tmp = kernels.located(1, 1, n), kernels.scratch(N)
    locating.begin_em(prior, found, 0, tmp)
    shift = found.shift_m[0]
    climbed = [reference.log_mixture(CAMERAS.P, CAMERAS.focal_px, seen, MODEL.noise, prior, shift)]
    for _ in range(6):
        locating.locate_joint(CAMERAS, MODEL.noise, seen, n, found, 0, tmp)
        climbed.append(
            reference.log_mixture(CAMERAS.P, CAMERAS.focal_px, seen, MODEL.noise, prior, shift)
        )
    assert np.diff(climbed).min() > -0.2
    assert climbed[-1] >= max(climbed) - 0.2
    assert climbed[-1] > climbed[0]


@given(SEEDS)
def test_an_images_equations_have_the_gradient_of_its_squared_residual(seed):
    """Central differences of ``weight / 2 |residual|^2`` over the shift."""
    rng = np.random.default_rng(seed)
    cam, x, shift = int(rng.integers(4)), rng.normal([0, 0, 1], 0.4), rng.normal(0, 0.05, 3)
    xy, weight = (
        reference.project(CAMERAS.P[cam], x) + rng.normal(0, 20, 2),
        rng.uniform(0.1, 2),
    )

    def cost(d):
        e = xy - reference.project(CAMERAS.P[cam], x + d)
        return 0.5 * weight * e @ e

    _, u, v, du, dv = kernels.project(CAMERAS.P, cam, *(x + shift))
    info, rhs = np.zeros((3, 3)), np.zeros(3)
    size = locating.add_image(info, rhs, weight, du, dv, xy[0] - u, xy[1] - v, shift)
    step = 1e-6 * np.eye(3)
    gradient = [(cost(shift + d) - cost(shift - d)) / 2e-6 for d in step]
    np.testing.assert_allclose(info @ shift - rhs, gradient, rtol=1e-4, atol=1e-2)
    assert size == pytest.approx(np.trace(info))


def body_of(limb_m, limb_m2):
    return kernels.Bodies(limb_m, limb_m2, np.array([0.0, 1.0]))


LIMBS = limbs_of([[0, 1], [1, 2]], 0.01**2)


@given(SEEDS, st.floats(0.001, 2.0))
def test_a_length_is_learnt_as_two_gaussians_are_combined(seed, elapsed_s):
    rng = np.random.default_rng(seed)
    x, cov = rng.normal(0, 0.5, (3, 3)), np.stack([positive(rng, 0.02) for _ in range(3)])
    limb_m, limb_m2 = rng.uniform(0.2, 0.6, 2), rng.uniform(0.01, 0.1, 2) ** 2
    before_m, before_m2 = limb_m.copy(), limb_m2.copy()
    lengths.learn(x, cov, np.array([3, 2, 1]), LIMBS, body_of(limb_m, limb_m2), elapsed_s)
    d = x[1] - x[0]
    length = np.linalg.norm(d)
    var = (d / length) @ (cov[0] + cov[1]) @ (d / length) + 0.02**2 + LIMBS.slack_m2[0]
    expected = reference.learnt(before_m[0], before_m2[0], length, var, min(1.0, elapsed_s / 0.5))
    np.testing.assert_allclose([limb_m[0], limb_m2[0]], expected, rtol=1e-9)
    # One camera alone teaches nothing.
    assert (limb_m[1], limb_m2[1]) == (before_m[1], before_m2[1])


def test_lengths_converge_and_are_never_surer_than_they_can_be():
    rng = np.random.default_rng(4)
    true_m, limb_m, limb_m2 = np.array([0.3, 0.25]), np.full(2, 0.45), np.full(2, 0.07**2)
    ends = np.array([[0, 0, 0], [0.3, 0, 0], [0.3, 0.25, 0]])
    for _ in range(4000):
        noisy = ends + rng.normal(0, 0.01, (3, 3))
        cov = np.tile(np.eye(3) * 0.01**2, (3, 1, 1))
        lengths.learn(noisy, cov, np.full(3, 2), LIMBS, body_of(limb_m, limb_m2), 0.04)
        assert (limb_m2 >= 0.005**2 - 1e-12).all()
    np.testing.assert_allclose(limb_m, true_m, atol=0.005)
    np.testing.assert_allclose(limb_m2, 0.005**2, rtol=0.05)


def test_time_that_stands_still_teaches_no_length():
    limb_m, limb_m2 = np.full(2, 0.45), np.full(2, 0.07**2)
    x, cov = np.eye(3), np.tile(np.eye(3) * 1e-4, (3, 1, 1))
    lengths.learn(x, cov, np.full(3, 4), LIMBS, body_of(limb_m, limb_m2), 0.0)
    assert (limb_m.tolist(), limb_m2.tolist()) == ([0.45, 0.45], [0.07**2] * 2)


@given(SEEDS)
def test_the_inverse_of_three_by_three_is_the_inverse(seed):
    A, out = positive(np.random.default_rng(seed)), np.empty((3, 3))
    small_matrices.invert3(A, out)
    np.testing.assert_allclose(out @ A, np.eye(3), atol=1e-7)


def tightened(x, cov, limbs, limb_m, limb_m2):
    """Take one limb after the other for a measurement of two joints' distance, the obvious way."""
    x, cov = x.copy(), cov.copy()
    for sweep in range(tuning.LIMB_SWEEPS):
        for (a, b), slack_m2, length_m, length_m2 in zip(
            limbs.joints, limbs.slack_m2, limb_m, limb_m2, strict=True
        ):
            u = (x[b] - x[a]) / np.linalg.norm(x[b] - x[a])
            rest = length_m - np.linalg.norm(x[b] - x[a])
            var = u @ (cov[a] + cov[b]) @ u + length_m2 + slack_m2 + tuning.TIE_M2
            excess_m2 = max(0.0, (rest / tuning.LIMB_GATE) ** 2 - var)
            worse = b if u @ cov[b] @ u > u @ cov[a] @ u else a
            cov[worse] = cov[worse] + excess_m2 * np.eye(3)
            var += excess_m2
            for j, sign in ((a, -1.0), (b, 1.0)):
                gain = cov[j] @ u / var
                x[j] = x[j] + sign * gain * rest
                if sweep == 0 and not excess_m2:
                    cov[j] = cov[j] - var * np.outer(gain, gain)
    return x, cov


@given(SEEDS)
def test_limbs_tighten_a_body_as_the_twin_says(seed):
    rng = np.random.default_rng(seed)
    x, cov = rng.normal(0, 0.4, (4, 3)), np.stack([positive(rng, 0.05) for _ in range(4)])
    limbs = limbs_of([[0, 1], [1, 2], [2, 3], [0, 3]], 0.01**2)
    apart_m = np.linalg.norm(np.diff(x[limbs.joints], axis=1)[:, 0], axis=1)
    limb_m, limb_m2 = apart_m * rng.uniform(0.7, 1.3, 4), rng.uniform(0.005, 0.05, 4) ** 2
    expected, expected_m2 = tightened(x, cov, limbs, limb_m, limb_m2)
    lengths.tighten(x, cov, limbs, body_of(limb_m, limb_m2))
    np.testing.assert_allclose(x, expected, atol=1e-9)
    np.testing.assert_allclose(cov, expected_m2, atol=1e-12)
    assert (np.linalg.eigvalsh(cov) > 0).all()


@given(SEEDS)
def test_limbs_tighten_a_turned_body_as_they_do_the_body(seed):
    rng = np.random.default_rng(seed)
    x, cov = rng.normal(0, 0.4, (3, 3)), np.stack([positive(rng, 0.05) for _ in range(3)])
    limb_m, limb_m2 = rng.uniform(0.2, 0.6, 2), rng.uniform(0.01, 0.1, 2) ** 2
    Q = np.linalg.qr(rng.normal(size=(3, 3)))[0]  # a turn, or a turn and a mirror
    turned, turned_m2 = x @ Q.T + 5.0, Q @ cov @ Q.T
    lengths.tighten(x, cov, LIMBS, body_of(limb_m, limb_m2))
    lengths.tighten(turned, turned_m2, LIMBS, body_of(limb_m, limb_m2))
    np.testing.assert_allclose(turned, x @ Q.T + 5.0, atol=1e-9)
    np.testing.assert_allclose(turned_m2, Q @ cov @ Q.T, atol=1e-12)
