"""Errors of the calibration and of the cameras' clocks, learnt from residuals while tracking."""

import math
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float64

from trecsim.fusion import kernels
from trecsim.fusion.kernels import Cameras
from trecsim.fusion.tuning import (
    CAMERA_CHECK_S,
    CAMERA_RENEW_S,
    CAMERA_SETTLE_S,
    CLOCK_SIGMA_S,
    EYES_OF_A_POINT,
    LEAST_TURN_RAD,
    NEAR_M,
    PRIOR_WEIGHT,
    PUSHED_RAD,
    TURN_SIGMA_RAD,
)
from trecsim.geometry import Rig

_PRIOR = np.array([TURN_SIGMA_RAD**2] * 3 + [CLOCK_SIGMA_S**2])
_TURN, _DELAY = slice(0, 3), 3
_ROBUST_STEPS = 3


@dataclass(eq=False)
class CameraErrors:
    """Turn and delay of each camera, as its residuals tell.

    Of all cameras together a turn can not be told from a motion of the world: what is estimated is
    what they disagree about, with a prior about no error.

    Attributes
    ----------
    rig
        The cameras as calibrated.
    info, vector
        Normal equations, written by the kernels.
    learned_s
        Time of the image that each camera last contributed [s].
    applied
        Rotation vector [rad], in the camera's coordinates, and delay of the clock [s] in use.
    variance
        Of both, as far as residuals tell them.
    scale
        Variance of the turns relative to their prior, learnt from all cameras.
    """

    rig: Rig
    info: Float64[np.ndarray, "cam 4 4"] = field(init=False)
    vector: Float64[np.ndarray, "cam 4"] = field(init=False)
    learned_s: Float64[np.ndarray, " cam"] = field(init=False)
    applied: Float64[np.ndarray, "cam 4"] = field(init=False)
    centre_px: Float64[np.ndarray, "cam 2"] = field(init=False)
    variance: Float64[np.ndarray, "cam 4"] = field(init=False)
    scale: float = field(default=1.0, init=False)
    _calibrated: "Calibrated" = field(init=False)
    _began_s: float = field(default=math.nan, init=False)
    _used_s: float = field(default=-math.inf, init=False)

    def __post_init__(self) -> None:
        n = len(self.rig)
        self.info, self.vector = np.zeros((n, 4, 4)), np.zeros((n, 4))
        self.learned_s, self.applied = np.full(n, -np.inf), np.zeros((n, 4))
        self.variance = np.tile(_PRIOR, (n, 1))
        self._calibrated = calibrated(self.rig)
        self.centre_px = np.ascontiguousarray(self._calibrated.K[:, :2, 2])

    @property
    def known(self) -> kernels.CameraErrors:
        """What is known, as the kernels take it."""
        return kernels.CameraErrors(
            self.info, self.vector, self.learned_s, self.applied, self.centre_px
        )

    def is_due(self, t_s: float) -> bool:
        """Return whether the projections are to be corrected anew at `t_s`: often at first."""
        if not self._began_s <= t_s:
            self._began_s = t_s
        often = t_s - self._began_s < CAMERA_SETTLE_S
        due = not 0.0 <= t_s - self._used_s < (CAMERA_CHECK_S if often else CAMERA_RENEW_S)
        if due:
            self._used_s = t_s
        return due

    def corrected(self, people_m: Float64[np.ndarray, "person 3"]) -> Cameras:
        """Return the cameras with their errors taken out as far as they are known.

        Parameters
        ----------
        people_m
            Where people are, whom two cameras see [m].

        Notes
        -----
        Ridge regression per camera. Turns that together move these people without a residual are
        taken off: what is left says where the cameras disagree, and moves nobody. The common scale
        of the turns' variance follows from the turns of all cameras (one EM step for a variance
        component), so that a rig that fits badly states more uncertainty in the directions that no
        residual shows, too: of the ``2 n`` image directions of ``n`` cameras a point in space takes
        up three.
        """
        prior = _PRIOR * np.array([self.scale] * 3 + [1.0])
        cov = np.linalg.inv(self.info + np.diag(1.0 / prior))
        before_rad = np.stack([self.applied[:, 1], -self.applied[:, 0]], axis=1)
        self.applied[:] = (cov @ self.vector[..., None])[..., 0]
        self.variance[:] = cov[:, range(4), range(4)]
        self.applied[:, _DELAY] -= np.median(self.applied[:, _DELAY])
        if len(people_m):
            is_known = self.variance[:, 1] < 0.5 * prior[1]
            self._keep_place(people_m.mean(axis=0), is_known, before_rad)
        spread = self.applied[:, _TURN] ** 2 + self.variance[:, _TURN]
        total = float(spread.sum()) / TURN_SIGMA_RAD**2
        self.scale = (PRIOR_WEIGHT + total) / (PRIOR_WEIGHT + spread.size)
        hidden = min(1.0, EYES_OF_A_POINT / len(self.rig)) * self.scale * TURN_SIGMA_RAD**2
        left = np.maximum(self.variance[:, :2].mean(axis=1), hidden) + LEAST_TURN_RAD**2
        return projections(self._calibrated, self.applied[:, _TURN], left)

    def _keep_place(
        self,
        xyz_m: Float64[np.ndarray, "3"],
        is_known: Bool[np.ndarray, " cam"],
        before_rad: Float64[np.ndarray, "cam 2"],
    ) -> None:
        """Take off the turns by which a motion of the point `xyz_m` explains most of them.

        Each camera counts by its information, as it does where joints are fitted, but the less the
        more it is turned: that one camera was pushed is likelier than that all the others were.
        `is_known` tells of which cameras the turns are known; `before_rad` is what was applied so
        far, from which the few steps go on.
        """
        R, t = self._calibrated.pose[:, :, :3], self._calibrated.pose[:, :, 3]
        there_m = R @ xyz_m + t
        known = np.flatnonzero(is_known & (there_m[:, 2] > NEAR_M))
        if len(known) < 2:
            return
        image = there_m[known, :2] / there_m[known, 2:]
        # Derivative of the normalised image by the place, and what the turns move it.
        moves = (R[known, :2] - image[..., None] * R[known, 2:]) / there_m[known, 2:, None]
        turn = np.stack([self.applied[known, 1], -self.applied[known, 0]], axis=1)
        info = np.stack([self.info[known, 1, 1], self.info[known, 0, 0]], axis=1)
        flat, rest = moves.reshape(-1, 3), before_rad[known]
        for _ in range(_ROBUST_STEPS):
            doubt = np.hypot(1.0, np.sqrt((rest**2).sum(axis=1)) / PUSHED_RAD)
            weighted = flat.T * (info / doubt[:, None]).ravel()
            A = weighted @ flat
            A += 1e-9 * np.trace(A) * np.eye(3)  # all cameras may stand in one place
            rest = turn - moves @ np.linalg.solve(A, weighted @ turn.ravel())
        self.applied[known, 1], self.applied[known, 0] = rest[:, 0], -rest[:, 1]


class Calibrated(NamedTuple):
    """The cameras as calibrated, as arrays in C order.

    Attributes
    ----------
    K, pose
        Intrinsics [px], and the world's motion into each camera's coordinates.
    position_m
        Where each camera stands.
    """

    K: Float64[np.ndarray, "cam 3 3"]
    pose: Float64[np.ndarray, "cam 3 4"]
    position_m: Float64[np.ndarray, "cam 3"]


def calibrated(rig: Rig) -> Calibrated:
    """Return the cameras of a rig as arrays."""
    return Calibrated(
        np.array([camera.K for camera in rig], order="C"),
        np.array([camera.T_cam_world[:3] for camera in rig], order="C"),
        np.array([camera.position_m for camera in rig], order="C"),
    )


def uncorrected(rig: Rig) -> Cameras:
    """Return the cameras as calibrated, with the usual error of a calibration."""
    n = len(rig)
    return projections(calibrated(rig), np.zeros((n, 3)), np.full(n, TURN_SIGMA_RAD**2))


def projections(
    as_calibrated: Calibrated,
    turn_rad: Float64[np.ndarray, "cam 3"],
    error_rad2: Float64[np.ndarray, " cam"],
) -> Cameras:
    """Return the cameras turned by small rotation vectors, with the variance of their angles."""
    K, pose, position_m = as_calibrated
    P = np.ascontiguousarray(K @ _rotations(turn_rad) @ pose)
    focal_px = 0.5 * (K[:, 0, 0] + K[:, 1, 1])
    return Cameras(
        P=P,
        focal_px=focal_px,
        ray_of=np.ascontiguousarray(np.linalg.inv(P[:, :, :3])),
        position_m=position_m,
        error_px2=focal_px**2 * error_rad2,
    )


def _rotations(turn_rad: Float64[np.ndarray, "cam 3"]) -> Float64[np.ndarray, "cam 3 3"]:
    """Return the rotations by rotation vectors (Rodrigues)."""
    angle = np.sqrt((turn_rad**2).sum(axis=1))
    cross = np.zeros((len(turn_rad), 3, 3))
    cross[:, [2, 0, 1], [1, 2, 0]] = turn_rad / np.maximum(angle, 1e-12)[:, None]
    cross -= cross.swapaxes(1, 2)
    sin, cos = np.sin(angle)[:, None, None], np.cos(angle)[:, None, None]
    return np.asarray(np.eye(3) + sin * cross + (1.0 - cos) * cross @ cross)
