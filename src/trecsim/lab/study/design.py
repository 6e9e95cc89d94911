"""Which combinations of values are tried."""

from dataclasses import dataclass
from itertools import product

import numpy as np
from jaxtyping import Float64, Int64

Value = float | int | bool | str
Point = tuple[Value, ...]

_WELL_SPREAD = 500  # points; improving more of them takes too long
BINS = 5  # a setting drawn at random is looked at in so many parts of equal count


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
    """One setting with what is tried of it.

    Attributes
    ----------
    name
        Of the setting.
    default
        Its default value.
    levels
        The values tried, at least two; empty if values are drawn from `span`.
    span
        Smallest and largest value, where values are drawn.
    log
        Whether equal factors count as equal steps.
    whole
        Whether only whole numbers make sense.
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
        Every combination that is tried, each once; the first is the default.
    own
        Which of them the design asks for; the default may be tried for comparison only.
    """

    kind: str
    factors: tuple[Factor, ...]
    points: tuple[Point, ...]
    own: tuple[bool, ...]


def grid(factors: tuple[Factor, ...]) -> Design:
    """Return every combination of the values.

    Examples
    --------
    >>> grid((Factor("a", 1.0, (1.0, 2.0)), Factor("b", 9.0, (5.0, 6.0)))).points
    ((1.0, 9.0), (1.0, 5.0), (1.0, 6.0), (2.0, 5.0), (2.0, 6.0))
    """
    return _design("grid", factors, list(product(*(factor.levels for factor in factors))))


def one_at_a_time(factors: tuple[Factor, ...]) -> Design:
    """Return the default, and it with one setting changed.

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


def random(factors: tuple[Factor, ...], count: int, seed: int = 0) -> Design:
    """Return points drawn so that each setting alone is covered evenly (a Latin hypercube).

    Parameters
    ----------
    factors
        The settings; those without levels are drawn from their span.
    count
        How many points.
    seed
        The same seed gives the same points, and more points begin anew.

    Examples
    --------
    >>> made = random((Factor("a", 1.0, span=(0.0, 4.0)), Factor("b", 2, (1, 2))), 4)
    >>> sorted(int(point[0]) for point in made.points[1:])  # one in each quarter
    [0, 1, 2, 3]
    """
    from scipy.stats.qmc import LatinHypercube

    better = "random-cd" if count <= _WELL_SPREAD else None  # less alike pairs of settings
    shares = LatinHypercube(len(factors), rng=seed, optimization=better).random(count)
    points = [tuple(map(_drawn, factors, row.tolist())) for row in shares]
    return _design("random", factors, points)


def _drawn(factor: Factor, share: float) -> Value:
    if factor.span is None:
        return factor.levels[int(share * len(factor.levels))]
    value = between(*factor.span, share, log=factor.log)
    return round(value) if factor.whole else float(f"{value:.4g}")


def between(low: float, high: float, share: float, *, log: bool) -> float:
    """Return the value that lies `share` of the way from `low` to `high`.

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
    """Return which level each point has of each setting, and what the levels are.

    Parameters
    ----------
    design
        Says which settings have levels; the values of others are put into parts of equal count,
        and a level is the mean of its part.
    points
        Of the design, all or some.
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
