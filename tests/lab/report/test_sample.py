"""Moments of long recordings in little memory."""

import math

import numpy as np
import pytest

from made_tracks import snapshot
from trecsim.lab.report.thinning import Sampler


def sampled(moments: int, people: int = 2, **settings: float) -> Sampler:
    sampler = Sampler(**settings)  # type: ignore[arg-type]
    for i in range(moments):
        sampler.add(snapshot(i * 0.04, list(range(people))))
    return sampler


def test_a_short_recording_is_kept_whole() -> None:
    sampler = sampled(50)
    assert (sampler.every, len(sampler.sample().t_s)) == (1, 50)
    assert sampler.sample().xyz_m.shape == (100, 17, 3)


def test_a_long_recording_is_counted_whole_and_kept_in_bounds() -> None:
    sampler = sampled(1000, most_rows=300)
    assert (sampler.moments, sampler.person_moments) == (1000, 2000)
    sample = sampler.sample()
    assert 100 <= len(sample.id) <= 300
    assert sample.t_s[-1] > 0.95 * 999 * 0.04
    assert sampler.stays()[0].moments == 1000


def test_moments_are_kept_in_pairs_so_that_what_lies_between_is_known() -> None:
    sampler = sampled(1000, most_rows=300)
    steps_s = np.diff(sampler.sample().t_s)
    assert steps_s[::2] == pytest.approx(0.04)
    assert (steps_s[1::2] > 0.1).all()
    assert sampler.period_s == pytest.approx(0.04)


def test_only_the_part_that_is_asked_for_counts() -> None:
    sampler = sampled(100, from_s=1.0, to_s=2.0)
    assert sampler.moments == 26
    assert sampler.span_s == pytest.approx((1.0, 2.0))


def test_who_stayed_longest_comes_first() -> None:
    sampler = Sampler()
    for i in range(10):
        sampler.add(snapshot(i * 0.04, [5, 9] if i < 4 else [9]))
    assert [stay.person for stay in sampler.stays()] == [9, 5]
    assert (sampler.stays()[1].first_s, sampler.stays()[1].last_s) == (0.0, pytest.approx(0.12))


def test_of_nothing_there_is_an_empty_sample() -> None:
    sampler = Sampler()
    assert sampler.sample().xyz_m.shape == (0, 17, 3)
    assert sampler.stays() == ()
    assert math.isnan(sampler.span_s[0])
    assert math.isnan(sampler.period_s)
