"""How a raised hand goes back and forth, and whether it waves.

A hand turns where it has come from at least `WAVE_M` away and goes back as far. It waves while each
turn follows the one before within `SLOWEST_S`.
"""

import math
from typing import NamedTuple

WAVE_M = 0.25
"""A hand that waves goes at least so far each way [m]."""
WAVED_S = 3.0
"""From its first turn to its last a hand must have waved for so long [s]."""
SLOWEST_S = 1.0
"""From one turn to the next, half a wave, there is no more time: slower is a gesture [s]."""
MOST_HZ = 3.0
"""A hand waves no more often: faster is noise [Hz]."""
_SAME_S = 1e-6  # times of frames are rounded


class Hand(NamedTuple):
    """How one hand has gone back and forth.

    Attributes
    ----------
    seen_s
        When it was raised last [s].
    low, high
        When and where it was farthest to one side and to the other, since it turned [s, m].
    way
        Towards which side it goes: 1, -1, or 0 where that is not known yet.
    turns
        How often it has turned in time.
    begun_s, turned_s
        When it turned first, and last [s].
    """

    seen_s: float
    low: tuple[float, float]
    high: tuple[float, float]
    way: int = 0
    turns: int = 0
    begun_s: float = math.nan
    turned_s: float = math.nan

    def waves(self, t_s: float) -> bool:
        """Tell whether it has waved for long enough, up to less than a slow wave ago."""
        if not self.turned_s - self.begun_s >= WAVED_S - _SAME_S or self.hertz > MOST_HZ:
            return False
        return not self.is_forgotten(t_s, self.turned_s)

    @staticmethod
    def is_forgotten(t_s: float, last_s: float) -> bool:
        """Tell whether a time is longer ago than a slow wave takes."""
        return t_s - last_s > 2.0 * SLOWEST_S + _SAME_S

    @property
    def hertz(self) -> float:
        """How often a second it waves [Hz]; 0 before the second turn."""
        return 0.5 * (self.turns - 1) / (self.turned_s - self.begun_s) if self.turns > 1 else 0.0


def swung(before: Hand | None, t_s: float, at_m: float) -> Hand:
    """Return a hand after one more moment.

    Parameters
    ----------
    before
        The hand so far; None for one that has just been raised.
    t_s, at_m
        The moment [s], and how far to one side the hand is then [m].

    Examples
    --------
    >>> hand = None
    >>> for k in range(101):
    ...     hand = swung(hand, k / 20, 0.3 * math.sin(2 * math.pi * k / 20))
    >>> hand.begun_s, hand.turned_s, hand.hertz, hand.waves(5.0)
    (0.25, 4.75, 1.0, True)
    """
    here = t_s, at_m
    if before is None or t_s - before.seen_s > SLOWEST_S + _SAME_S:
        return Hand(t_s, here, here)
    low = here if at_m < before.low[1] else before.low
    high = here if at_m > before.high[1] else before.high
    now = before._replace(seen_s=t_s, low=low, high=high)
    if before.way <= 0 and at_m - low[1] >= WAVE_M:
        turned = _turned(now, low[0]) if before.way < 0 else now
        return turned._replace(way=1, high=here)
    if before.way >= 0 and high[1] - at_m >= WAVE_M:
        turned = _turned(now, high[0]) if before.way > 0 else now
        return turned._replace(way=-1, low=here)
    return now


def _turned(hand: Hand, at_s: float) -> Hand:
    """Return a hand that turned at a time [s]."""
    if at_s - hand.turned_s <= SLOWEST_S + _SAME_S:
        return hand._replace(turns=hand.turns + 1, turned_s=at_s)
    return hand._replace(turns=1, begun_s=at_s, turned_s=at_s)
