"""Tracks seen through cameras: perfect ones lie on the key points, others as far as they err."""

from dataclasses import replace

import numpy as np
import pytest

from made_people import STANDING_M, track
from trecsim.errors import CalibrationError
from trecsim.geometry import Camera, Rig
from trecsim.lab.evaluation.reprojection import ALL_CAMERAS, ALL_JOINTS, positions_at, reprojection
from trecsim.skeleton import COCO17
from trecsim.values import Poses2D

STEP_S = 0.04
K = np.array([[800.0, 0, 480], [0, 800, 270], [0, 0, 1]])
LENS = np.array([-0.2, 0.05, 0.001, -0.001, 0.0])


def camera(name, *, turned_rad, time_offset_s=0.0):
    """Return a camera 5 m from the middle, 1 m above the floor, that looks at it."""
    c, s = np.cos(turned_rad), np.sin(turned_rad)
    R = np.array([[-s, c, 0.0], [0.0, 0.0, -1.0], [-c, -s, 0.0]])
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, -R @ np.array([5 * c, 5 * s, 1.0])
    return Camera(name, (960, 540), K, T, "brown", LENS, time_offset_s)


RIG = Rig((camera("east", turned_rad=0.0), camera("north", turned_rad=1.4, time_offset_s=0.5)))


def walker(person, y_m=0.0, n=60):
    t_s = np.arange(n) * STEP_S
    shift_m = np.stack([0.6 * t_s - 0.7, np.full(n, y_m), np.zeros(n)], axis=1)
    return track(person, t_s, STANDING_M + shift_m[:, None])


def image(camera, t_s, *people):
    """Return what a camera sees of people whose way is known, its clock `time_offset_s` behind."""
    now = np.array([t_s])
    xy_px = np.array([camera.project(positions_at(one, now, np.nan)[0]) for one in people]).reshape(
        -1, 17, 2
    )
    score = np.isfinite(xy_px[..., 0]).astype(float)
    return Poses2D(camera.name, t_s - camera.time_offset_s, xy_px, score, np.ones(len(xy_px)))


def moved(poses, joint, by_px):
    xy_px = poses.xy_px.copy()
    xy_px[:, COCO17.index(joint)] += by_px
    return replace(poses, xy_px=xy_px)


def by_name(result):
    return {(row.camera, row.joint): row for row in result.rows}


def test_perfect_tracks_lie_on_the_key_points_at_the_images_own_times():
    people = [walker(1), walker(2, y_m=0.9)]
    poses = [image(cam, t_s, *people) for t_s in np.linspace(0.0, 2.36, 31) for cam in RIG]
    result = reprojection(poses, RIG, people, STEP_S)
    assert result.overall.n == 31 * 2 * 2 * 17
    assert result.overall.p90_px < 1e-6
    assert [(row.images, row.people, row.matched) for row in result.cameras] == [(31, 62, 62)] * 2


def test_what_is_off_is_told_by_camera_and_joint():
    person = walker(1)
    poses = [moved(image(RIG["east"], t, person), "nose", [3.0, 4.0]) for t in np.arange(5) * 0.1]
    poses += [image(RIG["north"], t, person) for t in np.arange(5) * 0.1]
    rows = by_name(reprojection(poses, RIG, [person], STEP_S))
    assert rows["east", "nose"].median_px == pytest.approx(5.0)
    assert rows["east", "left_hip"].median_px == pytest.approx(0.0, abs=1e-6)
    assert rows["north", "nose"].median_px == pytest.approx(0.0, abs=1e-6)
    assert rows[ALL_CAMERAS, "nose"].n == 10
    assert rows[ALL_CAMERAS, "nose"].p90_px == pytest.approx(5.0)
    assert rows["east", ALL_JOINTS].n == 5 * 17


def test_the_time_of_the_image_counts():
    person = walker(1)
    # The clock of this camera is half a second behind; here its images are stamped as if not.
    late = [replace(image(RIG["north"], t, person), t_s=t) for t in np.arange(2, 12) * 0.1]
    rows = by_name(reprojection(late, RIG, [person], STEP_S))
    assert rows["north", "nose"].median_px == pytest.approx(0.5 * 0.6 * 800 / 5, rel=0.2)


def test_somebody_whom_no_track_explains_belongs_to_none():
    known, unknown = walker(1), walker(2, y_m=1.5)
    poses = [image(cam, t, known, unknown) for t in np.arange(5) * 0.1 for cam in RIG]
    result = reprojection(poses, RIG, [known], STEP_S)
    assert [(row.people, row.matched) for row in result.cameras] == [(10, 5), (10, 5)]
    assert result.cameras[0].row()["unmatched_share"] == pytest.approx(0.5)
    assert result.overall.p90_px < 1e-6


def test_one_key_point_far_away_makes_nobody_a_stranger():
    person = walker(1)
    seen = moved(image(RIG["east"], 0.2, person), "left_wrist", [5000.0, 0.0])
    result = reprojection([seen], RIG, [person], STEP_S)
    assert result.cameras[0].matched == 1
    assert by_name(result)["east", "left_wrist"].median_px == pytest.approx(5000.0)
    assert result.overall.median_px < 1e-6


def test_missing_key_points_do_not_count():
    person = walker(1)
    seen = image(RIG["east"], 0.2, person)
    seen.xy_px[0, 4:] = np.nan
    result = reprojection([seen], RIG, [person], STEP_S)
    assert result.overall.n == 4
    seen.xy_px[0, 2:] = np.nan  # two joints could be anybody's
    assert reprojection([seen], RIG, [person], STEP_S).overall.n == 0


def test_before_after_and_in_gaps_nobody_is_there():
    person = walker(1)
    gone = track(1, np.delete(person.t_s, range(20, 40)), np.delete(person.xyz_m, range(20, 40), 0))
    times_s = [-0.1, 0.5, 1.2, 2.0, 2.5]
    inside = np.isfinite(positions_at(gone, np.array(times_s), 3 * STEP_S)).all(axis=(1, 2))
    assert inside.tolist() == [False, True, False, True, False]


def test_a_time_rounded_in_a_file_is_still_within():
    person = walker(1)
    at = positions_at(person, person.t_s[[0, -1]] + np.array([-1e-6, 1e-6]), 3 * STEP_S)
    np.testing.assert_allclose(at, person.xyz_m[[0, -1]])


def test_a_single_moment_can_be_compared():
    person = track(1, np.array([1.0]))
    result = reprojection([image(RIG["east"], 1.0, person)], RIG, [person], float("nan"))
    assert result.overall.n == 17
    assert result.overall.median_px < 1e-6


def test_many_images_come_in_portions(monkeypatch):
    people = [walker(1), walker(2, y_m=0.9)]
    poses = [
        moved(image(cam, t_s, *people), "left_knee", [t_s, 0.0])
        for t_s in np.linspace(0.0, 2.36, 31)
        for cam in RIG
    ]
    whole = reprojection(poses, RIG, people, STEP_S)
    monkeypatch.setattr("trecsim.lab.evaluation.reprojection._AT_ONE_TIME", 7)
    assert reprojection(poses, RIG, people, STEP_S) == whole


def test_no_images_or_no_tracks_are_told_as_nothing():
    nothing = reprojection([], RIG, [walker(1)], STEP_S)
    assert nothing.overall.n == 0
    assert np.isnan(nothing.overall.median_px)
    nobody = reprojection([image(RIG["east"], 0.1, walker(1))], RIG, [], STEP_S)
    assert (nobody.cameras[0].people, nobody.cameras[0].matched) == (1, 0)


def test_an_unknown_camera_is_told():
    with pytest.raises(CalibrationError, match="no camera 'west'"):
        reprojection([replace(image(RIG["east"], 0.1), camera="west")], RIG, [], STEP_S)
