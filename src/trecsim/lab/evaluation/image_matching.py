"""Which detection in an image shows which person, by the distance of their joints in the image."""

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.lab.evaluation.reprojection import FAR, FEWEST, NEAR

FIRM = 0.3
"""Least score of a key point that counts: below it detectors guess."""


def firm_px(
    xy_px: Float64[np.ndarray, "person joint 2"], score: Float64[np.ndarray, "person joint"]
) -> Float64[np.ndarray, "person joint 2"]:
    """Return key points, NaN where their score is too low to count [px]."""
    return np.where((score >= FIRM)[..., None], xy_px, np.nan)


def same_people(
    found_px: Float64[np.ndarray, "found joint 2"], shown_px: Float64[np.ndarray, "shown joint 2"]
) -> tuple[Int64[np.ndarray, " pair"], Int64[np.ndarray, " pair"]]:
    """Return pairs of a detection and a projected person of whom each is the nearest to the other.

    The distance is the mean over their common joints, at least three, of which each counts for at
    most half the person's size in the image. Above a quarter of that size nobody is paired.
    """
    nothing = np.empty(0, np.int64)
    if not len(found_px) or not len(shown_px):
        return nothing, nothing
    away = _away(found_px, shown_px)
    found, shown = np.arange(len(found_px)), away.argmin(axis=1)
    paired = (away.argmin(axis=0)[shown] == found) & (away[found, shown] <= NEAR)
    return found[paired], shown[paired]


def _away(
    found_px: Float64[np.ndarray, "found joint 2"], shown_px: Float64[np.ndarray, "shown joint 2"]
) -> Float64[np.ndarray, "found shown"]:
    """Return mean distances relative to the size of the person; infinite where unknown."""
    with np.errstate(all="ignore"):
        spread_px = np.fmax.reduce(shown_px, axis=1) - np.fmin.reduce(shown_px, axis=1)
        size_px = np.linalg.norm(spread_px, axis=-1)
        apart_px = np.linalg.norm(found_px[:, None] - shown_px, axis=-1)
        known = np.isfinite(apart_px)
        capped = np.where(known, np.minimum(apart_px / size_px[:, None], FAR), 0.0)
        joints = known.sum(axis=-1)
        mean: Float64[np.ndarray, "found shown"] = capped.sum(axis=-1) / joints
    return np.where(joints >= FEWEST, mean, np.inf)
