import numpy as np
from hypothesis import given
from hypothesis import strategies as st

import reference_fusion as reference
from trecsim.fusion.spline import KnotGrid, basis


@given(st.floats(0, 1))
def test_basis_is_positive_and_sums_to_one(u):
    weights = basis(u)
    assert (weights >= 0).all()
    assert abs(weights.sum() - 1) < 1e-12


@given(st.floats(0.0, 0.4999), st.floats(1e-2, 0.5))
def test_grid_places_times_as_scipys_splines_do(share, knot_s):
    grid = KnotGrid(origin_s=3.0, knot_s=knot_s, live=9)
    t_s = 3.0 + share * 2 * (grid.end_s - 3.0)
    span, weights = grid.locate(t_s)
    row = np.zeros(9)
    row[span : span + 4] = weights
    np.testing.assert_allclose(row, reference.basis_rows([t_s], 3.0, knot_s, 9)[0], atol=1e-9)


def test_a_straight_line_of_control_points_is_a_straight_line_in_time():
    grid = KnotGrid(origin_s=0.0, knot_s=0.1, live=8)
    points = 2.0 * (np.arange(8) - 1) * 0.1
    for t_s in (0.0, 0.123, 0.4):
        span, weights = grid.locate(t_s)
        assert abs(weights @ points[span : span + 4] - 2.0 * t_s) < 1e-12


def test_moving_on_reaches_the_time_and_no_further():
    grid = KnotGrid(origin_s=0.0, knot_s=0.1, live=8).moved_to(1.234)
    assert grid.start_s < 1.234 < grid.end_s
    assert grid.end_s - 1.234 <= 0.1 + 1e-12


def test_unix_times_lose_no_digits():
    near, far = (KnotGrid(origin, 0.1, 8).locate(origin + 0.25) for origin in (0.0, 1.7e9))
    assert near[0] == far[0]
    np.testing.assert_allclose(near[1], far[1], atol=1e-5)
