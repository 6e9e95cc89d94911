"""Heights, lean and posture of bodies, from one snapshot."""

import math
from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import Bool, Float64, Shaped

from trecsim.floor_points import HIPS
from trecsim.skeleton import COCO17
from trecsim.values import Snapshot

Posture = Literal["upright", "low", "lying", "unknown"]

DOWN_HIP_M = 0.35
"""Hips below this are on the floor; those of somebody on a low seat are at 0.4 m or more."""
DOWN_HEAD_M = 0.6
"""So low is the head of somebody who lies; that of somebody who sits on the floor is at 0.75 m."""
LYING_RAD = math.radians(60.0)
"""A trunk that leans more than this from the vertical lies."""
LOW_SHARE = 0.65
"""Hips below this share of their height in standing: sitting, kneeling, crouching, crawling."""
STANDING_HIP_M = 0.9
"""Height of the hips in standing where the legs are not known."""

_HEAD = [COCO17.index(name) for name in ("nose", "left_eye", "right_eye", "left_ear", "right_ear")]
_SHOULDERS, _KNEES, _ANKLES = (
    [COCO17.index(f"{side}_{joint}") for side in ("left", "right")]
    for joint in ("shoulder", "knee", "ankle")
)
_ANKLE_M = 0.08  # height of the ankle joint above the floor


class Bodies(NamedTuple):
    """What the rules on bodies look at, for each person; NaN where no camera supports it.

    Attributes
    ----------
    hip_m
        Middle of the hips [m].
    hip_sigma_m
        Standard deviation of each of its coordinates [m].
    head_z_m, head_sigma_m
        Height of the head, and its standard deviation [m].
    trunk_rad, trunk_sigma_rad
        Lean of the trunk from the vertical, and its standard deviation [rad].
    standing_m
        Height of the hips when this person stands [m].
    """

    hip_m: Float64[np.ndarray, "person 3"]
    hip_sigma_m: Float64[np.ndarray, "person 3"]
    head_z_m: Float64[np.ndarray, " person"]
    head_sigma_m: Float64[np.ndarray, " person"]
    trunk_rad: Float64[np.ndarray, " person"]
    trunk_sigma_rad: Float64[np.ndarray, " person"]
    standing_m: Float64[np.ndarray, " person"]

    @property
    def postures(self) -> Shaped[np.ndarray, " person"]:
        """The posture of each person, as text: upright, low, lying or unknown."""
        hip_z_m = self.hip_m[:, 2]
        flat = (self.head_z_m < DOWN_HEAD_M) | (self.trunk_rad > LYING_RAD)
        low = (hip_z_m < LOW_SHARE * self.standing_m) | (self.trunk_rad > LYING_RAD)
        chosen = np.where(low, "low", "upright")
        chosen = np.where((hip_z_m < DOWN_HIP_M) & flat, "lying", chosen)
        return np.where(np.isfinite(hip_z_m), chosen, "unknown")


def bodies(snapshot: Snapshot) -> Bodies:
    """Return what rules on bodies look at; only joints that a camera supports count.

    The height of the hips in standing follows from the length of the person's own legs.
    """
    hip_m, hip_var = _middle(snapshot, HIPS)
    shoulder_m, shoulder_var = _middle(snapshot, _SHOULDERS)
    head_m, head_var = _middle(snapshot, _HEAD)
    trunk_m = shoulder_m - hip_m
    length_m = np.sqrt(np.square(trunk_m).sum(axis=1))
    lean_rad = np.arctan2(np.hypot(trunk_m[:, 0], trunk_m[:, 1]), trunk_m[:, 2])
    across = np.sqrt((hip_var + shoulder_var).mean(axis=1))
    return Bodies(
        hip_m,
        np.sqrt(hip_var),
        head_m[:, 2],
        np.sqrt(head_var[:, 2]),
        lean_rad,
        across / np.maximum(length_m, 0.1),
        _standing_m(snapshot.xyz_m),
    )


def _middle(
    snapshot: Snapshot, joints: list[int]
) -> tuple[Float64[np.ndarray, "person 3"], Float64[np.ndarray, "person 3"]]:
    """Return the mean of those joints that are supported, and its variances."""
    xyz_m = snapshot.xyz_m[:, joints]
    variance = np.diagonal(snapshot.cov_m2[:, joints], axis1=-2, axis2=-1)
    counts: Bool[np.ndarray, "person joint"] = np.isfinite(xyz_m).all(axis=-1)
    counts &= snapshot.support[:, joints] > 0
    number = counts.sum(axis=1).astype(np.float64)[:, None]
    number[number == 0.0] = np.nan
    known = np.where(counts[..., None] & np.isfinite(variance), variance, 0.0)
    mean_m = np.where(counts[..., None], xyz_m, 0.0).sum(axis=1) / number
    return mean_m, known.sum(axis=1) / np.square(number)


def _standing_m(xyz_m: Float64[np.ndarray, "person joint 3"]) -> Float64[np.ndarray, " person"]:
    """Return how high the hips are when the legs are straight; the longer leg counts."""
    leg_m = sum(
        np.sqrt(np.square(xyz_m[:, upper] - xyz_m[:, lower]).sum(axis=-1))
        for upper, lower in ((HIPS, _KNEES), (_KNEES, _ANKLES))
    )
    longer_m = np.fmax(leg_m[:, 0], leg_m[:, 1]) + _ANKLE_M
    return np.where(np.isfinite(longer_m), np.clip(longer_m, 0.4, 1.3), STANDING_HIP_M)
