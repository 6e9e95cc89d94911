"""Where people stand: one point on the floor for each, with its covariance."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float64

from trecsim.skeleton import COCO17
from trecsim.values import Snapshot

ANKLES = [COCO17.index(f"{side}_ankle") for side in ("left", "right")]
HIPS = [COCO17.index(f"{side}_hip") for side in ("left", "right")]


class FloorPoints(NamedTuple):
    """The floor point of each person; NaN where neither ankles nor hips are known.

    Attributes
    ----------
    xy_m
        On the floor [m].
    cov_m2
        Its covariance [m^2].
    """

    xy_m: Float64[np.ndarray, "person 2"]
    cov_m2: Float64[np.ndarray, "person 2 2"]


def floor_points(snapshot: Snapshot) -> FloorPoints:
    """Return the floor points of all people of a snapshot.

    The floor point is the mean of the ankles that a camera supports, dropped to the floor; where
    none is supported, the mean of the hips. The errors of the two joints count as independent.
    """
    ankles, hips = _mean_of(snapshot, ANKLES, supported=True), _mean_of(snapshot, HIPS)
    seen = np.isfinite(ankles.xy_m).all(axis=1)
    return FloorPoints(
        np.where(seen[:, None], ankles.xy_m, hips.xy_m),
        np.where(seen[:, None, None], ankles.cov_m2, hips.cov_m2),
    )


def _mean_of(snapshot: Snapshot, joints: list[int], *, supported: bool = False) -> FloorPoints:
    xy_m, cov_m2 = snapshot.xyz_m[:, joints, :2], snapshot.cov_m2[:, joints, :2, :2]
    counts: Bool[np.ndarray, "person joint"] = np.isfinite(xy_m).all(axis=-1)
    if supported:
        counts &= snapshot.support[:, joints] > 0
    number = counts.sum(axis=1).astype(np.float64)
    number[number == 0.0] = np.nan
    return FloorPoints(
        np.where(counts[..., None], xy_m, 0.0).sum(axis=1) / number[:, None],
        np.where(counts[..., None, None], cov_m2, 0.0).sum(axis=1)
        / np.square(number)[:, None, None],
    )
