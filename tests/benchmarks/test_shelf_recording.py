"""The Shelf recording: a made one whose numbers are known, and the real one where it is there."""

import json

import numpy as np
import pytest

from harness.shelf_recording import (
    CALIBRATION,
    DETECTIONS,
    convert_shelf,
    read_cameras,
    read_shelf,
    truth_of,
)
from made_people import STANDING_M
from trecsim.calibration import read_rig
from trecsim.errors import InputError
from trecsim.lab.evaluation.pcp_joints import annotated_joints
from trecsim.lab.evaluation.shelf import ANNOTATION, score_shelf
from trecsim.skeleton import COCO17
from trecsim.sources import read_poses
from trecsim.store.truth import read_truth
from trecsim.tracking import follow
from trecsim.values import Snapshot

FACING = {"K": [[1000, 0, 500], [0, 1000, 300], [0, 0, 1]], "width": 1032, "height": 776}
POSES = {
    "0": {"R": [[0, 1, 0], [0, 0, -1], [-1, 0, 0]], "t": [0, 1, 5]},
    "1": {"R": [[-1, 0, 0], [0, 0, -1], [0, -1, 0]], "t": [0, 1, 5]},
}


@pytest.fixture
def folder(tmp_path):
    """Return a recording of two cameras in which one of two people was detected now and then."""
    path = tmp_path / "shelf"
    path.mkdir()
    cameras = {name: {**FACING, **pose, "dist": [0] * 5} for name, pose in POSES.items()}
    (path / CALIBRATION).write_text(json.dumps({"cameras": cameras}))
    joints_m = np.full((2, 700, 14, 3), np.nan, np.float32)
    joints_m[0, 300:310] = annotated_joints(STANDING_M)
    joints_m[1, 305] = annotated_joints(STANDING_M) + 1.0
    np.savez(path / ANNOTATION, joints=joints_m)
    people = np.zeros((3, 17, 3), np.float32)
    people[:, :12] = [400.0, 300.0, 1.04]  # a score may be a little above 1
    people[2, 3] = 0.0
    people[2, 4] = [0.0, 20.0, 0.5]  # at the very border of the image
    np.savez(path / DETECTIONS, cam=[0, 1, 1], frame=[300, 300, 600], coco17=people)
    return path


def test_every_camera_has_an_image_of_every_frame(folder):
    images = read_shelf(folder).poses
    assert len(images) == 301 * 2
    assert [image.camera for image in images[:4]] == ["0", "1", "0", "1"]
    assert [image.t_s for image in images[:4]] == [12.0, 12.0, 12.04, 12.04]
    assert {i: len(image.xy_px) for i, image in enumerate(images) if len(image.xy_px)} == {
        0: 1,
        1: 1,
        601: 1,
    }
    last = images[601]
    assert np.isnan(last.xy_px[0, [3, 12, 16]]).all()
    assert last.xy_px[0, [0, 4]].tolist() == [[400.0, 300.0], [0.0, 20.0]]
    assert last.score[0, [0, 3, 4]].tolist() == [1.0, 0.0, 0.5]
    assert last.person_score.tolist() == [10.5 / 11]


def test_some_cameras_keep_their_own_detections(folder):
    assert read_cameras(folder, ["1"]).names == ("1",)
    images = read_shelf(folder, ["1"]).poses
    assert {image.camera for image in images} == {"1"}
    assert [i for i, image in enumerate(images) if len(image.xy_px)] == [0, 300]


def test_what_was_converted_says_the_same(folder, tmp_path):
    out = tmp_path / "new" / "out"
    convert_shelf(folder, out)
    assert read_rig(out / "rig.toml").names == ("0", "1")
    assert len(list(read_poses(out / "poses.jsonl"))) == 602
    truth = read_truth(out / "truth.npz")
    assert truth.t_s[[0, -1]].tolist() == [12.0, 24.0]
    knee = COCO17.index("left_knee")
    np.testing.assert_allclose(truth.xyz_m[0, 9, knee], STANDING_M[knee], atol=1e-6)
    assert np.isnan(truth.xyz_m[0, 9, COCO17.index("nose")]).all()
    assert np.isnan(truth.xyz_m[0, 10]).all()


def test_an_unknown_camera_is_told(folder):
    with pytest.raises(InputError, match="has the cameras 0, 1; found 7"):
        read_shelf(folder, ["1", "7"])
    with pytest.raises(InputError, match="found none"):
        read_shelf(folder, [])


@pytest.fixture(scope="module")
def real(shared_data):
    if not (shared_data / "shelf" / ANNOTATION).is_file():
        pytest.skip("the Shelf recording is not there")
    return read_shelf(shared_data / "shelf")


def test_people_are_annotated_in_as_many_frames_as_the_note_of_the_recording_says(real):
    there = np.isfinite(real.annotation.joints_m).all(axis=(2, 3))
    assert there.sum(axis=1).tolist() == [279, 37, 161, 33]


def test_people_on_the_real_recording_are_found_and_keep_their_identities(real):
    score = score_shelf(follow(real.poses, real.rig), real.annotation)
    assert score.average >= 97.0
    assert score.mpjpe_m <= 0.0490
    assert (score.missed, score.switches) == (0, 0)


def test_lagged_tracks_of_the_real_recording_miss_nobody_up_to_the_lag(real):
    score = score_shelf(follow(real.poses, real.rig, lag_s=0.2), real.annotation, lag_s=0.2)
    assert score.average >= 96.9
    assert (score.missed, score.switches) == (0, 0)


def test_the_annotation_scored_as_tracks_has_all_its_limbs_right(real):
    truth = truth_of(real.annotation)
    tracks = []
    for t_s, xyz_m in zip(truth.t_s.tolist(), np.swapaxes(truth.xyz_m, 0, 1), strict=True):
        ids = np.flatnonzero(np.isfinite(xyz_m[:, COCO17.index("left_hip")]).all(axis=1))
        cov_m2 = np.zeros((len(ids), 17, 3, 3))
        tracks.append(Snapshot(t_s, ids, xyz_m[ids], cov_m2, np.ones((len(ids), 17), int)))
    score = score_shelf(tracks, real.annotation)
    limbs = dict.fromkeys(("upper arms", "lower arms", "upper legs", "lower legs"), 100.0)
    # The truth in COCO-17 has no head, without which there is no torso either.
    assert score.groups == {"head": 0.0, "torso": 0.0, **limbs}
    assert score.mpjpe_m == pytest.approx(0.0, abs=1e-9)
