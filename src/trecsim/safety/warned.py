"""When a rule warns of what is expected, and when it takes the warning back.

A warning opens the episode before the condition holds. It is given when the probability that the
condition will hold within `early_s` has been `p_on` or more for a moment, and taken back when it
has been below `p_off` for `off_delay_s`. When the condition begins, the episode goes on as any
other.
"""

from dataclasses import dataclass, replace
from typing import Literal

from trecsim.safety.ahead import Expected
from trecsim.safety.machine import Ending, Timing

SURE_S = 0.2
"""One forecast alone warns of nothing: the next one must say the same, so much later [s]."""
_SAME_S = 1e-6


@dataclass(frozen=True, slots=True)
class Warned:
    """The warning of one rule about one person.

    Attributes
    ----------
    since_s
        Since when it is expected [s].
    start_s
        The predicted time that the warning told; None before it was given [s].
    told_s
        When it was given [s].
    known_s
        When it was last found to be expected [s].
    off_s
        Since when it is not expected any more [s].
    expected
        What is expected.
    """

    since_s: float
    known_s: float
    expected: Expected
    start_s: float | None = None
    told_s: float = 0.0
    off_s: float | None = None


Told = Literal["given"] | Ending | None
"""A warning is given, or taken back and why."""


def foreseen(
    before: Warned | None, timing: Timing, t_s: float, expected: Expected | None
) -> tuple[Warned | None, Told]:
    """Return the warning after a look ahead, and what is told.

    Parameters
    ----------
    before
        The warning so far.
    timing
        Of the rule.
    t_s
        Time of the frame set [s].
    expected
        What is expected of the person; None if nothing.
    """
    probability = 0.0 if expected is None else expected.probability
    if before is None or before.start_s is None:
        if expected is None or probability < timing.p_on:
            return None, None
        now = before or Warned(t_s, t_s, expected)
        now = replace(now, known_s=t_s, expected=expected)
        if t_s - now.since_s < SURE_S - _SAME_S:
            return now, None
        return replace(now, start_s=expected.at_s, told_s=t_s), "given"
    if expected is not None and probability >= timing.p_off:
        return replace(before, known_s=t_s, expected=expected, off_s=None), None
    off_s = before.off_s if before.off_s is not None else t_s
    if t_s - off_s >= timing.off_delay_s - _SAME_S:
        return None, "over"
    return replace(before, off_s=off_s), None


def unforeseen(
    before: Warned, timing: Timing, t_s: float, *, lost: bool
) -> tuple[Warned | None, Told]:
    """Return the warning after a moment in which the person was not seen; see `foreseen`.

    Parameters
    ----------
    before, timing, t_s
        See `foreseen`.
    lost
        Whether the person is not tracked any more, in place of coasting.
    """
    if before.start_s is None:
        return None, None
    if lost and t_s - before.known_s >= timing.off_delay_s:
        return None, "lost"
    return before, None
