"""Where people stand: one point on the floor for each, and its covariance.

The floor point is the mean of the ankles that a camera supports, dropped to the floor; where none
is supported, the mean of the hips.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.skeleton import COCO17
from trecsim.values import Snapshot

ANKLES = [COCO17.index(f"{side}_ankle") for side in ("left", "right")]
HIPS = [COCO17.index(f"{side}_hip") for side in ("left", "right")]
_JOINTS = [*ANKLES, *HIPS]


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
    """Return the floor points of all people; errors of two joints count as independent."""
    weights = _weights(snapshot.xyz_m, snapshot.support)
    cov_m2 = snapshot.cov_m2[:, _JOINTS, :2, :2]
    return FloorPoints(
        _weighted(weights, snapshot.xyz_m[:, _JOINTS, :2]), _weighted(weights**2, cov_m2)
    )


def floor_xy(
    xyz_m: Float64[np.ndarray, "person joint 3"], support: Int64[np.ndarray, "person joint"]
) -> Float64[np.ndarray, "person 2"]:
    """Return the floor points [m] alone, from joints [m] and how many cameras support each."""
    return _weighted(_weights(xyz_m, support), xyz_m[:, _JOINTS, :2])


def _weights(
    xyz_m: Float64[np.ndarray, "person joint 3"], support: Int64[np.ndarray, "person joint"]
) -> Float64[np.ndarray, "person 4"]:
    """Return by how much each ankle and hip counts; NaN where none does."""
    known = np.isfinite(xyz_m[:, _JOINTS, :2]).all(axis=-1)
    ankles = known[:, :2] & (support[:, ANKLES] > 0)
    hips = known[:, 2:] & ~ankles.any(axis=1, keepdims=True)
    counts = np.concatenate([ankles, hips], axis=1).astype(np.float64)
    number = counts.sum(axis=1, keepdims=True)
    number[number == 0.0] = np.nan
    return np.asarray(counts / number)


def _weighted(
    weights: Float64[np.ndarray, "person 4"], values: Float64[np.ndarray, "person 4 *axes"]
) -> Float64[np.ndarray, "person *axes"]:
    shape = (*weights.shape, *(1,) * (values.ndim - 2))
    by = weights.reshape(shape)
    return np.asarray((by * np.where(by == 0.0, 0.0, values)).sum(axis=1))


def path_xy(
    xyz_m: Float64[np.ndarray, "person joint 3"], support: Int64[np.ndarray, "person joint"]
) -> Float64[np.ndarray, "person 2"]:
    """Return the point on the floor whose path is forecast [m].

    It is the mean of the hips that a camera supports, dropped to the floor; where none is
    supported, the floor point. In walking the mean of the ankles stops and starts with each step,
    and its speed over 0.4 s says little; hips move nearly evenly.
    """
    hips_m = xyz_m[:, HIPS, :2]
    counts = (support[:, HIPS] > 0) & np.isfinite(hips_m).all(axis=-1)
    number = counts.sum(axis=1)[:, None]
    middle_m = np.where(counts[..., None], hips_m, 0.0).sum(axis=1) / np.maximum(number, 1)
    return np.where(number > 0, middle_m, floor_xy(xyz_m, support))
