"""Tables of 4D Association and VoxelPose, and the YAML of one camera."""

import json

import cv2
import numpy as np
import pytest

from made_rigs import LENSES, ring
from trecsim.calibration import read_intrinsics, read_rig
from trecsim.errors import CalibrationError

POINTS = np.array([[0.0, 0, 1], [0.5, -0.4, 0.2], [-0.6, 0.3, 1.6]])
ROS = """
image_width: 1280
image_height: 720
camera_name: front
camera_matrix:
  rows: 3
  cols: 3
  data: [900.0, 0.0, 640.0, 0.0, 905.0, 360.0, 0.0, 0.0, 1.0]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.2, 0.05, 0.001, -0.002, 0.0]
"""


def put(folder, data, name="calibration.json"):
    path = folder / name
    path.write_text(data if isinstance(data, str) else json.dumps(data))
    return path


def association(rig):
    return {
        str(n): {
            "K": c.K.ravel().tolist(),
            "RT": c.T_cam_world[:3].ravel().tolist(),
            "distCoeff": c.distortion.tolist(),
            "imgSize": list(c.size_px),
        }
        for n, c in enumerate(rig)
    }


def voxelpose(rig):
    tables = {}
    for n, c in enumerate(rig):
        k1, k2, p1, p2, k3 = c.distortion.tolist()
        tables[str(n)] = {
            "fx": c.K[0, 0], "fy": c.K[1, 1], "cx": c.K[0, 2], "cy": c.K[1, 2],
            "R": c.T_cam_world[:3, :3].tolist(), "T": (1e3 * c.position_m[:, None]).tolist(),
            "k": [[k1], [k2], [k3]], "p": [[p1], [p2]],
        }  # fmt: skip
    return tables


@pytest.mark.parametrize("table", [association, voxelpose])
def test_tables_of_other_programs_project_as_the_cameras_in_them(table, tmp_path):
    rig = ring(3, "brown")
    options = {"unit_m": 1.0} if table is association else {"size_px": (1920, 1080)}
    found = read_rig(put(tmp_path, table(rig)), remark=lambda _: None, **options)
    for one, true in zip(found, rig, strict=True):
        np.testing.assert_allclose(one.project(POINTS), true.project(POINTS), atol=1e-6)
        assert one.size_px == true.size_px


def test_a_table_without_a_size_takes_twice_the_principal_point_and_says_so(tmp_path):
    remarks = []
    found = read_rig(put(tmp_path, voxelpose(ring(1, "brown"))), remark=remarks.append)
    assert found.cameras[0].size_px == (1930, 1070)
    assert any("--size-px" in text for text in remarks)


def test_a_faulty_table_is_told_with_its_camera(tmp_path):
    data = association(ring(2, "brown"))
    data["1"]["RT"] = [1, 2, 3]
    with pytest.raises(CalibrationError, match=r"camera '1': RT must be 3 x 4 numbers"):
        read_rig(put(tmp_path, data))


def test_the_yaml_of_ros_is_read_as_intrinsics(tmp_path):
    (front,) = read_intrinsics(put(tmp_path, ROS, "front.yaml"))
    assert (front.name, front.size_px, front.distortion_model) == ("front", (1280, 720), "brown")
    np.testing.assert_allclose(front.K[0], [900, 0, 640])
    np.testing.assert_allclose(front.distortion, [-0.2, 0.05, 0.001, -0.002, 0.0])
    with pytest.raises(CalibrationError, match=r"no position.*--intrinsics"):
        read_rig(tmp_path / "front.yaml")


def test_files_that_opencv_writes_are_read_from_a_directory(tmp_path):
    for name, lens in (("left", "brown"), ("right", "rational")):
        camera = ring(1, lens).cameras[0]
        file = cv2.FileStorage(str(tmp_path / f"{name}.yml"), cv2.FILE_STORAGE_WRITE)
        file.write("image_width", 1920)
        file.write("image_height", 1080)
        file.write("camera_matrix", camera.K)
        file.write("distortion_coefficients", LENSES[lens].reshape(1, -1))
        file.release()
    found = read_intrinsics(tmp_path)
    assert found.names == ("left", "right")
    np.testing.assert_allclose(found["right"].distortion, LENSES["rational"])


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("plumb_bob", "magic", "distortion_model 'magic' is unknown; known: plumb_bob"),
        ("[900.0, ", "[", "camera_matrix must be 3 x 3 numbers"),
        ("image_height: 720", "", "image_height is missing"),
        ("-0.2, 0.05", "-0.2", "distortion_coefficients must be a list of numbers"),
    ],
)
def test_faults_of_the_yaml_of_a_camera_are_told(tmp_path, old, new, says):
    text = ROS.replace(old, new)
    with pytest.raises(CalibrationError, match=says):
        read_intrinsics(put(tmp_path, text, "front.yaml"))
