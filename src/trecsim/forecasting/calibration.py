"""Calibration while running: regions learn, from what people did, how wide they must be here.

Notes
-----
Adaptive conformal inference (Gibbs and Candes 2021) on the logarithm of the radius: for each level
p, class of speed and horizon the radius r follows

    log r <- log r + step (1{error > r} - (1 - p)),

so that in the long run the share 1 - p of the errors lies outside, whatever their distribution.
Only errors that have been seen count: of a forecast for 4.8 s, what happened 4.8 s later. The
factor for the whole path follows, in the same way, the largest error of a path in units of the
90 % radii that were stated for it.
"""

from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Bool, Float64, Int64

from trecsim.forecasting import tuning
from trecsim.forecasting.guess import Guess
from trecsim.forecasting.table_values import Table
from trecsim.forecasting.values import LEVELS

_OUTER = LEVELS.index(tuning.PATH_LEVEL)


@dataclass(slots=True, eq=False)
class _Stated:
    """A forecast that waits for what happens; its worst error so far, NaN once it is unknown."""

    guess: Guess
    radius: Float64[np.ndarray, "person 12"]
    counts: Bool[np.ndarray, " person"]
    done: int = 0
    worst: Float64[np.ndarray, " person"] = field(default_factory=lambda: np.empty(0))

    def __post_init__(self) -> None:
        self.worst = np.zeros(len(self.guess.person))


class Calibration:
    """The radii of the regions, and how they follow the truth.

    Parameters
    ----------
    table
        The fitted numbers to start from.
    """

    def __init__(self, table: Table) -> None:
        self.radius: Float64[np.ndarray, "kind 12 level"] = np.repeat(
            table.radius[:, None], tuning.STEPS, axis=1
        )
        self.path_factor: Float64[np.ndarray, " kind"] = table.path_radius.copy()
        self._truths: Int64[np.ndarray, "kind 12"] = np.zeros(self.radius.shape[:2], np.int64)
        self._paths: Int64[np.ndarray, " kind"] = np.zeros(len(self.path_factor), np.int64)
        self._stated: list[_Stated] = []

    def state(self, guess: Guess) -> None:
        """Keep a guess, of the horizons `AHEAD_S`, to compare it with what happens."""
        counts = guess.long | (guess.kind == tuning.CLASSES - 1)
        self._stated.append(_Stated(guess, self.radius[guess.kind, :, _OUTER], counts))

    def due(self, t_s: float) -> list[tuple[float, "_Stated"]]:
        """Return what can be compared by now: the time of the truth, and the forecast."""
        return [
            (when, stated)
            for stated in self._stated
            for when in (stated.guess.t_s + stated.guess.ahead_s[stated.done :]).tolist()
            if when <= t_s + 1e-6
        ]

    def learn(self, stated: "_Stated", truth_m: Float64[np.ndarray, "person 2"]) -> None:
        """Take what happened at the next horizon of a stated forecast; NaN where it is unknown."""
        k, kind = stated.done, stated.guess.kind
        stated.done += 1
        error = np.where(stated.counts, _at(stated.guess, truth_m, k), np.nan)
        self._follow(kind, k, error)
        stated.worst = np.maximum(stated.worst, error / stated.radius[:, k])
        if stated.done == tuning.STEPS:
            self._stated.remove(stated)
            self._follow_path(kind, stated.worst)

    def _follow(self, kinds: np.ndarray, k: int, error: np.ndarray) -> None:
        for kind in np.unique(kinds[~np.isnan(error)]).tolist():
            seen = error[(kinds == kind) & ~np.isnan(error)]
            excess = (seen[:, None] > self.radius[kind, k]).mean(axis=0) - (1 - np.array(LEVELS))
            step = _step(int(self._truths[kind, k]), len(seen))
            self._truths[kind, k] += len(seen)
            grown = self.radius[kind, k] * np.exp(step * excess)
            self.radius[kind, k] = np.maximum(grown, tuning.SMALLEST_RADIUS)

    def _follow_path(self, kinds: np.ndarray, worst: np.ndarray) -> None:
        for kind in np.unique(kinds[~np.isnan(worst)]).tolist():
            seen = worst[(kinds == kind) & ~np.isnan(worst)]
            excess = (seen > self.path_factor[kind]).mean() - (1 - tuning.PATH_LEVEL)
            step = _step(int(self._paths[kind]), len(seen))
            self._paths[kind] += len(seen)
            self.path_factor[kind] *= np.exp(step * excess)


def _at(guess: Guess, truth_m: np.ndarray, k: int) -> np.ndarray:
    """Return the size of the errors at one horizon, in units of the scale."""
    error_m = truth_m - guess.xy_m[:, k]
    along, across = guess.axes
    scaled = np.stack([(error_m * along).sum(axis=1), (error_m * across).sum(axis=1)], axis=1)
    size: np.ndarray = np.linalg.norm(scaled / guess.scale_m[:, k], axis=1)
    return size


def _step(before: int, new: int) -> float:
    """Return how far `new` truths move the logarithm, after `before` of them."""
    truths = before + np.arange(new)
    steps = tuning.FIRST_STEP / (1 + truths / tuning.HALVING_TRUTHS)
    return min(float(np.maximum(steps, tuning.LAST_STEP).sum()), tuning.MOST_STEP)
