"""Rules on a gate that another system opens: tickets, followers, and feeds that do not work."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from made_paths import PLACES, bodies_on, line, moments, site_with, there, times, told
from trecsim.assessing import RuleEvents, assess, rule_set
from trecsim.safety.signals import MOST_PLACES, Feed, Signal, Signals, recorded
from trecsim.store.parquet_file import TracksInfo
from trecsim.store.recordings import tracks_recorder
from trecsim.values import Snapshot

FRAME_S = 0.04 + 1e-6
T = times(12.0)
FEED = '[feeds.tickets]\nfile = "tickets.jsonl"\nsilent_s = 0\n'
# "in" is from the right of the line (x > 0) to its left
FIRST = line((4.8, 0.0), (-1.2, 0.0))  # crosses at 4.0 s
SECOND = line((5.4, 0.3), (-1.2, 0.0))  # at 4.5 s, 0.6 m behind
OUT = line((-4.8, 0.0), (1.2, 0.0))


def gate_rule(kind: str, keys: str = "", name: str = "r") -> str:
    place = 'line = "gate"\nfeed = "tickets"'
    return f'[[rules]]\nid = "{name}"\nkind = "access.{kind}"\n{place}\n{keys}\n'


BOTH = gate_rule("tailgate", name="follows") + gate_rule("unauthorised", name="alone")


def grant(t_s: float, people: int = 1, taken_s: float = np.nan) -> Signal:
    return Signal("tickets", t_s, "grant", "gate", taken_s, people)


def walking(*paths: Any) -> list[Snapshot]:
    return moments([bodies_on(path, T) for path in paths], T)


def judged(
    rules: str, snapshots: Sequence[Snapshot], signals: Sequence[Signal], feed: str = FEED
) -> tuple[list[dict[str, Any]], dict[str, list[str]]]:
    """Return the events, and the faults of each rule in the order in which they came."""
    site = site_with(feed + rules, PLACES)
    engine = RuleEvents(rule_set(site.name, site, None), signals=recorded(signals))
    events: list[dict[str, Any]] = []
    faults: dict[str, list[str]] = {}
    for snapshot in snapshots:
        events += engine.step(snapshot)
        for rule, fault in engine.faults.items():
            said = faults.setdefault(rule, [])
            if said[-1:] != [fault]:
                said.append(fault)
    return events, faults


def rules_told(
    snapshots: Sequence[Snapshot], signals: Sequence[Signal], rules: str = BOTH
) -> list[tuple[str, int, float]]:
    """Return rule, person and time of each event."""
    events, faults = judged(rules, snapshots, signals)
    assert faults == {}
    return [
        (data["rule"]["id"], data["people"][0]["person"], data["t_start_s"])
        for data in (event["data"] for event in events)
    ]


def test_who_has_a_ticket_passes_and_who_follows_on_the_same_one_is_told() -> None:
    events, _ = judged(BOTH, walking(FIRST, SECOND), [grant(3.0)])
    assert told(events, "phase", "t_start_s", "t_end_s", "direction") == [("new", 4.5, 4.5, "in")]
    data = events[0]["data"]
    assert data["rule"]["kind"] == "access.tailgate"
    assert [one["person"] for one in data["people"]] == [1]
    assert data["measures"] == {
        "since_grant_s": 1.5, "behind_m": pytest.approx(np.hypot(0.6, 0.3), abs=0.01),
    }  # fmt: skip
    assert data["t_detect_s"] == pytest.approx(4.5 + 0.15 / 1.2, abs=FRAME_S)


def test_two_tickets_or_one_for_two_let_two_people_pass() -> None:
    assert rules_told(walking(FIRST, SECOND), [grant(3.0), grant(3.5)]) == []
    assert rules_told(walking(FIRST, SECOND), [grant(3.0, people=2)]) == []


def test_without_a_ticket_nobody_passes_and_a_ticket_does_not_hold_for_ever() -> None:
    assert rules_told(walking(FIRST), []) == [("alone", 0, 4.0)]
    assert rules_told(walking(FIRST), [grant(-1.1)]) == [("alone", 0, 4.0)]
    assert rules_told(walking(FIRST), [grant(-0.9)]) == []
    short = gate_rule("unauthorised", "window_s = 0.5", "alone")
    assert rules_told(walking(FIRST), [grant(3.4)], short) == [("alone", 0, 4.0)]


def test_a_ticket_after_the_crossing_is_none_for_it() -> None:
    late = gate_rule("unauthorised", "on_delay_s = 2.0", "alone")
    assert rules_told(walking(FIRST), [grant(4.1)], late) == [("alone", 0, 4.0)]


def test_a_ticket_whose_message_comes_late_counts_where_the_rule_waits_for_it() -> None:
    message = [grant(3.5, taken_s=4.6)]
    assert rules_told(walking(FIRST), message) == [("alone", 0, 4.0)]
    patient = gate_rule("unauthorised", "on_delay_s = 1.0", "alone")
    assert rules_told(walking(FIRST), message, patient) == []


def test_a_shut_door_ends_a_ticket() -> None:
    closed = Signal("tickets", 3.9, "closed", "gate")
    assert rules_told(walking(FIRST), [grant(3.0), closed]) == [("alone", 0, 4.0)]
    assert rules_told(walking(FIRST, SECOND), [grant(3.0), closed, grant(3.95)]) == [
        ("follows", 1, 4.5)
    ]
    other = Signal("tickets", 3.9, "closed", "other-gate")
    assert rules_told(walking(FIRST), [grant(3.0), other]) == []


def test_the_other_direction_is_closed_unless_the_rule_says_that_it_is_free() -> None:
    assert rules_told(walking(OUT), [grant(3.0)]) == [("alone", 0, 4.0)]
    free = gate_rule("tailgate", name="follows") + gate_rule(
        "unauthorised", 'way_back = "free"', "alone"
    )
    assert rules_told(walking(OUT), [], free) == []
    outwards = gate_rule("unauthorised", 'direction = "out"', "alone")
    assert rules_told(walking(OUT), [grant(3.0)], outwards) == []


def test_who_goes_around_the_end_of_the_line_needs_no_ticket() -> None:
    assert rules_told(walking(line((4.8, 1.5), (-1.2, 0.0))), []) == []


def test_a_feed_with_other_limits_keeps_its_tickets_and_one_of_another_name_begins_anew() -> None:
    def after(feed: str, rules: str) -> list[tuple[str, int]]:
        """Return what is told when the feed changes at 3.5 s, after a ticket at 3 s."""
        before, then = (site_with(*one) for one in ((FEED + BOTH, PLACES), (feed + rules, PLACES)))
        signals = recorded([grant(3.0)])
        engine = RuleEvents(rule_set("made", before, None), signals=signals)
        events: list[Any] = []
        changed = False
        for snapshot in walking(FIRST):
            if snapshot.t_s > 3.5 and not changed:
                changed = True
                assert engine.change(rule_set("made", then, None), snapshot.t_s) == []
            events += engine.step(snapshot)
        return told(events, "phase", "t_start_s")

    assert after(FEED.replace("silent_s = 0", "silent_s = 20"), BOTH) == []
    other = (FEED.replace("tickets", "badges"), BOTH.replace('"tickets"', '"badges"'))
    assert after(*other) == [("new", 4.0)]


def test_tickets_of_other_lines_and_other_feeds_do_not_count() -> None:
    others = [
        Signal("tickets", 3.0, "grant", "other-gate"),
        Signal("badges", 3.0, "grant", "gate"),
    ]
    assert rules_told(walking(FIRST), others) == [("alone", 0, 4.0)]


ALIVE = [Signal("tickets", float(t_s)) for t_s in range(12)]
WATCHED = FEED.replace("silent_s = 0", "silent_s = 2")
OTHER = '[[rules]]\nid = "counts"\nkind = "line.cross"\nline = "gate"\n'


def test_a_feed_that_was_never_heard_of_is_said_and_its_rules_judge_nothing() -> None:
    events, faults = judged(BOTH + OTHER, walking(FIRST), [], WATCHED)
    assert [data["rule"]["id"] for data in (one["data"] for one in events)] == ["counts"]
    assert faults == {rule: ["feed tickets has sent nothing yet"] for rule in ("follows", "alone")}


def test_a_feed_that_goes_silent_is_said_until_it_is_heard_again() -> None:
    again = line((12.0, 0.0), (-1.2, 0.0))  # crosses at 10 s
    heard = [one for one in ALIVE if one.t_s < 1.5 or one.t_s > 8.5]
    events, faults = judged(BOTH, walking(FIRST, again), heard, WATCHED)
    assert told(events, "t_start_s") == [(10.0,)]
    assert faults["alone"] == ["feed tickets is silent: no message for more than 2 s"]


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (
            [Signal("tickets", 3.0, "unreadable", note="a message is no JSON")],
            "feed tickets: a message is no JSON",
        ),
        (
            [grant(3.0 + n / 1000.0) for n in range(150)],
            "feed tickets: more than 100 messages in a second",
        ),
    ],
)
def test_after_a_flood_or_an_unreadable_message_nothing_is_concluded_for_ten_seconds(
    wrong: list[Signal], said: str
) -> None:
    again = there(line((14.4, 0.0), (-1.2, 0.0)), 0.0, 20.0)
    t_s = times(16.0)
    alive = [Signal("tickets", float(one)) for one in range(16)]
    snapshots = moments([bodies_on(path, t_s) for path in (FIRST, again, SECOND)], t_s)
    late = moments([bodies_on(line((17.4, 0.0), (-1.2, 0.0)), t_s)], t_s)  # crosses at 14.5 s
    for with_late in (False, True):
        events, faults = judged(
            gate_rule("unauthorised"), late if with_late else snapshots[:320], [*alive, *wrong],
            WATCHED,
        )  # fmt: skip
        assert faults == {"r": [said]}
        assert told(events, "t_start_s") == ([(14.5,)] if with_late else [])


def test_a_feed_that_may_send_less_than_one_message_a_second_is_heard() -> None:
    signals = Signals([Feed("f", most_per_s=0.2)])
    signals.take([Signal("f", 1.0, "grant", "gate", 1.0), Signal("f", 6.0, "grant", "gate", 6.0)])
    assert signals.fault("f", 6.0) is None
    assert len(signals.grants("f", "gate")) == 2
    signals.take([Signal("f", 6.5, "grant", "gate", 6.5)])
    assert signals.fault("f", 6.5) == "feed f: more than 0.2 messages in a second"


@pytest.mark.parametrize("kept_s", [math.nan, 0.0])
def test_a_part_of_a_recording_begins_with_what_came_before_it_and_not_with_a_flood(
    kept_s: float,
) -> None:
    """As when a draft is tried on some minutes, or a file of messages is of the whole day."""
    before = [Signal("f", float(n), "grant", "gate", n + kept_s) for n in range(300)]
    source = recorded([*before, Signal("f", 299.9, "grant", "gate", 299.9 + kept_s)])
    signals = Signals([Feed("f")])
    signals.take(source(299.5))
    assert signals.fault("f", 299.5) is None
    assert len(signals.grants("f", "gate")) == 300
    signals.take(source(300.0))
    assert signals.grants("f", "gate")[-1].holds(300.0, 1.0)
    assert [one.taken_s for one in source(301.0)] == []


@pytest.mark.parametrize("what", ["grant", "volume", "gone"])
def test_a_feed_that_names_ever_more_places_is_a_fault_and_takes_no_memory(what: Any) -> None:
    def named(number: int, t_s: float) -> Signal:
        return Signal("f", t_s, what, f"place {number}", t_s, xy_m=(0.0, 0.0))

    signals = Signals([Feed("f")])
    signals.take(named(n, 1.0 + 0.1 * n) for n in range(MOST_PLACES))
    assert signals.fault("f", 30.0) is None
    signals.take(named(n, 30.0) for n in range(MOST_PLACES, MOST_PLACES + 50))
    assert signals.fault("f", 30.0) == f"feed f: it names more than {MOST_PLACES} places of a kind"
    state = signals._states["f"]
    assert len(state.grants) + len(state.vehicles) == MOST_PLACES
    signals.take([named(0, 41.0)])
    assert signals.fault("f", 41.0) is None


def test_doors_that_shut_where_nobody_had_a_ticket_take_no_memory() -> None:
    signals = Signals([Feed("f")])
    signals.take(Signal("f", 0.1 * n, "closed", f"line {n}", 0.1 * n) for n in range(500))
    assert signals._states["f"].grants == {}
    assert signals.fault("f", 50.0) is None


def test_assess_takes_the_messages_from_the_file_of_the_feed(tmp_path: Path) -> None:
    with tracks_recorder(tmp_path, TracksInfo(rig_sha256="")) as tracks:
        for snapshot in walking(FIRST, SECOND):
            tracks.write(snapshot)
    (tmp_path / "site.toml").write_text(PLACES + FEED + BOTH, encoding="utf-8")
    (tmp_path / "tickets.jsonl").write_text('{"t_s": 3.0, "grant": "gate"}\n', encoding="utf-8")
    summary = assess(tmp_path, tmp_path / "site.toml", tmp_path / "events.jsonl")
    assert summary["by_rule"] == {"follows": 1, "alone": 0}
    assert summary["remarks"] == []


def test_a_rule_on_a_feed_that_does_not_exist_is_refused_with_the_nearest_name() -> None:
    with pytest.raises(
        AssertionError, match=r"there is no feed 'tickets'; did you mean 'ticket'\?"
    ):
        site_with(FEED.replace("tickets", "ticket") + BOTH)
