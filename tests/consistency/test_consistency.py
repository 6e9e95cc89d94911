"""`follow` tells when poses and rig cannot fit, and is silent when they do."""

from dataclasses import replace

import numpy as np
import pytest

from consistency.faults import changed, in_order, later, room, scaled
from trecsim.tracking import Tally, follow

SIZE_PX = (1920.0, 1080.0)


@pytest.fixture(scope="module")
def good():
    return room()


def remarks(poses, rig, **kwargs):
    """Return what is said of a recording, and how many people there were."""
    tally = Tally()
    for _ in follow(poses, rig, tally=tally, **kwargs):
        pass
    return tally.remarks, len(tally.people)


def only(poses, rig):
    """Return the one remark on a recording."""
    (text,), _ = remarks(poses, rig)
    return text


def test_good_recordings_are_not_remarked(good):
    assert remarks(good.poses, good.rig) == ([], 3)


def test_poses_without_an_image_are_valid_and_said_to_hold_none(good):
    assert remarks([], good.rig) == (["the poses hold no image: there is nobody to be found"], 0)


def test_an_empty_room_is_said_to_be_empty(good):
    empty = changed(
        good.poses,
        lambda one: replace(
            one,
            xy_px=np.empty((0, 17, 2)),
            score=np.empty((0, 17)),
            person_score=np.empty(0),
        ),
    )
    assert only(empty, good.rig) == (
        f"nobody is in the poses: {len(empty)} images of 4 cameras hold no person"
    )


def test_one_camera_alone_is_told_to_need_another(good):
    alone = [one for one in good.poses if one.camera == "cam2"]
    assert only(alone, good.rig).startswith("0 people, as only camera 'cam2' sees anybody;")


def test_key_points_between_0_and_1_are_remarked(good):
    parts = changed(good.poses, scaled(1 / SIZE_PX[0], 1 / SIZE_PX[1]))
    assert "all cameras all lie within 2 px of the image's corner" in only(parts, good.rig)


def test_one_camera_with_key_points_between_0_and_1_is_named(good):
    parts = changed(good.poses, scaled(1 / SIZE_PX[0], 1 / SIZE_PX[1]), "cam3")
    found, people = remarks(parts, good.rig)
    assert people > 0
    assert any("camera 'cam3' all lie within 2 px" in text for text in found)


def test_key_points_of_images_twice_the_size_are_remarked(good):
    found, _ = remarks(changed(good.poses, scaled(2.0)), good.rig)
    assert any("lie outside of its image of 1920 x 1080 pixels" in text for text in found)


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


def test_the_image_size_is_told_while_a_long_recording_goes_on(good):
    tally = Tally()
    images = iter(changed(good.poses, scaled(2.0)))
    steps = follow(images, good.rig, tally=tally)
    while not tally.remarks:
        next(steps)
    assert tally.frame_sets < 75  # of 150
