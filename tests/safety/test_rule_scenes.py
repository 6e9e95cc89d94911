"""Each kind of rule on exact 3D: what fires, when it began, when that was decided, and what not.

Frames are 0.04 s apart; an onset is right within one frame.
"""

import dataclasses
from typing import Any

import numpy as np
import pytest

from made_paths import (
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
from trecsim.safety.polygons import Polygon
from trecsim.safety.rule_scene import Memory
from trecsim.values import PROVISIONAL, Snapshot

FRAME_S = 0.04 + 1e-6
T = times(12.0)
WALK = line((-2.0, 0.0), (1.2, 0.0))  # in the room from 1.667 s to 5.0 s
NEVER: list[Any] = []


def rule(kind: str, keys: str = "", name: str = "r") -> str:
    return f'[[rules]]\nid = "{name}"\nkind = "{kind}"\n{keys}\n'


def walking(*paths: Any, t_s: np.ndarray = T, **options: Any) -> list[Snapshot]:
    return moments([bodies_on(path, t_s) for path in paths], t_s, **options)


def check(events: list[dict[str, Any]], expected: list[tuple[str, float, float | None]]) -> None:
    """Compare phases, starts and ends, each within a frame."""
    assert [phase for (phase,) in told(events, "phase")] == [phase for phase, _, _ in expected]
    for (start_s, end_s), (_, true_start_s, true_end_s) in zip(
        told(events, "t_start_s", "t_end_s"), expected, strict=True
    ):
        assert start_s == pytest.approx(true_start_s, abs=FRAME_S)
        assert end_s == (None if true_end_s is None else pytest.approx(true_end_s, abs=FRAME_S))


def test_zones_that_a_rule_makes_for_a_moment_are_not_mixed_up() -> None:
    scene = Memory().take(walking(WALK)[0])
    around = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    for _ in range(20):
        assert scene.inside(Polygon(around + scene.floor.xy_m[0])) == pytest.approx(1.0)
        assert scene.inside(Polygon(around + 50.0)) == pytest.approx(0.0)


def test_no_rule_can_change_what_others_see_of_a_zone() -> None:
    scene = Memory().take(walking(WALK)[0])
    inside = scene.inside(Polygon(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]])))
    with pytest.raises(ValueError, match="read-only"):
        inside[:] = 1.0


@pytest.mark.parametrize("sigma_m", [0.001, 0.05])
def test_entering_a_zone(sigma_m: float) -> None:
    events = events_of(rule("zone.enter", 'zone = "room"'), walking(WALK, sigma_m=sigma_m))
    check(events, [("new", 1.667, None), ("end", 1.667, 5.0)])
    assert told(events, "t_detect_s")[0][0] == pytest.approx(1.867, abs=FRAME_S)


def test_who_is_first_seen_inside_enters_then_and_what_is_open_at_the_end_stays_open() -> None:
    inside = walking(lambda t_s: np.full((len(t_s), 2), 1.0) * [1, 0])
    check(events_of(rule("zone.enter", 'zone = "room"'), inside), [("new", 0.0, None)])


@pytest.mark.parametrize(("x_m", "events"), [(0.1, 1), (-0.05, 0)])
def test_noise_near_a_border_makes_no_further_events(x_m: float, events: int) -> None:
    near = walking(line((x_m, 0.0), (0.0, 0.0)), sigma_m=0.03, seed=4)
    assert len(events_of(rule("zone.enter", 'zone = "room"'), near)) == events


def test_leaving_a_zone_is_told_once_with_the_time_at_the_border() -> None:
    events = events_of(rule("zone.exit", 'zone = "room"'), walking(WALK))
    check(events, [("new", 5.0, 5.0)])
    # 0.15 m outside at 5.125 s, for 0.2 s
    assert told(events, "t_detect_s")[0][0] == pytest.approx(5.325, abs=FRAME_S)


def test_who_is_lost_inside_has_not_left_and_who_turns_within_the_margin_neither() -> None:
    lost = walking(there(WALK, 0.0, 3.0), line((9.0, 9.0), (0.0, 0.0)))
    assert events_of(rule("zone.exit", 'zone = "room"'), lost) == NEVER
    events = events_of(rule("zone.enter", 'zone = "room"'), lost)
    check(events, [("new", 1.667, None), ("end", 1.667, 2.96)])
    assert told(events, "ended_by") == [(None,), ("lost",)]
    turns = walking(through((0, 2, 0), (4, 4.1, 0), (8, 2, 0)))
    assert events_of(rule("zone.exit", 'zone = "room"'), turns) == NEVER


def test_who_leaves_and_is_lost_right_outside_has_left() -> None:
    gone = walking(there(WALK, 0.0, 5.2), line((9.0, 9.0), (0.0, 0.0)))
    events = events_of(rule("zone.exit", 'zone = "room"'), gone)
    check(events, [("new", 5.0, 5.0)])
    assert [one["person"] for (people,) in told(events, "people") for one in people] == [0]


def test_dwelling_begins_once_the_time_is_over_and_gets_worse_at_three_times_it() -> None:
    events = events_of(rule("zone.dwell", 'zone = "room"\ndwell_s = 1.0'), walking(WALK))
    check(events, [("new", 2.667, None), ("update", 2.667, None), ("end", 2.667, 5.0)])
    assert told(events, "severity") == [("warning",), ("alarm",), ("alarm",)]
    assert told(events, "t_detect_s")[1][0] == pytest.approx(4.667, abs=FRAME_S)


def test_dwelling_bridges_gaps_of_two_seconds_and_needs_the_whole_time() -> None:
    inside = through((0, 2, 0), (12, 2, 0))
    gone = walking(there(inside, 0.0, 12.0), t_s=T[(T < 3.0) | (T > 4.5)])
    keys = 'zone = "room"\ndwell_s = 6.0'
    check(events_of(rule("zone.dwell", keys), gone), [("new", 6.0, None)])
    assert events_of(rule("zone.dwell", 'zone = "room"\ndwell_s = 3.5'), walking(WALK)) == NEVER


def test_a_hand_in_a_restricted_zone_counts_with_the_joint_that_is_inside() -> None:
    beside = bodies_on(line((-0.4, 0.0), (0.0, 0.0)), T)
    beside[100:, 9, :2] += [1.0, 0.0]  # the left wrist reaches in, at 4 s
    events = events_of(rule("zone.restricted", 'zone = "room"'), moments([beside], T))
    check(events, [("new", 4.0, None)])
    assert told(events, "joints") == [(["left_wrist"],)]
    unsupported = moments([beside], T)
    for snapshot in unsupported:
        snapshot.support[:, 9] = 0
    assert events_of(rule("zone.restricted", 'zone = "room"'), unsupported) == NEVER


def test_a_restricted_zone_ends_at_its_height() -> None:
    low = "[zones.room]\npolygon_m = [[0.0, -1.0], [4.0, -1.0], [4.0, 1.0], [0.0, 1.0]]\n"
    head = 'format = "trecsim.site/1"\nname = "made"\n'
    over = rule("zone.restricted", 'zone = "room"')
    assert events_of(over, walking(WALK), places=f"{head}{low}z_m = [2.0, 3.0]\n") == NEVER
    assert events_of(over, walking(WALK), places=f"{head}{low}z_m = [1.5, 3.0]\n") != NEVER


def test_crossings_of_a_line_are_counted_once_each_in_their_direction() -> None:
    there_and_back = walking(through((0, -2, 0), (4, 2, 0), (8, -2, 0)))
    events = events_of(rule("line.cross", 'line = "gate"'), there_and_back)
    check(events, [("new", 2.0, 2.0), ("new", 6.0, 6.0)])
    assert told(events, "direction", "count") == [("out", 1), ("in", 1)]
    only_in = events_of(rule("line.cross", 'line = "gate"\ndirection = "in"'), there_and_back)
    assert told(only_in, "direction") == [("in",)]


@pytest.mark.parametrize(
    "path",
    [
        through((0, -2, 0), (3, 0.1, 0), (4, 0.1, 0), (8, -2, 0)),  # turns within the margin
        through((0, -2, 1.5), (6, 2, 1.5)),  # past the end of the line
        through((0, -2, 0), (12, -0.5, 0)),
    ],
)
def test_what_is_no_crossing_of_a_line(path: Any) -> None:
    assert events_of(rule("line.cross", 'line = "gate"'), walking(path)) == NEVER


def test_who_goes_around_the_end_and_comes_back_through_crosses_once() -> None:
    around = through((0, -1, 0), (2, -1, 2), (4, 1, 2), (6, 1, 0), (8, -1, 0))
    events = events_of(rule("line.cross", 'line = "gate"'), walking(around))
    assert told(events, "direction") == [("in",)]


def test_an_occupancy_counts_from_when_the_limit_is_reached() -> None:
    later = line((-3.2, 0.5), (1.2, 0.0))  # inside from 2.667 s to 6.0 s
    events = events_of(rule("occupancy.limit", 'zone = "room"\nlimit = 2'), walking(WALK, later))
    check(events, [("new", 2.667, None), ("end", 2.667, 5.0)])
    assert told(events, "count") == [(2,), (2,)]
    assert [one["person"] for one in events[0]["data"]["people"]] == [0, 1]
    assert events_of(rule("occupancy.limit", 'zone = "room"\nlimit = 3'), walking(WALK)) == NEVER


def test_running_begins_when_the_speed_is_reached_and_walking_is_none() -> None:
    runs = through((0, -2, 0), (3, -2, 0), (6, 7, 0), (12, 7, 0))  # 3 m/s from 3 s to 6 s
    events = events_of(rule("speed.running"), walking(runs))
    check(events, [("new", 3.0, None), ("end", 3.0, 6.0)])
    assert told(events, "t_detect_s")[0][0] == pytest.approx(3.8, abs=2 * FRAME_S)
    assert events_of(rule("speed.running"), walking(WALK)) == NEVER
    assert events_of(rule("speed.running", "speed_mps = 1.0"), walking(WALK)) != NEVER
    inside = events_of(rule("speed.running", 'zone = "room"'), walking(runs))
    assert told(inside, "t_start_s")[0][0] == pytest.approx(3.667, abs=FRAME_S)


def test_a_single_jump_of_a_track_is_no_running() -> None:
    jumps = bodies_on(through((0, 0, 0), (12, 0, 0)), T)
    jumps[150:, :, 0] += 1.0
    assert events_of(rule("speed.running"), moments([jumps], T)) == NEVER


def test_the_wrong_way_is_told_after_one_and_a_half_metres_with_the_time_it_began() -> None:
    back = through((0, 3.9, 0), (3, 3.9, 0), (6, 0.3, 0), (12, 0.3, 0))
    keys = 'zone = "room"\nheading_deg = 0'
    events = events_of(rule("flow.wrong_way", keys), walking(back))
    check(events, [("new", 3.0, None), ("end", 3.0, 6.0)])
    assert told(events, "t_detect_s")[0][0] == pytest.approx(4.25, abs=2 * FRAME_S)
    assert events_of(rule("flow.wrong_way", keys), walking(WALK)) == NEVER
    short = through((0, 3.9, 0), (3, 3.9, 0), (4, 2.7, 0), (12, 2.7, 0))
    assert events_of(rule("flow.wrong_way", keys), walking(short)) == NEVER


def test_near_an_edge_warns_after_two_seconds_and_beyond_it_alarms_at_once() -> None:
    near = through((0, 0, -2), (4, 0, -0.6), (8, 0, -0.6), (9, 0, 1), (12, 0, 1))
    events = events_of(rule("edge.platform", 'edge = "platform"'), walking(near))
    assert told(events, "phase", "severity") == [("new", "warning"), ("update", "alarm")]
    # the shoulder, 0.18 m ahead, is 0.5 m from the edge at y = -0.68, and over it at -0.18
    assert told(events, "t_start_s")[0][0] == pytest.approx(3.77, abs=FRAME_S)
    assert told(events, "t_detect_s")[1][0] == pytest.approx(8.263, abs=FRAME_S)
    away = walking(through((0, -5, -0.8), (12, 5, -0.8)))
    assert events_of(rule("edge.platform", 'edge = "platform"'), away) == NEVER


def test_over_an_edge_without_having_been_near_it_alarms_at_once() -> None:
    beyond = walking(line((0.0, 1.0), (0.0, 0.0)))
    events = events_of(rule("edge.platform", 'edge = "platform"'), beyond)
    assert told(events, "phase", "severity", "t_detect_s") == [("new", "alarm", 0.0)]
    narrow = rule("edge.platform", 'edge = "platform"\ndepth_m = 0.5')
    assert events_of(narrow, beyond) == NEVER


def test_a_fall_is_told_a_second_after_the_person_lies_there() -> None:
    falls = moments([falling((1.0, 0.0), 3.0, 0.9, T)], T)
    events = events_of(rule("body.fall"), falls)
    assert told(events, "phase") == [("new",)]
    (start_s, detect_s), *_ = told(events, "t_start_s", "t_detect_s")
    assert 3.7 < start_s < 3.9
    assert detect_s == pytest.approx(start_s + 1.0, abs=FRAME_S)
    assert events[0]["data"]["people"][0]["posture"] == "lying"
    assert events_of(rule("body.down"), falls) == NEVER


@pytest.mark.parametrize(("changes_s", "overlap_s"), [(3.5, 0.0), (3.85, 0.0), (3.85, 0.1)])
def test_who_gets_another_identity_while_falling_has_fallen(
    changes_s: float, overlap_s: float
) -> None:
    before, after = (falling((1.0, 0.0), 3.0, 0.9, T) for _ in range(2))
    before[changes_s + overlap_s <= T] = np.nan
    after[changes_s > T] = np.nan
    falls = moments([before, after], T)
    ((start_s, detect_s, people),) = told(
        events_of(rule("body.fall"), falls), "t_start_s", "t_detect_s", "people"
    )
    assert 3.7 < start_s < 3.9
    assert detect_s == pytest.approx(start_s + 1.0, abs=FRAME_S)
    assert [one["person"] for one in people] == [1]


def test_who_is_first_seen_lying_elsewhere_has_not_fallen() -> None:
    before, after = falling((1.0, 0.0), 3.0, 0.9, T), falling((2.5, 0.0), 3.0, 0.9, T)
    before[T >= 3.85] = after[T < 3.85] = np.nan
    assert events_of(rule("body.fall"), moments([before, after], T)) == NEVER


def test_who_squats_down_quickly_and_then_lies_down_has_not_fallen() -> None:
    standing = bodies_on(line((0.0, 0.0), (0.0, 0.0)), T)
    squats = standing.copy()
    squats[:, :13, 2] -= 0.55 * np.clip((T - 3.0) / 0.5, 0.0, 1.0)[:, None]  # 1.1 m/s
    share = np.clip((T - 4.0) / 1.0, 0.0, 1.0)[:, None, None]
    down = (1.0 - share) * squats + share * falling((0.0, 0.0), 0.0, 0.01, T)
    assert events_of(rule("body.fall"), moments([down], T)) == NEVER
    assert events_of(rule("body.down", "on_delay_s = 3"), moments([down], T)) != NEVER


def test_lying_down_slowly_is_no_fall_but_somebody_who_stays_down_is_told() -> None:
    t_s = times(45.0)
    slow = moments([falling((0.0, 0.0), 3.0, 3.0, t_s)], t_s)
    assert events_of(rule("body.fall"), slow) == NEVER
    events = events_of(rule("body.down"), slow)
    assert told(events, "phase", "severity") == [("new", "warning"), ("update", "alarm")]
    start_s, detect_s = told(events, "t_start_s", "t_detect_s")[0]
    assert detect_s == pytest.approx(start_s + 10.0, abs=FRAME_S)
    assert told(events, "t_detect_s")[1][0] == pytest.approx(start_s + 30.0, abs=FRAME_S)


def test_sitting_and_crouching_are_no_falls() -> None:
    for hip_m in (0.5, 0.38):
        body = bodies_on(line((0.0, 0.0), (0.0, 0.0)), T)
        down = np.clip((T - 3.0) / 0.35, 0.0, 1.0)[:, None]
        body[:, :13, 2] -= down * (0.9 - hip_m)
        assert (
            events_of(rule("body.fall") + rule("body.down", name="d"), moments([body], T)) == NEVER
        )


def test_provisional_people_count_for_nothing_and_who_coasts_begins_nothing() -> None:
    rules = rule("zone.enter", 'zone = "room"') + rule("zone.restricted", 'zone = "room"', "x")
    walk = walking(WALK)
    unsure = [dataclasses.replace(one, state=np.array([PROVISIONAL])) for one in walk]
    assert events_of(rules, unsure) == NEVER
    assert events_of(rules, walking(WALK, support=0)) == NEVER


def test_a_schedule_disarms_a_rule_and_ends_what_is_open() -> None:
    night = rule("zone.enter", 'zone = "room"\nschedule = ["Sa 22:00-06:00"]')
    inside = walking(line((1.0, 0.0), (0.0, 0.0)))
    ten_s = 1769896800.0  # Saturday, 22:00 UTC
    events = events_of(night, inside, start_s=ten_s - 5.0)
    check(events, [("new", 5.0, None)])
    six = ten_s + 8 * 3600.0 - 5.0
    events = events_of(night, inside, start_s=six)
    check(events, [("new", 0.0, None), ("end", 0.0, 5.0)])
    assert told(events, "ended_by")[1] == ("disarmed",)
    check(events_of(night, inside), [("new", 0.0, None)])


def test_episodes_of_several_people_and_rules_are_told_apart_and_ids_follow_from_the_facts() -> (
    None
):
    rules = rule("zone.enter", 'zone = "room"', "a") + rule("zone.enter", 'zone = "room"', "b")
    scene = walking(WALK, line((-2.0, 0.5), (1.2, 0.0)))
    events, again = events_of(rules, scene), events_of(rules, scene)
    assert events == again
    assert len({one["id"] for one in events}) == len(events) == 8
    assert len({episode for (episode,) in told(events, "event")}) == 4
    assert {one["type"] for one in events} == {"trecsim.zone.enter.v1"}
    assert {(one["source"], one["subject"]) for one in events} == {
        ("site/made", "rule/a"), ("site/made", "rule/b"),
    }  # fmt: skip


def test_events_have_all_that_the_contract_names() -> None:
    event = events_of(rule("zone.enter", 'zone = "room"'), walking(WALK))[0]
    assert {"specversion", "id", "type", "source", "subject", "data"} == set(event)
    data = event["data"]
    assert set(data) >= {
        "event", "phase", "seq", "severity", "rule", "t_start_s", "t_detect_s", "t_end_s",
        "probability", "predicted", "lead_s", "people", "zone", "measures", "evidence",
    }  # fmt: skip
    assert set(data["rule"]) == {"id", "kind", "config"}
    assert len(data["rule"]["config"]) == 64
    assert data["people"] == [
        {
            "person": 0, "floor_m": [0.256, 0.0], "floor_cov_m2": [0.0, 0.0, 0.0],
            "speed_mps": 1.2, "posture": "upright",
        }
    ]  # fmt: skip
    assert set(data["evidence"]) == {"t_from_s", "t_to_s", "cameras"}
    unix = [dataclasses.replace(one, t_s=one.t_s + 1.7e9) for one in walking(WALK)]
    assert events_of(rule("zone.enter", 'zone = "room"'), unix)[0]["time"].startswith("2023-11-14T")


def test_a_changed_rule_ends_its_episodes_and_others_go_on() -> None:
    first, second = (
        rule("zone.enter", 'zone = "room"', "a"),
        rule("zone.enter", 'zone = "room"', "b"),
    )
    site = site_with(first + second)
    engine = RuleEvents(rule_set("made", site, None))
    snapshots = walking(line((1.0, 0.0), (0.0, 0.0)))
    begun = [event for one in snapshots[:20] for event in engine.step(one)]
    assert len(begun) == 2
    other = site_with(first + second.replace("[[rules]]", '[[rules]]\nseverity = "alarm"'))
    ends = engine.change(rule_set("made", other, None), snapshots[19].t_s)
    assert told(ends, "phase", "ended_by") == [("end", "disarmed")]
    assert ends[0]["data"]["rule"]["id"] == "b"
    later = [event for one in snapshots[20:40] for event in engine.step(one)]
    assert [(one["data"]["rule"]["id"], one["data"]["severity"]) for one in later] == [
        ("b", "alarm")
    ]


def test_times_that_do_not_increase_are_left_out() -> None:
    engine = RuleEvents(rule_set("made", site_with(rule("zone.enter", 'zone = "room"')), None))
    snapshots = walking(WALK)
    events = [event for one in snapshots for event in [*engine.step(one), *engine.step(one)]]
    assert events == events_of(rule("zone.enter", 'zone = "room"'), snapshots)
