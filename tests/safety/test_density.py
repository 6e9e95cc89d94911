"""The density of people in a zone, against a sum over a grid, and its rule."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from made_paths import bodies_on, events_of, line, moments, times, told
from trecsim.safety.conditions.density import CUT_M, voronoi_density
from trecsim.safety.polygons import Polygon, area_m2

SQUARE = Polygon(np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 2.0], [0.0, 2.0]]))
BAY = Polygon(np.array([[0.0, 0], [4, 0], [4, 3], [2.5, 3], [2.5, 1], [1.5, 1], [1.5, 3], [0, 3]]))


def on_a_grid(polygon: Polygon, xy_m: np.ndarray, step_m: float = 0.03) -> float:
    """Give every point of a grid to the nearest person, far too slowly."""
    x, y = np.arange(-1.2, 5.2, step_m), np.arange(-1.2, 4.2, step_m)
    grid = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2) + 0.5 * step_m
    away_m = np.hypot(*np.moveaxis(grid[:, None] - xy_m, -1, 0))
    owner = np.where(away_m.min(axis=1) <= CUT_M, away_m.argmin(axis=1), -1)
    inside = polygon.distance_m(grid) > 0.0
    shares = [(inside & (owner == n)).sum() / max((owner == n).sum(), 1) for n in range(len(xy_m))]
    return sum(shares) / area_m2(polygon.corners_m)


@given(st.integers(0, 2**32 - 1), st.integers(1, 9), st.sampled_from([SQUARE, BAY]))
def test_the_density_equals_the_sum_over_a_grid(seed: int, people: int, polygon: Polygon) -> None:
    xy_m = np.random.default_rng(seed).uniform([-0.1, -0.1], [4.1, 3.1], (people, 2))
    assert voronoi_density(polygon, xy_m) == pytest.approx(
        on_a_grid(polygon, xy_m), rel=0.03, abs=0.004
    )


def test_people_well_inside_count_in_full_and_one_on_a_side_counts_half() -> None:
    wide = Polygon(np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]]))
    inside = np.array([[5.0, 5.0], [5.2, 5.0], [8.0, 2.0]])
    assert voronoi_density(wide, inside) == pytest.approx(0.03)
    assert voronoi_density(wide, np.array([[5.0, 0.0]])) == pytest.approx(0.005)
    assert voronoi_density(wide, np.full((2, 2), np.nan)) == 0.0


RULE = '[[rules]]\nid = "d"\nkind = "density.level"\nzone = "room"\n'  # of 8 m^2


def crowd(count: int, speed_mps: float) -> list:
    t_s = times(14.0)
    places = [(1.1 + 0.45 * (n % 5), -0.6 + 0.3 * (n // 5)) for n in range(count)]
    swing = np.sin(2.0 * np.pi * t_s)[:, None] * [speed_mps / 4.0, 0.0]
    return moments([bodies_on(line(at, (0, 0)), t_s) + np.pad(swing, ((0, 0), (0, 1)))[:, None]
                    for at in places], t_s)  # fmt: skip


def test_a_level_of_service_is_told_after_ten_seconds_with_who_is_there() -> None:
    assert events_of(RULE, crowd(7, 0.0)) == []
    events = events_of(RULE, crowd(12, 0.0))
    assert told(events, "phase", "severity", "t_start_s", "count") == [("new", "warning", 0.0, 12)]
    assert 10.0 <= events[0]["data"]["t_detect_s"] < 10.41
    assert events[0]["data"]["measures"]["density_pm2"] > 1.08
    assert len(events[0]["data"]["people"]) == 12
    assert events_of(f'{RULE}level = "F"\n', crowd(12, 0.0)) == []


def test_a_packed_crowd_that_moves_is_told_at_once_and_is_worse() -> None:
    assert told(events_of(RULE, crowd(25, 0.0)), "severity") == [("warning",)]
    moving = events_of(RULE, crowd(25, 1.5))
    assert told(moving, "severity")[0] == ("alarm",)
    assert moving[0]["data"]["t_detect_s"] < 5.0
