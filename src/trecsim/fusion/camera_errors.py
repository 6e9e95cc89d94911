"""Errors of the calibration and of the cameras' clocks, learnt from residuals while tracking."""

import math
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from jaxtyping import Float64

from trecsim.fusion import kernels
from trecsim.fusion.kernels import Cameras
from trecsim.fusion.tuning import (
    CAMERA_CHECK_S,
    CAMERA_RENEW_S,
    CAMERA_SETTLE_S,
    CLOCK_SIGMA_S,
    PUSH_SIGMA_RAD,
    TURN_SIGMA_RAD,
)
from trecsim.geometry import Rig

_TURN = slice(0, 3)


@dataclass(eq=False)
class CameraErrors:
    """Turn and delay of each camera, as its residuals tell.

    Of all cameras together a turn can hardly be told from a motion of the world: what is estimated
    is what they disagree about, with a prior about no error.

    Attributes
    ----------
    rig
        The cameras as calibrated.
    info, vector
        Normal equations of all cameras, written by the kernels.
    learned_s
        Time of the newest image that contributed [s].
    found, variance
        Rotation vector [rad], in the camera's coordinates, and delay of the clock [s], and the
        variances of both, as residuals tell them.
    applied
        What of it is in use.
    scale
        Variance of the turns relative to their prior, learnt from all cameras.
    """

    rig: Rig
    info: Float64[np.ndarray, "cam 4 cam 4"] = field(init=False)
    vector: Float64[np.ndarray, "cam 4"] = field(init=False)
    learned_s: Float64[np.ndarray, "1"] = field(init=False)
    found: Float64[np.ndarray, "cam 4"] = field(init=False)
    applied: Float64[np.ndarray, "cam 4"] = field(init=False)
    centre_px: Float64[np.ndarray, "cam 2"] = field(init=False)
    variance: Float64[np.ndarray, "cam 4"] = field(init=False)
    scale: float = field(default=1.0, init=False)
    _calibrated: "Calibrated" = field(init=False)
    _began_s: float = field(default=math.nan, init=False)
    _used_s: float = field(default=-math.inf, init=False)

    def __post_init__(self) -> None:
        n = len(self.rig)
        self.info, self.vector = np.zeros((n, 4, n, 4)), np.zeros((n, 4))
        self.learned_s = np.full(1, -np.inf)
        self.found, self.applied = np.zeros((n, 4)), np.zeros((n, 4))
        self.variance = np.tile([TURN_SIGMA_RAD**2] * 3 + [CLOCK_SIGMA_S**2], (n, 1))
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

    def push(self, camera: int, turn_rad: Float64[np.ndarray, " 2"]) -> None:
        """Forget what is known of a camera, and begin with a turn about its x and y axes.

        For a camera that was knocked: its key points are outliers to the tracks, so that residuals
        of those that are used would hardly tell. What follows refines the turn, or forgets it.

        Parameters
        ----------
        camera
            Its place in the rig.
        turn_rad
            The turn, in the camera's coordinates [rad].
        """
        self.info[camera], self.info[:, :, camera] = 0.0, 0.0
        self.vector[camera] = 0.0
        for axis, turn in enumerate(turn_rad.tolist()):
            self.info[camera, axis, camera, axis] = 1.0 / PUSH_SIGMA_RAD**2
            self.vector[camera, axis] = turn / PUSH_SIGMA_RAD**2
        self._used_s = -math.inf

    def corrected(self) -> Cameras:
        """Return the cameras with their errors taken out as far as they are known.

        Notes
        -----
        Ridge regression of all cameras together; turns that move people without a residual are
        left to the prior. Its variance grows with the size of the error last found, as under an L1
        norm: one camera that was pushed is preferred to small turns of all the others. The common
        scale of the turns' variance follows from the turns of all cameras (one EM step for a
        variance component), so that a rig that fits badly states more uncertainty in the directions
        that no residual shows, too: of the ``2 n`` image directions of ``n`` cameras a point in
        space takes up three.
        """
        n, (K, pose, position_m, focal_px) = len(self.vector), self._calibrated
        P, ray_of, error_px2 = np.empty((n, 3, 4)), np.empty((n, 3, 3)), np.empty(n)
        self.scale = kernels.correct_all(
            (self.info, self.vector), (self.found, self.variance, self.applied), self.scale,
            (K, pose, focal_px), (P, ray_of, error_px2),
        )  # fmt: skip
        return Cameras(P, focal_px, ray_of, position_m, error_px2)


class Calibrated(NamedTuple):
    """The cameras as calibrated, as arrays in C order.

    Attributes
    ----------
    K, pose
        Intrinsics [px], and the world's motion into each camera's coordinates.
    position_m, focal_px
        Where each camera stands, and its mean focal length [px].
    """

    K: Float64[np.ndarray, "cam 3 3"]
    pose: Float64[np.ndarray, "cam 3 4"]
    position_m: Float64[np.ndarray, "cam 3"]
    focal_px: Float64[np.ndarray, " cam"]


def calibrated(rig: Rig) -> Calibrated:
    """Return the cameras of a rig as arrays."""
    return Calibrated(
        np.array([camera.K for camera in rig], order="C"),
        np.array([camera.T_cam_world[:3] for camera in rig], order="C"),
        np.array([camera.position_m for camera in rig], order="C"),
        np.array([0.5 * (camera.K[0, 0] + camera.K[1, 1]) for camera in rig]),
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
    K, pose, position_m, focal_px = as_calibrated
    P = np.ascontiguousarray(K @ _rotations(turn_rad) @ pose)
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
