"""Experimental designs: grid, one at a time, and Latin hypercube."""

from dataclasses import dataclass
from itertools import product

import numpy as np
from jaxtyping import Float64, Int64

Value = float | int | bool | str
Point = tuple[Value, ...]

_WELL_SPREAD = 500  # largest number of points to optimise, for speed
BINS = 5  # bins of equal count for a setting with random values


def value_text(value: Value) -> str:
    """Return a value of a setting.

    Examples
    --------
    >>> value_text(0.0200), value_text(5), value_text(True)
    ('0.02', '5', 'true')
    """
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value:.3g}" if isinstance(value, float) else str(value)


@dataclass(frozen=True, slots=True)
class Factor:
    """One setting and its values.

    Attributes
    ----------
    name
        Name of the setting.
    default
        Its default value.
    levels
        At least two values; empty if values are drawn from `span`.
    span
        Range of drawn values.
    log
        Whether the scale is logarithmic.
    whole
        Whether values are whole numbers.
    """

    name: str
    default: Value
    levels: tuple[Value, ...] = ()
    span: tuple[float, float] | None = None
    log: bool = False
    whole: bool = False


@dataclass(frozen=True, slots=True)
class Design:
    """The points of a study.

    Attributes
    ----------
    kind
        ``"grid"``, ``"one-at-a-time"`` or ``"random"``.
    factors
        The settings, in the order of the points' values.
    points
        All points, each once; the first is the default.
    own
        Which points belong to the design; the default may be there for comparison only.
    """

    kind: str
    factors: tuple[Factor, ...]
    points: tuple[Point, ...]
    own: tuple[bool, ...]


def grid(factors: tuple[Factor, ...]) -> Design:
    """Return all combinations of the values.

    Examples
    --------
    >>> grid((Factor("a", 1.0, (1.0, 2.0)), Factor("b", 9.0, (5.0, 6.0)))).points
    ((1.0, 9.0), (1.0, 5.0), (1.0, 6.0), (2.0, 5.0), (2.0, 6.0))
    """
    return _design("grid", factors, list(product(*(factor.levels for factor in factors))))


def one_at_a_time(factors: tuple[Factor, ...]) -> Design:
    """Return the default, and the default with one setting changed.

    Examples
    --------
    >>> one_at_a_time((Factor("a", 1.0, (1.0, 2.0)), Factor("b", 9.0, (5.0, 6.0)))).points
    ((1.0, 9.0), (2.0, 9.0), (1.0, 5.0), (1.0, 6.0))
    """
    default = tuple(factor.default for factor in factors)
    points: list[Point] = [default]
    for k, factor in enumerate(factors):
        points += [(*default[:k], value, *default[k + 1 :]) for value in factor.levels]
    return _design("one-at-a-time", factors, points)


def random(factors: tuple[Factor, ...], count: int) -> Design:
    """Return a Latin hypercube, always the same: random points that cover each setting evenly.

    Without levels, values are drawn from the span.

    Examples
    --------
    >>> made = random((Factor("a", 1.0, span=(0.0, 4.0)), Factor("b", 2, (1, 2))), 4)
    >>> sorted(int(point[0]) for point in made.points[1:])  # one in each quarter
    [0, 1, 2, 3]
    """
    from scipy.stats.qmc import LatinHypercube

    better = "random-cd" if count <= _WELL_SPREAD else None  # lower discrepancy
    shares = LatinHypercube(len(factors), rng=0, optimization=better).random(count)
    points = [tuple(map(_drawn, factors, row.tolist())) for row in shares]
    return _design("random", factors, points)


def _drawn(factor: Factor, share: float) -> Value:
    if factor.span is None:
        return factor.levels[int(share * len(factor.levels))]
    value = between(*factor.span, share, log=factor.log)
    return round(value) if factor.whole else float(f"{value:.4g}")


def between(low: float, high: float, share: float, *, log: bool) -> float:
    """Interpolate between `low` and `high`.

    Examples
    --------
    >>> between(1.0, 100.0, 0.5, log=True)
    10.0
    """
    if not log:
        return low + share * (high - low)
    return float(np.exp((1 - share) * np.log(low) + share * np.log(high)).round(12))


def _design(kind: str, factors: tuple[Factor, ...], wanted: list[Point]) -> Design:
    default = tuple(factor.default for factor in factors)
    asked = dict.fromkeys(wanted)
    points = dict.fromkeys([default, *asked])
    return Design(kind, factors, tuple(points), tuple(point in asked for point in points))


def levels_of(
    design: Design, points: tuple[Point, ...]
) -> tuple[Int64[np.ndarray, "point factor"], tuple[tuple[Value, ...], ...]]:
    """Return the level of each setting at each point, and the values of the levels.

    Drawn values are put into bins of equal count; a level is the mean of its bin.
    """
    index = np.empty((len(points), len(design.factors)), np.int64)
    names = []
    for k, factor in enumerate(design.factors):
        column = [point[k] for point in points]
        if factor.span is None:
            known = [value for value in factor.levels if value in column]
            known += sorted(set(column) - set(known), key=str)  # the default, one at a time
            known = _in_order(known)
            index[:, k] = [known.index(value) for value in column]
        else:
            index[:, k], known = _parts(np.array(column, np.float64), factor.log)
        names.append(tuple(known))
    return index, tuple(names)


def _in_order(values: list[Value]) -> list[Value]:
    numbers = all(isinstance(value, int | float) for value in values)
    return sorted(values) if numbers else values


def _parts(
    values: Float64[np.ndarray, " point"], log: bool
) -> tuple[Int64[np.ndarray, " point"], list[Value]]:
    distinct = np.unique(values)
    if len(distinct) <= BINS:  # whole numbers
        return np.searchsorted(distinct, values), distinct.tolist()
    count = max(2, min(BINS, len(values) // 4))
    rank = np.empty(len(values), np.int64)
    rank[np.argsort(values, kind="stable")] = np.arange(len(values))
    part = rank * count // len(values)
    scaled = np.log(values) if log else values
    means = [float(scaled[part == p].mean()) for p in range(count)]
    return part, [float(f"{np.exp(mean) if log else mean:.3g}") for mean in means]
