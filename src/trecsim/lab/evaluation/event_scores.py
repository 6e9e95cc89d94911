"""Scores of events against the truth: what was found, what was invented, and how soon.

An episode that was told is right if a true episode of the same rule (and direction) began at most
`EARLY_S` later or `LATE_S` before, as in i-LIDS. Each episode counts once: the pairs are the
assignment with the most pairs and, among these, the least difference of time and place.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from trecsim.lab.evaluation.assignment import best_pairs
from trecsim.lab.evaluation.event_episodes import EpisodeTold, read_episodes
from trecsim.lab.evaluation.warning_scores import WarningScores, warning_scores, warnings_in

EARLY_S = 2.0
"""An episode may be told to begin so long before the true one [s]."""
LATE_S = 10.0
"""An episode may be told to begin so long after the true one [s]."""
FAR_M = 5.0  # differences of place that are larger count as this: times decide


@dataclass(frozen=True, slots=True)
class EventScores:
    """How well the episodes of one kind of rule were told.

    Attributes
    ----------
    told, true, right
        Number of episodes that were told, that there are, and that agree.
    onset_errors_s, end_errors_s
        How much later than the true one each right episode began and ended [s].
    latencies_s
        How long after the true beginning each was decided [s].
    """

    told: int
    true: int
    right: int
    onset_errors_s: tuple[float, ...] = ()
    end_errors_s: tuple[float, ...] = ()
    latencies_s: tuple[float, ...] = ()

    @property
    def precision(self) -> float:
        """Share of the episodes told that are right; NaN where none was told."""
        return self.right / self.told if self.told else math.nan

    @property
    def recall(self) -> float:
        """Share of the true episodes that were told; NaN where there are none."""
        return self.right / self.true if self.true else math.nan

    @property
    def f1(self) -> float:
        """Harmonic mean of precision and recall; NaN where nothing was told and nothing true."""
        either = self.told + self.true
        return 2.0 * self.right / either if either else math.nan

    def row(self) -> dict[str, Any]:
        """Return the scores as numbers with names."""
        return {
            "told": self.told,
            "true": self.true,
            "right": self.right,
            "precision": self.precision,
            "recall": self.recall,
            "f1": self.f1,
            "onset_error_s": _spread(self.onset_errors_s),
            "end_error_s": _spread(self.end_errors_s),
            "latency_s": _spread(self.latencies_s),
        }


@dataclass(frozen=True, slots=True)
class EventEvaluation:
    """Scores of a file of events.

    Attributes
    ----------
    kinds
        By kind of rule.
    total
        Of all kinds together.
    warnings
        Number of early warnings of what did not happen.
    early
        Scores of all early warnings.
    """

    kinds: dict[str, EventScores]
    total: EventScores
    warnings: int
    early: WarningScores = field(default_factory=lambda: WarningScores(0, 0, (), ()))

    @property
    def macro_f1(self) -> float:
        """Mean of the F1 scores of all kinds."""
        values = [one.f1 for one in self.kinds.values()]
        return float(np.mean(values)) if values else math.nan


def evaluate_events(events: Path, truth: Path) -> EventEvaluation:
    """Compare a file of events with the truth.

    Parameters
    ----------
    events, truth
        ``*.jsonl`` with one CloudEvent a line.

    Raises
    ------
    InputError
        When a file is wrong.
    SetupError
        When SciPy is not installed.
    """
    everything = read_episodes(events)
    told = [one for one in everything if not one.is_warning]
    true = read_episodes(truth)
    scores = compared(told, true, len(everything) - len(told))
    return replace(scores, early=warning_scores(warnings_in(events), true))


def compared(
    told: Sequence[EpisodeTold], true: Sequence[EpisodeTold], warnings: int = 0
) -> EventEvaluation:
    """Compare episodes with true ones; see `evaluate_events`."""
    rules = sorted({(one.kind, one.rule) for one in (*told, *true)})
    by_kind: dict[str, EventScores] = {}
    for kind, rule in rules:
        scores = _scores_of(
            [one for one in told if one.rule == rule and one.kind == kind],
            [one for one in true if one.rule == rule and one.kind == kind],
        )
        by_kind[kind] = together([by_kind[kind], scores]) if kind in by_kind else scores
    return EventEvaluation(by_kind, together(list(by_kind.values())), warnings)


def _scores_of(told: Sequence[EpisodeTold], true: Sequence[EpisodeTold]) -> EventScores:
    if not told or not true:
        return EventScores(len(told), len(true), 0)
    cost = np.array([[_apart(one, other) for other in true] for one in told])
    pairs = [(told[n], true[m]) for n, m in best_pairs(cost, LATE_S + FAR_M)]
    return EventScores(
        len(told),
        len(true),
        len(pairs),
        tuple(one.start_s - other.start_s for one, other in pairs),
        tuple(
            one.end_s - other.end_s
            for one, other in pairs
            if one.end_s is not None and other.end_s is not None
        ),
        tuple(one.detect_s - other.start_s for one, other in pairs),
    )


def _apart(told: EpisodeTold, true: EpisodeTold) -> float:
    """Return how different two episodes are, in seconds and metres; NaN if not the same."""
    late_s = told.start_s - true.start_s
    if told.direction != true.direction or not -EARLY_S <= late_s <= LATE_S:
        return math.nan
    if told.floor_m is None or true.floor_m is None:
        return abs(late_s)
    return abs(late_s) + min(math.dist(told.floor_m, true.floor_m), FAR_M)


def together(parts: Sequence[EventScores]) -> EventScores:
    """Return the scores of several files or kinds as those of one."""
    return EventScores(
        sum(one.told for one in parts),
        sum(one.true for one in parts),
        sum(one.right for one in parts),
        tuple(value for one in parts for value in one.onset_errors_s),
        tuple(value for one in parts for value in one.end_errors_s),
        tuple(value for one in parts for value in one.latencies_s),
    )


def _spread(values: Sequence[float]) -> dict[str, float]:
    """Return median, 95th percentile of the size, and the largest size, with its sign."""
    if not values:
        return dict.fromkeys(("median", "p95_abs", "max_abs"), math.nan)
    sizes = np.abs(values)
    return {
        "median": float(np.median(values)),
        "p95_abs": float(np.quantile(sizes, 0.95)),
        "max_abs": float(sizes.max()),
    }
