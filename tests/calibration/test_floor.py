import dataclasses

import numpy as np
import pytest

from made_rigs import camera, ring
from trecsim.calibration import Floor, read_rig, write_rig
from trecsim.calibration.floor import UP, upright_axis
from trecsim.errors import CalibrationError
from trecsim.geometry.rig import Rig


@pytest.mark.parametrize("axis", UP)
def test_the_rotation_takes_the_up_axis_to_z_and_is_one(axis):
    up = {"z": [0, 0, 1], "y": [0, 1, 0], "-y": [0, -1, 0], "-z": [0, 0, -1]}[axis]
    np.testing.assert_array_equal(UP[axis] @ up, [0, 0, 1])
    np.testing.assert_array_equal(UP[axis] @ UP[axis].T, np.eye(3))
    assert np.linalg.det(UP[axis]) == 1


@pytest.mark.parametrize("axis", UP)
def test_the_axis_about_which_cameras_stand_upright_is_found(axis):
    assert upright_axis(ring(4).cameras, UP[axis].T) == axis


def on_their_side(rig):
    """Return the rig with each camera turned by 90 degrees about its line of sight."""
    turn = np.eye(4)
    turn[:2, :2] = [[0, 1], [-1, 0]]
    return Rig(
        tuple(
            dataclasses.replace(
                camera, T_cam_world=turn @ camera.T_cam_world, size_px=camera.size_px[::-1]
            )
            for camera in rig
        )
    )


def test_cameras_mounted_in_portrait_show_no_axis():
    assert upright_axis(on_their_side(ring(4)).cameras, UP["z"]) is None


def test_parallel_cameras_that_look_down_steeply_show_no_axis():
    cameras = [
        camera(f"cam{x}", position_m=(x, -2.0, 3.0), target_m=(x, 0.0, 0.0)) for x in (0.0, 1.0)
    ]
    assert upright_axis(cameras, UP["z"]) is None


def test_one_camera_upside_down_among_four_leaves_the_axis_clear():
    upside_down, *others = ring(4)
    turn = np.diag([-1.0, -1.0, 1.0, 1.0])
    turned = dataclasses.replace(upside_down, T_cam_world=turn @ upside_down.T_cam_world)
    assert upright_axis([turned, *others], UP["z"]) == "z"


def test_a_shift_of_the_floor_does_not_turn_a_rig_of_cameras_in_portrait(tmp_path):
    path = tmp_path / "Calib.toml"
    write_rig(on_their_side(ring(4)), path, remark=pytest.fail)
    remarks = []
    plain = read_rig(path, remark=remarks.append)
    shifted = read_rig(path, floor=Floor((0.0,) * 3, (0.0, 0.0, 0.5)), remark=remarks.append)
    for before, after in zip(plain, shifted, strict=True):
        moved_m = after.position_m - before.position_m
        np.testing.assert_allclose(moved_m, [0.0, 0.0, 0.5], atol=1e-9)
    assert all("lie on their side or upside down" in remark for remark in remarks)


def test_a_file_without_axes_and_cameras_that_show_none_is_taken_as_z_up_with_a_remark(tmp_path):
    path = tmp_path / "calibration.toml"
    write_rig(on_their_side(ring(4)), path, format="anipose")
    remarks = []
    rig = read_rig(
        path, unit_m=1.0, floor=Floor((0.0,) * 3, (0.0, 0.0, 0.5)), remark=remarks.append
    )
    assert rig.cameras[0].position_m[2] == pytest.approx(3.0)
    assert "does not say which axis points up, and the cameras do not show it" in remarks[0]


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"rotation_deg": (0.0, 0.0)}, "rotation must be three finite numbers"),
        ({"translation_m": (0.0, np.nan, 0.0)}, "translation must be three finite numbers"),
        ({"up": "x"}, "one of z, y, -y, -z, got 'x'"),
    ],
)
def test_what_cannot_be_a_floor_is_refused(change, says):
    with pytest.raises(CalibrationError, match=says):
        Floor(**change)
