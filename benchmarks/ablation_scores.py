"""Scores of tracks, as far as the ablation looks at them, and how runs are put together."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from harness import regions
from harness.counted import FAR_M
from harness.figures import Better, Figure, Figures, once, over_seeds, summed

if TYPE_CHECKING:
    from harness.beside_truth import Beside, Flags
    from trecsim.geometry import Rig
    from trecsim.store.truth import Truth
    from trecsim.values import Poses2D

Array = npt.NDArray[np.float64]
Scores = Mapping[str, float]
FEWEST_RUNS = 4  # for a spread over them to say what is noise


@dataclass(frozen=True, slots=True)
class Kind:
    """What a score is measured in, and how runs are put together.

    `matters` is the least change worth naming.
    """

    unit: str
    better: Better = "lower"
    summed: bool = False
    matters: float | None = None


REGIONS = "in 90 % regions"
OFF_BY = "90 % regions, off by"
KINDS = {
    "error": Kind("cm"),
    "off more than 25 cm": Kind("%", matters=0.05),
    "limbs' spread": Kind("cm"),
    "switches": Kind("", summed=True),
    "missed": Kind("%", matters=0.2),
    "missed, provisional people counted": Kind("%", matters=0.2),
    "ghosts": Kind("%", matters=0.1),
    "ghosts, provisional people counted": Kind("%", matters=0.1),
    "log-likelihood": Kind("nats", "higher", matters=0.02),
    "left, gone after": Kind("s", matters=0.02),
    "support too high": Kind("%", matters=0.02),
    "fault named": Kind("%", "higher", matters=5.0),
    "average PCP": Kind("%", "higher", matters=0.2),
    "missed person-frames": Kind("", summed=True),
    "step, median": Kind("cm", matters=0.03),
    "reprojection error": Kind("px", matters=0.1),
    "off in depth": Kind("cm", matters=1.0),
    "off in depth, p95": Kind("cm", matters=2.0),
    "lost": Kind("%", matters=0.2),
}


def figures_of(runs: Mapping[str, Scores]) -> Figures:
    """Return the scores of several runs as figures."""
    out: dict[str, Figure] = {}
    for name, kind in KINDS.items():
        values = {run: found[name] for run, found in runs.items() if name in found}
        if values:
            out[name] = _figure(values, kind)
    held = [found[REGIONS] for found in runs.values() if REGIONS in found]
    if held:
        out[REGIONS] = once(float(np.mean(held)), "%", "higher", watched=False)
        out[OFF_BY] = once(abs(float(np.mean(held)) - 90.0), "%", matters=1.0)
    return out


def _figure(values: Mapping[str, float], kind: Kind) -> Figure:
    if kind.summed:
        return summed(values, kind.unit, kind.better)
    if len(values) >= FEWEST_RUNS:
        return over_seeds(values, kind.unit, kind.better, kind.matters)
    return once(float(np.mean(list(values.values()))), kind.unit, kind.better, kind.matters)


def scores(
    poses: "tuple[Poses2D, ...]",
    rig: "Rig",
    truth: "Truth",
    overrides: Mapping[str, Any],
    lag_s: float,
    judged: "Callable[[Beside], Flags] | None" = None,
    guilty: tuple[str, ...] = (),
    *,
    provisional: bool = False,
) -> dict[str, float]:
    """Track, and return what went wrong.

    Parameters
    ----------
    poses, rig, truth
        The scene.
    overrides, lag_s
        Settings of the fusion, and how far behind the newest image it reports [s].
    judged
        Of which joints at which moments errors count, (person, moment, joint); None: of all.
    guilty
        The cameras at fault, which a remark is to name within 20 s.
    provisional
        Whether provisional people are judged, too.
    """
    from disturbed import NAMED_WITHIN_S, mentions
    from harness.beside_truth import beside, left, said

    remarks: list[tuple[str, float]] = []
    snapshots = list(
        said(poses, rig, overrides, lag_s, provisional=True,
             remark=lambda text, t_s: remarks.append((text, t_s)))
    )  # fmt: skip
    confirmed = beside([s.confirmed() for s in snapshots], truth)
    out = {
        **errors_of(confirmed, judged(confirmed) if judged else None),
        **_people(confirmed),
        **_claimed(confirmed, rig),
    }
    if provisional:
        found = _people(beside(snapshots, truth))
        for name in ("missed", "ghosts"):
            out[f"{name}, provisional people counted"] = found[name]
    gone_s = [one.after_s for one in left(confirmed, rig)]
    if gone_s:
        out["left, gone after"] = float(np.mean(gone_s))
    if guilty:
        at_s = [t_s for text, t_s in remarks if any(mentions(text, name) for name in guilty)]
        out["fault named"] = 100.0 * (min(at_s, default=np.inf) <= NAMED_WITHIN_S)
    return out


def errors_of(one: "Beside", chosen: "Flags | None") -> dict[str, float]:
    errors = one.errors(chosen)
    if not len(errors.off):
        return {}
    return {
        "error": float(errors.norm.mean()),
        "off more than 25 cm": percent((errors.norm > 100 * FAR_M).sum(), len(errors.norm)),
        "log-likelihood": -regions.likelihood(errors),
        REGIONS: regions.inside(errors, 0.9),
    }


def _people(one: "Beside") -> dict[str, float]:
    there = int(one.there.sum())
    return {
        "limbs' spread": 100 * _limb_spread_m(one.found_m),
        "switches": float(one.switches),
        "missed": percent(one.missed, there),
        "ghosts": percent(len(one.ghosts.t_s), there),
    }


def _limb_spread_m(found_m: Array) -> float:
    """Return how far limbs are from their own mean lengths, (person, moment, joint, 3) [m]."""
    from harness.body_parts import LIMBS

    near, far = np.array(LIMBS).T
    limbs_m = np.linalg.norm(found_m[:, :, near] - found_m[:, :, far], axis=-1)
    known = np.isfinite(limbs_m)
    usual_m = np.where(known, limbs_m, 0.0).sum(axis=1) / np.maximum(known.sum(axis=1), 1)
    off_m = (limbs_m - usual_m[:, None])[known]
    return float(np.sqrt((off_m**2).mean())) if len(off_m) else float("nan")


def _claimed(one: "Beside", rig: "Rig") -> dict[str, float]:
    """Return how often more cameras are said to support a joint than have it in their images."""
    from close import images_with

    known = one.support >= 0
    wrong = known & (one.support > images_with(one.truth_m, rig))
    return {"support too high": percent(float(wrong.sum()), float(known.sum()))}


def percent(part: float, whole: float) -> float:
    return 100.0 * float(part) / float(whole) if whole else 0.0
