"""The one state machine of all rules: when a condition becomes an episode, and when that ends.

::

    idle ──> pending ──> active <──> clearing ──> idle
      ^─────────┘

The probability of the condition has hysteresis: it holds from `p_on` on until it falls below
`p_off`. It becomes an episode once it has held for `on_delay_s`, and the episode ends once it has
not held for `off_delay_s`. Nothing but the times of frame sets moves it.

Where a condition cannot be judged, as a person is coasting, everything stays as it is. Somebody who
is lost is unknown, not gone: the state is held for `off_delay_s`, then the episode ends at the time
when the person was last seen, marked as lost.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal, NamedTuple

Phase = Literal["idle", "pending", "active", "clearing"]
Ending = Literal["over", "lost", "disarmed"]

LOOK_BACK_S = 0.5
"""A condition begins when it became more likely than not, if that was at most so long before it
held [s]: somebody who walks over a border is there at p = 0.5, and surely inside a moment later."""
LIKELY = 0.5
_SAME_S = 1e-6  # times of frames are rounded


@dataclass(frozen=True, slots=True)
class Timing:
    """What makes an episode of a condition.

    Attributes
    ----------
    on_delay_s, off_delay_s
        How long it must hold, and must not hold [s].
    cooldown_s
        How long after the end of an episode no other begins [s].
    p_on, p_off
        Probabilities from which on it holds, and below which it does not any more.
    hold_s
        How long it must have held before it counts at all [s].
    gap_s
        Gaps that are bridged before it counts [s].
    escalate_s
        After so long the severity rises [s].
    at_once
        Whether an episode is over as soon as it begins, as a crossing of a line.
    """

    on_delay_s: float
    off_delay_s: float
    cooldown_s: float = 0.0
    p_on: float = 0.9
    p_off: float = 0.5
    hold_s: float = 0.0
    gap_s: float = 0.0
    escalate_s: float = math.inf
    at_once: bool = False


@dataclass(frozen=True, slots=True)
class Finding:
    """What a rule finds out about one person or place at one moment.

    Attributes
    ----------
    probability
        Of the condition.
    measures
        Numbers that say why, with their units in the names.
    since_s, until_s
        When the condition began and when it ended, where the rule knows better than the machine
        [s].
    graver
        Probability of something worse, which counts at once and raises the severity.
    people
        Who has to do with it; of a rule on persons that one person.
    joints
        Which joints have to do with it.
    direction, count
        Of a crossing or an occupancy.
    """

    probability: float
    measures: Mapping[str, float] = field(default_factory=dict)
    since_s: float | None = None
    until_s: float | None = None
    graver: float = 0.0
    people: tuple[int, ...] = ()
    joints: tuple[str, ...] = ()
    direction: str | None = None
    count: int | None = None


NOTHING = Finding(0.0)


class Change(NamedTuple):
    """What a rule tells: an episode begins, gets worse, or ends.

    Attributes
    ----------
    phase
        "new", "update" or "end".
    start_s, end_s
        When the episode began and ended [s].
    since_s
        Since when the condition held, where it counts only after a while [s].
    level
        How much the severity has risen.
    finding
        The last one while the condition held.
    ending
        Why it ended: the condition is over, the person was lost, or the rule was disarmed.
    """

    phase: Literal["new", "update", "end"]
    start_s: float
    end_s: float | None
    since_s: float
    level: int
    finding: Finding
    ending: Ending | None = None


@dataclass(frozen=True, slots=True)
class Episode:
    """The state of one rule with respect to one person or place.

    Attributes
    ----------
    phase
        See the module.
    holds
        Whether the condition holds.
    likely_s
        Since when it is more likely than not [s].
    since_s, off_s
        Since when it holds, or does not hold any more [s].
    known_s
        When it was last found to hold [s].
    level
        How much the severity has risen.
    free_s
        From when on the next episode may begin [s].
    finding
        The last one while it held.
    """

    phase: Phase = "idle"
    holds: bool = False
    likely_s: float | None = None
    since_s: float = math.nan
    off_s: float | None = None
    known_s: float = -math.inf
    level: int = 0
    free_s: float = -math.inf
    finding: Finding = NOTHING

    def is_forgotten(self, t_s: float) -> bool:
        """Tell whether nothing depends on it any more."""
        return self.phase == "idle" and self.likely_s is None and t_s >= self.free_s


IDLE = Episode()


def judged(
    before: Episode, timing: Timing, t_s: float, found: Finding
) -> tuple[Episode, Change | None]:
    """Return the state after a condition was judged, and what is told of it.

    Parameters
    ----------
    before
        The state so far.
    timing
        Of the rule.
    t_s
        Time of the frame set [s].
    found
        What the rule found out.
    """
    holds = found.probability >= timing.p_on or (before.holds and found.probability >= timing.p_off)
    likely_s = None
    if found.probability >= LIKELY:
        likely_s = before.likely_s if before.likely_s is not None else t_s
    if holds:  # `replace` costs several times as much, for each rule and person
        now = Episode(
            before.phase, holds=True, likely_s=likely_s, since_s=before.since_s, off_s=None,
            known_s=t_s, level=before.level, free_s=before.free_s, finding=found,
        )  # fmt: skip
    else:
        off_s = t_s if found.until_s is None else min(found.until_s, t_s)
        off_s = off_s if before.off_s is None else before.off_s
        now = Episode(
            before.phase, holds=False, likely_s=likely_s, since_s=before.since_s, off_s=off_s,
            known_s=before.known_s, level=before.level, free_s=before.free_s,
            finding=before.finding,
        )  # fmt: skip
    if before.phase in ("idle", "pending"):
        return _waited(now, timing, t_s, found)
    return _went_on(now, timing, t_s)


def unjudged(
    before: Episode, timing: Timing, t_s: float, *, lost: bool
) -> tuple[Episode, Change | None]:
    """Return the state after a moment in which nobody could tell, and what is told of it.

    Parameters
    ----------
    before, timing, t_s
        See `judged`.
    lost
        Whether the person is not tracked any more, in place of coasting.
    """
    if before.phase == "idle":
        return replace(before, holds=False, likely_s=None), None
    if before.phase == "clearing":
        return _went_on(before, timing, t_s)
    if not lost or t_s - before.known_s < timing.off_delay_s:
        return before, None
    if before.phase == "pending":
        return replace(IDLE, free_s=before.free_s), None
    return _ended(before, timing, before.known_s, "lost")


def disarmed(before: Episode, timing: Timing, t_s: float) -> tuple[Episode, Change | None]:
    """Return the state after a rule was disarmed, and what is told of it; see `judged`."""
    if before.phase in ("idle", "pending"):
        return replace(IDLE, free_s=before.free_s), None
    if before.phase == "clearing":
        assert before.off_s is not None
        return _ended(before, timing, before.off_s, "over")
    return _ended(before, timing, t_s, "disarmed")


def _waited(
    now: Episode, timing: Timing, t_s: float, found: Finding
) -> tuple[Episode, Change | None]:
    """Go on from idle or pending."""
    if not now.holds:
        assert now.off_s is not None
        if now.phase == "pending" and t_s - now.off_s < timing.gap_s:
            return now, None
        return _rested(now), None
    if now.phase == "idle":
        now = replace(now, phase="pending", since_s=_began(now, t_s, found))
    grave = found.graver >= timing.p_on
    held_s = t_s - now.since_s
    due = timing.at_once or grave or held_s >= timing.hold_s + timing.on_delay_s - _SAME_S
    if not due or t_s < now.free_s:
        return (_rested(now) if timing.at_once else now), None
    start_s = _start_s(now, timing)
    if timing.at_once:
        free_s = start_s + timing.cooldown_s
        return replace(IDLE, free_s=free_s), Change("new", start_s, start_s, start_s, 0, found)
    level = max(int(grave), int(held_s >= timing.escalate_s))
    now = replace(now, phase="active", level=level)
    return now, Change("new", start_s, None, now.since_s, level, found)


def _began(now: Episode, t_s: float, found: Finding) -> float:
    if found.since_s is not None:
        return min(found.since_s, t_s)
    likely_s = now.likely_s if now.likely_s is not None else t_s
    return likely_s if t_s - likely_s <= LOOK_BACK_S else t_s


def _went_on(now: Episode, timing: Timing, t_s: float) -> tuple[Episode, Change | None]:
    """Go on from active or clearing."""
    start_s = _start_s(now, timing)
    if not now.holds:
        assert now.off_s is not None
        if t_s - now.off_s >= timing.off_delay_s - _SAME_S:
            return _ended(now, timing, max(now.off_s, start_s), "over")
        return replace(now, phase="clearing"), None
    grave = now.finding.graver >= timing.p_on
    level = max(now.level, int(grave), int(t_s - now.since_s >= timing.escalate_s - _SAME_S))
    if now.phase == "active" and level == now.level:
        return now, None
    after = replace(now, phase="active", level=level)
    if level > now.level:
        return after, Change("update", start_s, None, now.since_s, level, now.finding)
    return after, None


def _start_s(now: Episode, timing: Timing) -> float:
    return now.since_s + timing.hold_s


def _ended(
    now: Episode, timing: Timing, end_s: float, ending: Ending
) -> tuple[Episode, Change | None]:
    start_s = _start_s(now, timing)
    change = Change(
        "end", start_s, max(end_s, start_s), now.since_s, now.level, now.finding, ending
    )
    return Episode(likely_s=now.likely_s, free_s=end_s + timing.cooldown_s), change


def _rested(now: Episode) -> Episode:
    """Return the state in which the next episode may begin."""
    return Episode(holds=now.holds, likely_s=now.likely_s, free_s=now.free_s)
