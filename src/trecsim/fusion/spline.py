"""Uniform cubic B-splines: the curves on which joints move (thesis eq. 27 and 38-41).

Knots lie on one grid for everybody, ``origin_s + i * knot_s``. In span ``i``, between knot ``i``
and knot ``i + 1``, the curve is a blend of the four control points ``i .. i + 3``.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

ORDER = 4


def basis(u: float) -> Float64[np.ndarray, "4"]:
    """Return the weights of the four control points at the fraction `u` of a span.

    Parameters
    ----------
    u
        Where in the span, 0 at its first knot, 1 at the next.

    Notes
    -----
    They are positive and sum to one, so the curve stays within its control points' hull.

    Examples
    --------
    >>> basis(0.0) * 6
    array([1., 4., 1., 0.])
    """
    v = 1.0 - u
    return (
        np.array(
            [
                v * v * v,
                3.0 * u * u * u - 6.0 * u * u + 4.0,
                3.0 * v * v * v - 6.0 * v * v + 4.0,
                u * u * u,
            ]
        )
        / 6.0
    )


@dataclass(frozen=True, slots=True)
class KnotGrid:
    """The grid of knots that all trajectories share.

    Attributes
    ----------
    origin_s
        Time of knot 0 [s]; near the data, so that Unix times lose no digits.
    knot_s
        Distance between knots [s].
    live
        Number of control points kept per joint; older ones are marginalised.
    first
        Index of the oldest live control point.

    Examples
    --------
    >>> grid = KnotGrid(origin_s=0.0, knot_s=0.1, live=6, first=0)
    >>> grid.end_s, grid.start_s
    (0.30000000000000004, 0.0)
    >>> grid.moved_to(0.45).first
    2
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
        return max(0, int(np.floor((t_s - self.origin_s) / self.knot_s)) - last_span)

    def moved_to(self, t_s: float) -> "KnotGrid":
        """Return the grid moved on just far enough to reach `t_s`."""
        first = self.first + self.steps_to(t_s)
        return KnotGrid(self.origin_s, self.knot_s, self.live, first)

    def locate(self, t_s: float) -> tuple[int, Float64[np.ndarray, "4"]]:
        """Return the first of the four live control points active at `t_s`, and their weights.

        Times outside the live part are taken at its nearer end.
        """
        position = (t_s - self.origin_s) / self.knot_s - self.first
        span = min(max(int(np.floor(position)), 0), self.live - ORDER)
        return span, basis(min(max(position - span, 0.0), 1.0))
