"""`follow` tells when poses and rig cannot fit, and is silent when they do."""

import logging
import pickle
import re
from dataclasses import replace

import numpy as np
import pytest

from made_faults import (
    at_half_rate,
    changed,
    elsewhere,
    in_order,
    knocked,
    later,
    mirrored,
    remarks,
    renamed,
    scaled,
    turned,
)
from trecsim.consistency import Consistency, Thresholds
from trecsim.geometry import Rig
from trecsim.lab.simulation import read_scene, room_scene, simulate
from trecsim.tracking import Tally, follow
from trecsim.values import FrameSet, Snapshot

SIZE_PX = (1920.0, 1080.0)


def room(*, people=3, cameras=4, seconds=6.0, seed=0):
    """Return a room in which people wander about."""
    return simulate(room_scene(people=people, cameras=cameras, seconds=seconds), seed)


@pytest.fixture(scope="module")
def good():
    return room()


@pytest.fixture(scope="module")
def longer():
    return room(seconds=14.0, seed=1)


@pytest.fixture(scope="module")
def longest():
    return room(seconds=20.0, seed=3)


@pytest.fixture(scope="module")
def two_cameras():
    return room(cameras=2, seconds=8.0, seed=2)


def only(poses, rig):
    """Return the one remark on a recording."""
    (text,), _ = remarks(poses, rig)
    return text


def test_good_recordings_are_not_remarked(good):
    assert remarks(good.poses, good.rig) == ([], 3)


def test_two_good_cameras_are_not_remarked(two_cameras):
    assert remarks(two_cameras.poses, two_cameras.rig)[0] == []


def test_good_recordings_with_a_lag_are_not_remarked(longer):
    assert remarks(longer.poses, longer.rig, lag_s=1.0)[0] == []


def test_poses_without_an_image_are_valid_and_said_to_hold_none(good):
    assert remarks([], good.rig) == (["the poses hold no image, so there are no people"], 0)


def test_an_empty_room_is_said_to_be_empty(good):
    nobody = {
        "xy_px": np.empty((0, 17, 2)),
        "score": np.empty((0, 17)),
        "person_score": np.empty(0),
    }
    empty = changed(good.poses, lambda one: replace(one, **nobody))
    assert only(empty, good.rig) == (
        f"0 people: the poses hold no person in {len(empty)} images of 4 cameras"
    )


def test_one_camera_alone_is_told_to_need_another(good):
    alone = [one for one in good.poses if one.camera == "cam2"]
    assert only(alone, good.rig).startswith("0 people: only camera 'cam2' sees people;")


def test_a_rig_of_one_camera_is_told_to_need_another(good):
    alone = [one for one in good.poses if one.camera == "cam2"]
    assert only(alone, Rig((good.rig["cam2"],))).startswith("0 people: the rig has one camera; ")


def test_cameras_that_see_people_at_different_times_are_said_to(good):
    half_s = good.poses[-1].t_s / 2
    poses = [
        one
        if (one.t_s < half_s) == (one.camera == "cam1")
        else replace(
            one, xy_px=one.xy_px[:0], score=one.score[:0], person_score=one.person_score[:0]
        )
        for one in good.poses
        if one.camera in ("cam1", "cam2")
    ]
    assert only(poses, good.rig).startswith(
        "0 people: no two cameras see a person at the same time"
    )


def test_key_points_between_0_and_1_are_remarked(good):
    parts = changed(good.poses, scaled(1 / SIZE_PX[0], 1 / SIZE_PX[1]))
    assert "all cameras all lie within 2 px of the image's corner" in only(parts, good.rig)


def test_one_camera_with_key_points_between_0_and_1_is_named(good):
    parts = changed(good.poses, scaled(1 / SIZE_PX[0], 1 / SIZE_PX[1]), "cam3")
    found, people = remarks(parts, good.rig)
    assert people == 3
    (text,) = found
    assert "camera 'cam3' all lie within 2 px" in text


@pytest.mark.parametrize(
    ("factor", "said"),
    [
        (0.5, "images half the size that the rig states (camera 'cam1': 960 x 540"),
        (2.0, "images twice the size that the rig states (camera 'cam1': 3840 x 2160"),
        (2 / 3, "images 2/3 the size that the rig states (camera 'cam1': 1280 x 720"),
    ],
)
def test_key_points_of_another_image_size_are_remarked_with_that_size(good, factor, said):
    text = only(changed(good.poses, scaled(factor)), good.rig)
    assert text.startswith("the key points of all cameras seem to be in pixels of")
    assert said in text
    assert f"multiply the key points by {1 / factor:.3g}" in text


def test_one_camera_of_another_image_size_is_named(good):
    text = only(changed(good.poses, scaled(0.5), "cam3"), good.rig)
    assert text.startswith("the key points of camera 'cam3' seem to be in pixels of images half")


def test_key_points_outside_of_the_image_are_remarked_where_no_size_explains_them(good):
    far = changed(good.poses, lambda one: replace(one, xy_px=one.xy_px[..., ::-1] * (3.3, 3.3)))
    assert "lie outside of its image of 1920 x 1080 pixels" in only(far, good.rig)


def test_recordings_without_a_common_time_are_remarked_with_their_times(good):
    starts_s = {"cam1": 0.0, "cam2": 5000.0, "cam3": 12000.0, "cam4": 30000.0}
    poses = in_order(later(starts_s[one.camera])(one) for one in good.poses)
    text = only(poses, good.rig)
    assert text.startswith("no two cameras have a time in common: 'cam1' from 0 to ")
    assert "'cam4' from 30000 to 30006 s" in text
    assert "time_offset_s" in text


def test_one_camera_without_a_time_in_common_is_named(good):
    poses = in_order(changed(good.poses, later(1e9), "cam3"))
    found, people = remarks(poses, good.rig)
    assert people == 3
    (text,) = found
    assert text.startswith("camera 'cam3' has no time in common with the others: 'cam3' from 10")


def test_a_camera_that_is_late_does_not_agree_and_its_beginning_tells_why(longer):
    text = only(in_order(changed(longer.poses, later(8.0), "cam2")), longer.rig)
    assert text.startswith("camera 'cam2' does not agree with the others on where people are")
    assert "its images begin 8.01 s after the others', so that its clock or time_offset_s" in text


@pytest.mark.parametrize("by_s", [3.0, 60.0, -3.0])
@pytest.mark.parametrize("from_s", [0.0, 3.0])
def test_a_wrong_clock_is_one_remark_whoever_notices_it(good, caplog, by_s, from_s):
    poses = [
        later(by_s)(one) if one.camera == "cam2" and one.t_s >= from_s else one
        for one in good.poses
    ]
    (text,), people = remarks(poses, good.rig)  # in order of arrival: sync and consistency see it
    assert people == 3
    assert caplog.messages == [text]
    ahead, late = (
        r"camera 'cam2' is (\d+|\d\.\d+) s ahead of",
        r"camera 'cam2' delivers \d\.\d+ s late",
    )
    assert re.match(ahead if by_s > 0.0 else late, text), text


def test_a_camera_of_half_the_rate_is_told_by_its_number_of_images(longer):
    found, _ = remarks(at_half_rate(longer.poses, "cam3"), longer.rig)
    assert all(text.startswith("camera 'cam3'") for text in found)
    assert "it has 175 images in 6.96 s where the others have " in found[-1]


def test_a_camera_that_was_turned_is_named_with_the_angle(good):
    text = only(good.poses, turned(good.rig, "cam2", (0.0, 10.0, 0.0)))
    assert text.startswith("camera 'cam2' does not look where the rig says: people appear about")
    assert "10 degrees" in text or "11 degrees" in text or "9." in text


def test_a_camera_that_stands_elsewhere_is_named(good):
    text = only(good.poses, turned(good.rig, "cam2", (0.0, 0.0, 0.0), (1.0, 0.5, 0.0)))
    assert text.startswith("camera 'cam2' does not ")


def test_a_mirrored_camera_is_named(good):
    text = only(changed(good.poses, mirrored(good.rig), "cam4"), good.rig)
    assert text.startswith("the images of camera 'cam4' seem to be mirrored: ")


def test_two_exchanged_cameras_are_named(good):
    text = only(changed(good.poses, renamed(cam1="cam2", cam2="cam1")), good.rig)
    assert text.startswith("cameras 'cam1' and 'cam2' seem to be exchanged: ")


@pytest.mark.parametrize("scene", ["falling", "overtaking"])
def test_exchanged_cameras_at_opposite_corners_are_told_with_the_pair_that_explains_as_much(scene):
    """Each pair agrees on people of its own, so that every detection is somebody."""
    made = simulate(read_scene(scene), 100)
    poses = [one for one in made.poses if one.t_s < 6.0]
    text = only(changed(poses, renamed(cam1="cam3", cam3="cam1")), made.rig)
    assert text.startswith(
        "either cameras 'cam1' and 'cam3' or cameras 'cam2' and 'cam4' seem to be exchanged: "
    )


def test_several_exchanged_cameras_are_named_with_what_they_show():
    made = simulate(read_scene("camera-dies"))  # three cameras, in no symmetry
    poses = made.poses[: len(made.poses) // 3]
    text = only(changed(poses, renamed(cam1="cam2", cam2="cam3", cam3="cam1")), made.rig)
    assert text.startswith("cameras seem to be exchanged: what is called 'cam2' shows 'cam1', ")


def test_a_wrong_rig_is_remarked(good):
    text = only(good.poses, elsewhere(good.rig))
    assert text.startswith("no two cameras agree on where people are (in ")
    assert "is it the rig of these recordings" in text


def test_two_cameras_that_are_exchanged_are_told(two_cameras):
    poses = changed(two_cameras.poses, renamed(cam1="cam2", cam2="cam1"))
    assert "'cam1' and 'cam2' seem to be exchanged" in only(poses, two_cameras.rig)


@pytest.mark.parametrize("turn_deg", [(0.0, 2.0, 0.0), (2.0, 0.0, 0.0), (-2.0, 5.0, 1.0)])
def test_a_camera_that_is_knocked_is_named_with_the_time(longest, turn_deg):
    text = only(knocked(longest.poses, longest.rig, "cam3", 10.0, turn_deg), longest.rig)
    assert text.startswith("camera 'cam3' seems to have been moved at about ")
    assert 7.5 <= float(text.split("at about ")[1].split(" s:")[0]) <= 12.5


def test_a_remark_is_made_while_the_recording_goes_on_and_only_once(longer):
    tally = Tally()
    steps = follow(iter(changed(longer.poses, scaled(2.0))), longer.rig, tally=tally)
    while not tally.remarks:
        next(steps)
    assert tally.frame_sets < 150  # of 350
    for _ in steps:
        pass
    assert len(tally.remarks) == 1


def test_remarks_are_logged_as_warnings(good, caplog):
    with caplog.at_level(logging.WARNING):
        text = only(changed(good.poses, scaled(0.5)), good.rig)
    assert text in caplog.messages


def test_a_run_of_many_hours_is_watched_with_bounded_memory(good):
    watch, view = Consistency(good.rig, Thresholds(spacing_growth=2.0)), good.poses[0]
    nobody = Snapshot(
        0.0,
        np.empty(0, np.int64),
        np.empty((0, 17, 3)),
        np.empty((0, 17, 3, 3)),
        np.empty((0, 17), np.int64),
    )
    for step in range(2_000):
        at = replace(nobody, t_s=3.0 * step)
        views = (replace(view, t_s=at.t_s), replace(view, camera="cam2", t_s=at.t_s))
        watch.observe(FrameSet(at.t_s, views), at)
    assert len(pickle.dumps(watch)) < 500_000
