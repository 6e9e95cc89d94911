"""On foot: feet side by side at both ends, whatever was done between."""

import numpy as np
import pytest

from trecsim.lab.simulation.actions import Run, Stand, Turn, Walk
from trecsim.lab.simulation.body_shape import body
from trecsim.lab.simulation.on_foot import OnFoot, on_foot, standing
from trecsim.lab.simulation.rotations import Place

ONE = body(1.7, np.random.default_rng(1))
WAYS: list[list[OnFoot]] = [
    [Walk(((3.0, 0.0),))],
    [Walk(((0.3, 0.0),), 0.5)],
    [Walk(((0.0, 2.0), (-2.0, 2.0)), 1.6)],
    [Turn(by_deg=11.5)],
    [Turn(by_deg=-401.0)],
    [Run(((6.0, 1.0),))],
    [Walk(((2.0, 0.0),)), Run(((8.0, 0.0),)), Walk(((9.0, 1.0),)), Stand(0.3), Turn(to_deg=0.0)],
]


@pytest.mark.parametrize("way", WAYS)
def test_both_feet_stand_side_by_side_at_both_ends(way: list[OnFoot]) -> None:
    stretch = on_foot(ONE, Place(0.0, 0.0, 0.0), way, 0.0, 1.0)
    path = stretch.walker.path
    first_m, last_m = stretch.walker(np.array([path.enter_s, path.leave_s]))
    for xyz_m, place in ((first_m, Place(0.0, 0.0, 0.0)), (last_m, stretch.end)):
        still_m = standing(ONE, place, 1.0, 0.0, 1.0)(np.zeros(1))[0]
        np.testing.assert_allclose(xyz_m[15:], still_m[15:], atol=1e-4)
        np.testing.assert_allclose(xyz_m[11:13], still_m[11:13], atol=0.02)  # but for idle swaying


def test_ways_in_a_row_are_gone_without_a_stop() -> None:
    way = [Walk(((3.0, 0.0),), 1.2), Walk(((6.0, 0.0),), 1.2)]
    stretch = on_foot(ONE, Place(0.0, 0.0, 0.0), way, 0.0, 1.0)
    path = stretch.walker.path
    there = (path.xy_m[:, 0] > 2.5) & (path.xy_m[:, 0] < 3.5)
    np.testing.assert_allclose(path.speed_mps[there], 1.2, atol=0.02)


def test_one_turns_on_the_spot_to_what_is_not_ahead() -> None:
    stretch = on_foot(ONE, Place(0.0, 0.0, 0.0), [Walk(((-2.0, 0.0),))], 0.0, 1.0)
    path = stretch.walker.path
    gone = np.linalg.norm(path.xy_m, axis=1) > 0.1
    first = int(np.argmax(gone))
    assert abs(abs(path.heading_rad[first]) - np.pi) < 0.1
    assert path.speed_mps.max() < 1.35
    turning = np.abs(np.gradient(path.heading_rad, path.t_s))
    assert turning.max() < 4.0


def test_corners_are_walked_around_with_bounded_acceleration() -> None:
    stretch = on_foot(
        ONE, Place(0.0, 0.0, 0.0), [Walk(((2.0, 0.0), (2.0, 2.0), (0.0, 2.0)), 1.4)], 0.0, 1.0
    )
    path = stretch.walker.path
    acceleration = np.diff(path.xy_m, 2, axis=0) / 0.01**2
    assert np.linalg.norm(acceleration, axis=1).max() < 6.0
    assert np.abs(path.xy_m[:, 0] - 1.0).max() < 1.01
