"""How far away somebody is whom a single camera sees: from the size of the body and the ground.

All joints are placed in the upright plane across the line of sight. In it, lengths and heights are
proportional to the distance of the plane, so that each limb, and the ground, measure one number.
"""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float64, Int64

from trecsim.fusion.birth import rays
from trecsim.fusion.body import contact_height_m
from trecsim.fusion.images import Detections
from trecsim.fusion.model import Model
from trecsim.fusion.population import Population
from trecsim.fusion.tuning import (
    FORESHORTENED,
    KNOWN_RATE_MPS,
    RANGE_ACCEL_M2PS3,
    RANGE_DRIFT2_PER_S,
    RANGE_GATE,
    RANGE_MEMORY_S,
    RANGE_SPEED_MPS,
    SAME_S,
    SIZE_NOISE,
    SIZE_SPREAD,
    SOLE_NOISE_M,
    STEP_NOISE_M,
    WALK_NOISE_S,
)

# A ray that is steeper leads to no distance along the ground: its horizontal part.
_STEEPEST = 0.1
# The limbs that are across the line of sight of somebody who stands or walks.
_UPRIGHT = (("shoulder", "hip"), ("hip", "knee"), ("knee", "ankle"))
# Entries of a filter's state.
_LOG, _RATE, _SIZE, _LEVEL = range(4)


@dataclass(frozen=True, slots=True, eq=False)
class Sizes:
    """What detections tell of distances, each by itself; NaN where it tells nothing.

    Attributes
    ----------
    at_one_m
        The joints, from the camera, on the upright plane at the horizontal distance of 1 m.
    size_m
        Distance at which the body has the usual size.
    drop, drop_scale
        How far the ankles are below the camera at 1 m, and by how much their standard deviation
        exceeds that of good key points.
    n_ankle
        How many they are.
    """

    at_one_m: Float64[np.ndarray, "person joint 3"]
    size_m: Float64[np.ndarray, " person"]
    drop: Float64[np.ndarray, " person"]
    drop_scale: Float64[np.ndarray, " person"]
    n_ankle: Int64[np.ndarray, " person"]


@lru_cache(maxsize=8)
def _parts(joints: tuple[str, ...], bones: tuple[tuple[int, int], ...]) -> tuple[list[int], ...]:
    """Return the upright limbs among the bones, and the ankles among the joints."""
    kinds = [name.rpartition("_")[2] for name in joints]
    upright = [
        i for i, (a, b) in enumerate(bones)
        if (kinds[a], kinds[b]) in _UPRIGHT or (kinds[b], kinds[a]) in _UPRIGHT
    ]  # fmt: skip
    return upright, [j for j, kind in enumerate(kinds) if kind == "ankle"]


def sizes(model: Model, found: Detections) -> Sizes:
    """Return what detections tell of the distance of their people.

    Notes
    -----
    With ``h`` the horizontal direction to a person and ``r_k`` the ray of joint ``k``, the plane at
    the horizontal distance ``D`` has the joint at ``o + D r_k / (r_k h)``. A limb of usual length
    ``L`` and of length ``c`` at distance 1 says ``D = L / c``. One that is turned towards the
    camera or away from it is shorter in the image and says too much; those that say much more than
    the second nearest are left out. Of two ankles the mean logarithm counts: one foot is before
    the body, the other one behind it.
    """
    upright, ankles = _parts(model.skeleton.joints, tuple(map(tuple, model.bones.joints.tolist())))
    ray = rays(model, found)
    with np.errstate(invalid="ignore", divide="ignore"):
        level = np.nansum(ray[..., :2], axis=1)  # NaN below, where there is no ray at all
        level /= np.linalg.norm(level, axis=-1, keepdims=True)
        ahead = np.einsum("dja,da->dj", ray[..., :2], level)
        ahead[~(ahead > _STEEPEST)] = np.nan
        at_one_m = ray / ahead[..., None]
        first, second = model.bones.joints[upright].T
        length = np.linalg.norm(at_one_m[:, first] - at_one_m[:, second], axis=-1)
        usual_m = np.broadcast_to(model.bones.length_m[upright], length.shape)
        says_m = usual_m / length
        second_m = np.sort(says_m, axis=1)[:, 1:2]  # NaN if it is not there
        across = says_m <= FORESHORTENED * second_m
        size_m = np.where(across, usual_m, 0.0).sum(axis=1) / np.where(across, length, 0.0).sum(
            axis=1
        )
        drop = np.log(-at_one_m[:, ankles, 2])
    n_ankle = np.isfinite(drop).sum(axis=1)
    several = np.maximum(n_ankle, 1)
    scale = np.where(np.isfinite(drop), found.sigma_scale[:, ankles], 0.0).sum(axis=1) / several
    mean = np.where(np.isfinite(drop), drop, 0.0).sum(axis=1) / several
    drop_at_one_m = np.where(n_ankle > 0, np.exp(mean), np.nan)
    return Sizes(at_one_m, size_m, drop_at_one_m, scale, n_ankle)


class Known(NamedTuple):
    """What is known of a person's distance when it begins to be measured: means and variances.

    Attributes
    ----------
    log_m, log_m2, rate, rate2
        Logarithm of the distance, and its rate [1/s].
    size, size2, level2
        Lasting relative errors of the distances that size and ground tell.
    """

    log_m: float
    log_m2: float
    rate: float
    rate2: float
    size: float
    size2: float
    level2: float


@dataclass(eq=False)
class Ranges:
    """Kalman filters of how far people are from the camera that sees them.

    Attributes
    ----------
    cam
        The camera.
    mean, cov
        Logarithm of the horizontal distance, its rate [1/s], and the lasting relative errors of
        the distances that size and ground tell.
    agree
        Whether all that was told so far of each distance was believed.

    Notes
    -----
    Body and ground are not those that are assumed; both errors last. As they are part of the state,
    its covariance says how far the distance may be off after any time and way. Other errors, of
    gait and posture, last as long as a step.
    """

    cam: Int64[np.ndarray, " track"]
    mean: Float64[np.ndarray, "track 4"]
    cov: Float64[np.ndarray, "track 4 4"]
    agree: Bool[np.ndarray, " track"]

    def __len__(self) -> int:
        """Return the number of filters."""
        return len(self.cam)

    @classmethod
    def none(cls) -> "Ranges":
        """Return no filter."""
        return cls(np.empty(0, np.int64), np.empty((0, 4)), np.empty((0, 4, 4)), np.empty(0, bool))

    def keep(self, which: Bool[np.ndarray, " track"]) -> "Ranges":
        """Return only the filters that `which` marks."""
        return Ranges(self.cam[which], self.mean[which], self.cov[which], self.agree[which])

    def joined(self, other: "Ranges") -> "Ranges":
        """Return both as one."""
        return Ranges(
            np.concatenate([self.cam, other.cam]),
            np.concatenate([self.mean, other.mean]),
            np.concatenate([self.cov, other.cov]),
            np.concatenate([self.agree, other.agree]),
        )

    @property
    def sigma(self) -> Float64[np.ndarray, " track"]:
        """Standard deviation of each distance, as a share of it."""
        return np.asarray(np.sqrt(self.cov[:, _LOG, _LOG]))

    @property
    def rate_sigma(self) -> Float64[np.ndarray, " track"]:
        """Standard deviation of each rate [1/s]."""
        return np.asarray(np.sqrt(self.cov[:, _RATE, _RATE]))

    def set(self, k: int, log_m: float, rate: float, sigma: float) -> None:
        """Begin anew with a distance from another source, in place; lasting errors stay."""
        self.mean[k, [_LOG, _RATE]] = log_m, rate
        self.cov[k, [_LOG, _RATE]] = 0.0
        self.cov[k][:, [_LOG, _RATE]] = 0.0
        self.cov[k, _LOG, _LOG] = sigma**2
        self.cov[k, _RATE, _RATE] = (RANGE_SPEED_MPS * math.exp(-log_m)) ** 2

    def stay(self, k: int, log_m: float, rate: float, elapsed_s: float) -> None:
        """Take over a distance that nothing has measured, in place; it becomes less sure."""
        before = self.cov[k, _LOG, _LOG] + RANGE_DRIFT2_PER_S * elapsed_s
        self.set(k, log_m, rate, math.sqrt(before))
        self.cov[k, _RATE, _RATE] = (KNOWN_RATE_MPS * math.exp(-log_m)) ** 2

    def predict(self, elapsed_s: float) -> None:
        """Move on in time, in place."""
        kept = math.exp(-elapsed_s / RANGE_MEMORY_S)
        F = np.eye(4)
        F[_LOG, _RATE], F[_RATE, _RATE] = elapsed_s, kept
        self.mean[:] = self.mean @ F.T
        self.cov[:] = F @ self.cov @ F.T
        self.cov[:, _RATE, _RATE] += (
            RANGE_ACCEL_M2PS3 * elapsed_s * np.exp(-2.0 * self.mean[:, _LOG])
        )

    def measure(self, k: int, log_m: float, var: float, lasting: int) -> None:
        """Take in a distance, in place: ``log_m`` is the state's and its lasting error.

        One that is off by more than `RANGE_GATE` standard deviations is left out.
        """
        if not math.isfinite(log_m):
            return
        P = self.cov[k]
        h = np.zeros(4)
        h[[_LOG, lasting]] = 1.0
        off, spread = log_m - h @ self.mean[k], h @ P @ h + var
        if off * off > RANGE_GATE**2 * spread:
            self.agree[k] = False
            return
        gain = P @ h / spread
        self.mean[k] += gain * off
        self.cov[k] = P - np.outer(gain, gain) * spread

    def look(
        self,
        k: int,
        told: Sizes,
        d: int,
        above_m: float,
        since_s: float,
    ) -> None:
        """Take in what detection `d` tells of person `k`, in place.

        Parameters
        ----------
        k, told, d
            The person, and what the detections tell.
        above_m
            Height of the camera above an ankle that stands on the ground as it is assumed [m].
        since_s
            Time since the last detection of this person [s].
        """
        again = max(1.0, WALK_NOISE_S / max(since_s, 1e-3))
        self.measure(k, math.log(told.size_m[d]), SIZE_NOISE**2 * again, _SIZE)
        if told.drop[d] > 0.0 and above_m > 0.0:
            step_m = STEP_NOISE_M[0 if told.n_ankle[d] == 1 else 1]
            noise = (SOLE_NOISE_M * told.drop_scale[d] / above_m) ** 2
            noise += (step_m * math.exp(-self.mean[k, _LOG])) ** 2
            self.measure(k, math.log(above_m / told.drop[d]), noise * again, _LEVEL)

    @classmethod
    def known(cls, cam: int, known: Known) -> "Ranges":
        """Return the filter of one person whom two cameras have measured until now."""
        mean = np.array([[known.log_m, known.rate, known.size, 0.0]])
        cov = np.diag([known.log_m2, known.rate2, known.size2, known.level2])[None]
        return cls(np.array([cam]), mean, cov, np.ones(1, bool))

    @classmethod
    def begun(
        cls, cam: Int64[np.ndarray, " track"], log_m: Float64[np.ndarray, " track"],
        level_spread: Float64[np.ndarray, " track"],
    ) -> "Ranges":  # fmt: skip
        """Return filters that know nothing yet but a rough distance.

        `level_spread` is the relative spread of the distance that the ground tells.
        """
        n = len(cam)
        mean, cov = np.zeros((n, 4)), np.zeros((n, 4, 4))
        mean[:, _LOG] = log_m
        cov[:, _LOG, _LOG] = 1.0
        cov[:, _RATE, _RATE] = RANGE_SPEED_MPS**2 * np.exp(-2.0 * log_m)
        cov[:, _SIZE, _SIZE] = SIZE_SPREAD**2
        cov[:, _LEVEL, _LEVEL] = level_spread**2
        return cls(cam, mean, cov, np.isfinite(log_m))


def upright_bones(model: Model) -> list[int]:
    """Return which of the skeleton's bones are across the line of sight of who stands or walks."""
    return _parts(model.skeleton.joints, tuple(map(tuple, model.bones.joints.tolist())))[0]


def above_ankle_m(model: Model, cam: int, level_m: float) -> float:
    """Return how high a camera is above an ankle that stands on the ground [m]."""
    ankle = [j for j, name in enumerate(model.skeleton.joints) if name.endswith("ankle")]
    height_m = contact_height_m(model.skeleton)[ankle].mean() if ankle else 0.0
    return float(model.cameras.position_m[cam, 2] - height_m - level_m)


def believed(
    people: Population, k: int, found: Detections, flip: int, mirror: Int64[np.ndarray, " joint"]
) -> Detections:
    """Return one detection with only the key points that support joints of person `k`.

    `flip` is 1 if the detection has left and right exchanged.
    """
    supports = people.joint_last_seen_s[k, :, found.cam[0]] >= found.t_s[0] - SAME_S
    if flip:
        supports = supports[mirror]
    xy_px = np.where(supports[:, None], found.xy_px, np.nan)
    return Detections(found.cam, found.t_s, xy_px, found.sigma_scale, found.claim)
