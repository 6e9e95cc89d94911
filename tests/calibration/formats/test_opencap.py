"""OpenCap's pickles: arrays are read, and nothing else."""

import os
import pickle

import numpy as np
import pytest

from made_rigs import ring
from trecsim.calibration import read_rig
from trecsim.errors import CalibrationError

POINTS = np.array([[0.0, 0, 1], [0.5, -0.4, 0.2], [-0.6, 0.3, 1.6]])
BOARD = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])  # from the world; its y points down


def fields(camera):
    T = camera.T_cam_world
    return {
        "intrinsicMat": camera.K,
        "distortion": camera.distortion.reshape(1, -1),
        "imageSize": np.array([[1080.0], [1920.0]]),
        "rotation": T[:3, :3] @ BOARD.T,
        "translation": 1e3 * T[:3, 3:],
    }


def put(folder, name, data, protocol=4):
    path = folder / name / "cameraIntrinsicsExtrinsics.pickle"
    path.parent.mkdir(parents=True)
    path.write_bytes(data if isinstance(data, bytes) else pickle.dumps(data, protocol))
    return path


@pytest.mark.parametrize("protocol", [2, 4, 5])
def test_a_session_projects_as_the_cameras_in_it(tmp_path, protocol):
    rig = ring(3, "brown")
    for camera in rig:
        put(tmp_path / "Videos", camera.name, fields(camera), protocol)
    found = read_rig(tmp_path, remark=lambda _: None)
    assert found.names == rig.names
    for one, true in zip(found, rig, strict=True):
        np.testing.assert_allclose(one.project(POINTS), true.project(POINTS), atol=1e-6)
        assert one.size_px == (1920, 1080)


class Harm:
    def __reduce__(self):
        return os.mkdir, ("harm",)


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (Harm(), "it asks for .*mkdir, expected arrays and text alone"),
        (np.array([Harm()], dtype=object), "it asks for|expected arrays of numbers"),
        ({"intrinsicMat": np.array(["a"])}, "expected arrays of numbers"),
        (b"not a pickle", "is no camera of OpenCap"),
        (b"x" * 2**17, "more than 64 KiB"),
        ([1, 2], "expected names with values"),
    ],
)
def test_whatever_else_a_pickle_holds_is_refused_and_never_run(tmp_path, monkeypatch, data, says):
    monkeypatch.chdir(tmp_path)
    put(tmp_path / "session", "Cam0", data)
    with pytest.raises(CalibrationError, match=says):
        read_rig(tmp_path / "session")
    assert not (tmp_path / "harm").exists()


def test_an_array_that_claims_to_be_huge_is_not_made(tmp_path):
    data = pickle.dumps(fields(ring(1, "brown").cameras[0]), 4)
    for old in (b"K\x03K\x03\x86",):
        assert old in data
        data = data.replace(old, b"J\xff\xff\xff\x7fJ\xff\xff\xff\x7f\x86", 1)
    put(tmp_path, "Cam0", data)
    with pytest.raises(CalibrationError, match="is no camera of OpenCap"):
        read_rig(tmp_path)


def test_what_is_missing_is_told_with_the_camera(tmp_path):
    data = fields(ring(1, "brown").cameras[0])
    data["rotation"] = np.eye(2)
    put(tmp_path, "Cam0", data)
    with pytest.raises(CalibrationError, match=r"camera 'Cam0': rotation must be 3 x 3 numbers"):
        read_rig(tmp_path)
