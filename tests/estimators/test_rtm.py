import sys
from types import ModuleType, SimpleNamespace
from urllib.error import URLError

import numpy as np
import pytest

from made_onnx import write_onnx
from trecsim.errors import ConfigError, SetupError
from trecsim.estimators import load, rtm
from trecsim.estimators.rtm import RtmPose, RtmPoseSettings
from trecsim.values import Frame


def frame():
    image = np.zeros((64, 128, 3), np.uint8)
    image[..., 0] = 200  # red
    return Frame("north", 0, 2.0, image)


@pytest.fixture
def rtmlib(tmp_path, monkeypatch):
    """Stand in for rtmlib, so that no test asks the makers for weights."""
    dets = np.array([[[10, 10, 40, 60, 0.9]]], np.float32)
    joints = np.full((1, 1, 17, 3), 0.5, np.float32)
    file = write_onnx(tmp_path / "r.onnx", (1, 3, 64, 64), {"dets": dets, "keypoints": joints})
    made = SimpleNamespace(address=None, fault=None, built=None)

    def download_checkpoint(address, progress=True):
        made.address = address
        if made.fault:
            raise made.fault
        return str(file)

    class Body:
        def __init__(self, **how):
            print("load", how["pose"])
            made.built = how

        def __call__(self, image):
            assert image[0, 0].tolist() == [0, 0, 200]  # BGR
            xy = np.stack([np.arange(34.0).reshape(17, 2), 50 + np.arange(34.0).reshape(17, 2)])
            return xy, np.stack([np.full(17, 0.9), np.full(17, 0.1)])

    Body.RTMO_MODE = {"lightweight": {"pose": "maker://rtmo-s.zip"}}
    balanced = {"det": "maker://det.zip", "det_input_size": (640, 640)}
    balanced |= {"pose": "maker://pose.zip", "pose_input_size": (192, 256)}
    Body.MODE = {"balanced": balanced}
    package, tools, files = ModuleType("rtmlib"), ModuleType("rtmlib.tools"), ModuleType("file")
    package.Body, package.tools, tools.file = Body, tools, files
    files.download_checkpoint = download_checkpoint
    files._get_rtmhub_dir = lambda: str(tmp_path / "hub")
    monkeypatch.setitem(sys.modules, "rtmlib", package)
    monkeypatch.setitem(sys.modules, "rtmlib.tools", tools)
    monkeypatch.setitem(sys.modules, "rtmlib.tools.file", files)
    return made


def test_rtmo_runs_on_the_weights_that_rtmlib_keeps(rtmlib):
    pytest.importorskip("onnxruntime")
    model = load("rtmlib:rtmo-s", min_person_score=0.5)
    assert rtmlib.address == "maker://rtmo-s.zip"
    assert model.layout.name == "RTMO"
    assert len(model(frame()).person_score) == 1


def test_rtmpose_gives_the_people_that_score_enough(rtmlib, capsys):
    model = load("rtmlib:rtmpose-m")
    poses = model(frame())
    np.testing.assert_allclose(poses.person_score, [0.9])
    np.testing.assert_allclose(poses.xy_px[0], np.arange(34.0).reshape(17, 2))
    assert (poses.camera, poses.t_s) == ("north", 2.0)
    assert rtmlib.built["det_input_size"] == (640, 640)
    assert capsys.readouterr().out == ""  # what rtmlib prints must not mix with results


def test_nobody_as_rtmlib_tells_it_is_nobody():
    nobody = RtmPose(lambda image: (np.zeros((1, 17, 2)), np.zeros((1, 17))), RtmPoseSettings())
    assert nobody(frame()).xy_px.shape == (0, 17, 2)
    nobody = RtmPose(lambda image: (np.zeros((0, 17, 2)), np.zeros((0, 17))), RtmPoseSettings())
    assert nobody(frame()).xy_px.shape == (0, 17, 2)


@pytest.mark.parametrize("name", ["rtmo-s", "rtmpose-m"])
def test_without_a_network_it_says_what_to_put_where(rtmlib, tmp_path, name):
    rtmlib.fault = URLError("no route")
    with pytest.raises(SetupError) as caught:
        load(f"rtmlib:{name}")
    told = str(caught.value)
    assert "could not fetch" in told
    assert "maker://" in told
    assert str(tmp_path / "hub" / "checkpoints") in told


def test_an_unknown_model_is_told():
    with pytest.raises(ConfigError, match="no model 'rtmo-xxl'; known: rtmo-s"):
        load("rtmlib:rtmo-xxl")


def test_settings_of_the_other_kind_are_refused(rtmlib):
    with pytest.raises(ConfigError, match="'threads' is unknown"):
        load("rtmlib:rtmpose-m", threads=2)


def test_missing_rtmlib_is_told(monkeypatch):
    monkeypatch.setitem(sys.modules, "rtmlib", None)
    with pytest.raises(SetupError, match=r"needs rtmlib.*\[rtmlib\]"):
        load("rtmlib")


def test_the_installed_rtmlib_has_what_is_used():
    rtmlib = pytest.importorskip("rtmlib")
    for mode in rtm._RTMO.values():
        assert "pose" in rtmlib.Body.RTMO_MODE[mode]
    for mode in rtm._RTMPOSE.values():
        files = {"det", "det_input_size", "pose", "pose_input_size"}
        assert files <= rtmlib.Body.MODE[mode].keys()
