"""How late people are found and forgotten, counted by hand; one moment a second."""

import numpy as np

from lab.evaluation.scored_cases import Found, scores_of, truth_of
from trecsim.lab.evaluation.latency import Delay, Latency

AWAY = float("nan")


def latency_of(people: list[list[float]], found: list[Found]) -> Latency:
    return scores_of(truth_of(*people), found).latency


def test_somebody_is_found_two_seconds_after_coming() -> None:
    people = [[AWAY, 0.0, 0.0, 0.0, 0.0]]
    birth = latency_of(people, [{}, {}, {}, {1: 0.0}, {1: 0.0}]).birth
    assert birth == Delay(n=1, never=0, median_s=2.0, max_s=2.0)


def test_who_is_there_from_the_beginning_is_born_with_the_first_moment() -> None:
    assert latency_of([[0.0, 0.0, 0.0]], [{}, {1: 0.0}, {1: 0.0}]).birth.max_s == 1.0


def test_who_is_never_found_is_counted_apart() -> None:
    birth = latency_of([[0.0, 0.0], [5.0, 5.0]], [{1: 0.0}, {1: 0.0}]).birth
    assert birth == Delay(n=2, never=1, median_s=0.0, max_s=0.0)


def test_somebody_is_forgotten_three_seconds_after_leaving() -> None:
    people = [[0.0, 0.0, AWAY, AWAY, AWAY, AWAY, AWAY]]
    found: list[Found] = [*[{1: 0.0}] * 5, {}, {}]
    assert latency_of(people, found).death == Delay(n=1, never=0, median_s=3.0, max_s=3.0)


def test_who_is_forgotten_at_once_has_no_delay() -> None:
    people = [[0.0, 0.0, AWAY, AWAY]]
    assert latency_of(people, [{1: 0.0}, {1: 0.0}, {}, {}]).death.max_s == 0.0


def test_who_stays_until_the_end_has_no_death() -> None:
    death = latency_of([[0.0, 0.0]], [{1: 0.0}, {1: 0.0}]).death
    assert death.n == 0
    assert np.isnan(death.median_s)


def test_an_identity_that_goes_over_to_somebody_else_is_forgotten() -> None:
    people = [[0.0, 0.0, AWAY, AWAY, AWAY], [AWAY, AWAY, AWAY, 0.0, 0.0]]
    assert latency_of(people, [{1: 0.0}] * 5).death.max_s == 1.0


def test_an_identity_that_comes_back_later_is_forgotten_all_the_same() -> None:
    people = [[0.0, 0.0, AWAY, AWAY, AWAY, AWAY]]
    found: list[Found] = [{1: 0.0}, {1: 0.0}, {1: 0.0}, {}, {1: 0.0}, {}]
    assert latency_of(people, found).death.max_s == 1.0


def test_each_stay_of_a_person_counts() -> None:
    people = [[0.0, 0.0, AWAY, AWAY, 0.0, 0.0]]
    result = latency_of(people, [{1: 0.0}, {1: 0.0}, {1: 0.0}, {}, {}, {1: 0.0}])
    assert result.birth == Delay(n=2, never=0, median_s=0.5, max_s=1.0)
    assert result.death == Delay(n=1, never=0, median_s=1.0, max_s=1.0)
