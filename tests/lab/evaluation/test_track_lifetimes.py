"""Track lifetimes and fragmentations."""

import numpy as np
import pytest

from made_people import STANDING_M, track
from trecsim.lab.evaluation.track_lifetimes import fragmentations, lifetimes

STEP_S = 0.04


def standing(person, from_s, until_s, x_m=0.0):
    t_s = np.arange(round(from_s / STEP_S), round(until_s / STEP_S) + 1) * STEP_S
    return track(person, t_s, np.array([STANDING_M + np.array([x_m, 0.0, 0.0])] * len(t_s)))


def pairs(*people):
    return [(one.ended, one.began) for one in fragmentations(people)]


def test_a_life_with_a_gap():
    t_s = np.array([1.0, 1.04, 1.08, 2.0, 2.04])
    (life,) = lifetimes([track(4, t_s)], STEP_S)
    assert (life.person, life.moments, life.gaps) == (4, 5, 1)
    assert life.seconds == pytest.approx(1.04)


def test_one_that_begins_where_another_ended_is_a_fragmentation():
    (found,) = fragmentations([standing(1, 0, 2), standing(2, 2.4, 5, x_m=0.3)])
    assert (found.ended, found.began) == (1, 2)
    assert found.pause_s == pytest.approx(0.4)
    assert found.at_s == pytest.approx(2.4)
    assert found.distance_m == pytest.approx(0.3)


def test_one_that_is_carried_on_for_a_moment_is_a_break_too():
    assert pairs(standing(1, 0, 3), standing(2, 2.4, 5)) == [(1, 2)]


@pytest.mark.parametrize(
    "second",
    [
        standing(2, 4.2, 5),  # too late
        standing(2, 0.8, 5),  # too early: both were there for 1.2 s
        standing(2, 2.0, 5, x_m=0.6),  # too far: 0.5 m and nothing to walk in
        standing(2, 1.4, 5, x_m=0.6),  # nor does an overlap give time to walk
        standing(2, 2.4, 5, x_m=1.2),  # 0.5 m and 0.6 m in 0.4 s
    ],
)
def test_others_are_none(second):
    assert pairs(standing(1, 0, 2), second) == []


def test_the_longer_the_pause_the_further_one_may_have_walked():
    assert pairs(standing(1, 0, 2), standing(2, 3.4, 5, x_m=2.5)) == [(1, 2)]


def test_each_ends_and_begins_once_and_the_nearest_comes_first():
    people = [
        standing(1, 0, 2),
        standing(2, 0, 2, x_m=0.3),
        standing(3, 2.2, 4, x_m=0.35),
        standing(4, 4.2, 6, x_m=0.35),
    ]
    assert pairs(*people) == [(2, 3), (3, 4)]


def test_where_somebody_is_does_not_need_the_hips():
    one, other = standing(1, 0, 2), standing(2, 2.04, 3)
    one.xyz_m[:, 11] = np.nan
    assert pairs(one, other) == [(1, 2)]
    one.xyz_m[:] = np.nan
    assert pairs(one, other) == []
