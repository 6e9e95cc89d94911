"""Getting off chairs: who is still in the strip, who stays on, and who is told of neither."""

from typing import Any

import numpy as np
import pytest

from made_paths import (
    PLACES,
    bodies_on,
    events_of,
    falling,
    line,
    moments,
    site_with,
    there,
    through,
    times,
    told,
)
from trecsim.assessing import RuleEvents, rule_set
from trecsim.lab.true_events.truth_events import truth_events
from trecsim.safety.signals import Signal, recorded

T = times(16.0)
HEAD = PLACES.partition("[zones")[0]
PLACED = (
    f"{HEAD}[zones.strip]\npolygon_m = [[0.0, -1.5], [3.0, -1.5], [3.0, 1.5], [0.0, 1.5]]\n"
    "[lines.off]\npoints_m = [[0.0, 1.5], [0.0, -1.5]]\n"
    "[volumes.chair]\nsize_m = [1.0, 2.0, 1.2]\nbottom_m = 0.4\n"
)
TABLE = (
    "path_m = [[-8.0, 0.0], [0.0, 0.0], [1.0, 0.0]]\npath_s = [0.0, 8.0, 9.0]\n"
    "period_s = 6.0\n"
)  # chairs pass the line at 8 s and 14 s, and are gone a second later
RULE = (
    '[[rules]]\nid = "r"\nkind = "lift.unload"\nvolume = "chair"\nline = "off"\nstrip = "strip"\n'
)
STANDS = line((2.0, 0.0), (0.0, 0.0))


def both(*bodies: np.ndarray, rule: str = RULE) -> tuple[Any, Any]:
    """Return what the rule tells and what is true: phase, person, beginning and severity."""
    site = PLACED + TABLE
    events = events_of(rule, moments(bodies, T), places=site)
    true = truth_events(site + rule, T, np.array(bodies))
    one, other = (
        [
            (data["phase"], data["people"][0]["person"], data["t_start_s"], data["t_detect_s"])
            for data in (event["data"] for event in some)
        ]
        for some in (events, true)
    )
    return one, other


def test_who_is_in_the_strip_when_a_chair_comes_is_told_until_it_has_passed() -> None:
    events, true = both(bodies_on(STANDS, T))
    assert [one[:2] for one in events] == [one[:2] for one in true]
    assert [one[:2] for one in events] == [("new", 0), ("end", 0), ("new", 0), ("end", 0)]
    for told_of in (events, true):
        starts_s = [one[2] for one in told_of]
        assert starts_s == pytest.approx([5.0, 5.0, 11.0, 11.0], abs=0.08)
        assert told_of[0][3] == pytest.approx(5.3, abs=0.08)


def test_who_gets_off_and_leaves_in_time_is_not_told() -> None:
    rides = bodies_on(through((0, -8, 0), (7.2, 0, 0), (10.0, 5, 0), (16, 5, 0)), T)
    assert both(rides) == ([], [])


def test_who_stays_on_the_chair_behind_the_line_is_told() -> None:
    stays = bodies_on(through((0, -8, 0), (9, 1, 0), (10, 5, 0), (16, 5, 0)), T)
    events, true = both(stays)
    assert [one[:2] for one in events] == [one[:2] for one in true] == [("new", 0), ("end", 0)]
    assert events[0][2] == pytest.approx(8.0, abs=0.08) == true[0][2]


def test_who_lies_in_the_strip_is_told_at_once_with_a_higher_severity() -> None:
    body = falling((1.5, 0.0), 1.0, 0.9, T)
    places = PLACED + TABLE
    events = events_of(RULE, moments([body], T), places=places)
    assert told(events, "severity", "phase")[0] == ("alarm", "new")
    assert told(events, "t_detect_s")[0][0] == pytest.approx(5.0, abs=0.05)
    assert "in_strip_s" in events[0]["data"]["measures"]


def test_with_a_feed_the_chairs_are_where_it_tells() -> None:
    fed = PLACED.replace("[zones.strip]", '[feeds.lift]\nfile = "lift.jsonl"\n[zones.strip]', 1)
    site = site_with(f'feed = "lift"\n{RULE}', fed)
    signals = [
        Signal("lift", 0.1 * n, "volume", "chair", vehicle="12", xy_m=(-8.0 + 0.1 * n, 0.0))
        for n in range(100)
    ]
    engine = RuleEvents(rule_set("made", site, None), signals=recorded(signals))
    snapshots = moments([bodies_on(there(STANDS, 0.0, 9.5), T[T < 9.5])], T[T < 9.5])
    events = [event for one in snapshots for event in engine.step(one)]
    assert told(events, "phase") == [("new",), ("end",)]
    starts_s = [one for (one,) in told(events, "t_start_s")]
    assert starts_s == pytest.approx([5.0, 5.0], abs=0.15)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ('line = "of"', "there is no line 'of'; did you mean 'off'"),
        ('strip = "stripe"', "there is no zone 'stripe'; did you mean 'strip'"),
    ],
)
def test_its_other_places_have_to_exist(wrong: str, said: str) -> None:
    key = wrong.partition(" ")[0]
    right = next(one for one in RULE.splitlines() if one.startswith(key))
    with pytest.raises(AssertionError, match=said.replace("?", r"\?")):
        site_with(RULE.replace(right, wrong), PLACED + TABLE)
