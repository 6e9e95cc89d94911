"""Rates and times over the last seconds, from what happens now."""

import math
from collections import deque
from collections.abc import Iterable

import numpy as np

from trecsim.health import Stage

WINDOW_S = 5.0
_MOST = 2000  # values that are kept; what comes faster is counted for a shorter time


class Recent:
    """Values of the last seconds, each with the moment at which it came.

    May be added to in one thread and read in another.

    Examples
    --------
    >>> delays_ms = Recent()
    >>> for n in range(101):
    ...     delays_ms.add(0.1 * n, 20.0 + n)
    >>> delays_ms.rate_hz(10.0)
    10.0
    >>> delays_ms.stage(10.0).median_ms
    95.5
    """

    def __init__(self) -> None:
        self._values: deque[tuple[float, float, float]] = deque(maxlen=_MOST)

    def add(self, now_s: float, value: float = 0.0, age: float = math.nan) -> None:
        """Take in a value, and the age of what it is about where that is known."""
        self._values.append((now_s, value, age))

    @property
    def last_s(self) -> float | None:
        """When the last value came [s]; None before the first."""
        return self._values[-1][0] if self._values else None

    def rate_hz(self, now_s: float) -> float:
        """Return how many values came per second [1/s]."""
        values = list(self._values)
        if not values or now_s <= values[0][0]:
            return 0.0
        over_s = min(WINDOW_S, now_s - values[0][0])
        return sum(now_s - over_s < at_s for at_s, *_ in values) / over_s

    def stage(self, now_s: float) -> Stage | None:
        """Return median and 95th percentile of the values [ms]; None where there are none."""
        return stage_of([self], now_s)


def stage_of(parts: Iterable[Recent], now_s: float) -> Stage | None:
    """Return the time of a stage that several things do, as the decoders of all cameras."""
    recent = [one for part in parts for one in list(part._values) if now_s - one[0] < WINDOW_S]
    if not recent:
        return None
    _, values, ages = np.array(recent).T
    known = ages[np.isfinite(ages)]
    age_ms = float(np.median(known)) if len(known) else None
    return Stage(float(np.median(values)), float(np.quantile(values, 0.95)), age_ms)
