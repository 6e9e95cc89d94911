"""Who comes back, and who was never gone."""

from dataclasses import replace

import numpy as np
import pytest

from fusion.made import frame_sets, made, outcome, path
from fusion.somebody import MODEL, somebody
from trecsim.fusion import Tracker
from trecsim.fusion.duplicates import is_duplicate
from trecsim.fusion.kernels import Matches
from trecsim.fusion.population import Population
from trecsim.fusion.reidentification import (
    LostTrack,
    lost_since,
    nearest_unseen,
    reidentify,
    within,
)
from trecsim.fusion.tuning import UNSEEN_MPS, YOUNG_MPS

WALKING = LostTrack(7, 10.0, np.array([1.0, 0.0, 0.9]), np.array([2.0, 0.0, 0.0]))


@pytest.mark.parametrize(
    ("x_m", "away_m"),
    [
        (1.0, 0.0),  # stopped at once
        (1.6, 0.0),  # slowed down
        (2.0, 0.0),  # went on for half a second
        (2.3, 0.3),
        (0.4, 0.6),  # turned round
    ],
)
def test_somebody_may_have_stopped_or_gone_on(x_m, away_m):
    assert WALKING.distance_m(np.array([x_m, 0.0, 0.9]), 11.0) == pytest.approx(away_m)


def test_who_appears_where_somebody_was_lost_is_that_person_for_a_while_only():
    other = LostTrack(8, 10.0, np.array([5.0, 0.0, 0.9]), np.zeros(3))
    here = np.array([1.5, 0.3, 0.9])
    assert reidentify([other, WALKING], here, 11.0, 1.5) is WALKING
    assert reidentify([other, WALKING], here, 11.6, 1.5) is None
    assert reidentify([other], here, 11.0, 1.5) is None
    assert within([other, WALKING], 11.6, 1.5) == []


def test_whom_one_camera_alone_saw_before_may_be_further_away():
    here = np.array([-0.1, 0.0, 0.9])  # 1.1 m behind
    assert reidentify([WALKING], here, 10.4, 1.5) is None
    alone = replace(WALKING, alone_s=0.8)
    assert reidentify([alone], here, 10.4, 1.5) is alone
    for_long = replace(WALKING, alone_s=30.0)
    assert reidentify([for_long], here - [0.5, 0.0, 0.0], 10.4, 1.5) is None


def population(xyz):
    people = Population.empty(17, 9, 4, 0)
    people.xyz_m = xyz
    return people


@pytest.mark.parametrize(
    ("match", "eyes", "known"),
    [
        ([0, 1, -1, -1], [False, False, True, True], True),  # two see the person, these two do not
        ([0, -1, -1, -1], [False, False, True, True], False),  # one camera may have drifted
        ([0, 1, 2, -1], [False, False, True, True], False),  # one of these sees both
    ],
)
def test_nobody_is_new_who_is_only_not_recognised_by_some_cameras(match, eyes, known):
    xyz, _ = somebody(np.random.default_rng(1))
    match = np.array([match])
    association = Matches(match, np.zeros_like(match), np.ones(match.shape))
    torso = xyz[MODEL.torso]
    people = population(xyz[None])
    assert is_duplicate(people, torso + 0.05, np.array(eyes), association, MODEL) == known
    assert not is_duplicate(people, torso + 0.5, np.array(eyes), association, MODEL)


def test_a_new_track_may_be_a_person_whom_no_camera_recognised_in_this_frame_set():
    fell = LostTrack(3, 10.0, np.array([0.0, 0.0, 0.9]), np.array([0.0, 0.0, -2.0]))
    beside = LostTrack(4, 10.0, np.array([1.2, 0.0, 0.9]), np.zeros(3))
    there = np.array([0.45, 0.0, 0.6])
    assert nearest_unseen([beside, fell], there, 10.125) is fell
    assert nearest_unseen([fell], there, 10.02) is None  # nobody is as fast
    assert nearest_unseen([beside], there, 10.125) is None
    assert nearest_unseen([], there, 10.125) is None


@pytest.mark.parametrize(
    ("match", "last_s", "since_s"),
    [
        ([-1, -1, -1, -1], [9.8, 9.9, 9.0, 9.0], 9.9),  # no camera sees it in this frame set
        ([0, 1, -1, -1], [10.0, 10.0, 9.9, 9.9], 9.9),  # torn: the new one's two did until now
        ([0, 1, -1, -1], [10.0, 10.0, 9.9, 9.0], -np.inf),  # one of them had lost it long before
        ([0, -1, 2, -1], [10.0, 9.9, 10.0, 9.9], -np.inf),  # one of them sees both
    ],
)
def test_a_new_track_takes_the_place_of_one_that_its_cameras_saw_until_the_last_image(
    match, last_s, since_s
):
    found = lost_since(
        np.array([last_s]), np.array([2, 3]), np.array([match]), np.arange(4), np.full(4, 9.85)
    )
    assert found.tolist() == [since_s]


def test_two_of_the_new_tracks_cameras_that_saw_another_lately_are_enough():
    """A third may have missed it for a while, or never had it in view."""
    view_cam, lately_s = np.arange(4), np.full(4, 9.85)
    match, cam = np.array([[0, -1, -1, -1]]), np.array([1, 2, 3])
    two, one = np.array([[10.0, 9.9, 9.95, -np.inf]]), np.array([[10.0, 9.9, 9.0, -np.inf]])
    assert lost_since(two, cam, match, view_cam, lately_s).tolist() == [9.95]
    assert lost_since(one, cam, match, view_cam, lately_s).tolist() == [-np.inf]


def test_a_track_just_born_may_belong_to_a_runner_as_its_velocity_is_hardly_known():
    young = LostTrack(5, 10.0, np.array([0.0, 0.0, 0.9]), np.zeros(3), YOUNG_MPS)
    there = np.array([0.75, 0.0, 0.9])
    assert nearest_unseen([young], there, 10.125) is young
    assert nearest_unseen([replace(young, reach_mps=UNSEEN_MPS)], there, 10.125) is None
    # The way since then tells the velocity, as far as it exceeds the error of a place.
    assert young.velocity_to(there, 10.125)[0] == pytest.approx(0.93 * 6.0, abs=0.1)
    assert young.velocity_to(np.array([0.05, 0.0, 0.9]), 10.001)[0] < 0.1


@pytest.mark.parametrize(("fps", "speed_mps"), [(8.0, 5.0), (8.0, 6.0), (5.0, 5.0)])
def test_a_runner_who_stops_keeps_the_identity_with_few_images_per_second(fps, speed_mps):
    """At 8 images per second a runner is 0.6 m from the prediction, in all cameras at once."""
    stops_s = 6.0 / speed_mps
    runs = path((0, -3, 0), (stops_s, 3, 0), (stops_s + 0.1, 3.2, 0), (3, 3.2, 0))
    scene = made([runs], fps=fps, seconds=3.0, stagger=False)
    tracker = Tracker(scene.rig)
    snapshots = [tracker.step(one) for one in frame_sets(scene, fps)]
    assert outcome(scene, snapshots).ids == {0}
