"""The state machine of the rules, with probabilities given by hand."""

from collections.abc import Sequence
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from trecsim.safety.machine import (
    IDLE,
    Change,
    Episode,
    Finding,
    Timing,
    disarmed,
    judged,
    unjudged,
)

STEP_S = 0.1
COASTS, LOST = "coasts", "lost"
PLAIN = Timing(on_delay_s=0.2, off_delay_s=0.5)


def run(timing: Timing, seen: Sequence[Any], before: Episode = IDLE) -> list[tuple[float, Change]]:
    """Judge one condition at every tenth of a second; return what is told, and when."""
    told, state = [], before
    for n, one in enumerate(seen):
        t_s = round(n * STEP_S, 3)
        if one in (COASTS, LOST):
            state, change = unjudged(state, timing, t_s, lost=one == LOST)
        else:
            found = one if isinstance(one, Finding) else Finding(one)
            state, change = judged(state, timing, t_s, found)
        if change is not None:
            told.append((t_s, change))
    return told


def phases(told: list[tuple[float, Change]]) -> list[tuple[float, str]]:
    return [(t_s, change.phase) for t_s, change in told]


def test_an_episode_begins_after_the_delay_and_counts_from_when_the_condition_began() -> None:
    ((t_s, change),) = run(PLAIN, [0.0, 0.95, 0.95, 0.95, 0.95])
    assert (t_s, change.phase, change.start_s, change.end_s) == (0.3, "new", 0.1, None)


def test_what_does_not_last_is_no_episode() -> None:
    assert run(PLAIN, [0.0, 0.95, 0.95, 0.1, 0.95, 0.95, 0.1] * 3) == []


def test_it_holds_from_p_on_until_it_falls_below_p_off() -> None:
    assert run(PLAIN, [0.85] * 20) == []
    told = run(PLAIN, [0.95, *[0.6] * 10, *[0.4] * 10])
    assert phases(told) == [(0.2, "new"), (1.6, "end")]
    assert told[1][1].end_s == 1.1


def test_a_gap_shorter_than_the_off_delay_is_bridged() -> None:
    assert phases(run(PLAIN, [*[1.0] * 5, *[0.0] * 4, *[1.0] * 5, *[0.0] * 4])) == [(0.2, "new")]


def test_it_began_when_it_became_likely_but_not_long_before_it_was_sure() -> None:
    crossing = run(PLAIN, [0.1, 0.5, 0.7, 0.95, 1.0, 1.0])
    assert crossing[0][1].start_s == 0.1
    on_the_border = run(PLAIN, [*[0.6] * 20, *[1.0] * 5])
    assert on_the_border[0][1].start_s == 2.0


def test_who_coasts_keeps_the_state_and_who_is_lost_keeps_it_for_the_off_delay() -> None:
    assert phases(run(PLAIN, [*[1.0] * 5, *[COASTS] * 50])) == [(0.2, "new")]
    told = run(PLAIN, [*[1.0] * 5, *[LOST] * 10])
    assert phases(told) == [(0.2, "new"), (0.9, "end")]
    assert (told[1][1].end_s, told[1][1].ending) == (0.4, "lost")


def test_nothing_begins_while_nobody_can_tell() -> None:
    assert run(PLAIN, [1.0, *[COASTS] * 20]) == []
    assert run(PLAIN, [1.0, *[LOST] * 20, *[0.0] * 5]) == []
    assert phases(run(PLAIN, [1.0, *[COASTS] * 5, 1.0])) == [(0.6, "new")]


def test_after_an_episode_the_next_one_waits_for_the_cooldown() -> None:
    timing = Timing(0.0, 0.0, cooldown_s=1.0)
    told = run(timing, [1.0, 0.0, *[1.0] * 20])
    assert phases(told) == [(0.0, "new"), (0.1, "end"), (1.1, "new")]
    assert told[2][1].start_s == 0.2


def test_a_time_that_must_have_passed_comes_before_the_start_and_bridges_gaps() -> None:
    dwell = Timing(0.0, 2.0, hold_s=1.0, gap_s=2.0, escalate_s=3.0)
    told = run(dwell, [*[1.0] * 5, *[0.0] * 10, *[1.0] * 25])
    assert phases(told) == [(1.5, "new"), (3.0, "update")]
    assert (told[0][1].start_s, told[0][1].since_s) == (1.0, 0.0)
    assert [change.level for _, change in told] == [0, 1]


def test_something_graver_counts_at_once_and_raises_an_episode_that_is_open() -> None:
    near, beyond = Finding(1.0), Finding(1.0, graver=0.95)
    slow = Timing(2.0, 0.5)
    ((t_s, change),) = run(slow, [near, near, beyond])
    assert (t_s, change.phase, change.level, change.start_s) == (0.2, "new", 1, 0.0)
    told = run(PLAIN, [near, near, near, near, beyond, near, beyond])
    assert [(one.phase, one.level) for _, one in told] == [("new", 0), ("update", 1)]


def test_a_crossing_is_over_at_once_and_a_cooldown_leaves_out_the_next() -> None:
    crossing = Finding(1.0, since_s=0.05)
    momentary = Timing(0.0, 0.5, at_once=True)
    told = run(momentary, [0.0, crossing, 0.0, Finding(1.0, since_s=0.25)])
    assert [(one.start_s, one.end_s) for _, one in told] == [(0.05, 0.05), (0.25, 0.25)]
    cooled = Timing(0.0, 0.5, cooldown_s=1.0, at_once=True)
    assert len(run(cooled, [0.0, crossing, 0.0, Finding(1.0, since_s=0.25), *[0.0] * 20])) == 1


@pytest.mark.parametrize(
    ("seen", "end_s", "ending"),
    [([1.0, 1.0, 1.0, 1.0], 5.0, "disarmed"), ([1.0, 1.0, 1.0, 0.0], 0.3, "over")],
)
def test_disarming_ends_what_is_open(seen: list[float], end_s: float, ending: str) -> None:
    state = IDLE
    for n, one in enumerate(seen):
        state, _ = judged(state, PLAIN, n * STEP_S, Finding(one))
    state, change = disarmed(state, PLAIN, 5.0)
    assert change is not None
    assert (change.phase, pytest.approx(change.end_s), change.ending) == ("end", end_s, ending)
    assert disarmed(state, PLAIN, 6.0)[1] is None


@given(
    st.lists(st.sampled_from([0.0, 0.55, 0.95, COASTS, LOST]), max_size=60),
    st.floats(0.0, 1.0),
    st.floats(0.0, 1.0),
    st.floats(0.0, 2.0),
)
def test_episodes_never_overlap_and_each_ends_after_it_began(
    seen: list[Any], on_delay_s: float, off_delay_s: float, cooldown_s: float
) -> None:
    told = run(Timing(on_delay_s, off_delay_s, cooldown_s), seen)
    assert [one.phase for _, one in told] == (["new", "end"] * len(told))[: len(told)]
    for t_s, one in told:
        assert one.start_s <= t_s
        assert one.end_s is None or one.start_s <= one.end_s <= t_s
    ends = [one.end_s for _, one in told if one.end_s is not None]
    news = [t_s for t_s, one in told if one.phase == "new"]
    assert all(new_s >= end_s + cooldown_s for end_s, new_s in zip(ends, news[1:], strict=False))
