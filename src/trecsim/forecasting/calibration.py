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

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Bool, Float64, Int64

from trecsim.forecasting import constants
from trecsim.forecasting.forecasts import AHEAD_S, LEVELS
from trecsim.forecasting.guess import Guess
from trecsim.forecasting.table_values import Table

_OUTER = LEVELS.index(constants.PATH_LEVEL)
PATH_LEVELS = (constants.PATH_LEVEL,)


@dataclass(slots=True, eq=False)
class Stated:
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
            table.radius[:, None], constants.STEPS, axis=1
        )
        self.path_factor: Float64[np.ndarray, " kind"] = table.path_radius.copy()
        groups = constants.CLASSES * constants.STEPS
        self._truths: Int64[np.ndarray, " group"] = np.zeros(groups, np.int64)
        self._paths: Int64[np.ndarray, " kind"] = np.zeros(len(self.path_factor), np.int64)
        self._stated: list[Stated] = []

    def state(self, guess: Guess) -> None:
        """Keep a guess, of the horizons `AHEAD_S`, to compare it with what happens."""
        counts = guess.long | (guess.kind == constants.CLASSES - 1)
        self._stated.append(Stated(guess, self.radius[guess.kind, :, _OUTER], counts))

    def due(self, t_s: float) -> "list[Due]":
        """Return what can be compared by now: the time, the forecast, and which horizon of it."""
        return [
            (when_s, stated, k)
            for stated in self._stated
            for k, when_s in enumerate((stated.guess.t_s + AHEAD_S).tolist())
            if k >= stated.done and when_s <= t_s + 1e-6
        ]

    def learn(self, due: "Sequence[Due]", truth_m: Sequence[np.ndarray]) -> None:
        """Take what happened, (person, 2) for each that was due [m]; NaN where it is unknown."""
        pairs = zip(due, truth_m, strict=True)
        error = np.concatenate([_at(one.guess, xy, k) for (_, one, k), xy in pairs])
        error[~np.concatenate([one.counts for _, one, _ in due])] = np.nan
        kind = np.concatenate([one.guess.kind for _, one, _ in due])
        step = np.repeat([k for _, _, k in due], [len(one.counts) for _, one, _ in due])
        group = kind * constants.STEPS + step
        radius = self.radius.reshape(-1, len(LEVELS))
        moved = _moves(group, error, radius, self._truths, LEVELS)
        grown = np.maximum(radius * np.exp(moved), constants.SMALLEST_RADIUS)
        self.radius = grown.reshape(self.radius.shape)
        self._follow_paths(due, error)

    def _follow_paths(self, due: "Sequence[Due]", error: np.ndarray) -> None:
        """Keep the worst error of each path; learn from the paths that have ended."""
        ends = np.cumsum([len(one.counts) for _, one, _ in due])
        for (_, one, k), of_one in zip(due, np.split(error, ends[:-1]), strict=True):
            one.worst = np.maximum(one.worst, of_one / one.radius[:, k])
            one.done = k + 1
            if one.done == constants.STEPS:
                self._stated.remove(one)
                factor = self.path_factor[:, None]
                moved = _moves(one.guess.kind, one.worst, factor, self._paths, PATH_LEVELS)
                self.path_factor = self.path_factor * np.exp(moved[:, 0])


Due = tuple[float, Stated, int]
"""When a horizon of a forecast was reached [s], the forecast, and the number of the horizon."""


def _moves(
    group: Int64[np.ndarray, " sample"],
    error: Float64[np.ndarray, " sample"],
    radius: Float64[np.ndarray, "group level"],
    truths: Int64[np.ndarray, " group"],
    levels: Sequence[float],
) -> Float64[np.ndarray, "group level"]:
    """Return how far the logarithms of the radii move; count the new truths in `truths`."""
    known = ~np.isnan(error)
    group, error = group[known], error[known]
    new = np.bincount(group, minlength=len(radius))
    outside = (error[:, None] > radius[group]).astype(np.float64)
    number = [np.bincount(group, weights=one, minlength=len(radius)) for one in outside.T]
    share = np.stack(number, axis=1) / np.maximum(new, 1)[:, None]
    step = np.minimum(_steps_until(truths + new) - _steps_until(truths), constants.MOST_STEP)
    truths += new
    return np.asarray(step[:, None] * (share - (1.0 - np.array(levels))))


def _at(guess: Guess, truth_m: np.ndarray, k: int) -> np.ndarray:
    """Return the size of the errors at one horizon, in units of the scale."""
    x, y = (truth_m - guess.xy_m[:, k]).T
    along, left = guess.heading.T
    scale_x, scale_y = guess.scale_m[:, k].T
    size: np.ndarray = np.hypot((x * along + y * left) / scale_x, (y * along - x * left) / scale_y)
    return size


_EARLY = int(constants.HALVING_TRUTHS * (constants.FIRST_STEP / constants.LAST_STEP - 1))
"""From so many truths on, the step is the last one."""
_EARLY_STEPS = np.append(
    0.0, np.cumsum(constants.FIRST_STEP / (1 + np.arange(_EARLY) / constants.HALVING_TRUTHS))
)


def _steps_until(truths: Int64[np.ndarray, " group"]) -> Float64[np.ndarray, " group"]:
    """Return the sum of the steps of the first so many truths."""
    early = _EARLY_STEPS[np.minimum(truths, _EARLY)]
    return np.asarray(early + np.maximum(truths - _EARLY, 0) * constants.LAST_STEP)
