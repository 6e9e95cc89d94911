"""What every estimator keeps to: ours, and those that other packages install."""

from concurrent.futures import ThreadPoolExecutor
from itertools import islice

import numpy as np
import pytest

from made_onnx import write_onnx
from trecsim.errors import Error
from trecsim.estimators import Estimator2D, image_limit_px, load, names, workers
from trecsim.skeleton import SKELETONS
from trecsim.sources import VideoFile
from trecsim.values import Frame

OURS = ("movenet", "onnx", "rtmlib")
PLUG_INS = [name for name in names() if name not in OURS]


def made_onnx(folder):
    table = np.zeros((1, 56, 84), np.float32)
    table[0, :5, 0] = [32, 32, 20, 40, 0.9]
    table[0, 5:, 0] = np.tile([30, 30, 0.8], 17) + np.arange(51)
    table[0, 7::3, 0] = 0.8
    return write_onnx(folder / "made.onnx", (1, 3, 64, 64), {"output0": table})


@pytest.fixture(scope="module", params=["movenet", "onnx", *PLUG_INS])
def estimator(request, tmp_path_factory):
    if request.param == "movenet":
        pytest.importorskip("openvino")
        return load("movenet", long_side=256, threads=2)
    if request.param == "onnx":
        pytest.importorskip("onnxruntime")
        return load(f"onnx:{made_onnx(tmp_path_factory.mktemp('onnx'))}")
    try:
        return load(request.param)
    except Error as error:
        pytest.skip(f"{request.param} cannot be loaded without an argument: {error}")


@pytest.fixture(scope="module")
def images(shared_data_or_none):
    """Return images of many shapes; one with people, where the test data is."""
    noise = np.random.default_rng(3).integers(0, 256, (90, 160, 3), dtype=np.uint8)
    shapes = [(48, 64), (64, 48), (1, 1), (3, 500)]
    made = [noise, *(np.full((*shape, 3), 90, np.uint8) for shape in shapes)]
    if shared_data_or_none is not None:
        video = shared_data_or_none / "pose2sim_demo" / "MultiPerson" / "videos" / "cam04.mp4"
        made += [frame.image for frame in islice(VideoFile(video, "cam04"), 2)]
    return made


@pytest.fixture(scope="module")
def shared_data_or_none(request):
    try:
        return request.getfixturevalue("shared_data")
    except pytest.skip.Exception:
        return None


@pytest.fixture(scope="module")
def pairs(estimator, images):
    """Return frames and what the estimator makes of them."""
    frames = [Frame(f"cam{i}", i, 10.0 + i, image) for i, image in enumerate(images)]
    return [(frame, estimator(frame)) for frame in frames]


def test_it_is_an_estimator_with_a_known_skeleton(estimator):
    assert isinstance(estimator, Estimator2D)
    assert estimator.skeleton in SKELETONS


def test_camera_and_time_are_those_of_the_frame(pairs):
    for frame, poses in pairs:
        assert (poses.camera, poses.t_s) == (frame.camera, frame.t_s)


def test_shapes_agree_with_the_skeleton(estimator, pairs):
    joints = len(SKELETONS[estimator.skeleton].joints)
    for _, poses in pairs:
        people = len(poses.person_score)
        assert poses.xy_px.shape == (people, joints, 2)
        assert poses.score.shape == (people, joints)
        assert poses.person_score.shape == (people,)
        assert {poses.xy_px.dtype, poses.score.dtype, poses.person_score.dtype} == {
            np.dtype(np.float64)
        }


def test_scores_run_from_zero_to_one(pairs):
    for _, poses in pairs:
        for score in (poses.score, poses.person_score):
            assert ((score >= 0) & (score <= 1)).all()


def test_a_missing_key_point_is_nan_with_score_zero_and_nobody_lacks_all(pairs):
    for _, poses in pairs:
        seen = np.isfinite(poses.xy_px).all(axis=-1)
        np.testing.assert_array_equal(seen, poses.score > 0)
        assert np.isnan(poses.xy_px[~seen]).all()
        assert seen.any(axis=1).all()


def test_key_points_lie_in_or_near_the_image(pairs):
    for frame, poses in pairs:
        height, width, _ = frame.image.shape
        reach = max(width, height)
        for axis, side in enumerate((width, height)):
            xy_px = poses.xy_px[..., axis][poses.score > 0]
            assert ((xy_px > -reach) & (xy_px < side + reach)).all()


def test_the_same_frame_gives_the_same_poses(estimator, pairs):
    for frame, poses in pairs:
        again = estimator(frame)
        np.testing.assert_array_equal(again.xy_px, poses.xy_px)
        np.testing.assert_array_equal(again.score, poses.score)


def test_the_image_is_left_as_it_was(estimator, images):
    for image in images:
        before = image.copy()
        image.setflags(write=False)
        estimator(Frame("a", 0, 0.0, image))
        np.testing.assert_array_equal(image, before)


def test_as_many_threads_as_it_says_may_call_it(estimator, pairs):
    with ThreadPoolExecutor(workers(estimator)) as pool:
        found = list(pool.map(estimator, [frame for frame, _ in pairs]))
    for one, (_, poses) in zip(found, pairs, strict=True):
        np.testing.assert_array_equal(one.xy_px, poses.xy_px)


def test_it_says_how_large_images_need_to_be(estimator):
    limit_px = image_limit_px(estimator)
    assert limit_px is None or (len(limit_px) == 2 and min(limit_px) >= 1)
    assert workers(estimator) >= 1
