"""Limbs that jump are told in plain words; steady ones, and those carried along, are not."""

import numpy as np

from trecsim.lab.evaluation.limbs import LIMBS, LimbSeries
from trecsim.lab.plots.elapsed_time import ElapsedTime
from trecsim.lab.report.odd_limbs import MOST_TOLD, odd_limbs

SHIN = LIMBS.index("left shin")


def steady(person: int = 0) -> LimbSeries:
    t_s = 100 + 0.1 * np.arange(100)
    return LimbSeries(person, t_s, np.full((100, 14), 0.47), np.ones((100, 14), bool))


def told(*series: LimbSeries) -> list[str]:
    return list(odd_limbs(series, ElapsedTime(100.0)))


def test_a_steady_limb_is_not_told() -> None:
    assert told(steady()) == []


def test_a_limb_that_jumps_is_told_with_its_worst_moment() -> None:
    series = steady()
    series.length_m[[50, 72], SHIN] = 0.9, 1.0
    assert told(series) == [
        "Person 0: left shin is much too long in 2 frames (longest 1.00 m at 7.2 s, median 0.47 "
        "m). One end was probably matched to a wrong detection."
    ]


def test_a_jump_that_no_camera_supports_is_not_told() -> None:
    series = steady()
    series.length_m[72, SHIN] = 1.0
    series.supported[72, SHIN] = False
    assert told(series) == []


def test_a_limb_that_varies_is_told() -> None:
    series = steady()
    series.length_m[::2, LIMBS.index("right forearm")] += 0.12
    assert told(series) == [
        "Person 0: right forearm varies in length by 6.0 cm around 53 cm. Likely causes: a noisy "
        "detector, or a camera that is off."
    ]


def test_lines_across_the_body_change_with_the_posture() -> None:
    series = steady()
    series.length_m[::2, LIMBS.index("left trunk")] = 0.2
    assert told(series) == []


def test_only_the_worst_are_told_one_by_one() -> None:
    many = [steady(person) for person in range(MOST_TOLD + 1)]
    for person, series in enumerate(many):
        series.length_m[5, SHIN] = 1.0 + 0.1 * person
    lines = told(*many)
    assert lines[0].startswith(f"Person {MOST_TOLD}: left shin is much too long in 1 frame ")
    assert len(lines) == MOST_TOLD + 1
    assert lines[-1].startswith("The same holds for 1 more limb;")
