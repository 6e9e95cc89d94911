import dataclasses

import numpy as np
import pytest

from made_rigs import ring
from trecsim.calibration import Floor, read_intrinsics, read_rig, write_intrinsics, write_rig
from trecsim.errors import CalibrationError
from trecsim.geometry.rig import Rig

GOOD = """
format = "trecsim.rig/1"
[cameras.north]
size_px = [1920, 1080]
K = [[1100.0, 0.0, 960.0], [0.0, 1100.0, 540.0], [0.0, 0.0, 1.0]]
distortion_model = "brown"
distortion = [0.0, 0.0, 0.0, 0.0, 0.0]
T_cam_world = [[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, -1.0, 1.5], [0.0, 1.0, 0.0, 3.0], [0, 0, 0, 1]]
time_offset_s = 0.0
"""


def write(folder, text):
    path = folder / "rig.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_the_example_of_the_contract_is_read(tmp_path):
    rig = read_rig(write(tmp_path, GOOD))
    north = rig["north"]
    assert north.size_px == (1920, 1080)
    np.testing.assert_allclose(north.position_m, [0.0, -3.0, 1.5])
    np.testing.assert_allclose(north.project(np.array([0.0, 0.0, 1.5])), [960.0, 540.0])


def test_the_optional_keys_may_be_left_out(tmp_path):
    optional = ("distortion", "time_offset")
    text = "\n".join(line for line in GOOD.splitlines() if not line.startswith(optional))
    camera = read_rig(write(tmp_path, text)).cameras[0]
    assert (camera.distortion_model, len(camera.distortion), camera.time_offset_s) == ("none", 0, 0)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("rig/1", "rig/2", "format must be 'trecsim.rig/1', found 'trecsim.rig/2'"),
        ("[cameras.north]", "[camera.north]", "unknown key 'camera'; did you mean 'cameras'"),
        ("size_px =", "size =", "camera 'north': unknown key 'size'; did you mean 'size_px'"),
        ("size_px = [1920, 1080]", "", "camera 'north': size_px is missing, expected 2 numbers"),
        ("[1920, 1080]", "[1920.5, 1080]", "size_px must be whole numbers of pixels"),
        ("[1920, 1080]", "[1920]", "size_px must be 2 numbers, found [1920]"),
        ("[1920, 1080]", "[0, 1080]", "size_px must be two whole numbers"),
        ("[1920, 1080]", "[1e308, 1080]", "size_px must be whole numbers"),
        ("[1920, 1080]", f"[1{'0' * 400}, 1080]", "size_px must be 2 numbers"),
        ("[1920, 1080]", "[true, true]", "size_px must be 2 numbers"),
        ("K = [[1100.0", "K = [[nan", "camera 'north': K must be finite"),
        ("K = [[1100.0", "K = [[0.0", "camera 'north': focal lengths in K must be positive"),
        ("K = [[1100.0, ", "K = [[", "K must be 3 x 3 numbers"),
        ("[0.0, 0.0, 1.0]]", "[0.0, 0.0, 0.0]]", "K must be [[fx, skew, cx]"),
        ("K =", "k =", "K is missing, expected 3 x 3 numbers; it has 'k'"),
        ('"brown"', '"plumb_bob"', "unknown distortion_model 'plumb_bob'; known: none, brown"),
        ('"brown"', "7", "unknown distortion_model 7"),
        ('"brown"', '"fisheye"', "distortion model 'fisheye' takes 4 numbers"),
        ("distortion = [0.0,", "distortion = [inf,", "distortion must be finite"),
        ("[[1.0, 0.0, 0.0, 0.0]", "[[1.1, 0.0, 0.0, 0.0]", "must hold a rotation"),
        ("[[1.0, 0.0, 0.0, 0.0]", "[[-1.0, 0.0, 0.0, 0.0]", "it mirrors"),
        ("[0, 0, 0, 1]]", "[0, 0, 0, 2]]", "T_cam_world must end with"),
        ("time_offset_s = 0.0", "time_offset_s = nan", "time_offset_s must be finite"),
        ("time_offset_s = 0.0", "time_offset_s = 1e300", "time_offset_s must be a finite number"),
        ("time_offset_s = 0.0", "time_drift_ppm = -1e6", "time_drift_ppm must be a finite number"),
        ("time_offset_s = 0.0", "time_ref_s = nan", "time_ref_s must be finite"),
        ("time_offset_s = 0.0", "time_offset_s = 'soon'", "time_offset_s must be "),
        ("[cameras.north]", "[cameras.'']", "the name must be 1 to 100 printable"),
    ],
)
def test_what_is_wrong_is_told_with_its_camera(old, new, says, tmp_path):
    assert old in GOOD
    with pytest.raises(CalibrationError) as caught:
        read_rig(write(tmp_path, GOOD.replace(old, new)))
    assert says in str(caught.value)


def test_all_faults_of_all_cameras_come_in_one_message(tmp_path):
    other = GOOD.partition("[cameras.north]")[2].replace("size_px", "sise_px").replace("1100", "0")
    with pytest.raises(CalibrationError) as caught:
        read_rig(write(tmp_path, GOOD.replace('"brown"', '"brawn"') + "[cameras.south]" + other))
    lines = str(caught.value).splitlines()
    assert lines[0] == f"the rig {tmp_path / 'rig.toml'}:"
    assert any("'north'" in line and "'brawn'" in line for line in lines)
    assert any("'south'" in line and "did you mean 'size_px'" in line for line in lines)


@pytest.mark.parametrize("cameras", ["", "[cameras]\n", "cameras = 3\n", "cameras = {a = 1}\n"])
def test_a_rig_needs_cameras(cameras, tmp_path):
    with pytest.raises(CalibrationError, match="camera"):
        read_rig(write(tmp_path, f'format = "trecsim.rig/1"\n{cameras}'))


def test_a_camera_that_stands_twice_is_told(tmp_path):
    table = GOOD.partition("[cameras.north]")[2]
    with pytest.raises(CalibrationError, match="north"):
        read_rig(write(tmp_path, GOOD + "[cameras.north]" + table))


def test_it_is_in_metres_always_but_may_be_put_on_another_floor(tmp_path):
    path = write(tmp_path, GOOD)
    with pytest.raises(CalibrationError, match="in metres always"):
        read_rig(path, unit_m=0.01)
    raised = read_rig(path, floor=Floor(translation_m=(0.0, 0.0, 1.0), up="z"))
    np.testing.assert_allclose(raised["north"].position_m, [0.0, -3.0, 2.5])


def test_many_faults_are_cut(tmp_path):
    cameras = "".join(f"[cameras.c{i}]\n" for i in range(500))
    with pytest.raises(CalibrationError, match="and 1480 more"):
        read_rig(write(tmp_path, f'format = "trecsim.rig/1"\n{cameras}'))


def test_two_cameras_with_one_pose_are_remarked(tmp_path):
    rig = ring(3)
    first, second, third = rig.cameras
    twin = dataclasses.replace(third, T_cam_world=second.T_cam_world)
    write_rig(Rig((first, second, twin)), tmp_path / "rig.toml")
    remarks = []
    read_rig(tmp_path / "rig.toml", remark=remarks.append)
    assert len(remarks) == 1
    assert remarks[0].startswith("cameras 'cam1' and 'cam2' stand in the same place and look")


def test_a_file_of_intrinsics_is_read_as_such_and_is_no_rig(tmp_path):
    write_intrinsics(ring(2, "rational"), tmp_path / "rig.toml")
    assert "T_cam_world" not in (tmp_path / "rig.toml").read_text()
    for camera, given in zip(
        read_intrinsics(tmp_path / "rig.toml"), ring(2, "rational"), strict=True
    ):
        np.testing.assert_array_equal(camera.K, given.K)
        np.testing.assert_array_equal(camera.distortion, given.distortion)
        np.testing.assert_array_equal(camera.T_cam_world, np.eye(4))
    with pytest.raises(CalibrationError, match=r"T_cam_world is missing.*trecsim calibrate rig"):
        read_rig(tmp_path / "rig.toml")


def test_intrinsics_are_read_from_a_whole_rig_too(tmp_path):
    write_rig(ring(2, "fisheye"), tmp_path / "rig.toml")
    for camera, given in zip(
        read_intrinsics(tmp_path / "rig.toml"), ring(2, "fisheye"), strict=True
    ):
        np.testing.assert_array_equal(camera.T_cam_world, given.T_cam_world)
