"""Exclusion volumes: beds and benches on which lying is no fall."""

from typing import Any

import numpy as np
import pytest

from made_paths import PLACES, events_of, falling, moments, site_with, times, told
from trecsim.assessing import rule_set
from trecsim.lab.true_events.truth_events import truth_events

T = times(16.0)
BED = "[exclusions.bed]\npolygon_m = [[0.0, -1.0], [3.0, -1.0], [3.0, 1.0], [0.0, 1.0]]\n"
FALL = '[[rules]]\nid = "fall"\nkind = "body.fall"\n'
DOWN = '[[rules]]\nid = "down"\nkind = "body.down"\n'
HEAD = PLACES.partition("[zones")[0]


def falls_at(x_m: float, seconds: float = 0.9) -> np.ndarray:
    return falling((x_m, 0.0), 3.0, seconds, T)


def both(body: np.ndarray, exclusions: str, rules: str = FALL + DOWN) -> tuple[Any, Any]:
    """Return what the rules tell and what is true: rule, phase and beginning of each event."""
    events = events_of(rules, moments([body], T), places=HEAD + exclusions)
    true = truth_events(HEAD + exclusions + rules, T, body[None])
    found = ([(one["data"]["rule"]["id"], *told([one], "phase", "t_start_s")[0]) for one in some]
             for some in (events, true))  # fmt: skip
    return tuple(found)


def test_who_falls_onto_a_bed_is_not_told_and_who_falls_beside_it_is() -> None:
    assert both(falls_at(1.5), BED) == ([], [])
    for events in both(falls_at(-1.0), BED):
        assert [one[:2] for one in events] == [("fall", "new")]
    for events in both(falls_at(1.5), ""):
        assert [one[:2] for one in events] == [("fall", "new")]


def test_who_lies_down_on_a_bed_is_not_told_and_beside_it_is() -> None:
    assert both(falls_at(1.5, 3.0), BED) == ([], [])
    for events in both(falls_at(-1.0, 3.0), BED):
        assert [one[:2] for one in events] == [("down", "new")]


def test_a_bed_counts_at_its_height_alone() -> None:
    for events in both(falls_at(1.5), f"{BED}z_m = [0.3, 1.0]\n"):
        assert [one[:2] for one in events] == [("fall", "new")]


def test_who_slides_off_the_bed_is_told_from_when_the_hips_are_beside_it() -> None:
    body = falls_at(0.6)
    body[..., 0] -= np.clip((T - 7.0) / 2.0, 0.0, 1.0)[:, None] * 1.2  # at the edge at 8 s
    events, true = both(body, BED)
    assert [one[:2] for one in events] == [one[:2] for one in true] == [("fall", "new")]
    assert events[0][2] == pytest.approx(true[0][2], abs=0.04 + 1e-6)
    assert 7.5 < events[0][2] < 8.5


def test_an_exclusion_belongs_to_the_digest_of_the_rules_that_it_concerns() -> None:
    enter = '[[rules]]\nid = "room"\nkind = "zone.enter"\nzone = "room"\n'
    with_bed, without = (
        {one.id: one.config for one in rule_set("made", site_with(more + FALL + enter), None).rules}
        for more in (BED, "")
    )
    assert with_bed["fall"] != without["fall"]
    assert with_bed["room"] == without["room"]
