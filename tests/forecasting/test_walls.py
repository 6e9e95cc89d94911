"""Walls: no path crosses one, and nothing is expected of anybody behind it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from forecasting.made_walks import line
from trecsim.forecasting import Forecaster
from trecsim.forecasting.held_paths import cut_off, slid
from trecsim.forecasting.walls import NO_WALLS, Walls, first_met, hidden

ROOM = Walls.along([[(0.0, 0.0), (6.0, 0.0), (6.0, 4.0), (0.0, 4.0), (0.0, 0.0)]])


def naive_first_met(at_m, by_m, wall_m):
    """Where a motion meets one wall, by solving at + s by = a + u (b - a) for s and u."""
    (a, b) = wall_m
    system = np.column_stack([by_m, a - b])
    if abs(np.linalg.det(system)) < 1e-12:
        return np.inf
    share, place = np.linalg.solve(system, a - at_m)
    return share if 0.0 <= share <= 1.0 and 0.0 <= place <= 1.0 else np.inf


@given(st.integers(0, 2**32 - 1))
def test_where_a_motion_meets_a_wall_is_as_by_the_reference(seed):
    rng = np.random.default_rng(seed)
    walls = Walls(rng.uniform(-2.0, 2.0, (5, 2, 2)))
    at_m, by_m = rng.uniform(-2.0, 2.0, (2, 7, 2))
    share, wall = first_met(at_m, by_m, walls)
    for row in range(7):
        naive = [naive_first_met(at_m[row], by_m[row], ends_m) for ends_m in walls.ends_m]
        assert share[row] == pytest.approx(min(naive))
        if np.isfinite(share[row]):
            assert wall[row] == int(np.argmin(naive))


@given(st.integers(0, 2**32 - 1))
def test_no_path_leaves_a_room_without_doors(seed):
    rng = np.random.default_rng(seed)
    from_m = rng.uniform((0.1, 0.1), (5.9, 3.9), (20, 2))
    path_m = from_m[:, None] + np.cumsum(rng.normal(0.0, 1.5, (20, 6, 2)), axis=1)
    held_m = slid(from_m, path_m, ROOM)
    assert (held_m > 0.0).all()
    assert (held_m < (6.0, 4.0)).all()
    inside = ((path_m > 0.02) & (path_m < (5.98, 3.98))).all(axis=(1, 2))
    np.testing.assert_allclose(held_m[inside], path_m[inside])


def test_who_walks_at_a_wall_goes_on_along_it():
    from_m = np.array([[1.0, 2.0]])
    path_m = np.array([[[2.0, 3.0], [3.0, 4.0], [4.0, 5.0], [5.0, 6.0]]])
    held_m = slid(from_m, path_m, ROOM)[0]
    np.testing.assert_allclose(held_m[:, 0], [2.0, 3.0, 4.0, 5.0])
    np.testing.assert_allclose(held_m[:, 1], [3.0, 3.99, 3.99, 3.99])


@given(st.floats(0.0, 3.0), st.floats(-0.9, 0.9), st.floats(0.3, 2.0))
def test_what_lies_behind_a_wall_is_cut_off(distance_m, lean, wide_m):
    """Moments of the samples on this side: the same distribution, drawn and counted."""
    cov_m2 = np.array([[wide_m**2, lean * wide_m], [lean * wide_m, 1.0]])
    wall = Walls.along([[(-50.0, 0.0), (50.0, 0.0)]])
    at_m = np.array([0.3, -distance_m])
    mean_m, left_m2 = cut_off(at_m[None, None], cov_m2[None, None], wall)
    rng = np.random.default_rng(3)
    drawn = rng.multivariate_normal(at_m, cov_m2, 200_000)
    drawn = drawn[drawn[:, 1] < 0.0]
    np.testing.assert_allclose(mean_m[0, 0], drawn.mean(axis=0), atol=0.02 * max(wide_m, 1.0))
    np.testing.assert_allclose(left_m2[0, 0], np.cov(drawn.T), atol=0.03 * max(wide_m, 1.0) ** 2)


def test_a_wall_cuts_off_nothing_beside_its_ends():
    at_m, cov_m2 = np.array([[[2.0, -0.1]]]), np.eye(2)[None, None]
    mean_m, left_m2 = cut_off(at_m, cov_m2, Walls.along([[(0.0, 0.0), (1.0, 0.0)]]))
    np.testing.assert_array_equal(mean_m, at_m)
    np.testing.assert_array_equal(left_m2, cov_m2)


def test_a_place_is_seen_through_a_door():
    wall = Walls.along([[(0.0, -5.0), (0.0, -0.5)], [(0.0, 0.5), (0.0, 5.0)]])
    behind_m = np.array([[2.0, 0.0], [2.0, 3.0]])
    seen_from_m = np.array([[-2.0, 0.0], [-2.0, 4.0]])
    assert hidden(seen_from_m, behind_m, wall).tolist() == [[False, True], [True, True]]


def test_a_forecast_stops_at_a_wall_and_without_one_nothing_changes():
    def made(walls):
        forecaster = Forecaster(walls=walls)
        return [forecaster.together(*moment) for moment in line(1.0, 9)][-1]

    free, far = made(NO_WALLS), made(Walls.along([[(50.0, -9.0), (50.0, 9.0)]]))
    np.testing.assert_array_equal(free.xy_m, far.xy_m)
    np.testing.assert_array_equal(free.cov_m2, far.cov_m2)
    assert free.xy_m[0, 0, -1, 0] > 6.0
    held = made(Walls.along([[(4.2, -9.0), (4.2, 9.0)]]))
    assert (held.xy_m[..., 0] < 4.2).all()
    assert held.xy_m[0, 0, -1, 1] == pytest.approx(free.xy_m[0, 0, -1, 1], abs=0.2)
    assert held.cov_m2[0, 0, -1, 0, 0] < 0.5 * free.cov_m2[0, 0, -1, 0, 0]
    np.testing.assert_array_equal(held.region_m2, free.region_m2)
