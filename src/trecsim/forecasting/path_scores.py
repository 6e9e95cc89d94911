"""How good forecasts are: distances, coverage of the regions, likelihood, best of 20.

Every figure is over the same samples: a person and a moment with 8 samples behind it (3.2 s, 0.4 s
apart) and 12 truths ahead (4.8 s).
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64

from trecsim.forecasting import constants
from trecsim.forecasting.forecaster import Forecaster
from trecsim.forecasting.forecasts import AHEAD_S, LEVELS, Forecast, Moment
from trecsim.forecasting.recorded_paths import RecordedPaths
from trecsim.forecasting.spread_table import TABLE
from trecsim.forecasting.table_values import Table

PATHS = 20
"""Of so many representative paths the best one counts, in "best of 20"."""
_RINGS = ((1, 0.0), (6, 0.6), (6, 1.2), (7, 2.0))
"""Number of points, and radius in units of the region of 80 %: one in the middle, then rings."""


@dataclass(frozen=True, slots=True, eq=False)
class Scores:
    """Errors per sample of a forecast, to be averaged.

    Attributes
    ----------
    error_m
        Distance of the single guess from the truth [m].
    constant_m
        The same for constant velocity: the last displacement repeated [m].
    best_m
        Distance of the best of 20 paths, at each step that of the path with the least mean [m].
    best_last_m
        Least distance among 20 paths at the last step [m].
    inside
        Whether the region of each level holds the truth.
    whole
        Whether the region of the whole path holds all of it.
    nll
        Negative log likelihood of the truth under all modes [log m^2].
    """

    error_m: Float64[np.ndarray, "sample step"]
    constant_m: Float64[np.ndarray, "sample step"]
    best_m: Float64[np.ndarray, "sample step"]
    best_last_m: Float64[np.ndarray, " sample"]
    inside: Bool[np.ndarray, "sample level step"]
    whole: Bool[np.ndarray, " sample"]
    nll: Float64[np.ndarray, "sample step"]

    def summary(self) -> dict[str, object]:
        """Return the mean figures; coverage per level over all horizons, and per horizon."""
        return {
            "samples": len(self.error_m),
            **_distances(self.error_m),
            "best_of_20": {
                "ade_m": float(self.best_m.mean()), "fde_m": float(self.best_last_m.mean()),
            },
            "coverage": _per_level(self.inside.mean(axis=(0, 2))),
            "coverage_by_horizon": {
                f"{ahead_s:g}": _per_level(self.inside[..., k].mean(axis=0))
                for k, ahead_s in enumerate(AHEAD_S.tolist())
            },
            "whole_path_coverage": {f"{constants.PATH_LEVEL:g}": float(self.whole.mean())},
            "nll": float(self.nll.mean()),
            "constant_velocity": _distances(self.constant_m),
        }  # fmt: skip


def evaluated(moments: Iterable[Moment], table: Table = TABLE) -> Scores:
    """Return the errors of forecasts every 0.4 s on a recording, each made without what follows.

    Parameters
    ----------
    moments
        Time [s], identities and floor points [m], in order of time.
    table
        The fitted numbers.
    """
    kept = list(moments)
    paths = RecordedPaths(kept)
    forecaster = Forecaster(every_s=constants.PAST_STEP_S, table=table)
    parts = [
        part for moment in kept if (part := _scored(forecaster.step(*moment), paths)) is not None
    ]
    return joined(parts)


def joined(parts: Sequence[Scores]) -> Scores:
    """Return the scores of several recordings as those of one."""
    if not parts:
        none, steps = 0, constants.STEPS
        empty = np.empty((none, steps))
        return Scores(
            empty, empty, empty, np.empty(none), np.empty((none, len(LEVELS), steps), bool),
            np.empty(none, bool), empty,
        )  # fmt: skip
    names = ("error_m", "constant_m", "best_m", "best_last_m", "inside", "whole", "nll")
    return Scores(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))


def representatives(
    centre_m: Float64[np.ndarray, "person step 2"],
    region_m2: Float64[np.ndarray, "person step 2 2"],
) -> Float64[np.ndarray, "person path step 2"]:
    """Return 20 paths that stand for a forecast: the guess, and rings of ellipses around it."""
    root = np.linalg.cholesky(region_m2)
    angles = [(np.arange(n) + 0.5 * (i % 2)) * 2 * np.pi / n for i, (n, _) in enumerate(_RINGS)]
    points = np.concatenate(
        [r * np.stack([np.cos(a), np.sin(a)], axis=1)
         for (_, r), a in zip(_RINGS, angles, strict=True)]
    )  # fmt: skip
    return np.asarray(centre_m[:, None] + np.einsum("psxy,qy->pqsx", root, points))


def _scored(made: Sequence[Forecast], paths: RecordedPaths) -> Scores | None:
    if not made:
        return None
    person, t_s = np.array([one.person for one in made]), made[0].t_s
    times_s = t_s + np.arange(1 - constants.PAST, constants.STEPS + 1) * constants.PAST_STEP_S
    way_m = paths.at(person, times_s)
    whole = ~np.isnan(way_m).any(axis=(1, 2))
    if not whole.any():
        return None
    chosen = [one for one, known in zip(made, whole.tolist(), strict=True) if known]
    past_m, truth_m = way_m[whole, : constants.PAST], way_m[whole, constants.PAST :]
    step_m = past_m[:, -1] - past_m[:, -2]
    constant_m = past_m[:, -1:] + np.arange(1, constants.STEPS + 1)[:, None] * step_m[:, None]
    return _compared(chosen, truth_m, np.linalg.norm(constant_m - truth_m, axis=2))


def _compared(made: Sequence[Forecast], truth_m: np.ndarray, constant_m: np.ndarray) -> Scores:
    guess_m = np.stack([one.xy_m[0] for one in made])
    region_m2 = np.stack([one.region_m2 for one in made])
    error = truth_m - guess_m
    likely = representatives(guess_m, region_m2[:, 1])
    off_m = np.linalg.norm(likely - truth_m[:, None], axis=3)
    best = off_m.mean(axis=2).argmin(axis=1)
    size2 = _size2(error[:, None], region_m2)
    path2 = _size2(error, np.stack([one.path_m2 for one in made]))
    return Scores(
        np.linalg.norm(error, axis=2),
        constant_m,
        off_m[np.arange(len(made)), best],
        off_m[:, :, -1].min(axis=1),
        size2 <= 1,
        np.all(path2 <= 1, axis=1),
        _nll(made, truth_m),
    )


def _nll(made: Sequence[Forecast], truth_m: np.ndarray) -> np.ndarray:
    weight = np.stack([one.weight for one in made])
    xy_m, cov_m2 = np.stack([one.xy_m for one in made]), np.stack([one.cov_m2 for one in made])
    log = -0.5 * _size2(truth_m[:, None] - xy_m, cov_m2) - 0.5 * np.log(_determinant(cov_m2))
    log = log + np.log(weight)[..., None] - np.log(2 * np.pi)
    top = log.max(axis=1)
    total: np.ndarray = top + np.log(np.exp(log - top[:, None]).sum(axis=1))
    return -total


def _size2(error: np.ndarray, matrix: np.ndarray) -> np.ndarray:
    """Return e' M^-1 e for 2 x 2 matrices."""
    x, y = error[..., 0], error[..., 1]
    xx, xy, yy = matrix[..., 0, 0], matrix[..., 0, 1], matrix[..., 1, 1]
    size: np.ndarray = (yy * x**2 - 2 * xy * x * y + xx * y**2) / _determinant(matrix)
    return size


def _determinant(matrix: np.ndarray) -> np.ndarray:
    product: np.ndarray = matrix[..., 0, 0] * matrix[..., 1, 1] - matrix[..., 0, 1] ** 2
    return product


def _distances(error_m: np.ndarray) -> dict[str, float]:
    return {"ade_m": float(error_m.mean()), "fde_m": float(error_m[:, -1].mean())}


def _per_level(shares: np.ndarray) -> dict[str, float]:
    return {f"{level:g}": float(share) for level, share in zip(LEVELS, shares, strict=True)}
