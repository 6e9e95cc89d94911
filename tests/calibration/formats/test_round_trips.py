"""Project, write, read, project: for every format that is written."""

import dataclasses

import cv2
import numpy as np
import pytest

from made_rigs import ring
from trecsim.calibration import FORMATS, Floor, read_rig, write_rig
from trecsim.errors import CalibrationError
from trecsim.geometry.rig import Rig
from trecsim.geometry.rigid import inverse, rotation_vector

LENSES_OF = {
    "trecsim": ("none", "brown", "rational", "fisheye"),
    "mc-calib": ("none", "brown", "fisheye"),
    "pose2sim": ("none", "brown", "rational", "fisheye"),
    "anipose": ("none", "brown", "rational", "fisheye"),
    "easymocap": ("none", "brown", "rational"),
}
FILES = {
    "trecsim": "rig.toml",
    "mc-calib": "calibrated_cameras_data.yml",
    "pose2sim": "Calib.toml",
    "anipose": "calibration.toml",
    "easymocap": "calibration",
}
ALL = [
    (name, lens, unit_m)
    for name, lenses in LENSES_OF.items()
    for lens in lenses
    for unit_m in (1.0, 0.01)
    if name != "trecsim" or unit_m == 1.0
]


def nothing(_text):
    """Take a remark and forget it."""


def floor_under(camera):
    """Return the floor that leads from a camera's frame to the world."""
    T_world_cam = inverse(camera.T_cam_world)
    return Floor(
        tuple(np.rad2deg(rotation_vector(T_world_cam[:3, :3])).tolist()),
        tuple(T_world_cam[:3, 3].tolist()),
        "z",
    )


def assert_same_images(rig, other):
    xyz_m = np.random.default_rng(0).uniform([-2, -2, 0], [2, 2, 2], (100, 3))
    assert len(rig) == len(other)
    for mine, theirs in zip(rig, other, strict=True):
        assert mine.size_px == theirs.size_px
        expected = mine.project(xyz_m)
        assert np.isfinite(expected).any()
        np.testing.assert_allclose(theirs.project(xyz_m), expected, atol=1e-6)


def test_every_format_that_is_written_is_tested():
    assert {entry.name for entry in FORMATS if entry.write} == set(LENSES_OF)


@pytest.mark.parametrize(("name", "lens", "unit_m"), ALL)
def test_a_rig_comes_back_as_it_was_written(name, lens, unit_m, tmp_path):
    rig, path = ring(3, lens), tmp_path / FILES[name]
    write_rig(rig, path, format=name, unit_m=unit_m, remark=nothing)
    floor = floor_under(rig.cameras[0]) if name == "mc-calib" else None
    again = read_rig(path, unit_m=unit_m, floor=floor, remark=pytest.fail)
    assert_same_images(rig, again)
    if name != "mc-calib":
        assert again.names == rig.names


@pytest.mark.parametrize("name", [name for name in FILES if name != "anipose"])
def test_the_format_is_taken_from_the_name_of_the_file(name, tmp_path):
    path = tmp_path / FILES[name]
    write_rig(ring(2), path, remark=nothing)
    again = read_rig(path, format=name, floor=floor_under(ring(2).cameras[0]), remark=nothing)
    assert len(again) == 2


def test_our_own_file_comes_back_to_the_last_bit(tmp_path):
    clock = {"time_offset_s": -0.0125, "time_drift_ppm": 12.5, "time_ref_s": 1.7e9}
    rig = Rig(tuple(dataclasses.replace(c, **clock) for c in ring(3, "rational")))
    write_rig(rig, tmp_path / "rig.toml")
    for mine, theirs in zip(rig, read_rig(tmp_path / "rig.toml"), strict=True):
        for key in ("K", "T_cam_world", "distortion"):
            np.testing.assert_array_equal(getattr(mine, key), getattr(theirs, key))
        for key in ("name", "size_px", "distortion_model", *clock):
            assert getattr(mine, key) == getattr(theirs, key)


@pytest.mark.parametrize("name", ['a "b"\\', "caméra 1", "a.b", "#=[]", "null", "📷"])
def test_any_printable_name_comes_back(name, tmp_path):
    rig = Rig((dataclasses.replace(ring(2).cameras[0], name=name),))
    for file in ("rig.toml", "Calib.toml"):
        write_rig(rig, tmp_path / file)
        assert read_rig(tmp_path / file).names == (name,)


@pytest.mark.parametrize("name", ["mc-calib", "easymocap"])
def test_opencv_reads_the_yaml_that_is_written(name, tmp_path):
    rig, path = ring(2, "brown"), tmp_path / FILES[name]
    write_rig(rig, path, format=name, remark=nothing)
    file = path if name == "mc-calib" else path / "intri.yml"
    storage = cv2.FileStorage(str(file), cv2.FILE_STORAGE_READ)
    node = storage.getNode("camera_1").getNode("camera_matrix")
    K = node.mat() if name == "mc-calib" else storage.getNode("K_cam1").mat()
    storage.release()
    np.testing.assert_array_equal(K, rig["cam1"].K)


def test_what_a_format_cannot_hold_is_refused_or_told(tmp_path):
    late = Rig(tuple(dataclasses.replace(c, time_offset_s=0.5) for c in ring(2)))
    remarks = []
    write_rig(late, tmp_path / "Calib.toml", remark=remarks.append)
    write_rig(late, tmp_path / "calibration", remark=remarks.append)
    assert [text.partition(";")[0] for text in remarks] == ["the format has no time offsets"] * 2
    remarks.clear()
    write_rig(late, tmp_path / "rig.yml", remark=remarks.append)
    assert any("camera_1 is 'cam1'" in text for text in remarks)
    assert any("--floor-rotation-deg" in text for text in remarks)
    with pytest.raises(CalibrationError, match="five distortion coefficients"):
        write_rig(ring(2, "rational"), tmp_path / "rational.yml")
    with pytest.raises(CalibrationError, match="has no fisheye lenses"):
        write_rig(ring(2, "fisheye"), tmp_path / "fisheye")
    named = Rig((dataclasses.replace(ring(2).cameras[0], name="north east"),))
    with pytest.raises(CalibrationError, match="letters, digits, - and _"):
        write_rig(named, tmp_path / "named")
    with pytest.raises(CalibrationError, match="in metres always"):
        write_rig(ring(2), tmp_path / "rig.toml", unit_m=0.01)
    assert sorted(file.name for file in tmp_path.iterdir()) == [
        "Calib.toml",
        "calibration",
        "rig.yml",
    ]


def test_a_format_that_cannot_be_told_or_is_not_written_is_refused(tmp_path):
    with pytest.raises(CalibrationError, match=r"cannot tell from the name 'rig\.xyz'"):
        write_rig(ring(2), tmp_path / "rig.xyz")
    with pytest.raises(CalibrationError, match="does not write it; it writes: trecsim"):
        write_rig(ring(2), tmp_path / "rig.json", format="panoptic")
    with pytest.raises(CalibrationError, match="did you mean 'pose2sim'"):
        write_rig(ring(2), tmp_path / "rig.toml", format="pose2sin")
    assert not list(tmp_path.iterdir())
