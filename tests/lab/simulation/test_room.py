"""The room's cameras."""

import numpy as np
import pytest

from trecsim.errors import InputError
from trecsim.lab.simulation.room import corner_rig


@pytest.mark.parametrize("cameras", [1, 2, 4, 7, 12, 28])
def test_cameras_hang_on_the_walls_and_look_at_the_middle(cameras: int) -> None:
    rig = corner_rig(8.0, 6.0, 2.7, cameras)
    assert len(rig) == cameras
    places_m = np.array([camera.position_m for camera in rig])
    np.testing.assert_allclose(np.abs(places_m[:, :2] / [4.0, 3.0]).max(axis=1), 1.0)
    np.testing.assert_allclose(places_m[:, 2], 2.7)
    assert len(np.unique(places_m.round(6), axis=0)) == cameras
    for camera in rig:
        middle_px = camera.project(np.array([0.0, 0.0, 1.0]))
        np.testing.assert_allclose(middle_px, [959.5, 539.5], atol=1e-6)
        above_px = camera.project(np.array([0.0, 0.0, 1.5]))
        assert above_px[1] < middle_px[1]  # upright: up in the room is up in the image


def test_the_first_cameras_stand_in_the_corners() -> None:
    places_m = [tuple(camera.position_m[:2].round(9)) for camera in corner_rig(8.0, 6.0, 2.4, 5)]
    assert set(places_m[:4]) == {(-4.0, -3.0), (4.0, -3.0), (4.0, 3.0), (-4.0, 3.0)}
    assert places_m[4] == (0.0, -3.0)


@pytest.mark.parametrize(("width_m", "cameras"), [(0.0, 4), (8.0, 0)])
def test_a_room_that_cannot_be_is_refused(width_m: float, cameras: int) -> None:
    with pytest.raises(InputError, match=r"positive sides|at least one camera"):
        corner_rig(width_m, 6.0, 2.7, cameras)
