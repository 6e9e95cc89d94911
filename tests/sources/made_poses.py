"""2D poses for the tests of their files."""

import json

import numpy as np

from trecsim.values import Poses2D


def made_poses(camera: str, t_s: float, n_people: int, seed: int = 0) -> Poses2D:
    """Return random people whose numbers survive the rounding of files; some joints missing."""
    rng = np.random.default_rng(seed)
    xy_px = rng.integers(-10_000, 200_000, (n_people, 17, 2)) / 100.0
    score = rng.integers(1, 1000, (n_people, 17)) / 1000.0
    missing = rng.random((n_people, 17)) < 0.2
    xy_px[missing], score[missing] = np.nan, 0.0
    return Poses2D(camera, t_s, xy_px, score, rng.integers(0, 1001, n_people) / 1000.0)


def assert_same(found: Poses2D, expected: Poses2D) -> None:
    """Compare two images field by field."""
    assert (found.camera, found.t_s) == (expected.camera, expected.t_s)
    np.testing.assert_array_equal(found.xy_px, expected.xy_px)
    np.testing.assert_array_equal(found.score, expected.score)
    np.testing.assert_array_equal(found.person_score, expected.person_score)
    assert found.xy_px.flags.c_contiguous
    assert found.score.flags.c_contiguous
    assert {found.xy_px.dtype, found.score.dtype, found.person_score.dtype} == {np.dtype(float)}


def flat(image, person):
    """Return the key points of one person as ``[x, y, score, x, ...]``."""
    rows = np.nan_to_num(np.concatenate([image.xy_px, image.score[..., None]], axis=2))[person]
    return rows.ravel().tolist()


def write_openpose(folder, image, name):
    """Write one image as OpenPose does."""
    folder.mkdir(parents=True, exist_ok=True)
    people = [
        {"person_id": [-1], "pose_keypoints_2d": flat(image, person), "face_keypoints_2d": []}
        for person in range(len(image.xy_px))
    ]
    (folder / name).write_text(json.dumps({"version": 1.3, "people": people}))


def write_coco(path, images, fps, image_id=int):
    """Write images as COCO key point results."""
    entries = [
        {
            "image_id": image_id(round(image.t_s * fps)),
            "category_id": 1,
            "keypoints": flat(image, person),
            "score": image.person_score[person],
        }
        for image in images
        for person in range(len(image.xy_px))
    ]
    path.write_text(json.dumps(entries))


def instance(image, person):
    """Return one person as an instance of MMPose."""
    return {
        "keypoints": np.nan_to_num(image.xy_px[person]).tolist(),
        "keypoint_scores": image.score[person].tolist(),
        "bbox": [[0, 0, 9, 9]],
        "bbox_score": image.person_score[person],
    }


def mmpose_frames(images):
    """Return images as MMPose's inferencer writes those of a video."""
    return [
        {
            "frame_id": round(25 * image.t_s),
            "instances": [instance(image, person) for person in range(len(image.xy_px))],
        }
        for image in images
    ]
