"""Walls: no path crosses one, and nothing is expected of anybody behind it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from forecasting.made_walks import line
from trecsim.forecasting import Forecaster
from trecsim.forecasting.forecasts import Forecasts
from trecsim.forecasting.held_paths import cut_off, held_by_walls, slid
from trecsim.forecasting.walls import NO_WALLS, Walls, first_met, sees

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
    seen_from_m = np.array([[[-2.0, 0.0]], [[-2.0, 4.0]]])
    assert sees(seen_from_m, behind_m[:1], wall).tolist() == [True, False]
    assert sees(seen_from_m, behind_m[1:], wall).tolist() == [False, False]
    assert sees(seen_from_m.swapaxes(0, 1), behind_m, wall).tolist() == [True]
    assert sees(np.empty((0, 3, 2)), behind_m, wall).tolist() == []


@given(st.integers(0, 2**32 - 1))
def test_who_sees_a_place_is_as_by_looking_along_each_way(seed):
    rng = np.random.default_rng(seed)
    walls = Walls(rng.uniform(-2.0, 2.0, (8, 2, 2)))
    from_m, place_m = rng.uniform(-2.0, 2.0, (6, 3, 2)), rng.uniform(-2.0, 2.0, (4, 2))
    naive = [
        any(
            all(np.isinf(naive_first_met(at_m, to_m - at_m, wall_m)) for wall_m in walls.ends_m)
            for at_m in points_m
            for to_m in place_m
        )
        for points_m in from_m
    ]
    assert sees(from_m, place_m, walls).tolist() == naive


@given(st.integers(0, 2**32 - 1), st.floats(2.0, 178.0))
def test_no_path_leaves_the_corner_of_two_walls(seed, corner_deg):
    rng, corner = np.random.default_rng(seed), np.radians(corner_deg)
    walls = Walls.along([[(9.0, 0.0), (0.0, 0.0), (9.0 * np.cos(corner), 9.0 * np.sin(corner))]])
    inwards = np.array([np.cos(corner / 2), np.sin(corner / 2)])
    from_m = np.tile(2.0 * inwards, (10, 1))
    path_m = from_m[:, None] + np.cumsum(rng.normal(0.0, 0.3, (10, 8, 2)) - 0.4 * inwards, axis=1)
    held_m = slid(from_m, path_m, walls)
    angle = np.arctan2(held_m[..., 1], held_m[..., 0])
    at_the_corner = np.hypot(*np.moveaxis(held_m, -1, 0)) < 8.0
    assert ((angle > 0.0) & (angle < corner))[at_the_corner].all()


@pytest.mark.parametrize("by_m", [(0.6, 0.2), (0.3, 0.1), (0.7, 0.7), (1.1, 0.4)])
def test_nobody_slips_through_where_two_walls_meet(by_m):
    corner_m = np.array([0.1, 0.7]) + by_m
    for other_m in ((-0.3, 0.9), (-0.7, 0.1), (0.1, 0.9)):
        walls = Walls.along([[(2.9, -1.7), tuple(corner_m), tuple(corner_m + other_m)]])
        share, _ = first_met(np.array([[0.1, 0.7]]), 2.0 * np.array([by_m]), walls)
        assert share[0] == pytest.approx(0.5)


def test_who_stands_on_a_wall_may_leave_it_to_either_side():
    wall = Walls.along([[(0.0, -5.0), (0.0, 5.0)]])
    path_m = np.array([[[0.5, 0.0], [-0.5, 0.0]], [[-0.5, 0.0], [-1.0, 0.0]]])
    held_m = slid(np.zeros((2, 2)), path_m, wall)
    np.testing.assert_allclose(held_m[..., 0], [[0.5, 0.01], [-0.5, -1.0]])


@given(st.floats(0.2, 3.0), st.floats(0.05, 0.95), st.floats(0.3, 8.0), st.booleans())
def test_between_the_walls_of_a_corridor_everything_stays_there(wide_m, share, sigma_m, turned):
    ends = [[(-90.0, 0.0), (90.0, 0.0)], [(-90.0, wide_m), (90.0, wide_m)]]
    walls = Walls.along(ends[::-1] if turned else ends)
    at_m, cov_m2 = np.array([[[0.0, share * wide_m]]]), sigma_m**2 * np.eye(2)[None, None]
    mean_m, left_m2 = cut_off(at_m, cov_m2, walls)
    assert 0.0 < mean_m[0, 0, 1] < wide_m
    np.testing.assert_allclose(left_m2[0, 0, 0], [sigma_m**2, 0.0])
    assert 0.0 < left_m2[0, 0, 1, 1] < sigma_m**2
    if sigma_m > wide_m:
        assert np.sqrt(left_m2[0, 0, 1, 1]) < wide_m  # a uniform one: 0.29 of it


@given(st.integers(0, 2**32 - 1))
def test_no_mean_gets_behind_a_wall(seed):
    rng = np.random.default_rng(seed)
    walls = Walls(rng.uniform(-2.0, 2.0, (9, 2, 2)))
    at_m, half = rng.uniform(-2.0, 2.0, (4, 3, 2)), rng.normal(0.0, 1.0, (4, 3, 2, 2))
    mean_m, left_m2 = cut_off(at_m, half @ half.swapaxes(-1, -2) + 0.01 * np.eye(2), walls)
    share, _ = first_met(at_m.reshape(-1, 2), (mean_m - at_m).reshape(-1, 2), walls)
    assert np.isinf(share).all()
    assert (np.linalg.eigvalsh(left_m2) > 0.0).all()


def test_of_nobody_there_is_no_forecast_before_a_wall():
    steps = np.arange(1.0, 4.0)
    nobody = Forecasts(
        0.0, np.empty(0, np.int64), np.empty((0, 2)), steps, np.empty((0, 6)),
        np.empty((0, 6, 3, 2)), np.empty((0, 6, 3, 2, 2)), np.empty((0, 4, 3, 2, 2)),
        np.empty((0, 3, 2, 2)),
    )  # fmt: skip
    assert held_by_walls(nobody, ROOM).xy_m.shape == (0, 6, 3, 2)


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
