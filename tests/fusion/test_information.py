"""The square-root information against dense least squares over the whole history."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import reference_fusion as reference
from trecsim.fusion import kernels
from trecsim.fusion.spline import KnotGrid

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
    kernels.fold_row(R, z, row.copy(), y)
    np.testing.assert_allclose(R.T @ R, stacked.T @ stacked, atol=1e-9)
    np.testing.assert_allclose(R.T @ z, stacked.T @ rhs, atol=1e-9)
    assert np.allclose(np.tril(R, -1), 0.0)


@pytest.mark.parametrize("memory", [1.0, 0.7])
def test_a_filter_with_marginalised_past_equals_the_fit_of_everything(memory):
    """Fold scalar observations for two seconds; compare with one dense problem of all points."""
    rng = np.random.default_rng(3)
    drift = np.array([0.02, -0.01, 0.0])
    grid = KnotGrid(0.0, KNOT_S, LIVE)
    R, z = np.zeros((1, 1, 24, 24)), np.zeros((1, 1, 24))
    here = np.array([1.0, 2.0, 3.0])
    kernels.start_all(R[0], z[0], here[None], np.array([START_M]), STEP_M, np.array([STIFF]))
    rows = []
    for t_s in np.arange(0.0, 2.0, 0.037):
        for _ in range(grid.steps_to(t_s)):
            kernels.extend_all(R, z, np.array([STIFF]), np.array([[memory]]), drift[None])
        grid = grid.moved_to(t_s)
        direction, value = rng.normal(size=3), rng.normal()
        span, weights = grid.locate(t_s)
        row = np.zeros(24)
        for m in range(4):
            row[3 * (span + m) : 3 * (span + m) + 3] = weights[m] * direction
        kernels.fold_row(R[0, 0], z[0, 0], row, value)
        rows.append((t_s, direction, value))

    n_point = grid.first + LIVE
    expected, covariance = _dense(rows, n_point, here, memory, drift)
    c = np.empty((1, 1, 24))
    kernels.solve_all(R, z, c)
    np.testing.assert_allclose(c[0, 0], expected[-24:], atol=1e-7)
    np.testing.assert_allclose(
        np.linalg.inv(R[0, 0].T @ R[0, 0]), covariance[-24:, -24:], rtol=1e-6, atol=1e-9
    )

    for t_s in (grid.start_s + 0.01, grid.end_s - 0.05):
        span, weights = grid.locate(t_s)
        B = np.zeros((3, 24))
        for m in range(4):
            B[:, 3 * (span + m) : 3 * (span + m) + 3] = weights[m] * np.eye(3)
        cov, xyz = np.empty((1, 1, 3, 3)), np.empty((1, 1, 3))
        kernels.covariance_all(R, span, weights, cov)
        kernels.evaluate_all(c, span, weights, xyz)
        np.testing.assert_allclose(cov[0, 0], B @ covariance[-24:, -24:] @ B.T, rtol=1e-6)
        np.testing.assert_allclose(xyz[0, 0], B @ expected[-24:], atol=1e-7)


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
