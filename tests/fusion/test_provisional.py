"""Tracks that are not confirmed yet: reported on demand, and the rest stays as it is."""

import numpy as np
import pytest

from fusion.made import frame_sets
from trecsim.fusion import Tracker
from trecsim.lab.simulation.scene import room_scene, simulate
from trecsim.tracking import Follower, Tally
from trecsim.values import COASTING, CONFIRMED, PROVISIONAL


@pytest.fixture(scope="module")
def scene():
    return simulate(room_scene(people=3, cameras=2, seconds=3.0), 3)


def steps(scene, **options):
    return list(map(Tracker(scene.rig, **options).step, frame_sets(scene)))


def test_a_person_is_provisional_first_and_confirmed_later_under_the_same_identity(scene):
    states = {}
    for snapshot in steps(scene, provisional=True):
        for person, state in zip(snapshot.id.tolist(), snapshot.state.tolist(), strict=True):
            states.setdefault(person, []).append(state)
    both = [one for one in states.values() if PROVISIONAL in one and CONFIRMED in one]
    assert both
    for one in both:
        first = one.index(CONFIRMED)
        assert set(one[:first]) == {PROVISIONAL}
        assert set(one[first:]) <= {CONFIRMED, COASTING}


@pytest.mark.parametrize("lag_s", [0.0, 0.08])
def test_confirmed_people_are_the_same_with_and_without_the_others(scene, lag_s):
    alone, all_ = (steps(scene, provisional=p, lag_s=lag_s) for p in (False, True))
    assert any(PROVISIONAL in one.state for one in all_)
    for one, other in zip(alone, all_, strict=True):
        assert PROVISIONAL not in one.state
        confirmed = other.confirmed()
        np.testing.assert_array_equal(confirmed.id, one.id)
        np.testing.assert_array_equal(confirmed.state, one.state)
        np.testing.assert_array_equal(confirmed.xyz_m, one.xyz_m)
        np.testing.assert_array_equal(confirmed.cov_m2, one.cov_m2)


def test_provisional_people_are_reported_but_not_counted_and_keep_their_identities(scene):
    tally, steps = Tally(), {}
    follower = Follower(
        scene.rig,
        tally=tally,
        step=lambda step: steps.update({step.t_s: step.people}),
        first_id=7,
        provisional=True,
    )
    snapshots = [one for image in scene.poses for one in follower.add(image)]
    assert any(PROVISIONAL in one.state for one in snapshots)
    confirmed = {one.t_s: one.confirmed().id.tolist() for one in snapshots}
    assert {t_s: len(people) for t_s, people in confirmed.items()} == steps
    assert tally.people == len({person for people in confirmed.values() for person in people})
    assert follower.next_id == 1 + max(one.id.max(initial=7) for one in snapshots)
