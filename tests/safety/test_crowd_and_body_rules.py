"""Kinds of rules on crowds, groups and what bodies do: what fires on exact people, and what not."""

from typing import Any

import numpy as np
import pytest

from made_paths import bodies_on, events_of, line, moments, there, through, times, told
from trecsim.safety.conditions.crowds import crowd_pressure
from trecsim.safety.conditions.waving import Hand, swung
from trecsim.skeleton import COCO17
from trecsim.values import Snapshot

T = times(8.0)
NEVER: list[Any] = []
WRISTS = [COCO17.index("left_wrist"), COCO17.index("right_wrist")]
ANKLE = COCO17.index("left_ankle")


def rule(kind: str, keys: str = "") -> str:
    return f'[[rules]]\nid = "r"\nkind = "{kind}"\n{keys}\n'


ROOM = 'zone = "room"'


def walking(*paths: Any, t_s: np.ndarray = T, **options: Any) -> list[Snapshot]:
    return moments([bodies_on(path, t_s) for path in paths], t_s, **options)


def test_who_leaves_the_zone_they_should_stay_in_is_told_and_who_never_was_inside_not() -> None:
    leaves, outside = line((2.0, 0.0), (0.0, 0.5)), line((8.0, 8.0), (0.1, 0.0))
    events = events_of(rule("zone.confined", ROOM), walking(leaves, outside))
    assert told(events, "phase") == [("new",)]
    assert events[0]["data"]["people"][0]["person"] == 0
    assert events[0]["data"]["t_start_s"] == pytest.approx(2.0, abs=0.05)


def standing(t_s: np.ndarray, at: tuple[float, float] = (-0.5, 0.0)) -> np.ndarray:
    return bodies_on(line(at, (0.0, 0.0)), t_s)


def test_a_hand_in_the_zone_is_told_while_the_feet_are_outside() -> None:
    body = standing(T, (-0.2, 0.0))
    body[75:150, WRISTS[0], :2] = [0.4, 0.0]  # from 3 s to 6 s
    events = events_of(rule("body.reach", ROOM), moments([body], T))
    assert told(events, "phase", "joints") == [
        ("new", ["left_wrist"]), ("end", ["left_wrist"]),
    ]  # fmt: skip
    assert events[0]["data"]["t_start_s"] == pytest.approx(3.0, abs=0.05)
    inside = moments([standing(T, (1.0, 0.0))], T)
    assert events_of(rule("body.reach", ROOM), inside) == NEVER


def test_a_foot_on_the_barrier_and_hips_above_it_climb_and_a_step_elsewhere_does_not() -> None:
    place = f"{ROOM}"
    foot = standing(T, (-0.3, 0.0))
    foot[75:, ANKLE, 2] = 0.6
    assert told(events_of(rule("body.climb", place), moments([foot], T)), "phase") == [("new",)]
    far = standing(T, (-2.0, 0.0))
    far[75:, ANKLE, 2] = 0.6
    assert events_of(rule("body.climb", place), moments([far], T)) == NEVER
    over = standing(T, (1.0, 0.0))
    over[75:, :, 2] += 2.0  # the room is 2.5 m high
    assert len(events_of(rule("body.climb", place), moments([over], T))) == 1


def test_arms_above_the_head_ask_for_help_after_two_seconds_and_one_arm_does_not() -> None:
    both = standing(T)
    both[50:150, WRISTS, 2] = 2.0
    events = events_of(rule("body.distress"), moments([both], T))
    assert told(events, "phase") == [("new",), ("end",)]
    assert events[0]["data"]["t_detect_s"] == pytest.approx(4.0, abs=0.1)
    one = standing(T)
    one[50:150, WRISTS[0], 2] = 2.0
    assert events_of(rule("body.distress"), moments([one], T)) == NEVER


@pytest.mark.parametrize(("hertz", "wide_m", "fires"), [(1.0, 0.3, True), (1.0, 0.05, False),
                                                         (0.2, 0.3, False)])  # fmt: skip
def test_a_raised_hand_that_waves_asks_for_help(hertz: float, wide_m: float, fires: bool) -> None:
    body = standing(T)
    body[50:, WRISTS[0], 2] = 1.9
    shoulders = body[:, [COCO17.index("left_shoulder"), COCO17.index("right_shoulder")], :2]
    across = shoulders[:, 0] - shoulders[:, 1]
    across /= np.hypot(*across.T)[:, None]
    middle = shoulders.mean(axis=1)
    wave = wide_m * np.sin(2.0 * np.pi * hertz * T)[:, None]
    body[50:, WRISTS[0], :2] = (middle + across * wave)[50:]
    assert bool(events_of(rule("body.distress"), moments([body], T))) == fires


def test_noise_does_not_wave() -> None:
    rng = np.random.default_rng(0)
    hand: Hand | None = None
    for n, at_m in enumerate(rng.normal(0.0, 0.04, 100).tolist()):
        hand = swung(hand, n / 25, at_m)
        assert hand.turns == 0


def packed(spacing_m: float, t_s: np.ndarray, seed: int = 0) -> list[np.ndarray]:
    """Return people on a grid over the room and around it, who push back and forth or stand."""
    x, y = np.meshgrid(np.arange(-1.0, 5.0, spacing_m), np.arange(-2.0, 2.0, spacing_m))
    return [bodies_on(line((a, b), (0.0, 0.0)), t_s) for a, b in zip(x.flat, y.flat, strict=True)]


def test_people_who_stand_as_dense_as_dangerous_are_told_with_their_density() -> None:
    t_s = times(8.0, 2.0)
    events = events_of(rule("density.critical", ROOM), moments(packed(0.4, t_s), t_s))
    density = events[0]["data"]["measures"]["density_pm2"]
    assert density == pytest.approx(1.0 / 0.4**2, rel=0.05)
    assert events[0]["data"]["severity"] == "alarm"  # above 5 in the mean over 5 s
    few = moments(packed(0.55, t_s), t_s)  # 3.3 people/m2
    assert events_of(rule("density.critical", ROOM), few) == NEVER


def test_pressure_is_that_of_velocities_that_differ_and_a_crowd_that_moves_as_one_has_none() -> (
    None
):
    x, y = np.meshgrid(np.arange(10) * 0.4, np.arange(10) * 0.4)
    xy_m = np.stack([x.ravel(), y.ravel()], axis=1)
    as_one = np.full((100, 2), 0.8)
    assert np.abs(crowd_pressure(xy_m, as_one)[0]).max() < 1e-12
    rng = np.random.default_rng(1)
    pressure, density = crowd_pressure(xy_m, rng.normal(0.0, 0.1, (100, 2)))
    middle = 44
    assert density[middle] == pytest.approx(1.0 / 0.4**2, rel=0.1)
    assert pressure[middle] == pytest.approx(density[middle] * 2.0 * 0.1**2, rel=0.5)


def test_a_packed_crowd_that_pushes_is_told_and_one_that_stands_is_not() -> None:
    t_s = times(6.0, 10.0)
    rng = np.random.default_rng(2)
    standing_still = packed(0.4, t_s)
    pushing = []
    for body in standing_still:
        heading, hertz = rng.uniform(0, 2 * np.pi), rng.uniform(0.2, 0.3)
        shift = 0.25 * np.sin(2 * np.pi * hertz * t_s + rng.uniform(0, 6))
        moved = body.copy()
        moved[..., 0] += (shift * np.cos(heading))[:, None]
        moved[..., 1] += (shift * np.sin(heading))[:, None]
        pushing.append(moved)
    events = events_of(rule("crowd.pressure", ROOM), moments(pushing, t_s))
    assert len(events) >= 1
    assert events[0]["data"]["measures"]["pressure_ps2"] > 0.02
    assert events_of(rule("crowd.pressure", ROOM), moments(standing_still, t_s)) == NEVER


def test_a_way_out_that_clogs_is_told_once_the_crowd_grows_before_it() -> None:
    t_s = times(70.0, 5.0)
    paths = []
    for n in range(40):  # one a second walks through the room, until the way out is blocked at 35 s
        enters_s = 1.0 + 1.3 * n
        leaves_s = enters_s + 5.0
        if leaves_s < 35.0:
            path = through((enters_s, 0.0, 0.0), (leaves_s, 5.0, 0.0))
            paths.append(there(path, enters_s, leaves_s))
        else:
            stops_s = enters_s + 2.0 + 0.1 * n
            at_m = 3.8 - 0.1 * (n - 22)
            path = through((enters_s, 0.0, 0.0), (stops_s, at_m, 0.3 * (n % 5) - 0.6))
            paths.append(there(path, enters_s, 70.0))
    people = walking(*paths, t_s=t_s)
    events = events_of(rule("flow.bottleneck", f"{ROOM}\non_delay_s = 2.0"), people)
    assert len(events) >= 1
    assert 35.0 < events[0]["data"]["t_start_s"] < 60.0
    open_way = [there(through((1 + 1.3 * n, 0, 0), (6 + 1.3 * n, 5, 0)), 1 + 1.3 * n, 6 + 1.3 * n)
                for n in range(48)]  # fmt: skip
    flowing = walking(*open_way, t_s=t_s)
    assert events_of(rule("flow.bottleneck", f"{ROOM}\non_delay_s = 2.0"), flowing) == NEVER


def test_a_few_who_come_in_while_nobody_leaves_are_no_bottleneck() -> None:
    """One leaves a minute before three come in and wait: the flow falls, and nobody is in a way."""
    t_s = times(70.0, 5.0)
    left = there(through((1.0, 0.0, 0.0), (33.0, 1.0, 0.0), (37.0, 5.0, 0.0)), 1.0, 37.0)
    waits = [
        there(through((40.0 + 6.0 * n, 0.0, 0.0), (44.0 + 6.0 * n, 3.0 - n, 0.3 * n)), 40.0, 70.0)
        for n in range(3)
    ]
    people = walking(left, *waits, t_s=t_s)
    assert events_of(rule("flow.bottleneck", f"{ROOM}\non_delay_s = 2.0"), people) == NEVER
    fewer = f"{ROOM}\non_delay_s = 2.0\ndensity_pm2 = 0.01"
    assert told(events_of(rule("flow.bottleneck", fewer), people), "phase")


def begins_to_run(y_m: float, at_s: float) -> Any:
    return through((0, 0, y_m), (at_s, at_s * 1.0, y_m), (8, at_s * 1.0 + 3.5 * (8 - at_s), y_m))


def test_three_who_begin_to_run_together_are_told_and_joggers_and_stragglers_are_not() -> None:
    panic = rule("crowd.panic")
    together = walking(*(begins_to_run(y, 3.0 + 0.5 * y) for y in range(3)))
    events = events_of(panic, together)
    assert told(events, "phase") == [("new",)]
    assert events[0]["data"]["count"] == 3
    joggers = walking(*(line((0, y), (3.5, 0)) for y in range(3)))
    assert events_of(panic, joggers) == NEVER
    apart = walking(*(begins_to_run(y, 0.5 + 2.5 * y) for y in range(3)))
    assert events_of(panic, apart) == NEVER


def test_who_stays_behind_their_companions_is_told_and_strangers_are_not() -> None:
    t_s = times(30.0, 5.0)
    split = rule("group.split", "on_delay_s = 3\ntogether_s = 5")
    goes, stays = line((0, 0), (1.0, 0)), through((0, 0, 1), (10, 10, 1), (30, 10, 1))
    events = events_of(split, walking(goes, stays, t_s=t_s))
    assert {one["data"]["people"][0]["person"] for one in events} == {0, 1}
    assert events[0]["data"]["t_start_s"] == pytest.approx(18.0, abs=0.6)
    stranger = line((20, 5), (-1.0, 0))
    assert events_of(split, walking(goes, stranger, t_s=t_s)) == NEVER
