"""Made cameras: where they look, how wide, and the patterns in which they hang."""

import numpy as np
import pytest

from trecsim.errors import InputError
from trecsim.geometry.view import field_of_view_deg
from trecsim.lab.simulation.camera_placement import LENSES, Make, look_at, rolled
from trecsim.lab.simulation.room import PATTERNS, Floor, pattern_rig

HALL = Floor(16.0, 10.0, 3.5, (5.0, -2.0))


@pytest.mark.parametrize("lens", LENSES)
@pytest.mark.parametrize("view_deg", [40.0, 95.0, 130.0])
def test_a_camera_sees_as_wide_as_it_was_asked_to(lens: str, view_deg: float) -> None:
    T_cam_world = look_at(np.array([0.0, 0.0, 2.0]), np.array([3.0, 1.0, 1.0]))
    camera = Make((1280, 720), view_deg, lens).camera("one", T_cam_world)  # type: ignore[arg-type]
    seen_deg, complete = field_of_view_deg(camera)
    assert complete
    assert seen_deg == pytest.approx(view_deg, abs=0.3)
    middle_px = camera.project(np.array([3.0, 1.0, 1.0]))
    np.testing.assert_allclose(middle_px, [639.5, 359.5], atol=1e-6)


def test_a_lens_that_cannot_reach_so_far_is_refused() -> None:
    with pytest.raises(InputError, match="does not reach 150 degrees"):
        Make(view_deg=150.0, lens="brown", distortion=(-0.4, 0.0, 0.0, 0.0)).camera(
            "one", np.eye(4)
        )
    with pytest.raises(InputError, match="view_deg = 180"):
        Make(view_deg=180.0)


def test_a_camera_may_look_straight_down_but_not_at_itself() -> None:
    above_m = np.array([1.0, 2.0, 3.0])
    camera = Make().camera("above", look_at(above_m, np.array([1.0, 2.0, 0.0])))
    below_px = camera.project(np.array([[1.0, 2.0, 0.0], [1.5, 2.0, 0.0], [1.0, 2.5, 0.0]]))
    np.testing.assert_allclose(below_px[0], [959.5, 539.5], atol=1e-6)
    assert below_px[1, 0] > 1000  # +x to the right
    assert below_px[2, 1] < 500  # +y up
    with pytest.raises(InputError, match="another point"):
        look_at(above_m, above_m)


def test_a_rolled_camera_turns_its_image_the_other_way() -> None:
    T_cam_world = look_at(np.array([0.0, -3.0, 1.0]), np.array([0.0, 0.0, 1.0]))
    above_m = np.array([0.0, 0.0, 2.0])
    assert rolled(T_cam_world, 0.0)[0, 3] == T_cam_world[0, 3]
    clockwise = Make().camera("rolled", rolled(T_cam_world, 90.0))
    np.testing.assert_allclose(clockwise.project(above_m)[1], 539.5, atol=1e-6)
    assert clockwise.project(above_m)[0] < 900  # what was above is to the left


@pytest.mark.parametrize("pattern", PATTERNS)
@pytest.mark.parametrize("cameras", [1, 2, 5, 12, 28])
def test_cameras_of_every_pattern_look_down_into_the_floor_from_different_places(
    pattern: str, cameras: int
) -> None:
    rig = pattern_rig(pattern, HALL, cameras)
    assert len(rig) == cameras
    places_m = np.array([camera.position_m for camera in rig])
    np.testing.assert_allclose(places_m[:, 2], 3.5)
    assert (np.abs(places_m[:, :2] - [5.0, -2.0]) <= np.array([8.0, 5.0]) + 1e-9).all()
    assert len(np.unique(places_m.round(6), axis=0)) == cameras
    for camera in rig:
        ahead = camera.T_cam_world[2, :3]
        assert ahead[2] < 0
        at_m = camera.position_m + ahead * (3.5 - 1.0) / -ahead[2]
        assert (np.abs(at_m[:2] - [5.0, -2.0]) <= [8.01, 5.01]).all()


def test_a_corridor_is_looked_along_both_ways() -> None:
    along = [camera.T_cam_world[2, 0] for camera in pattern_rig("corridor", HALL, 6)]
    assert along[0] > 0.5
    assert along[-1] < -0.5
    deep = pattern_rig("corridor", Floor(2.0, 12.0, 2.7), 2)
    assert [round(float(camera.position_m[1])) for camera in deep] == [-6, 6]


def test_every_place_of_a_hall_is_seen_from_several_sides() -> None:
    rig = pattern_rig("hall", Floor(24.0, 16.0, 4.5), 12)
    x, y = np.meshgrid(np.linspace(-10, 10, 9), np.linspace(-6, 6, 7))
    points_m = np.stack((x, y, np.full_like(x, 1.2)), axis=-1)
    seen = np.zeros(x.shape, dtype=int)
    for camera in rig:
        px = camera.project(points_m)
        seen += ((px >= 0) & (px < camera.size_px)).all(axis=-1)
    assert seen.min() >= 4


def test_an_unknown_pattern_is_refused() -> None:
    with pytest.raises(InputError, match="known: corners, ring"):
        pattern_rig("circle", HALL, 3)
