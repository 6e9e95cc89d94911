"""Uniform cubic B-splines: the curves on which joints move (thesis eq. 27 and 38-41).

Knots lie on one grid for everybody, ``origin_s + i * knot_s``. In span ``i``, between knot ``i``
and knot ``i + 1``, the curve is a blend of the four control points ``i .. i + 3``; their weights
are in `trecsim.fusion.kernels.curve`.
"""

import math
from dataclasses import dataclass, replace

ORDER = 4


@dataclass(frozen=True, slots=True)
class KnotGrid:
    """The grid of knots common to all trajectories.

    Attributes
    ----------
    origin_s
        Time of knot 0 [s]; near the data, so that Unix times lose no digits.
    knot_s
        Distance between knots [s].
    live
        Number of live control points per joint; older ones are marginalised.
    first
        Index of the oldest live control point.

    Examples
    --------
    >>> grid = KnotGrid(origin_s=0.0, knot_s=0.1, live=6, first=0)
    >>> grid.end_s, grid.start_s
    (0.30000000000000004, 0.0)
    >>> moved = grid.moved_to(0.45)
    >>> moved.first, round(moved.knot_time(0.45), 9)
    (2, 2.5)
    """

    origin_s: float
    knot_s: float
    live: int
    first: int = 0

    @property
    def start_s(self) -> float:
        """Oldest time the live control points reach [s]."""
        return self.origin_s + self.first * self.knot_s

    @property
    def end_s(self) -> float:
        """Newest time they reach [s]."""
        return self.origin_s + (self.first + self.live - ORDER + 1) * self.knot_s

    def steps_to(self, t_s: float) -> int:
        """Return how many control points must be appended to reach `t_s` (0 if none)."""
        last_span = self.first + self.live - ORDER
        return max(0, math.floor((t_s - self.origin_s) / self.knot_s) - last_span)

    @property
    def place(self) -> tuple[float, float, int]:
        """The grid as the kernels take it: time of knot 0, distance, oldest live control point."""
        return self.origin_s, self.knot_s, self.first

    def moved_to(self, t_s: float) -> "KnotGrid":
        """Return the grid moved on just far enough to reach `t_s`."""
        return self.moved_on(self.steps_to(t_s))

    def moved_on(self, steps: int) -> "KnotGrid":
        """Return the grid moved on by so many knots."""
        return replace(self, first=self.first + steps) if steps else self

    def knot_time(self, t_s: float) -> float:
        """Return `t_s` in knots since the oldest live one, as the kernels take it."""
        return (t_s - self.origin_s) / self.knot_s - self.first
