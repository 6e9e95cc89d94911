"""Tracks against the truth, as figures over seeds."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from harness.figures import Better, Figure, Figures, once, over_seeds, summed
from harness.options import settings_from

if TYPE_CHECKING:
    import numpy as np

    from trecsim.geometry import Rig
    from trecsim.types import Poses2D

LAGS_S = {"newest": 0.0, "lag 0.2 s": 0.2}


@dataclass(frozen=True, slots=True)
class Kind:
    """What a score is measured in, which way is better, and how seeds are put together.

    `matters` is the least change worth naming where there is a single run.
    """

    unit: str
    better: Better = "lower"
    summed: bool = False
    matters: float | None = None


KINDS = {
    "mean error": Kind("cm"),
    "median error": Kind("cm"),
    "p95 error": Kind("cm"),
    "joints within 15 cm": Kind("", "higher", matters=0.003),
    "missed": Kind("%", matters=0.3),
    "ghosts": Kind("%", matters=0.3),
    "switches": Kind("", summed=True, matters=0.0),
}


def scores(
    poses: "Iterable[Poses2D]",
    rig: "Rig",
    t_s: "np.ndarray",
    xyz_m: "np.ndarray",
    lag_s: float,
    overrides: Mapping[str, object],
) -> dict[str, float]:
    """Track, compare with the truth, and return the scores by the names in `KINDS`."""
    from trecsim.evaluation.truth import compare
    from trecsim.tracking import follow

    snapshots = follow(poses, rig, settings_from(overrides), lag_s=lag_s)
    result = compare(snapshots, t_s, xyz_m)
    there = max(result.person_frames, 1)
    return {
        "mean error": 100 * result.mean_m,
        "median error": 100 * result.median_m,
        "p95 error": 100 * result.p95_m,
        "joints within 15 cm": result.recall_15cm,
        "missed": 100 * result.missed / there,
        "ghosts": 100 * result.ghosts / there,
        "switches": float(result.switches),
    }


def of_seeds(by_seed: Mapping[int, Mapping[str, float]]) -> Figures:
    """Return scores of many seeds as figures."""
    return {name: _figure(name, by_seed) for name in KINDS if name in next(iter(by_seed.values()))}


def _figure(name: str, by_seed: Mapping[int, Mapping[str, float]]) -> Figure:
    kind = KINDS[name]
    runs = {seed: of_one[name] for seed, of_one in by_seed.items()}
    return summed(runs) if kind.summed else over_seeds(runs, kind.unit, kind.better)


def of_one(values: Mapping[str, float]) -> Figures:
    """Return scores of a single run as figures."""
    return {
        name: once(values[name], kind.unit, kind.better, kind.matters)
        for name, kind in KINDS.items()
        if name in values
    }
