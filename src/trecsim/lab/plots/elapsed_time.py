"""Times from the start of a recording, in a unit that suits its length."""

import math
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

T = TypeVar("T", float, np.ndarray)


@dataclass(frozen=True, slots=True)
class ElapsedTime:
    """Times from the start.

    Attributes
    ----------
    start_s
        Time zero [s].
    unit_s, unit
        Length of the unit [s] and its name.
    """

    start_s: float
    unit_s: float = 1.0
    unit: str = "s"

    def __call__(self, t_s: T) -> T:
        """Return times in the unit, from the start."""
        return (t_s - self.start_s) / self.unit_s

    @property
    def label(self) -> str:
        """Label of a time axis."""
        return f"time from the start [{self.unit}]"


def clock_of(start_s: float, length_s: float) -> ElapsedTime:
    """Return times of a recording of this length; a start of NaN counts as 0 [s].

    Examples
    --------
    >>> clock_of(10.0, 600.0)(130.0), clock_of(10.0, 600.0).unit
    (2.0, 'min')
    """
    start_s = start_s if math.isfinite(start_s) else 0.0
    if length_s < 300:
        return ElapsedTime(start_s)
    long = length_s >= 3 * 3600
    return ElapsedTime(start_s, 3600.0, "h") if long else ElapsedTime(start_s, 60.0, "min")
