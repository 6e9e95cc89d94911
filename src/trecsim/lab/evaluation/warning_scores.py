"""Scores of early warnings against the ground truth: lead time, Brier score, reliability.

Probabilities are reliable if what is warned of with 0.8 happens in 80 % of the cases.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from trecsim.lab.evaluation.event_episodes import EpisodeTold, event_data_of

WITHIN_S = (1.0, 2.0, 4.0)
"""Events state the probabilities within these times [s]."""
BEGUN_S = 0.5
"""An episode that began this long before its warning still counts as warned of, with lead 0 [s]."""
FASTEST_MPS, APART_M = 3.0, 1.5
"""A warning matches an episode within `APART_M`, plus `FASTEST_MPS` times the time between."""
OF_WORSE = ("edge.platform",)
"""Kinds of rules whose warnings are of something worse than what begins an episode."""
BINS = 5
"""Number of bins of the probability, of equal width."""


class Warned(NamedTuple):
    """One early warning.

    Attributes
    ----------
    rule, told_s, floor_m
        Which rule gave it, when [s], and where the person was [m].
    within
        Probability that it happens within each of `WITHIN_S`; NaN where it is not stated.
    """

    rule: str
    told_s: float
    floor_m: tuple[float, float] | None
    within: tuple[float, ...]


class Bin(NamedTuple):
    """Warnings with similar probabilities.

    Attributes
    ----------
    low, high
        Limits of the probability.
    number
        Number of warnings.
    told, happened
        The mean of their probabilities, and the share that happened.
    """

    low: float
    high: float
    number: int
    told: float
    happened: float


@dataclass(frozen=True, slots=True)
class Horizon:
    """How well the probabilities within one time agree with what happened.

    Attributes
    ----------
    within_s
        The time [s].
    count
        Number of warnings that state a probability for it.
    brier
        Mean squared difference of probability and outcome; NaN without warnings.
    told, happened
        The mean of the probabilities, and the share that happened.
    bins
        The same by probability; bins without a warning are left out.
    """

    within_s: float
    count: int
    brier: float
    told: float
    happened: float
    bins: tuple[Bin, ...]


@dataclass(frozen=True, slots=True)
class WarningScores:
    """Scores of the early warnings of a file of events.

    Attributes
    ----------
    given, came_true
        How many there are, and how many of them happened within the longest time.
    leads_s
        How long before the true beginning each of these was given [s].
    horizons
        By time.
    unwarned
        True happenings that no warning preceded, of rules that gave any.
    """

    given: int
    came_true: int
    leads_s: tuple[float, ...]
    horizons: tuple[Horizon, ...]
    unwarned: int = 0

    def row(self) -> dict[str, Any]:
        """Return the scores as numbers with names."""
        return {
            "given": self.given,
            "came_true": self.came_true,
            "unwarned": self.unwarned,
            "lead_s": float(np.median(self.leads_s)) if self.leads_s else math.nan,
            "within": {
                f"{one.within_s:g}": {
                    "count": one.count,
                    "brier": one.brier,
                    "told": one.told,
                    "happened": one.happened,
                    "reliability": [row._asdict() for row in one.bins],
                }
                for one in self.horizons
            },
        }


def warnings_in(path: Path) -> list[Warned]:
    """Read the early warnings in a file of events.

    Raises
    ------
    InputError
        When it cannot be read, or a line is no event.
    """
    return warnings_of(data for _, data in event_data_of(path))


def warnings_of(events: Iterable[Mapping[str, Any]]) -> list[Warned]:
    """Return the early warnings among the `data` of events."""
    return [
        Warned(
            str(data["rule"]["id"]),
            float(data["t_detect_s"]),
            _floor_m(data.get("people") or []),
            tuple(
                float(data.get("measures", {}).get(f"probability_{one:g}s", math.nan))
                for one in WITHIN_S
            ),
        )
        for data in events
        if data.get("phase") == "new" and data.get("predicted")
    ]


def _floor_m(people: Sequence[Mapping[str, Any]]) -> tuple[float, float] | None:
    xy_m = people[0].get("floor_m") if people else None
    return None if xy_m is None or None in xy_m else (float(xy_m[0]), float(xy_m[1]))


def warning_scores(warned: Sequence[Warned], true: Sequence[EpisodeTold]) -> WarningScores:
    """Compare early warnings with true episodes.

    Parameters
    ----------
    warned
        The warnings.
    true
        True episodes. A warning belongs to the first one of the same rule that begins after it, or
        up to `BEGUN_S` before, of a person who can have been where the warned one was.
    """
    leads_s = [_lead_s(one, true) for one in warned]
    came = [lead_s for lead_s in leads_s if lead_s <= WITHIN_S[-1]]
    horizons = tuple(
        _horizon(within_s, [one.within[n] for one in warned], leads_s)
        for n, within_s in enumerate(WITHIN_S)
    )
    return WarningScores(len(warned), len(came), tuple(came), horizons, _unwarned(warned, true))


def _begins_s(true: EpisodeTold) -> float:
    """Return when that began of which warnings warn [s]; infinity where it did not."""
    if true.kind not in OF_WORSE:
        return true.start_s
    return math.inf if true.worse_s is None else true.worse_s


def _lead_s(warned: Warned, true: Sequence[EpisodeTold]) -> float:
    """Return how long after the warning its episode began [s]; infinity where none did."""
    leads_s = [
        _begins_s(one) - warned.told_s
        for one in true
        if one.rule == warned.rule
        and _begins_s(one) >= warned.told_s - BEGUN_S
        and _same(warned, one)
    ]
    return max(min(leads_s, default=math.inf), 0.0)


def _unwarned(warned: Sequence[Warned], true: Sequence[EpisodeTold]) -> int:
    """Return how many true happenings no warning preceded, of rules that gave any."""
    rules = {one.rule for one in warned}
    return sum(
        one.rule in rules
        and math.isfinite(_begins_s(one))
        and not any(
            some.rule == one.rule
            and -BEGUN_S <= _begins_s(one) - some.told_s <= WITHIN_S[-1]
            and _same(some, one)
            for some in warned
        )
        for one in true
    )


def _same(warned: Warned, true: EpisodeTold) -> bool:
    if warned.floor_m is None or true.floor_m is None:
        return True
    passed_s = abs(true.detect_s - warned.told_s)
    return math.dist(warned.floor_m, true.floor_m) <= APART_M + FASTEST_MPS * passed_s


def _horizon(within_s: float, probability: Sequence[float], leads_s: Sequence[float]) -> Horizon:
    told = np.array(probability, dtype=float)
    known = np.isfinite(told)
    happened = np.array([lead_s <= within_s for lead_s in leads_s], dtype=float)[known]
    told = told[known]
    if not len(told):
        return Horizon(within_s, 0, math.nan, math.nan, math.nan, ())
    at = np.minimum((told * BINS).astype(int), BINS - 1)
    bins = tuple(
        Bin(
            n / BINS, (n + 1) / BINS, int((at == n).sum()),
            float(told[at == n].mean()), float(happened[at == n].mean()),
        )
        for n in np.unique(at).tolist()
    )  # fmt: skip
    brier = float(np.square(told - happened).mean())
    return Horizon(within_s, len(told), brier, float(told.mean()), float(happened.mean()), bins)
