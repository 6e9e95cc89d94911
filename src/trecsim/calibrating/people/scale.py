"""Where the scale of a rig comes from, and how sure it is."""

from dataclasses import dataclass

import numpy as np

from trecsim.calibrating.people.tuning import STATURE_M, STATURE_SD_M
from trecsim.calibrating.people.world import Bodies
from trecsim.calibrating.result import Finding

ANATOMY = 0.01  # proportions of bodies differ by so much
UNEQUAL_M = 0.15  # statures of people found that differ by more may be of wrong chains


@dataclass(frozen=True, slots=True)
class Scale:
    """Metres per unit of the adjustment.

    Attributes
    ----------
    factor
        Metres per unit.
    sd
        Its standard deviation, as a share.
    finding
        What is said of it.
    """

    factor: float
    sd: float
    finding: Finding


def from_distance(metres: float) -> Scale:
    """Return the scale of an adjustment in which a distance was pinned."""
    text = f"the scale comes from the given distance of {metres:g} m between two cameras"
    return Scale(1.0, max(0.001, 0.002 / metres), Finding("good", text))


def from_stature(found: Bodies, stature_m: float | None) -> Scale:
    """Return the scale that gives the people a mean stature."""
    people = max(1, int(np.isfinite(found.stature_m).sum()))
    mean_m = found.mean_stature_m
    factor = (stature_m or STATURE_M) / mean_m if np.isfinite(mean_m) else 1.0
    if stature_m is not None:
        text = f"the scale comes from the given mean stature of {stature_m:g} m, about 1.5 %"
        return Scale(factor, 0.015, Finding("good", text))
    sd = float(np.hypot(STATURE_SD_M / STATURE_M / np.sqrt(people), ANATOMY))
    count = "one person" if people == 1 else f"{people} people"
    text = (
        f"the scale is a guess from {count} taken to be {STATURE_M:g} m tall: all distances may be "
        f"off by {sd:.1%} (one standard deviation); give --distance between two cameras, or "
        "--stature-m"
    )
    return Scale(factor, sd, Finding("usable", text))
