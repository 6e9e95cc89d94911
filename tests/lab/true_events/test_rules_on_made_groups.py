"""On made people who run together or part, rules tell what the naive reading says."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from made_paths import bodies_on, line, there, through, times
from made_truths import agreed, bodies_at, rule

T = times(11.0)
PANIC = rule("crowd.panic", "")


def runner(
    from_s: float, y_m: float, *, for_s: float = 3.0, mps: float = 3.5, x_m: float = 0.0
) -> np.ndarray:
    """Return somebody who walks at 1 m/s, runs for a while, and walks on."""
    till_s = from_s + for_s
    far_m = x_m + from_s + mps * for_s
    path = through(
        (0.0, x_m, y_m), (from_s, x_m + from_s, y_m), (till_s, far_m, y_m),
        (20.0, far_m + 20.0 - till_s, y_m),
    )  # fmt: skip
    return bodies_on(path, T)


def walkers(number: int) -> list[np.ndarray]:
    return [bodies_on(line((-20.0, 2.0 * n), (1.0, 0.0)), T) for n in range(number)]


def test_the_third_who_begins_to_run_makes_a_panic_and_the_first_who_stops_ends_it() -> None:
    (told,) = agreed(PANIC, [runner(3.0, 0), runner(4.0, 2), runner(4.9, 4)], T)
    assert (told.start_s, told.end_s) == pytest.approx((4.9, 6.0), abs=0.05)
    (told,) = agreed(PANIC, [runner(3.0 + 0.4 * n, 2.0 * n) for n in range(5)], T)
    assert (told.start_s, told.end_s) == pytest.approx((3.8, 6.8), abs=0.05)


def fast(speed_mps: np.ndarray, y_m: float) -> np.ndarray:
    """Return somebody who goes along x with a speed at each time [m/s]."""
    x_m = np.concatenate([[0.0], np.cumsum(speed_mps)[:-1] * 0.04])
    return bodies_at(np.stack([x_m, np.full(len(x_m), y_m)], axis=1), T)


def test_who_gets_faster_little_by_little_runs_from_the_limit_on() -> None:
    speed_mps = np.interp(T, [3.0, 5.0, 8.0], [1.0, 3.4, 3.4])
    (told,) = agreed(PANIC, [fast(speed_mps, y_m) for y_m in range(3)], T)
    assert told.start_s == pytest.approx(4.0, abs=0.1)  # 2.2 m/s


def test_of_two_who_are_noticed_at_once_the_first_who_began_is_enough() -> None:
    """Who stops short twice is noticed as late as who begins 0.16 s later."""
    halting, even = (np.where(from_s - 1e-6 < T, 3.5, 1.0) for from_s in (4.0, 4.16))
    halting[[108, 114]] = 0.0
    people = [runner(3.0, 0), runner(3.2, 2), fast(halting, 4), fast(even, 6)]
    (told,) = agreed(PANIC, people, T)
    assert told.start_s == pytest.approx(4.0, abs=0.05)


def test_when_others_leave_those_who_run_are_enough_from_then_on() -> None:
    run = [runner(3.0 + 0.2 * n, 2.0 * n, for_s=5.0) for n in range(3)]
    gone = bodies_on(there(line((-20.0, -2.0), (1.0, 0.0)), 0.0, 6.0), T)
    (told,) = agreed(PANIC, [*run, *walkers(7), gone], T)
    assert (told.start_s, told.end_s) == pytest.approx((6.0, 8.0), abs=0.05)


@pytest.mark.parametrize(
    "people",
    [
        [runner(3.0, 0), runner(4.2, 2), runner(5.2, 4)],
        [runner(3.0, 0), runner(3.5, 2)],
        [runner(3.0, 0), runner(3.4, 2), runner(3.8, 4, mps=2.1)],
        [runner(3.0, 0), runner(3.4, 2), bodies_on(there(line((0, 4), (3.5, 0)), 2.6, 11.0), T)],
        [*(runner(3.0, 2.0 * n) for n in range(3)), *walkers(8)],
        [runner(3.0, 2.0 * n, for_s=0.45) for n in range(3)],
    ],
    ids=["apart", "two", "slow", "ran already", "few of all", "short"],
)
def test_who_nearly_begin_to_run_together_make_no_panic(people: Sequence[np.ndarray]) -> None:
    assert agreed(PANIC, people, T) == []


def test_three_of_ten_are_enough() -> None:
    (told,) = agreed(PANIC, [*(runner(3.0, 2.0 * n) for n in range(3)), *walkers(7)], T)
    assert told.start_s == pytest.approx(3.0, abs=0.05)


def test_in_a_zone_only_who_begins_there_counts() -> None:
    zone = rule("crowd.panic", 'zone = "room"\non_delay_s = 0.3')  # x from 0 to 4 m
    there_m = [runner(3.0, y, x_m=-2.5) for y in (-0.5, 0.0, 0.5)]  # at 0.5 m
    (told,) = agreed(zone, there_m, T)
    assert (told.start_s, told.end_s) == pytest.approx((3.0, 4.0), abs=0.05)
    outside = runner(3.0, 0.5, x_m=-3.5)  # at -0.5 m
    assert agreed(zone, [*there_m[:2], outside], T) == []


SPLIT = rule("group.split", "")
SPLIT_S = times(60.0, 5.0)


def on(*paths: Any) -> list[np.ndarray]:
    return [bodies_on(path, SPLIT_S) for path in paths]


def walks(y_m: float, from_s: float, until_s: float) -> Any:
    """Return a path at 1 m/s from somebody's first step to the last, along x, with stops around."""
    return through(
        (0, 0, y_m), (from_s, 0, y_m), (until_s, until_s - from_s, y_m), (60, until_s - from_s, y_m)
    )


def test_who_stays_behind_is_told_and_so_is_who_went_on_alone() -> None:
    told = agreed(SPLIT, on(walks(0.0, 0.0, 60.0), walks(1.0, 0.0, 12.0)), SPLIT_S)
    assert [one.start_s for one in told] == pytest.approx([20.0, 20.0], abs=0.25)
    assert [one.detect_s for one in told] == pytest.approx([35.0, 35.0], abs=0.45)


def test_ways_that_are_walked_together_count_in_all() -> None:
    pauses = through((0, 0, 0), (6, 6, 0), (16, 6, 0), (22, 12, 0), (60, 50, 0))
    stays = through((0, 0, 1), (6, 6, 1), (16, 6, 1), (22, 12, 1), (60, 12, 1))
    assert len(agreed(SPLIT, on(pauses, stays), SPLIT_S)) == 2


def test_who_comes_back_is_not_alone_any_more() -> None:
    comes = through((0, 0, 0), (30, 30, 0), (40, 40, 0), (60, 14, 0))
    told = agreed(rule("group.split", "on_delay_s = 5"), on(comes, walks(1.0, 0.0, 12.0)), SPLIT_S)
    assert [one.end_s for one in told] == pytest.approx([55.4, 55.4], abs=0.3)


@pytest.mark.parametrize(
    "people",
    [
        on(walks(0.0, 0.0, 60.0), walks(1.0, 0.0, 9.2)),
        on(walks(0.0, 0.0, 19.8), walks(1.0, 0.0, 12.0)),
        on(walks(0.0, 20.0, 60.0), line((0.0, 1.0), (0.0, 0.0))),
        on(walks(0.0, 0.0, 60.0), walks(1.6, 0.0, 12.0)),
        on(walks(0.0, 0.0, 60.0), there(walks(1.0, 0.0, 12.0), 0.0, 21.0)),
        on(line((0, 0), (1.3, 0)), through((0, 0.5, 1), (12, 10.5, 1), (60, 10.5, 1))),
    ],
    ids=["short", "near", "stood", "beside", "gone", "overtaken"],
)
def test_who_nearly_belonged_together_or_nearly_part_are_not_told(
    people: Sequence[np.ndarray],
) -> None:
    assert agreed(SPLIT, people, SPLIT_S) == []


def test_who_has_one_of_the_others_near_is_not_alone() -> None:
    told = agreed(
        SPLIT, on(walks(0.0, 0.0, 60.0), walks(0.7, 0.0, 60.0), walks(1.4, 0.0, 12.0)), SPLIT_S
    )
    assert [one.floor_m for one in told] == [pytest.approx((12.0, 1.4))]
