"""PCP of tracks against a made annotation of the Shelf recording."""

import numpy as np
import pytest

from made_people import STANDING_M
from trecsim.errors import InputError
from trecsim.lab.evaluation.pcp_joints import annotated_joints
from trecsim.lab.evaluation.shelf import ANNOTATION, read_annotation, score_shelf
from trecsim.values import Snapshot


@pytest.fixture
def folder(tmp_path):
    """Return an annotation of two people, one of them in a single frame."""
    joints_m = np.full((2, 700, 14, 3), np.nan, np.float32)
    joints_m[0, 300:310] = annotated_joints(STANDING_M)
    joints_m[1, 305] = annotated_joints(STANDING_M) + 1.0
    np.savez(tmp_path / ANNOTATION, joints=joints_m)
    return tmp_path


def standing(t_s, *, identity=4, shift_m=0.0):
    xyz_m = (STANDING_M + shift_m)[None].copy()
    cov_m2 = np.broadcast_to(1e-4 * np.eye(3), (1, 17, 3, 3)).copy()
    return Snapshot(t_s, np.array([identity]), xyz_m, cov_m2, np.full((1, 17), 2))


def test_perfect_tracks_have_every_part_right(folder):
    annotation = read_annotation(folder)
    tracks = [standing(300 / 25 + 0.04 * i) for i in range(10)]
    first, second = score_shelf(tracks, annotation).actors
    assert (first.correct, first.total) == (100, 100)
    # Of the second only the first person's parts could be taken, 1.7 m off.
    assert (second.correct, second.total, second.missed) == (0, 10, 1)


def test_frames_without_tracks_are_missed(folder):
    annotation = read_annotation(folder)
    tracks = [standing(300 / 25 + 0.04 * i) for i in range(4)]
    assert score_shelf(tracks, annotation).actors[0].correct == 40
    assert score_shelf(tracks, annotation).actors[0].missed == 6


def test_the_nearest_moment_within_half_a_frame_counts(folder):
    annotation = read_annotation(folder)
    tracks = [
        *(standing(12.0 - 0.015, identity=1, shift_m=9.0), standing(12.0 + 0.005, identity=2)),
        standing(12.04 + 0.019, identity=3),
    ]
    actor = score_shelf(tracks, annotation).actors[0]
    assert (actor.correct, actor.switches) == (20, 1)
    early = score_shelf([standing(12.0 - 0.0199)], annotation)
    assert early.actors[0].correct == 10
    with pytest.raises(InputError, match="12 s to 24 s"):
        score_shelf([standing(12.0 - 0.0201)], annotation)


def test_the_last_frames_that_lagged_tracks_cannot_reach_are_not_scored(folder):
    annotation = read_annotation(folder)
    annotation.joints_m[0, -6:] = annotated_joints(STANDING_M)
    tracks = [standing(t_s) for t_s in annotation.t_s[:-5]]
    actor = score_shelf(tracks, annotation, lag_s=0.2).actors[0]
    assert (actor.frames, actor.missed) == (11, 0)
    assert score_shelf(tracks, annotation).actors[0].missed == 5


@pytest.mark.parametrize("lag_s", [-0.1, 12.1, np.nan])
def test_a_lag_longer_than_the_recording_is_told(folder, lag_s):
    with pytest.raises(InputError, match="between 0 and 12 s"):
        score_shelf([standing(12.0)], read_annotation(folder), lag_s=lag_s)


def test_tracks_of_another_time_are_told(folder):
    annotation = read_annotation(folder)
    with pytest.raises(InputError, match="12 s to 24 s"):
        score_shelf([standing(0.0)], annotation)
    with pytest.raises(InputError, match="12 s to 24 s"):
        score_shelf([], annotation)


def test_tracks_of_another_skeleton_are_told(folder):
    other = Snapshot(
        12.0, np.array([0]), np.zeros((1, 26, 3)), np.zeros((1, 26, 3, 3)), np.zeros((1, 26), int)
    )
    with pytest.raises(InputError, match="17 joints of coco17, found 26"):
        score_shelf([other], read_annotation(folder))


def test_a_missing_annotation_is_told(tmp_path):
    with pytest.raises(InputError, match=f"{ANNOTATION} is not there"):
        read_annotation(tmp_path)


@pytest.mark.parametrize(
    ("joints", "told"),
    [
        (np.zeros((2, 10, 14, 3)), "2 people in 10 frames"),
        (np.zeros((0, 700, 14, 3)), "0 people in 700 frames"),
        (np.full((1, 700, 14, 3), np.nan), "an annotated person"),
        (np.full((1, 700, 14, 3), np.inf), "finite numbers or NaN"),
        (np.array([None]), "expected real numbers, found the type object"),
    ],
)
def test_what_is_wrong_with_the_annotation_is_told(tmp_path, joints, told):
    np.savez(tmp_path / ANNOTATION, joints=joints)
    with pytest.raises(InputError, match=told) as caught:
        read_annotation(tmp_path)
    assert ANNOTATION in str(caught.value)


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04 and no more", b"text"])
def test_what_is_no_array_file_is_told(folder, content):
    (folder / ANNOTATION).write_bytes(content)
    with pytest.raises(InputError, match="not a readable part of the Shelf recording"):
        read_annotation(folder)
