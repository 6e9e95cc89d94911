"""Ways over the floor."""

import numpy as np
import pytest

from trecsim.lab.simulation.paths import LEAD_S, STEP_S, through
from trecsim.lab.simulation.wandering import wander


def test_a_straight_walk_stays_straight_and_even() -> None:
    path = through(np.array([1.0, 5.0]), np.array([[0.0, 1.0], [4.0, 1.0]]))
    wanted_m = np.stack((path.t_s - 1.0, np.ones_like(path.t_s)), axis=1)
    np.testing.assert_allclose(path.xy_m, wanted_m, atol=1e-9)
    np.testing.assert_allclose(path.heading_rad, 0.0, atol=1e-12)
    assert path.t_s[0] <= 1.0 - LEAD_S + STEP_S
    assert path.t_s[-1] >= 5.0 + LEAD_S - 2 * STEP_S


def test_corners_are_rounded_without_overshoot() -> None:
    corner_m = np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 3.0]])
    path = through(np.array([0.0, 3.0, 6.0]), corner_m)
    inside = (path.t_s >= 0) & (path.t_s <= 6)
    assert path.xy_m[inside].min() >= -1e-9
    assert path.xy_m[inside].max() <= 3 + 1e-9
    acceleration = np.diff(path.xy_m, 2, axis=0) / STEP_S**2
    assert 1.0 < np.linalg.norm(acceleration, axis=1).max() < 4.0


def test_who_stands_still_keeps_facing_the_same_way_and_then_turns() -> None:
    points_m = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 0.0], [2.0, -2.0]])
    path = through(np.array([0.0, 2.0, 6.0, 8.0]), points_m)
    assert path.heading_rad[np.searchsorted(path.t_s, 1.0)] == pytest.approx(0.0, abs=0.02)
    assert path.heading_rad[np.searchsorted(path.t_s, 7.5)] == pytest.approx(-np.pi / 2, abs=0.05)
    assert path.speed_mps[np.searchsorted(path.t_s, 4.0)] == pytest.approx(0.0, abs=1e-6)
    turn_radps = np.abs(np.gradient(path.heading_rad, STEP_S))
    assert turn_radps.max() < 2.0  # rad/s


@pytest.mark.parametrize("people", [1, 4, 12])
@pytest.mark.parametrize("seed", range(3))
def test_wanderers_keep_apart_at_walking_pace_inside_the_room(people: int, seed: int) -> None:
    paths = wander(people, 8.0, 6.0, 15.0, np.random.default_rng(seed))
    t_s = np.arange(0.0, 15.0, 0.05)
    xy_m = np.full((people, len(t_s), 2), np.nan)
    for place, path in zip(xy_m, paths, strict=True):
        here = (t_s >= path.enter_s) & (t_s <= path.leave_s)
        for axis in (0, 1):
            place[here, axis] = np.interp(t_s[here], path.t_s, path.xy_m[:, axis])
        walking = (path.t_s >= path.enter_s) & (path.t_s <= path.leave_s)
        assert path.speed_mps[walking].max() < 1.6
    assert (np.nanmax(np.abs(xy_m), axis=(0, 1)) <= [4.01, 3.01]).all()
    apart_m = np.linalg.norm(xy_m[:, None] - xy_m[None], axis=-1)
    apart_m[np.eye(people, dtype=bool)] = np.nan
    if people > 1:
        assert np.nanmin(apart_m) >= 0.5


def test_some_come_later_and_some_leave_early() -> None:
    paths = wander(6, 8.0, 6.0, 20.0, np.random.default_rng(0))
    assert sum(path.enter_s == 0.0 for path in paths) == 3
    assert sum(path.leave_s < 20.0 for path in paths) == 2
    assert all(path.leave_s - path.enter_s > 5.0 for path in paths)


def test_nobody_wanders_when_nobody_is_asked_for() -> None:
    assert wander(0, 8.0, 6.0, 5.0, np.random.default_rng(0)) == ()
