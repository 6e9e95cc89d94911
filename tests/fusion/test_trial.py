"""Phantoms: new tracks at which other cameras look and see nobody, or beside a track read badly."""

import numpy as np
import pytest

from fusion.somebody import MODEL
from fusion.test_visibility import standing
from trecsim.fusion.lifecycle import ON_TRIAL, missing_cameras
from trecsim.fusion.population import Population

LOOKING = np.ones(4, bool)
SINCE_S = np.full(4, 9.88)


def tracks(places, seen, confirmed):
    """Return tracks of people who stand there, and that the cameras `seen` support now."""
    n = len(places)
    people = Population.empty(17, 9, 4, 0)
    people.xyz_m = np.stack([standing(*place) for place in places])
    people.c = np.tile(people.xyz_m, (1, 1, 9))
    people.confirmed = np.array(confirmed)
    people.last_seen_s = np.where(np.array(seen, bool), 10.0, -np.inf).reshape(n, 4)
    people.id = np.arange(n)
    return people


@pytest.mark.parametrize(
    ("seen", "looking", "missing"),
    [
        ([1, 1, 0, 0], [1, 1, 1, 1], 2),
        ([1, 1, 1, 0], [1, 1, 1, 1], 1),
        ([1, 1, 0, 0], [1, 1, 0, 1], 1),  # one camera delivers nothing
        ([1, 1, 1, 1], [1, 1, 1, 1], 0),
    ],
)
def test_cameras_that_have_a_new_tracks_place_in_view_and_see_nobody_are_missing(
    seen, looking, missing
):
    people = tracks([(0, 0)], [seen], [False])
    assert missing_cameras(people, MODEL, np.array(looking, bool), SINCE_S).tolist() == [missing]


def test_a_place_is_not_empty_for_a_camera_that_sees_somebody_beside_it():
    """In a group, detections of one person are easily taken for another's."""
    for apart_m, missing in ((0.7, 0), (1.3, 2)):
        people = tracks([(0, 0), (0, apart_m)], [[1, 1, 1, 1], [1, 1, 0, 0]], [True, False])
        assert missing_cameras(people, MODEL, LOOKING, SINCE_S)[1] == missing


@pytest.mark.parametrize(
    ("apart_m", "old", "new", "trial"),
    [
        (0.5, [1, 1, 0, 0], [0, 0, 1, 1], True),  # both cameras of the new one miss the other
        (0.5, [1, 1, 1, 0], [0, 0, 1, 1], False),  # one shows both
        (0.5, [0, 0, 0, 0], [0, 0, 1, 1], False),  # nobody sees the other: it may be lost
        (1.5, [1, 1, 0, 0], [0, 0, 1, 1], False),
    ],
)
def test_a_new_track_is_on_trial_beside_one_that_its_cameras_should_see(apart_m, old, new, trial):
    people = tracks([(0, 0), (0, apart_m)], [old, new], [True, False])
    missing = missing_cameras(people, MODEL, LOOKING, SINCE_S)
    assert (missing[1] == ON_TRIAL) == trial
    assert missing[0] < ON_TRIAL


def test_a_new_track_that_stands_before_the_other_is_not_on_trial():
    """From the cameras of one side, it hides the other."""
    rig_m = np.array([camera.position_m for camera in MODEL.rig])
    near = int(np.argmin(rig_m[:, 0] + rig_m[:, 1]))
    way = -rig_m[near, :2] / np.linalg.norm(rig_m[near, :2])
    new = np.arange(4) == near
    people = tracks([tuple(0.3 * way), tuple(-0.1 * way)], [~new, new], [True, False])
    assert missing_cameras(people, MODEL, LOOKING, SINCE_S)[1] < ON_TRIAL
    apart = tracks([tuple(-0.1 * way), tuple(0.3 * way)], [~new, new], [True, False])
    assert missing_cameras(apart, MODEL, LOOKING, SINCE_S)[1] == ON_TRIAL
