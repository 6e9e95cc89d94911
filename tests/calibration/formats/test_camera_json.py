import json

import numpy as np
import pytest

from trecsim.calibration import Floor, read_rig
from trecsim.errors import CalibrationError

# One camera 3 m in front of the origin and 1.5 m above it: y points down there, centimetres.
PANOPTIC = {
    "calibDataSource": "made",
    "cameras": [
        {
            "name": "00_00",
            "type": "hd",
            "resolution": [1920, 1080],
            "panel": 0,
            "node": 0,
            "K": [[1400.0, 0, 950], [0, 1400.0, 540], [0, 0, 1]],
            "distCoef": [-0.28, 0.18, -0.0002, 0.0003, 0.06],
            "R": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
            "t": [[0.0], [150.0], [300.0]],
        }
    ],
}
TABLE = {
    "cameras": {
        "west": {
            "K": [[1000.0, 0, 500], [0, 1000.0, 400], [0, 0, 1]],
            "R": [[1, 0, 0], [0, 0, -1], [0, 1, 0]],
            "t": [0.0, 1.5, 3.0],
            "width": 1000,
            "height": 800,
        }
    }
}


def read(folder, data, **options):
    path = folder / "calibration.json"
    path.write_text(json.dumps(data))
    return read_rig(path, **options)


def changed(data, key, value):
    text = json.loads(json.dumps(data))
    cameras = text["cameras"]
    camera = cameras[0] if isinstance(cameras, list) else cameras["west"]
    camera[key] = value
    return text


def test_panoptic_is_turned_to_z_up_and_metres(tmp_path):
    camera = read(tmp_path, PANOPTIC, remark=pytest.fail)["00_00"]
    np.testing.assert_allclose(camera.position_m, [0.0, -3.0, 1.5])
    np.testing.assert_allclose(camera.T_cam_world[1, :3], [0, 0, -1])
    ahead_px = camera.project(np.array([0.0, 0.0, 1.5]))
    np.testing.assert_allclose(ahead_px, [950, 540])


def test_a_floor_of_the_users_replaces_that_turn(tmp_path):
    floor = Floor(translation_m=(1.0, 0.0, 0.0), up="-y")
    camera = read(tmp_path, PANOPTIC, floor=floor)["00_00"]
    np.testing.assert_allclose(camera.position_m, [1.0, -3.0, 1.5])


def test_a_table_of_cameras_is_read(tmp_path):
    camera = read(tmp_path, TABLE, remark=pytest.fail)["west"]
    assert camera.size_px == (1000, 800)
    np.testing.assert_allclose(camera.position_m, [0.0, -3.0, 1.5])


def test_the_shelf_calibration_is_read(shared_data):
    path = shared_data / "shelf" / "calibration.json"
    rig = read_rig(path, remark=pytest.fail)
    expected = json.loads(path.read_text())["cameras"]
    assert len(rig) == 5
    for camera in rig:
        np.testing.assert_allclose(camera.position_m, expected[camera.name]["centre_m"], atol=1e-4)


@pytest.mark.parametrize(
    ("data", "key", "value", "says"),
    [
        (PANOPTIC, "resolution", "hd", "camera '00_00': resolution must be 2 numbers"),
        (PANOPTIC, "distCoef", [1, 2, 3], "takes 4 or 5 or 8 numbers"),
        (PANOPTIC, "R", [[1, 0, 0], [0, 1, 0], [0, 0, -1]], "it mirrors"),
        (PANOPTIC, "R", [[1, 0, 0], [0, 1, 0]], "R must be 3 x 3 numbers"),
        (PANOPTIC, "K", [[0, 0, 0]] * 3, "focal lengths in K must be positive"),
        (PANOPTIC, "t", [0, float("nan"), 0], "t must be finite"),
        (PANOPTIC, "name", ["a"], "camera"),
        (TABLE, "width", None, "camera 'west': width must be"),
        (TABLE, "t", [0.0, 1.5], "t must be 3 numbers"),
        (TABLE, "dist", "none", "dist must be a list of numbers"),
    ],
)
def test_what_is_wrong_is_told(data, key, value, says, tmp_path):
    wrong = changed(data, key, value)
    if key == "name":
        wrong["cameras"][0]["t"] = "x"
    with pytest.raises(CalibrationError, match=says):
        read(tmp_path, wrong)


def test_a_list_without_cameras_or_with_something_else_is_told(tmp_path):
    with pytest.raises(CalibrationError, match="it has no camera"):
        read(tmp_path, {"cameras": []})
    with pytest.raises(CalibrationError, match="expected names with values, found 7"):
        read(tmp_path, {"cameras": [*PANOPTIC["cameras"], 7]})
    twice = {"cameras": PANOPTIC["cameras"] * 2}
    with pytest.raises(CalibrationError, match="more than once: '00_00'"):
        read(tmp_path, twice)
