"""The floor point of a person: where the feet are, seen from above."""

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.skeleton import COCO17
from trecsim.values import Snapshot

_ANKLES = [COCO17.joints.index(f"{side}_ankle") for side in ("left", "right")]
_HIPS = [COCO17.joints.index(f"{side}_hip") for side in ("left", "right")]


def floor_points(snapshot: Snapshot) -> Float64[np.ndarray, "person 2"]:
    """Return the mean of the ankles that cameras see [m], else of the hips; NaN without both."""
    return floor_points_of(snapshot.xyz_m, snapshot.support)


def floor_points_of(
    xyz_m: Float64[np.ndarray, "person joint 3"], support: Int64[np.ndarray, "person joint"]
) -> Float64[np.ndarray, "person 2"]:
    """Return the same from joints [m] and the number of cameras that support them."""
    xy_m = xyz_m[..., :2]
    ankles = np.where(support[:, _ANKLES, None] > 0, xy_m[:, _ANKLES], np.nan)
    ankle = _mean(ankles)
    return np.where(np.isnan(ankle), _mean(xy_m[:, _HIPS]), ankle)


def _mean(points_m: Float64[np.ndarray, "person joint 2"]) -> Float64[np.ndarray, "person 2"]:
    known = ~np.isnan(points_m).any(axis=2, keepdims=True)
    number = known.sum(axis=1)
    total = np.where(known, points_m, 0.0).sum(axis=1)
    return np.where(number > 0, total / np.maximum(number, 1), np.nan)
