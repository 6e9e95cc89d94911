"""The square-root information against dense least squares over the whole history."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import reference_fusion as reference
from trecsim.fusion import kernels
from trecsim.fusion.kernels.body_motion import extend
from trecsim.fusion.spline import KnotGrid
from trecsim.fusion.tuning import KEPT, UNSEEN_WEIGHT

LIVE, KNOT_S, STIFF, STEP_M, START_M = 8, 0.1, 15.0, 0.2, 0.5


@given(st.integers(0, 2**32 - 1), st.integers(0, 4))
def test_folding_a_row_equals_the_qr_of_the_stacked_equations(seed, first):
    rng = np.random.default_rng(seed)
    n = 24
    R = np.triu(rng.normal(size=(n, n)))
    for i in range(n):
        R[i, (i // 3) * 3 + 12 :] = 0.0
    R[np.diag_indices(n)] = rng.uniform(0.1, 2, n)
    z = rng.normal(size=n)
    row = np.zeros(n)
    row[3 * first : 3 * first + 12] = rng.normal(size=12)
    y = rng.normal()
    stacked, rhs = np.vstack([R, row]), np.append(z, y)
    kernels.fold_row(R, z, row.copy(), y, 3 * first)
    np.testing.assert_allclose(R.T @ R, stacked.T @ stacked, atol=1e-9)
    np.testing.assert_allclose(R.T @ z, stacked.T @ rhs, atol=1e-9)
    assert np.allclose(np.tril(R, -1), 0.0)


@given(st.integers(0, 2**32 - 1), st.integers(0, 4), st.integers(1, 3))
def test_folding_a_gaussian_adds_its_information_at_its_place_and_time(seed, span, rank):
    rng = np.random.default_rng(seed)
    R = np.triu(rng.normal(size=(24, 24)))
    for i in range(24):
        R[i, (i // 3) * 3 + 12 :] = 0.0
    R[np.diag_indices(24)] = rng.uniform(0.1, 2, 24)
    z, x = rng.normal(size=24), rng.normal(size=3)
    A = rng.normal(size=(rank, 3))
    info, rhs = A.T @ A, A.T @ rng.normal(size=rank)
    weights = np.empty(4)
    assert kernels.locate(span + rng.random(), 8, weights) == span
    B = np.zeros((3, 24))
    for m in range(4):
        B[:, 3 * (span + m) : 3 * (span + m) + 3] = weights[m] * np.eye(3)
    expected = R.T @ R + B.T @ info @ B
    expected_rhs = R.T @ z + B.T @ (rhs + info @ x)
    kernels.fold_gaussian(
        R, z, info.copy(), rhs.copy(), 1e-9, x, span, weights, np.empty((3, 24)), np.empty(3)
    )
    np.testing.assert_allclose(R.T @ R, expected, atol=1e-8)
    np.testing.assert_allclose(R.T @ z, expected_rhs, atol=1e-6)
    assert np.allclose(np.tril(R, -1), 0.0)
    assert (np.diag(R) > 0).all()


@pytest.mark.parametrize("memory", [1.0, 0.7])
def test_a_filter_with_marginalised_past_equals_the_fit_of_everything(memory):
    """Fold scalar observations for two seconds; compare with one dense problem of all points."""
    rng = np.random.default_rng(3)
    drift = np.array([0.02, -0.01, 0.0])
    grid = KnotGrid(0.0, KNOT_S, LIVE)
    R, z, c = np.zeros((1, 1, 24, 24)), np.zeros((1, 1, 24)), np.zeros((1, 1, 24))
    here = np.array([1.0, 2.0, 3.0])
    kernels.start_all(
        R[0], z[0], c[0], here[None], np.array([START_M]), STEP_M, np.array([STIFF]), 0
    )
    rows = []
    for t_s in np.arange(0.0, 2.0, 0.037):
        for _ in range(grid.steps_to(t_s)):
            extend(R[0, 0], z[0, 0], c[0, 0], STIFF, memory, drift, np.empty(24))
            np.testing.assert_allclose(R[0, 0] @ c[0, 0], z[0, 0], atol=1e-8)
        grid = grid.moved_to(t_s)
        direction, value = rng.normal(size=3), rng.normal()
        span, weights = located(grid, t_s)
        row = np.zeros(24)
        for m in range(4):
            row[3 * (span + m) : 3 * (span + m) + 3] = weights[m] * direction
        kernels.fold_row(R[0, 0], z[0, 0], row, value, 0)
        kernels.control_points(R[0, 0], z[0, 0], c[0, 0])
        rows.append((t_s, direction, value))

    n_point = grid.first + LIVE
    expected, covariance = _dense(rows, n_point, here, memory, drift)
    np.testing.assert_allclose(c[0, 0], expected[-24:], atol=1e-7)
    np.testing.assert_allclose(
        np.linalg.inv(R[0, 0].T @ R[0, 0]), covariance[-24:, -24:], rtol=1e-6, atol=1e-9
    )

    for t_s in (grid.start_s + 0.01, grid.end_s - 0.05):
        span, weights = located(grid, t_s)
        B = np.zeros((3, 24))
        for m in range(4):
            B[:, 3 * (span + m) : 3 * (span + m) + 3] = weights[m] * np.eye(3)
        cov, xyz = np.empty((1, 1, 3, 3)), np.empty((1, 1, 1, 3))
        kernels.covariance_all(R, grid.knot_time(t_s), cov)
        kernels.evaluate_all(c, np.array([grid.knot_time(t_s)]), xyz)
        np.testing.assert_allclose(cov[0, 0], B @ covariance[-24:, -24:] @ B.T, rtol=1e-6)
        np.testing.assert_allclose(xyz[0, 0, 0], B @ expected[-24:], atol=1e-7)


def tracks(R, z, c):
    x_m = np.empty((*c.shape[:2], 3))
    return kernels.Trajectories(R, z, c, x_m, np.empty((*x_m.shape, 3)))


def located(grid, t_s):
    weights = np.empty(4)
    return kernels.locate(grid.knot_time(t_s), grid.live, weights), weights


@pytest.mark.parametrize(("seeing", "kept"), [(2, 1.0), (1, KEPT)])
def test_everybody_moves_on_with_the_body_the_sooner_the_less_is_seen_of_them(seeing, kept):
    rng = np.random.default_rng(9)
    c = rng.normal(size=(1, 3, 24))
    R, z = np.tile(np.eye(24), (1, 3, 1, 1)), c.copy()
    before = c.copy()
    seen, torso = np.array([[seeing, 0, 0]]), np.array([0, 1])
    kernels.extend_all(tracks(R, z, c), seen, torso, np.full(3, STIFF), 0.8, 0.3)
    step = before[0, :, -3:] - before[0, :, -6:-3]
    body = kept * (step[0] + UNSEEN_WEIGHT * step[1]) / (1 + UNSEEN_WEIGHT)
    np.testing.assert_allclose(c[0, :, :-3], before[0, :, 3:])
    for j, memory in enumerate((0.8, 0.3, 0.3)):
        moved = c[0, j, -3:] - c[0, j, -6:-3]
        np.testing.assert_allclose(moved, memory * step[j] + (1 - memory) * body)


def _dense(rows, n_point, here, memory, drift):
    """Solve for all control points at once: start, motion prior and every observation."""
    A, b = [], []
    for axis in range(3):

        def put(row, value, axis=axis):
            full = np.zeros(3 * n_point)
            full[axis::3] = row
            A.append(full)
            b.append(value)

        unit = np.eye(n_point)
        put(unit[0] / START_M, here[axis] / START_M)
        put((unit[1] - unit[0]) / STEP_M, 0.0)
        first, _ = reference.smoothing_rows(LIVE, STIFF, 1.0, 0.0)
        for row in first:
            put(np.pad(row, (0, n_point - LIVE)), 0.0)
        later, rhs = reference.smoothing_rows(n_point, STIFF, memory, drift[axis])
        for p in range(LIVE - 2, n_point - 2):
            put(later[p], rhs[p])
    for t_s, direction, value in rows:
        A.append(np.kron(reference.basis_rows([t_s], 0.0, KNOT_S, n_point)[0], direction))
        b.append(value)
    A, b = np.array(A), np.array(b)
    information = A.T @ A
    return np.linalg.solve(information, A.T @ b), np.linalg.inv(information)
