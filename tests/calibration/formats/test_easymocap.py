import numpy as np
import pytest

from made_rigs import ring
from trecsim.calibration import read_rig, write_rig
from trecsim.errors import CalibrationError

INTRINSICS = """%YAML:1.0
---
names:
  - "1"
  - "01"
K_1: !!opencv-matrix
  rows: 3
  cols: 3
  dt: d
  data: [900.000000, 0.000000, 960.300000, 0.000000, 900.000000, 540.200000, 0, 0, 1]
dist_1: !!opencv-matrix
  rows: 1
  cols: 5
  dt: d
  data: [-0.1, 0.0, 0.0, 0.0, 0.0]
K_01: !!opencv-matrix
  rows: 3
  cols: 3
  dt: d
  data: [800.000000, 0.000000, 959.900000, 0.000000, 800.000000, 539.800000, 0, 0, 1]
"""
EXTRINSICS = """%YAML:1.0
---
names:
  - "1"
  - "01"
R_1: !!opencv-matrix
  rows: 3
  cols: 1
  dt: d
  data: [1.57079632679, 0.0, 0.0]
T_1: !!opencv-matrix
  rows: 3
  cols: 1
  dt: d
  data: [0.0, 1.5, 3.0]
Rot_01: !!opencv-matrix
  rows: 3
  cols: 3
  dt: d
  data: [1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0]
T_01: !!opencv-matrix
  rows: 3
  cols: 1
  dt: d
  data: [0.5, 1.5, 3.0]
"""


def write(folder, intrinsics=INTRINSICS, extrinsics=EXTRINSICS):
    (folder / "intri.yml").write_bytes(intrinsics.replace("\n", "\r\n").encode())
    (folder / "extri.yml").write_bytes(extrinsics.replace("\n", "\r\n").encode())
    return folder


@pytest.mark.parametrize("given", [".", "intri.yml", "extri.yml"])
def test_the_pair_is_read_from_the_directory_or_either_file(given, tmp_path):
    rig = read_rig(write(tmp_path) / given, size_px=(1920, 1080), remark=pytest.fail)
    assert rig.names == ("1", "01")
    np.testing.assert_allclose(rig["1"].position_m, [0.0, -3.0, 1.5], atol=1e-9)
    np.testing.assert_allclose(rig["01"].position_m, [-0.5, -3.0, 1.5], atol=1e-9)
    assert (rig["1"].K[0, 0], rig["01"].K[0, 0]) == (900.0, 800.0)
    assert (rig["1"].distortion[0], rig["01"].distortion[0]) == (-0.1, 0.0)


def test_without_a_size_twice_the_principal_point_is_taken_and_remarked(tmp_path):
    remarks = []
    rig = read_rig(write(tmp_path), remark=remarks.append)
    assert (rig["1"].size_px, rig["01"].size_px) == ((1921, 1080), (1920, 1080))
    assert len(remarks) == 2
    assert "camera '1': EasyMocap does not say the size of its images" in remarks[0]


def test_a_size_in_the_file_is_taken(tmp_path):
    sizes = "W_1: 1920\nH_1: 1080\nW_01: 1280\nH_01: 720\n"
    rig = read_rig(write(tmp_path, INTRINSICS + sizes), remark=pytest.fail)
    assert (rig["1"].size_px, rig["01"].size_px) == ((1920, 1080), (1280, 720))


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("K_1:", "K_7:", "camera '1': K is missing"),
        ("T_1:", "T_7:", "camera '1': T is missing"),
        ("Rot_01:", "Rot_7:", "camera '01': R is missing"),
        ("[900.000000", "[0.000000", "focal lengths in K must be positive"),
        ("[1.57079632679,", "[.Nan,", "R must be finite"),
    ],
)
def test_what_is_wrong_is_told(old, new, says, tmp_path):
    intrinsics, extrinsics = INTRINSICS.replace(old, new), EXTRINSICS.replace(old, new)
    write(tmp_path, intrinsics, extrinsics)
    with pytest.raises(CalibrationError, match=says):
        read_rig(tmp_path, size_px=(1920, 1080))


def test_cameras_without_a_pose_or_without_a_lens_are_left_out_with_a_remark(tmp_path):
    remarks = []
    write(tmp_path, extrinsics=EXTRINSICS.replace('  - "1"\n', ""))
    rig = read_rig(tmp_path, size_px=(1920, 1080), remark=remarks.append)
    assert rig.names == ("01",)
    write(tmp_path, intrinsics=INTRINSICS.replace('  - "01"\n', ""))
    rig = read_rig(tmp_path, size_px=(1920, 1080), remark=remarks.append)
    assert rig.names == ("1",)
    told = [remark.partition(": ")[2] for remark in remarks]
    assert told == [
        "cameras without a pose in extri.yml are left out: 1",
        "cameras without a lens in intri.yml are left out: 01",
    ]


def test_a_pair_without_a_camera_in_common_is_refused(tmp_path):
    write(tmp_path, extrinsics=EXTRINSICS.replace('"1"', '"7"').replace('"01"', '"8"'))
    with pytest.raises(CalibrationError, match="its files have no camera in common"):
        read_rig(tmp_path)


def test_a_pair_without_names_or_without_its_other_half_is_told(tmp_path):
    write(tmp_path, "names: []\nK_1: 1\n", "names: []\nR_1: 1\n")
    with pytest.raises(CalibrationError, match="its list of names is empty"):
        read_rig(tmp_path)
    (tmp_path / "extri.yml").unlink()
    with pytest.raises(CalibrationError, match=r"extri\.yml: No such file"):
        read_rig(tmp_path)


def test_the_directory_is_made_and_an_older_pair_is_replaced(tmp_path):
    folder = tmp_path / "new" / "calibration"
    write_rig(ring(2), folder)
    write_rig(ring(3), folder)
    assert read_rig(folder).names == ("cam0", "cam1", "cam2")
    assert sorted(file.name for file in folder.iterdir()) == ["extri.yml", "intri.yml"]
