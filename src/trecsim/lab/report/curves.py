"""Curves of any length drawn with a few hundred points, with a band for what they leave out."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float, Float64

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MOST_POINTS = 420  # of a curve as wide as the page


@dataclass(frozen=True, slots=True, eq=False)
class Curve:
    """Values over time, several of them to a point where there are many.

    Attributes
    ----------
    t
        Time of each point; NaN where the curve pauses.
    middle, low, high
        Median of the values of a point, and the limits of 90 % of them.
    """

    t: Float64[np.ndarray, " point"]
    middle: Float64[np.ndarray, " point"]
    low: Float64[np.ndarray, " point"]
    high: Float64[np.ndarray, " point"]


def curve(
    t: Float64[np.ndarray, " value"],
    value: Float[np.ndarray, " value"],
    *,
    most: int = MOST_POINTS,
    together: bool = False,
) -> Curve:
    """Return values over time as a limited number of points.

    Parameters
    ----------
    t
        Times, increasing, in any unit.
    value
        Values; those that are NaN are left out.
    most
        Points to return at most.
    together
        Values of the same time belong to one point, as those of several people do.
    """
    known = np.isfinite(value)
    t, value = t[known], np.asarray(value[known], np.float64)
    moments = len(np.unique(t)) if together else len(t)
    if not len(t):
        nothing = np.empty(0)
        return Curve(nothing, nothing, nothing, nothing)
    if moments <= most and not together:
        return _with_pauses(Curve(t, value, value, value))
    edges = np.linspace(t[0], t[-1], min(most, moments) + 1)
    place = np.clip(np.searchsorted(edges, t, side="right") - 1, 0, len(edges) - 2)
    _, first = np.unique(place, return_index=True)
    groups = np.split(value, first[1:])
    low, middle, high = np.array([np.quantile(group, (0.05, 0.5, 0.95)) for group in groups]).T
    middle_t = np.array([group.mean() for group in np.split(t, first[1:])])
    return _with_pauses(Curve(middle_t, middle, low, high))


def _with_pauses(drawn: Curve) -> Curve:
    """Put a NaN where the time between points is much longer than usual."""
    if len(drawn.t) < 3:
        return drawn
    steps = np.diff(drawn.t)
    breaks = np.flatnonzero(steps > max(8 * float(np.median(steps)), 1e-9)) + 1
    columns = (drawn.t, drawn.middle, drawn.low, drawn.high)
    return Curve(*(np.insert(column, breaks, np.nan) for column in columns))


def draw_curve(axes: "Axes", drawn: Curve, colour: str, *, width: float = 1.2) -> None:
    """Draw the medians as a line and, where a point is of many values, 90 % of them as a band."""
    if np.nanmax(drawn.high - drawn.low, initial=0.0) > 0:
        axes.fill_between(drawn.t, drawn.low, drawn.high, color=colour, alpha=0.22, linewidth=0)
    axes.plot(drawn.t, drawn.middle, color=colour, linewidth=width)
