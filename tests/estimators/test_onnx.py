import sys

import numpy as np
import pytest

from made_onnx import write_onnx
from trecsim.errors import ConfigError, InputError, SetupError
from trecsim.estimators import load
from trecsim.estimators.onnx import OnnxEstimator, OnnxSettings
from trecsim.values import Frame

pytest.importorskip("onnxruntime")

INPUT = (1, 3, 64, 64)


def person(x=30.0, y=20.0, score=0.9):
    """Return a row of YOLO before suppression: box, score, 17 joints on a slanted line."""
    joints = np.stack([x + np.arange(17), y + 2 * np.arange(17), np.full(17, 0.8)], axis=1)
    return np.concatenate([[x + 8, y + 16, 16, 32, score], joints.ravel()]).astype(np.float32)


def yolo(path, *people, **how):
    table = np.zeros((1, 56, 84), np.float32)
    for index, row in enumerate(people):
        table[0, :, index] = row
    return write_onnx(path, INPUT, {"output0": table}, **how)


def frame(width=128, height=64):
    return Frame("north", 3, 1.5, np.zeros((height, width, 3), np.uint8))


@pytest.fixture
def file(tmp_path):
    return yolo(tmp_path / "a.onnx", person(), person(31, 21, 0.6), person(score=0.1))


def test_key_points_come_in_pixels_of_the_image(file):
    poses = load(f"onnx:{file}")(frame())
    assert (poses.camera, poses.t_s) == ("north", 1.5)
    np.testing.assert_allclose(poses.person_score, [0.9], rtol=1e-6)
    # 128 x 64 fills 64 x 32 of the input, centred: 16 px of padding above.
    expected = np.stack([(30 + np.arange(17)) * 2 - 0.5, (20 + 2 * np.arange(17) - 16) * 2 - 0.5])
    np.testing.assert_allclose(poses.xy_px[0], expected.T, rtol=1e-5)


def test_thresholds_are_the_users(file):
    assert len(load(f"onnx:{file}", min_person_score=0.95)(frame()).person_score) == 0
    assert len(load(f"onnx:{file}", min_joint_score=0.85)(frame()).person_score) == 0


def test_the_number_of_people_is_limited(tmp_path):
    file = yolo(tmp_path / "a.onnx", *(person(x, 10, 0.5) for x in (2, 22, 42)))
    assert len(load(f"onnx:{file}")(frame()).person_score) == 3
    assert len(load(f"onnx:{file}", max_people=2)(frame()).person_score) == 2


def test_a_fixed_input_limits_the_images(file):
    assert load(f"onnx:{file}", long_side=1024).image_limit_px == (64, 64)


def test_an_open_input_takes_the_long_side_of_the_user(tmp_path):
    shape = ("batch", 3, "height", "width")
    table = np.zeros((1, 56, 84), np.float32)
    table[0, :, 0] = person()
    file = write_onnx(tmp_path / "a.onnx", shape, {"output0": table})
    model = load(f"onnx:{file}", long_side=96)
    assert model.image_limit_px == (96, 96)
    poses = model(frame())
    np.testing.assert_allclose(poses.xy_px[0, 0], (np.array([30, 20]) * 128 / 96) - 0.5, rtol=1e-5)


def test_rtmo_and_movenet_files_run(tmp_path):
    dets = np.array([[[10, 10, 40, 60, 0.9]]], np.float32)
    joints = np.full((1, 1, 17, 3), 0.5, np.float32)
    joints[..., :2] = 20
    file = write_onnx(tmp_path / "r.onnx", INPUT, {"dets": dets, "keypoints": joints})
    np.testing.assert_allclose(load(f"onnx:{file}")(frame()).xy_px[0, 0], [40.5, 40.5])
    out = np.full((1, 6, 56), 0.5, np.float32)
    shape = (1, 64, 64, 3)
    file = write_onnx(tmp_path / "m.onnx", shape, {"out": out}, input_dtype="int32")
    assert len(load(f"onnx:{file}")(frame()).person_score) == 1  # six of the same are one


def test_a_yolov7_file_with_further_outputs_runs(tmp_path):
    rows = 3 * (8 * 8 + 4 * 4 + 2 * 2 + 1)
    table = np.zeros((1, rows, 57), np.float32)
    table[0, 7] = np.insert(person(), 5, 1.0)
    heads = {"a": np.zeros((1, 3, 8, 8, 57), np.float32), "out": table}
    file = write_onnx(tmp_path / "v7.onnx", INPUT, heads)
    poses = load(f"onnx:{file}")(frame())
    np.testing.assert_allclose(poses.xy_px[0, 0], [59.5, 7.5], rtol=1e-5)


def test_a_file_that_is_not_there_is_told(tmp_path):
    with pytest.raises(InputError, match="there is no file"):
        load(f"onnx:{tmp_path / 'none.onnx'}")


def test_a_spec_without_a_file_is_told():
    with pytest.raises(ConfigError, match="onnx:FILE"):
        load("onnx")


@pytest.mark.parametrize("content", [b"", b"no network at all", bytes(1000)])
def test_a_file_that_is_no_network_is_told(tmp_path, content):
    path = tmp_path / "a.onnx"
    path.write_bytes(content)
    with pytest.raises(InputError, match="no ONNX file that can be run here"):
        load(f"onnx:{path}")


def test_a_truncated_network_is_told(tmp_path, file):
    path = tmp_path / "b.onnx"
    path.write_bytes(file.read_bytes()[:-500])
    with pytest.raises(InputError, match="no ONNX file that can be run here"):
        load(f"onnx:{path}")


def test_an_unknown_layout_is_told_with_the_file(tmp_path):
    file = write_onnx(tmp_path / "a.onnx", INPUT, {"probabilities": np.zeros((1, 1000))})
    with pytest.raises(ConfigError, match=r"a\.onnx: its layout is not known.*probabilities"):
        load(f"onnx:{file}")


def test_an_output_other_than_the_file_says_is_told(tmp_path):
    dets = np.zeros((1, 2, 5), np.float32)
    joints = np.zeros((1, 3, 17, 3), np.float32)
    shown = {"dets": (1, "n", 5), "keypoints": (1, "m", 17, 3)}
    file = write_onnx(tmp_path / "a.onnx", INPUT, {"dets": dets, "keypoints": joints}, shown=shown)
    with pytest.raises(InputError, match="taken for RTMO, puts out 1 x 2 x 5, 1 x 3 x 17 x 3"):
        load(f"onnx:{file}")(frame())


def test_a_device_that_is_not_here_is_told(file):
    with pytest.raises(SetupError, match=r"cannot use the device 'coreml'; it can use: .*cpu"):
        load(f"onnx:{file}", device="coreml")


def test_threads_are_shared_between_images_and_the_layers_of_one(file):
    assert OnnxEstimator(file, OnnxSettings(threads=8)).workers == 4
    assert OnnxEstimator(file, OnnxSettings(threads=1)).workers == 1


def test_a_missing_onnx_runtime_is_told(file, monkeypatch):
    monkeypatch.setitem(sys.modules, "onnxruntime", None)
    with pytest.raises(SetupError, match=r"needs ONNX Runtime.*\[onnx\]"):
        load(f"onnx:{file}")
