"""Tracks against the truth, as figures over seeds."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from harness.figures import Better, Figure, Figures, once, over_seeds, summed
from harness.options import settings_from

if TYPE_CHECKING:
    from trecsim.geometry import Rig
    from trecsim.store.truth import Truth
    from trecsim.values import Poses2D

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
    watched: bool = True


KINDS = {
    "mean error": Kind("cm"),
    "median error": Kind("cm"),
    "p95 error": Kind("cm"),
    "joints within 15 cm": Kind("", "higher", matters=0.003),
    "missed": Kind("%", matters=0.3),
    "ghosts": Kind("%", matters=0.3),
    "right count": Kind("%", "higher", matters=0.5),
    "switches": Kind("", summed=True, matters=0.0),
    "switches in 10 person-minutes": Kind("", watched=False),
    "IDF1": Kind("%", "higher", matters=0.3),
    "MOTA": Kind("%", "higher", matters=0.3),
    "HOTA": Kind("%", "higher", matters=0.3),
    "limb length sd": Kind("cm"),
    "truth in 90 % regions": Kind("%", "higher", watched=False),
    # Not where a detector has no errors that all cameras share: they are in the stated region.
    "away from 90 %": Kind("%", matters=1.0, watched=False),
    "found after, median": Kind("s", matters=0.05),
    "gone after, median": Kind("s", matters=0.05),
    "gone after, latest": Kind("s", matters=0.1),
}


def scores(
    poses: "Iterable[Poses2D]",
    rig: "Rig",
    truth: "Truth",
    lag_s: float,
    overrides: Mapping[str, object],
) -> dict[str, float]:
    """Track, compare with the truth, and return the scores by the names in `KINDS`."""
    from trecsim.lab.evaluation.limbs import limb_series, limb_summary, limb_table
    from trecsim.lab.evaluation.moments import gather, within
    from trecsim.lab.evaluation.person_tracks import people_of
    from trecsim.lab.evaluation.scores import score
    from trecsim.tracking import follow

    snapshots = follow(poses, rig, settings_from(overrides), lag_s=lag_s)
    from_s, until_s = float(truth.t_s[0]), float(truth.t_s[-1])
    moments = within(gather(snapshots), from_s, until_s)
    found = score(moments, truth, from_s, until_s)
    limbs = limb_summary(limb_table(limb_series(people_of(moments))))
    minutes = found.person_moments * (until_s - from_s) / max(found.moments, 1) / 60.0
    in_90 = 100 * found.uncertainty_calibration.within_90
    return {
        "mean error": 100 * found.error.mean_m,
        "median error": 100 * found.error.median_m,
        "p95 error": 100 * found.error.p95_m,
        "joints within 15 cm": found.error.recall_15cm,
        "missed": 100 * found.missed_share,
        "ghosts": 100 * found.false_positives_share,
        "right count": 100 * found.right_count,
        "switches": float(found.identity.switches),
        "switches in 10 person-minutes": 10 * found.identity.switches / minutes,
        "IDF1": 100 * found.identity.idf1,
        "MOTA": 100 * found.identity.mota,
        "HOTA": 100 * found.identity.hota,
        "limb length sd": 100 * limbs.sd_m,
        "truth in 90 % regions": in_90,
        "away from 90 %": abs(in_90 - 90.0),
        "found after, median": found.latency.birth.median_s,
        "gone after, median": found.latency.death.median_s,
        "gone after, latest": found.latency.death.max_s,
    }


def of_seeds(by_seed: Mapping[Any, Mapping[str, float]]) -> Figures:
    """Return scores of many seeds, or of runs by any other name, as figures."""
    return {name: _figure(name, by_seed) for name in KINDS if name in next(iter(by_seed.values()))}


def _figure(name: str, by_seed: Mapping[Any, Mapping[str, float]]) -> Figure:
    kind = KINDS[name]
    runs = {seed: of_one[name] for seed, of_one in by_seed.items()}
    figure = summed(runs) if kind.summed else over_seeds(runs, kind.unit, kind.better)
    return replace(figure, watched=kind.watched)


def of_one(values: Mapping[str, float]) -> Figures:
    """Return scores of a single run as figures."""
    return {
        name: once(values[name], kind.unit, kind.better, kind.matters, watched=kind.watched)
        for name, kind in KINDS.items()
        if name in values
    }
