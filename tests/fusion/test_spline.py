import numpy as np
from hypothesis import given
from hypothesis import strategies as st

import reference_fusion as reference
from trecsim.fusion import kernels
from trecsim.fusion.spline import KnotGrid


def locate(place, live):
    weights = np.empty(4)
    return kernels.locate(place, live, weights), weights


@given(st.floats(-1, 10))
def test_weights_are_not_negative_and_sum_to_one(place):
    span, weights = locate(place, 9)
    assert 0 <= span <= 5
    assert (weights >= 0).all()
    assert abs(weights.sum() - 1) < 1e-12


@given(st.floats(0.0, 0.4999), st.floats(1e-2, 0.5))
def test_grid_places_times_as_scipys_splines_do(share, knot_s):
    grid = KnotGrid(origin_s=3.0, knot_s=knot_s, live=9)
    t_s = 3.0 + share * 2 * (grid.end_s - 3.0)
    span, weights = locate(grid.knot_time(t_s), grid.live)
    row = np.zeros(9)
    row[span : span + 4] = weights
    np.testing.assert_allclose(row, reference.basis_rows([t_s], 3.0, knot_s, 9)[0], atol=1e-9)


def test_a_straight_line_of_control_points_is_a_straight_line_in_time():
    grid = KnotGrid(origin_s=0.0, knot_s=0.1, live=8)
    points = 2.0 * (np.arange(8) - 1) * 0.1
    for t_s in (0.0, 0.123, 0.4):
        span, weights = locate(grid.knot_time(t_s), grid.live)
        assert abs(weights @ points[span : span + 4] - 2.0 * t_s) < 1e-12


@given(st.integers(0, 2**32 - 1))
def test_everybodys_joints_are_blends_of_their_control_points(seed):
    rng = np.random.default_rng(seed)
    c, place = rng.normal(size=(2, 3, 24)), rng.uniform(0, 5, 4)
    xyz = np.empty((4, 2, 3, 3))
    kernels.evaluate_all(c, place, xyz)
    for v in range(4):
        row = reference.basis_rows([place[v]], 0.0, 1.0, 8)[0]
        np.testing.assert_allclose(
            xyz[v], np.einsum("p,kjpa->kja", row, c.reshape(2, 3, 8, 3)), atol=1e-12
        )


def test_moving_on_reaches_the_time_and_no_further():
    grid = KnotGrid(origin_s=0.0, knot_s=0.1, live=8).moved_to(1.234)
    assert grid.start_s < 1.234 < grid.end_s
    assert grid.end_s - 1.234 <= 0.1 + 1e-12


def test_unix_times_lose_no_digits():
    near, far = (KnotGrid(origin, 0.1, 8).knot_time(origin + 0.25) for origin in (0.0, 1.7e9))
    assert abs(near - far) < 1e-5
