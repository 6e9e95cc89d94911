"""The people of a scene as the definitions of rules speak of them: floor points, hips, postures."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float64, Shaped

from trecsim.skeleton import COCO17

HIPS, SHOULDERS, ELBOWS, WRISTS, KNEES, ANKLES = (
    [COCO17.index(f"{side}_{joint}") for side in ("left", "right")]
    for joint in ("hip", "shoulder", "elbow", "wrist", "knee", "ankle")
)
FACE = [COCO17.index(name) for name in ("nose", "left_eye", "right_eye", "left_ear", "right_ear")]

HIPS_DOWN_M, HEAD_DOWN_M, FLAT_DEG = 0.35, 0.6, 60.0
"""Who lies has the hips below the first, and the head below the second or the trunk flatter."""
LOW_SHARE = 0.65
FOOT_M = 0.08
"""From the ankle down to the sole [m]."""
SPEED_OVER_S = 0.08  # before and after together


@dataclass(frozen=True)
class TruePerson:
    """One person of the truth.

    Attributes
    ----------
    number
        Row in the truth.
    t_s
        Times [s].
    xyz_m
        Joints [m]; NaN while the person is not there.
    """

    number: int
    t_s: Float64[np.ndarray, " time"]
    xyz_m: Float64[np.ndarray, "time 17 3"]

    @cached_property
    def there(self) -> Bool[np.ndarray, " time"]:
        """When the person is there."""
        return np.asarray(np.isfinite(self.xyz_m[:, 0, 0]))

    @cached_property
    def floor_m(self) -> Float64[np.ndarray, "time 2"]:
        """Where the person stands: between the ankles [m]."""
        return np.asarray(self.xyz_m[:, ANKLES, :2].mean(axis=1))

    @cached_property
    def hips_m(self) -> Float64[np.ndarray, "time 3"]:
        """Middle of the hips [m]."""
        return np.asarray(self.xyz_m[:, HIPS].mean(axis=1))

    @cached_property
    def trunk_deg(self) -> Float64[np.ndarray, " time"]:
        """Angle of the trunk from the vertical [degrees]."""
        trunk_m = self.xyz_m[:, SHOULDERS].mean(axis=1) - self.hips_m
        return np.asarray(np.degrees(np.arccos(trunk_m[:, 2] / np.linalg.norm(trunk_m, axis=1))))

    @cached_property
    def standing_m(self) -> Float64[np.ndarray, " time"]:
        """Height of the hips when the person stands: the longer leg, and the foot [m]."""
        thigh_m = np.linalg.norm(self.xyz_m[:, HIPS] - self.xyz_m[:, KNEES], axis=2)
        shank_m = np.linalg.norm(self.xyz_m[:, KNEES] - self.xyz_m[:, ANKLES], axis=2)
        return np.asarray((thigh_m + shank_m).max(axis=1) + FOOT_M)

    @cached_property
    def hips_down(self) -> Bool[np.ndarray, " time"]:
        """When the hips are on the floor."""
        return np.asarray(self.hips_m[:, 2] < HIPS_DOWN_M)

    @cached_property
    def head_m(self) -> Float64[np.ndarray, " time"]:
        """Height of the head: between nose, eyes and ears [m]."""
        return np.asarray(self.xyz_m[:, FACE, 2].mean(axis=1))

    @cached_property
    def lies(self) -> Bool[np.ndarray, " time"]:
        """When the person lies."""
        flat = (self.head_m < HEAD_DOWN_M) | (self.trunk_deg > FLAT_DEG)
        return np.asarray(self.hips_down & flat)

    @cached_property
    def posture(self) -> Shaped[np.ndarray, " time"]:
        """The posture at each time, as text."""
        is_low = (self.hips_m[:, 2] < LOW_SHARE * self.standing_m) | (self.trunk_deg > FLAT_DEG)
        return np.where(self.lies, "lying", np.where(is_low, "low", "upright"))

    @cached_property
    def velocity_mps(self) -> Float64[np.ndarray, "time 3"]:
        """Velocity of the hips, from just before to just after each time [m/s]."""
        out = np.full_like(self.hips_m, np.nan)
        step_s = float(np.median(np.diff(self.t_s))) if len(self.t_s) > 1 else 1.0
        half = max(1, round(0.5 * SPEED_OVER_S / step_s))
        for n in np.flatnonzero(self.there).tolist():
            begin, end = n, n
            while begin > max(n - half, 0) and self.there[begin - 1]:
                begin -= 1
            while end < min(n + half, len(self.t_s) - 1) and self.there[end + 1]:
                end += 1
            if end > begin:
                way_m = self.hips_m[end] - self.hips_m[begin]
                out[n] = way_m / (self.t_s[end] - self.t_s[begin])
        return out
