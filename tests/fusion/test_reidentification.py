"""Who comes back, and who was never gone."""

import numpy as np
import pytest

from fusion.somebody import MODEL, somebody
from trecsim.fusion.association import Association
from trecsim.fusion.duplicates import is_duplicate
from trecsim.fusion.population import Population
from trecsim.fusion.reidentification import DeadTrack, reidentify, within

WALKING = DeadTrack(7, 10.0, np.array([1.0, 0.0, 0.9]), np.array([2.0, 0.0, 0.0]))


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
    other = DeadTrack(8, 10.0, np.array([5.0, 0.0, 0.9]), np.zeros(3))
    here = np.array([1.5, 0.3, 0.9])
    assert reidentify([other, WALKING], here, 11.0, 1.5) is WALKING
    assert reidentify([other, WALKING], here, 11.6, 1.5) is None
    assert reidentify([other], here, 11.0, 1.5) is None
    assert within([other, WALKING], 11.6, 1.5) == []


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
    association = Association(match, np.zeros_like(match), np.ones(match.shape))
    torso = xyz[MODEL.torso]
    people = population(xyz[None])
    assert is_duplicate(people, torso + 0.05, np.array(eyes), association, MODEL) == known
    assert not is_duplicate(people, torso + 0.5, np.array(eyes), association, MODEL)
