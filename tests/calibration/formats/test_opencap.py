"""OpenCap's pickles: arrays are read, and nothing else."""

import os
import pickle

import numpy as np
import pytest

from made_rigs import ring
from trecsim.calibration import read_rig
from trecsim.calibration.formats import opencap
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


def pickled(value):
    """Return the pickle of a mapping whose field `rotation` an operation of ours makes."""
    return b"\x80\x04}X\x08\x00\x00\x00rotation" + value + b"s."


def number(n):
    return b"\x8a\x08" + n.to_bytes(8, "little")


ARRAY, KIND = b"cnumpy\nndarray\n", b"cnumpy\ndtype\n(X\x03\x00\x00\x00>f8tR"
EMPTY = b"cnumpy.core.multiarray\n_reconstruct\n(" + ARRAY + b"tR"
LINE = EMPTY + b"(K\x01K\x09\x85"
NINE = b"C\x48" + b"A" * 72
NESTED = b"](K\x01K\x01eq\x00" + b"".join(
    b"](" + b"h" + bytes([n]) + b"h" + bytes([n]) + b"eq" + bytes([n + 1]) for n in range(60)
)


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (pickled(ARRAY + b"(" + number(10**10) + b"\x85" + KIND + b"tR"), "asks for numpy.ndarray"),
        (pickled(ARRAY + b"(K\x03\x85tR"), "asks for numpy.ndarray"),
        (pickled(LINE + KIND.replace(b">f8", b"O, ") + b"\x89" + NINE + b"tb"),
         "expected arrays of numbers"),
        (pickled(LINE + KIND.replace(b">f8", b"f,O") + b"\x89" + NINE + b"tb"),
         "expected arrays of numbers"),
        (pickled(b"cnumpy.core.numeric\n_frombuffer\n(" + number(4 * 10**9) + KIND
                 + number(5 * 10**8) + b"\x85X\x01\x00\x00\x00CtR"), "of other things"),
        (pickled(b"\x96" + number(2**40)[2:]), "it is damaged: .* only .* remain"),
        (pickled(EMPTY), "found one without them"),
        (b"\x80\x04\x95", "it is damaged"),
        (b"\x80\x04}h\x05.", "recalls a value"),
        (b"\x80\x04e.", "a mark is missing"),
        (b"\x80\x04}K\x01K\x02s.", "expected names with values"),
        (b"\x80\x04.", "takes more values than it gives"),
        (pickled(b"cos\nsystem\n(X\x04\x00\x00\x00exittR"), "asks for os.system"),
        (pickled(b"(X\x04\x00\x00\x00exitios\nsystem\n"), "asks for INST"),
    ],
)  # fmt: skip
def test_a_hostile_pickle_is_refused_in_one_line(tmp_path, data, says):
    put(tmp_path, "Cam0", data)
    with pytest.raises(CalibrationError, match=says) as error:
        read_rig(tmp_path)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("data", [pickled(b"(" + NESTED + b"t"), b"\x80\x04}r\xff\xff\xff\x7f."])
def test_a_small_pickle_that_swells_takes_no_memory(tmp_path, data):
    path = put(tmp_path, "Cam0", data)
    assert not opencap.read_pickle(path)


def test_what_a_pickle_says_of_the_kind_of_numbers_changes_no_memory(tmp_path):
    as_objects = b"(K\x03X\x01\x00\x00\x00>NNNJ\xff\xff\xff\xffJ\xff\xff\xff\xffK\x3ftb"
    array = EMPTY + b"(K\x01K\x03K\x03\x86" + KIND + as_objects + b"\x89" + NINE + b"tb"
    found = opencap.read_pickle(put(tmp_path, "Cam0", pickled(array)))["rotation"]
    np.testing.assert_array_equal(found, np.full((3, 3), np.frombuffer(b"A" * 8, ">f8")[0]))


@pytest.mark.parametrize("protocol", range(6))
def test_arrays_of_any_order_and_kind_come_back(tmp_path, protocol):
    fields = {
        "a": np.arange(6.0).reshape(2, 3), "b": np.asfortranarray(np.arange(6).reshape(2, 3)),
        "c": np.arange(3, dtype=">i4"), "d": np.float32([0.5]), "e": "text", "f": 3, "g": [1],
        "h": np.zeros((0, 2)),
    }  # fmt: skip
    found = opencap.read_pickle(put(tmp_path, "Cam0", fields, protocol))
    assert set(found) == set(fields) - {"g"}
    for name in "abcdefh":
        np.testing.assert_array_equal(found[name], fields[name])


def test_two_sessions_in_one_folder_are_not_mixed(tmp_path):
    for session in ("Monday", "Tuesday"):
        put(tmp_path / session, "Cam0", fields(ring(1, "brown").cameras[0]))
    with pytest.raises(CalibrationError, match=r"one file of each camera, found .*Monday"):
        read_rig(tmp_path)


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
