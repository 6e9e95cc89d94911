"""From moments in which something holds to episodes with a beginning and an end."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float64

SAME_S = 1e-6
"""Times of frames are rounded [s]."""


class Delays(NamedTuple):
    """How long something must hold before it counts, and not hold before it is over [s].

    Attributes
    ----------
    on_s, off_s
        The delays of the rule.
    gap_s
        Gaps that are bridged before it counts.
    hold_s
        How long it must have held before it begins.
    """

    on_s: float
    off_s: float
    gap_s: float = 0.0
    hold_s: float = 0.0


class Span(NamedTuple):
    """An episode: when it began, when it could be told at the earliest, and when it ended [s]."""

    start_s: float
    told_s: float
    end_s: float | None


Times = Float64[np.ndarray, " time"]
Flags = Bool[np.ndarray, " time"]


def spans(
    t_s: Times,
    holds: Flags,
    there: Flags,
    delays: Delays,
    *,
    since_s: Times | None = None,
    until_s: Times | None = None,
    at_once: Flags | None = None,
) -> list[Span]:
    """Return the episodes of one condition.

    Parameters
    ----------
    t_s
        The moments [s].
    holds
        When the condition holds.
    there
        When it can be judged; where it cannot, it is neither true nor false.
    delays
        Of the rule.
    since_s, until_s
        When it began, of each moment in which it holds, and when it ended, of each in which it
        does not, where that is not the moment itself [s].
    at_once
        When no delay counts.

    Examples
    --------
    >>> holds, there = np.array([0, 1, 1, 1, 0, 0], bool), np.ones(6, bool)
    >>> spans(np.arange(6.0), holds, there, Delays(2.0, 1.0))
    [Span(start_s=1.0, told_s=3.0, end_s=4.0)]
    """
    found: list[Span] = []
    begin: float | None = None
    told: float | None = None
    off: float | None = None
    last = 0.0
    for n, now in enumerate(t_s.tolist()):
        if holds[n]:
            if begin is None:
                begin = now if since_s is None else min(float(since_s[n]), now)
            off, last = None, now
            is_due = now - begin >= delays.on_s + delays.hold_s - SAME_S
            if told is None and (is_due or (at_once is not None and at_once[n])):
                told = now
            continue
        if begin is None:
            continue
        if there[n] and off is None:
            off = now if until_s is None else min(float(until_s[n]), now)
        gone = last if off is None else off
        patience_s = delays.off_s if told is not None or not there[n] else delays.gap_s
        if now - gone < patience_s - SAME_S:
            continue
        if told is not None:
            start = begin + delays.hold_s
            found.append(Span(start, told, max(gone, start)))
        begin = told = off = None
    if begin is not None and told is not None:
        found.append(Span(begin + delays.hold_s, told, None))
    return found
