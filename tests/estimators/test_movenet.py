"""The default estimator on real pictures; positions were read off them by hand."""

import sys
from concurrent.futures import ThreadPoolExecutor
from itertools import islice

import numpy as np
import pytest

from trecsim.errors import ConfigError, SetupError
from trecsim.estimators import load
from trecsim.estimators.letterbox import scale
from trecsim.estimators.movenet import MoveNet, MoveNetSettings
from trecsim.skeleton import COCO17
from trecsim.sources import VideoFile
from trecsim.values import Frame

CAMERAS = ("cam01", "cam02", "cam03", "cam04")
PEOPLE = {"cam01": 3, "cam02": 3, "cam03": 2, "cam04": 2}  # the bystander is in two views only


@pytest.fixture(scope="session")
def pictures(shared_data):
    """Return the eleventh image of each camera of a scene with two people and a bystander."""
    folder = shared_data / "pose2sim_demo" / "MultiPerson" / "videos"
    if not folder.is_dir():
        pytest.skip("the recording pose2sim_demo is not among the test data")
    videos = [VideoFile(folder / f"{camera}.mp4", camera) for camera in CAMERAS]
    return {video.camera: next(islice(video, 10, None)) for video in videos}


@pytest.fixture(scope="session")
def movenet(movenet_file):
    """Return the estimator as it is by default, with the same numbers on every machine."""
    return MoveNet(movenet_file, MoveNetSettings(precision="f32"))


@pytest.fixture(scope="session")
def found(movenet, pictures):
    """Return what it finds in each of the pictures."""
    return {camera: movenet(frame) for camera, frame in pictures.items()}


@pytest.fixture(scope="session")
def found_at_once(movenet_file, pictures):
    """Return what it finds without a second look."""
    model = MoveNet(movenet_file, MoveNetSettings(second_look=0, precision="f32"))
    return {camera: model(frame) for camera, frame in pictures.items()}


def nearest(poses, joint, xy_px):
    """Return how far the nearest joint of that name is from a point [px]."""
    return np.nanmin(np.linalg.norm(poses.xy_px[:, COCO17.index(joint)] - xy_px, axis=-1))


@pytest.mark.parametrize("camera", CAMERAS)
def test_everybody_is_found_once(found, pictures, camera):
    poses = found[camera]
    assert len(poses.person_score) == PEOPLE[camera]
    assert (poses.camera, poses.t_s) == (camera, pictures[camera].t_s)


@pytest.mark.parametrize(
    ("camera", "joint", "xy_px"),
    [
        ("cam01", "right_wrist", (285, 705)),  # of the man
        ("cam01", "left_hip", (830, 1315)),  # of the woman
        ("cam02", "nose", (574, 460)),  # of the man
        ("cam02", "right_ankle", (575, 1096)),
        ("cam02", "left_wrist", (335, 1025)),  # of the woman
        ("cam03", "left_ankle", (535, 1195)),
        ("cam03", "right_ankle", (690, 1270)),
        ("cam04", "right_wrist", (652, 780)),
        ("cam04", "left_ankle", (540, 1345)),
    ],
)
def test_joints_are_where_they_are_seen(found, camera, joint, xy_px):
    mirror = COCO17.joints[COCO17.mirror[COCO17.index(joint)]]
    poses = found[camera]
    # Left and right of somebody seen from behind are the tracker's business.
    assert min(nearest(poses, joint, xy_px), nearest(poses, mirror, xy_px)) < 40


def test_computing_in_bfloat16_moves_joints_by_less_than_they_are_uncertain(found, pictures):
    quick = load("movenet")
    for camera, frame in pictures.items():
        exact, rough = found[camera], quick(frame)
        assert len(exact.person_score) == len(rough.person_score)
        for xy_px in exact.xy_px:
            distance = np.nanmedian(np.linalg.norm(rough.xy_px - xy_px, axis=-1), axis=1)
            assert distance.min() < 8  # of about a thousand pixels of height


def test_it_is_the_same_whether_the_video_or_the_estimator_makes_images_smaller(
    movenet, found, pictures
):
    whole = pictures["cam02"]
    width, height = whole.image.shape[1::-1]
    small = scale(whole.image, (round(width * 512 / height), 512))
    poses = movenet(Frame("cam02", 0, 0.0, small))
    factor = np.array([width, height]) / small.shape[1::-1]
    np.testing.assert_allclose((poses.xy_px + 0.5) * factor - 0.5, found["cam02"].xy_px, atol=1e-6)


def test_more_than_six_people_are_found(movenet_file, pictures):
    small = [scale(pictures[camera].image, (363, 640)) for camera in CAMERAS]
    crowd = np.vstack([np.hstack(small), np.hstack(small[::-1])])  # twice ten people
    model = MoveNet(movenet_file, MoveNetSettings(long_side=1440, precision="f32"))
    assert 15 <= len(model(Frame("crowd", 0, 0.0, crowd)).person_score) <= 20
    few = MoveNet(movenet_file, MoveNetSettings(long_side=1440, max_people=7, precision="f32"))
    assert len(few(Frame("crowd", 0, 0.0, crowd)).person_score) == 7


@pytest.mark.parametrize(
    ("camera", "rows", "columns"),
    [
        ("cam01", (342, 798), (158, 706)),
        ("cam02", (392, 808), (308, 808)),
        ("cam03", (439, 929), (308, 896)),
    ],
)
def test_a_second_look_finds_who_fills_the_image(
    movenet_file, movenet, found, pictures, camera, rows, columns
):
    close = np.ascontiguousarray(pictures[camera].image[slice(*rows), slice(*columns)])
    once = MoveNet(movenet_file, MoveNetSettings(second_look=0, precision="f32"))
    assert len(once(Frame(camera, 0, 0.0, close)).person_score) == 0
    best = movenet(Frame(camera, 0, 0.0, close)).xy_px[0] + [columns[0], rows[0]]
    distance = np.nanmedian(np.linalg.norm(found[camera].xy_px - best, axis=-1), axis=1)
    assert distance.min() < 15


@pytest.mark.parametrize("camera", CAMERAS)
def test_a_second_look_adds_nobody_who_is_there_already(found, found_at_once, camera):
    np.testing.assert_array_equal(found[camera].xy_px, found_at_once[camera].xy_px)


@pytest.mark.parametrize("grey", [0, 128, 255])
def test_an_empty_image_has_nobody(movenet, grey):
    poses = movenet(Frame("a", 0, 0.0, np.full((270, 480, 3), grey, np.uint8)))
    assert poses.xy_px.shape == (0, 17, 2)


@pytest.mark.parametrize("size_px", [(1, 1), (1, 700), (900, 2), (33, 31)])
def test_odd_images_do_no_harm(movenet, size_px):
    poses = movenet(Frame("a", 0, 0.0, np.zeros((size_px[1], size_px[0], 3), np.uint8)))
    assert poses.score.shape[1] == 17


def test_threads_do_not_disturb_each_other(movenet_file, pictures):
    model = MoveNet(movenet_file, MoveNetSettings(threads=2, long_side=256))
    frames = [frame for frame in pictures.values() for _ in range(3)]
    alone = [model(frame) for frame in frames]
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(model, frames))
    for one, other in zip(alone, together, strict=True):
        np.testing.assert_array_equal(one.xy_px, other.xy_px)
        np.testing.assert_array_equal(one.score, other.score)


def test_images_need_not_be_larger_than_the_network_sees_them(movenet_file):
    model = MoveNet(movenet_file, MoveNetSettings(long_side=320, threads=1))
    assert model.image_limit_px == (320, 320)


def test_something_after_a_colon_is_refused():
    with pytest.raises(ConfigError, match="takes nothing after a colon, got 'x'"):
        load("movenet:x")


@pytest.mark.parametrize("content", [b"", b"no model", bytes(4096)])
def test_a_file_that_is_no_model_is_told(tmp_path, content):
    pytest.importorskip("openvino")
    path = tmp_path / "m.tflite"
    path.write_bytes(content)
    with pytest.raises(SetupError, match="OpenVINO does not take the model"):
        MoveNet(path, MoveNetSettings(threads=1))


def test_a_missing_openvino_is_told(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "openvino", None)
    with pytest.raises(SetupError, match=r"needs OpenVINO.*\[video\]"):
        MoveNet(tmp_path / "m.tflite", MoveNetSettings())
