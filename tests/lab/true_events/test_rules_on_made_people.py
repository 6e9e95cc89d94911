"""On made people, in what happens and in what nearly does, rules tell what the naive reading says.

Here stand the kinds of which the built-in scenes have too little: both must tell the same
episodes, begun and ended within one frame, and neither must tell a near miss.
"""

from collections.abc import Sequence

import numpy as np
import pytest

from made_paths import PLACES, bodies_on, line, there, through, times
from made_truths import agreed, bodies_at, both, rule
from trecsim.skeleton import COCO17

HEAD = PLACES.partition("[zones")[0]
WRISTS = [COCO17.index(f"{side}_wrist") for side in ("left", "right")]
ANKLES = [COCO17.index(f"{side}_ankle") for side in ("left", "right")]
T = times(11.0)


def standing(at_m: tuple[float, float], t_s: np.ndarray = T) -> np.ndarray:
    return bodies_on(line(at_m, (0.0, 0.0)), t_s)


def lifting(to_m: float, at_m: tuple[float, float]) -> np.ndarray:
    """Return somebody who lifts one ankle from 2 s on by 0.5 m/s, and puts it down from 6 s on."""
    body = standing(at_m)
    up_m = np.minimum(0.5 * (T - 2.0), to_m - 0.08)
    body[:, ANKLES[0], 2] += np.clip(np.minimum(up_m, 0.5 * (7.0 - T)), 0.0, None)
    return body


def test_a_foot_that_is_raised_high_enough_near_enough_to_the_barrier_climbs() -> None:
    climb = rule("body.climb")
    (told,) = agreed(climb, [lifting(0.6, (-0.3, 0.0))], T)
    assert told.start_s == pytest.approx(2.7, abs=0.05)  # the foot is 0.35 m high
    assert told.end_s == pytest.approx(6.3, abs=0.05)
    assert agreed(climb, [lifting(0.42, (-0.3, 0.0))], T) == []  # the foot is 0.34 m high
    assert len(agreed(climb, [lifting(0.6, (-0.48, 0.0))], T)) == 1
    assert agreed(climb, [lifting(0.6, (-0.52, 0.0))], T) == []


def test_hips_over_the_barrier_climb_where_they_are_above_its_top() -> None:
    walks = bodies_on(line((-3.0, 0.0), (1.0, 0.0)), T)  # hips at 0.9 m
    low, high = (
        f"{HEAD}[zones.room]\npolygon_m = [[0.0, -1.0], [2.0, -1.0], [2.0, 1.0], [0.0, 1.0]]\n"
        f"z_m = [0.0, {top_m}]\n"
        for top_m in (0.88, 0.92)
    )
    (told,) = agreed(rule("body.climb"), [walks], T, low)
    assert (told.start_s, told.end_s) == pytest.approx((3.0, 5.0), abs=0.05)
    assert agreed(rule("body.climb"), [walks], T, high) == []


def between(from_s: float, until_s: float) -> np.ndarray:
    """Tell which moments are in a time; frames on its borders go to what follows."""
    into_s = T + 1e-6
    return (into_s > from_s) & (into_s < until_s)


def raising(wrists: Sequence[int], to_m: float, until_s: float) -> np.ndarray:
    """Return somebody who holds wrists up from 2 s on."""
    body = standing((1.0, 0.0))
    up = between(2.0, until_s)
    for wrist in wrists:
        body[up, wrist, 2] = to_m
    return body


def test_both_hands_above_the_head_for_long_enough_ask_for_help() -> None:
    distress = rule("body.distress")
    (told,) = agreed(distress, [raising(WRISTS, 1.73, 5.0)], T)  # the head is at 1.612 m
    assert (told.start_s, told.end_s) == pytest.approx((2.0, 5.0), abs=0.05)
    assert agreed(distress, [raising(WRISTS, 1.70, 5.0)], T) == []
    assert agreed(distress, [raising(WRISTS, 1.73, 3.9)], T) == []
    assert agreed(distress, [raising(WRISTS[:1], 1.9, 5.0)], T) == []
    outside = raising(WRISTS, 1.73, 5.0)
    outside[..., 0] -= 2.0
    assert agreed(distress, [outside], T) == []


def waving(
    hertz: float, *, wide_m: float = 0.2, from_s: float = 2.0, until_s: float = 8.0,
    height_m: float = 1.5, wrist: int = WRISTS[0],
) -> np.ndarray:  # fmt: skip
    """Return somebody who has a wrist above the shoulders (1.4 m) and moves it back and forth."""
    body = standing((1.0, 0.0))
    up = between(from_s, until_s)
    to_m = 0.3 + wide_m * np.sin(2.0 * np.pi * hertz * (T - from_s) - 0.3)
    body[up, wrist, 1] = to_m[up]
    body[up, wrist, 2] = height_m
    return body


@pytest.mark.parametrize("hertz", [0.55, 0.7, 1.0, 2.0, 2.8])
def test_a_hand_that_waves_asks_for_help_from_its_first_turn_to_its_last(hertz: float) -> None:
    (told,) = agreed(rule("body.distress"), [waving(hertz)], T)
    first_s = 2.0 + (0.25 + 0.3 / (2.0 * np.pi)) / hertz  # where the sine is at its top
    assert told.start_s == pytest.approx(first_s, abs=0.05)
    assert told.end_s is not None
    assert 8.0 - 1.0 / hertz < told.end_s <= 8.0


def test_who_waves_and_then_holds_up_both_hands_asks_once_until_these_are_down() -> None:
    body = waving(1.0, until_s=6.5)
    body[between(6.0, 8.0)[:, None] & np.isin(np.arange(17), WRISTS), 2] = 1.9
    (told,) = agreed(rule("body.distress"), [body], T)
    assert (told.start_s, told.end_s) == pytest.approx((2.3, 8.0), abs=0.05)


def test_who_leaves_the_zone_while_waving_asks_until_then() -> None:
    body = waving(1.0, until_s=10.5)
    body[..., 0] += np.interp(T, [6.0, 7.0], [0.0, -2.0])[:, None]  # at the border at 6.5 s
    (told,) = agreed(rule("body.distress"), [body], T)
    assert told.end_s == pytest.approx(6.5, abs=0.05)


def test_a_hand_that_waves_at_the_end_of_a_recording_may_wave_on() -> None:
    (told,) = agreed(rule("body.distress"), [waving(1.0, until_s=10.2)], T)
    assert told.end_s is None


@pytest.mark.parametrize(
    "body",
    [
        waving(0.45),
        waving(3.4),
        waving(1.0, wide_m=0.12),
        waving(1.0, height_m=1.38),
        waving(1.0, until_s=5.2),  # from the first turn to the last less than 3 s
        raising(WRISTS[:1], 1.6, 8.0),
    ],
    ids=["slow", "fast", "narrow", "low", "short", "still"],
)
def test_a_hand_that_nearly_waves_does_not_ask_for_help(body: np.ndarray) -> None:
    assert agreed(rule("body.distress"), [body], T) == []


def test_two_raised_hands_that_are_still_do_not_wave_however_their_heights_change() -> None:
    body = raising(WRISTS, 1.5, 11.0)
    body[:, WRISTS[0], 2] += 0.02 * np.sin(2.0 * np.pi * T)  # now one is the higher, now the other
    assert agreed(rule("body.distress"), [body], T) == []


def test_a_hand_that_is_down_for_a_moment_waves_on_and_one_that_rests_begins_anew() -> None:
    distress, body = rule("body.distress"), waving(1.0)
    body[between(4.0, 4.4), WRISTS[0], 2] = 1.0
    (told,) = agreed(distress, [body], T)
    assert told.start_s < 2.5
    body[between(4.0, 5.5), WRISTS[0], 2] = 1.0
    assert agreed(distress, [body], T) == []


def crowd(spacing_m: np.ndarray, t_s: np.ndarray) -> list[np.ndarray]:
    """Return people about a grid over the room and around it, of a width that may change [m]."""
    rng = np.random.default_rng(5)
    places = [
        (x + rng.uniform(-0.2, 0.2), y + rng.uniform(-0.2, 0.2))
        for x in np.arange(-3.5, 4.0)
        for y in np.arange(-3.5, 4.0)
    ]
    paths_m = [np.stack([2.0 + x * spacing_m, y * spacing_m], axis=1) for x, y in places]
    return [bodies_at(path_m, t_s) for path_m in paths_m]


def width(t_s: np.ndarray, *points: tuple[float, float]) -> np.ndarray:
    """Return a width that changes from time to time [s, m]."""
    at_s, at_m = np.array(points).T
    return np.asarray(np.interp(t_s, at_s, at_m))


SMALL = f"{HEAD}[zones.room]\npolygon_m = [[1.0, -1.0], [3.0, -1.0], [3.0, 1.0], [1.0, 1.0]]\n"
CROWD_S = times(14.0, 10.0)


def test_people_who_stand_too_dense_for_long_enough_are_in_danger() -> None:
    critical = rule("density.critical")
    closes = crowd(width(CROWD_S, (2, 0.6), (4, 0.48), (11, 0.48), (12, 0.6)), CROWD_S)
    (told,) = agreed(critical, closes, CROWD_S, SMALL)
    assert told.start_s == pytest.approx(3.7, abs=0.4)  # 0.5 m: 4 people/m2
    assert told.end_s == pytest.approx(11.2, abs=0.4)
    nearly = crowd(width(CROWD_S, (2, 0.6), (4, 0.515), (11, 0.515), (12, 0.6)), CROWD_S)
    assert agreed(critical, nearly, CROWD_S, SMALL) == []
    shortly = crowd(width(CROWD_S, (2, 0.6), (4, 0.48), (8, 0.48), (9, 0.6)), CROWD_S)
    assert agreed(critical, shortly, CROWD_S, SMALL) == []


def test_a_density_that_is_worse_in_the_mean_over_5_s_counts_at_once() -> None:
    late = rule("density.critical", 'zone = "room"\non_delay_s = 8')
    for dense_m, after_s in ((0.43, 4.8), (0.46, 8.0)):  # 5.4 and 4.7 people/m2
        told, true = both(late, crowd(np.full(len(CROWD_S), dense_m), CROWD_S), CROWD_S, SMALL)
        assert [one.detect_s for one in told] == pytest.approx([after_s], abs=0.11)
        assert [one.detect_s for one in true] == pytest.approx([after_s], abs=0.11)


def pushing(people: list[np.ndarray], share: np.ndarray, seed: int = 3) -> list[np.ndarray]:
    """Return people who are pushed about, each another way, by 0.25 m times a share."""
    rng, pushed = np.random.default_rng(seed), []
    for body in people:
        way, hertz, phase = rng.uniform(0, 2 * np.pi), rng.uniform(0.2, 0.3), rng.uniform(0, 6)
        by_m = 0.25 * share * np.sin(2 * np.pi * hertz * CROWD_S + phase)
        shift_m = by_m[:, None] * [np.cos(way), np.sin(way)]
        moved = body.copy()
        moved[..., :2] += shift_m[:, None]
        pushed.append(moved)
    return pushed


def test_a_packed_crowd_that_pushes_is_told_and_one_that_nearly_does_is_not() -> None:
    pressure = rule("crowd.pressure")
    packed, loose = (crowd(np.full(len(CROWD_S), m), CROWD_S) for m in (0.4, 0.55))
    grows = width(CROWD_S, (0, 0.0), (3, 0.0), (5, 1.0), (10, 1.0), (11, 0.0))
    (told,) = agreed(pressure, pushing(packed, 0.35 * grows), CROWD_S, SMALL)
    assert 3.0 < told.start_s < 5.5
    assert told.end_s is not None
    assert 10.0 < told.end_s < 12.5
    assert agreed(pressure, pushing(packed, 0.2 * grows), CROWD_S, SMALL) == []
    assert agreed(pressure, pushing(loose, grows), CROWD_S, SMALL) == []
    as_one = packed + np.stack([0.8 * CROWD_S, 0.0 * CROWD_S, 0.0 * CROWD_S], axis=1)[:, None]
    assert agreed(pressure, list(as_one), CROWD_S, SMALL) == []


QUEUE_S = times(80.0, 5.0)


def queue(every_s: float) -> list[np.ndarray]:
    """Return people who pass through the room; from 35 s to 60 s one every so often [s]."""
    people, free_s = [], 0.0
    for n in range(55):
        enters_s, y_m = 1.0 + 1.3 * n, 0.3 * (2 * n % 5 - 2)
        waits_m = 3.7 - 0.15 * (n % 7)
        leaves_s = max(enters_s + 4.0, free_s)
        free_s = leaves_s + (every_s if 35.0 < leaves_s < 60.0 else 0.5)
        way = through(
            (enters_s, 0.05, y_m), (enters_s + 4.0, waits_m, y_m), (leaves_s, waits_m, y_m),
            (leaves_s + 1.0, 5.0, y_m),
        )  # fmt: skip
        people.append(bodies_on(there(way, enters_s, leaves_s + 1.0), QUEUE_S))
    return people


def test_a_way_out_that_clogs_is_told_and_one_that_is_only_slower_is_not() -> None:
    clogs = rule("flow.bottleneck")
    (told,) = agreed(clogs, queue(6.0), QUEUE_S)
    assert 38.0 < told.start_s < 50.0
    assert told.end_s is not None
    assert 60.0 < told.end_s < 66.0
    assert agreed(clogs, queue(1.8), QUEUE_S) == []


def test_a_crowd_that_stands_still_does_not_fill_a_zone() -> None:
    """Means of equal densities differ by rounding, and nobody leaves."""
    t_s = times(70.0, 5.0)
    leaves = [
        bodies_on(there(line((1.0 - n, 0.9), (1.0, 0.0)), 0.0, 4.0 + n), t_s) for n in range(20)
    ]
    stand = [standing((0.5 + 0.37 * n, -0.4), t_s) for n in range(8)]
    assert (
        agreed(rule("flow.bottleneck", 'zone = "room"\non_delay_s = 0.2'), leaves + stand, t_s)
        == []
    )
