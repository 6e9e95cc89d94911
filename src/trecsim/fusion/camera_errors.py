"""Errors of the calibration and of the cameras' clocks, learnt from residuals while tracking."""

from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float64

from trecsim.fusion import kernels
from trecsim.fusion.kernels import Cameras
from trecsim.fusion.tuning import (
    CLOCK_SIGMA_S,
    EYES_OF_A_POINT,
    LEAST_TURN_RAD,
    PRIOR_WEIGHT,
    PUSHED_RAD,
    TURN_SIGMA_RAD,
)
from trecsim.geometry import Camera, Rig

_PRIOR = np.array([TURN_SIGMA_RAD**2] * 3 + [CLOCK_SIGMA_S**2])
_TURN, _DELAY = slice(0, 3), 3
_ROBUST_STEPS = 10


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

    def __post_init__(self) -> None:
        n = len(self.rig)
        self.info, self.vector = np.zeros((n, 4, 4)), np.zeros((n, 4))
        self.learned_s, self.applied = np.full(n, -np.inf), np.zeros((n, 4))
        self.variance = np.tile(_PRIOR, (n, 1))
        self.centre_px = np.array([camera.K[:2, 2] for camera in self.rig])

    @property
    def known(self) -> kernels.CameraErrors:
        """What is known, as the kernels take it."""
        return kernels.CameraErrors(
            self.info, self.vector, self.learned_s, self.applied, self.centre_px
        )

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
        self.applied[:] = np.einsum("cij,cj->ci", cov, self.vector)
        self.variance[:] = np.diagonal(cov, axis1=1, axis2=2)
        self.applied[:, _DELAY] -= np.median(self.applied[:, _DELAY])
        if len(people_m):
            self._keep_place(people_m.mean(axis=0), np.diagonal(cov, axis1=1, axis2=2) / prior)
        spread = self.applied[:, _TURN] ** 2 + np.diagonal(cov, axis1=1, axis2=2)[:, _TURN]
        n = spread.size
        total = float((spread / TURN_SIGMA_RAD**2).sum())
        self.scale = (PRIOR_WEIGHT + total) / (PRIOR_WEIGHT + n)
        hidden = min(1.0, EYES_OF_A_POINT / len(self.rig)) * self.scale * TURN_SIGMA_RAD**2
        left = np.maximum(0.5 * (cov[:, 0, 0] + cov[:, 1, 1]), hidden) + LEAST_TURN_RAD**2
        return projections(self.rig, self.applied[:, _TURN], left)

    def _keep_place(
        self, xyz_m: Float64[np.ndarray, "3"], unknown: Float64[np.ndarray, "cam 4"]
    ) -> None:
        """Take off the turns by which a motion of the point `xyz_m` explains most of them.

        Each camera counts by its information, as it does where joints are fitted, but the less the
        more it is turned: that one camera was pushed is likelier than that all the others were.
        `unknown` is the share of the prior variance that is left.
        """
        known = np.flatnonzero(unknown[:, 1] < 0.5)
        if len(known) < 2:
            return
        moves = np.stack([_image_motion(self.rig.cameras[c], xyz_m) for c in known])
        turn = np.stack([self.applied[known, 1], -self.applied[known, 0]], axis=1)
        info = np.stack([self.info[known, 1, 1], self.info[known, 0, 0]], axis=1)
        rest = turn
        for _ in range(_ROBUST_STEPS):
            doubt = np.hypot(1.0, np.linalg.norm(rest, axis=1) / PUSHED_RAD)
            weight = np.sqrt(info / doubt[:, None])
            motion_m = np.linalg.lstsq(
                (weight[..., None] * moves).reshape(-1, 3), (weight * turn).ravel(), rcond=None
            )[0]
            rest = turn - moves @ motion_m
        self.applied[known, 1], self.applied[known, 0] = rest[:, 0], -rest[:, 1]


def _image_motion(camera: Camera, xyz_m: Float64[np.ndarray, "3"]) -> Float64[np.ndarray, "2 3"]:
    """Return the derivative of a point's normalised image by its place [1/m]."""
    R = camera.T_cam_world[:3, :3]
    x, y, z = R @ xyz_m + camera.T_cam_world[:3, 3]
    return np.asarray(np.stack([R[0] - x / z * R[2], R[1] - y / z * R[2]]) / z)


def uncorrected(rig: Rig) -> Cameras:
    """Return the cameras as calibrated, with the usual error of a calibration."""
    n = len(rig)
    return projections(rig, np.zeros((n, 3)), np.full(n, TURN_SIGMA_RAD**2))


def projections(
    rig: Rig, turn_rad: Float64[np.ndarray, "cam 3"], error_rad2: Float64[np.ndarray, " cam"]
) -> Cameras:
    """Return the cameras turned by small rotation vectors, with the variance of their angles."""
    P = np.array(
        [
            camera.K @ _rotation(turn) @ camera.T_cam_world[:3]
            for camera, turn in zip(rig, turn_rad, strict=True)
        ],
        order="C",
    )
    focal_px = np.array([0.5 * (c.K[0, 0] + c.K[1, 1]) for c in rig])
    return Cameras(
        P=P,
        focal_px=focal_px,
        ray_of=np.array(np.linalg.inv(P[:, :, :3]), order="C"),
        position_m=np.stack([camera.position_m for camera in rig]),
        error_px2=focal_px**2 * error_rad2,
    )


def _rotation(turn_rad: Float64[np.ndarray, "3"]) -> Float64[np.ndarray, "3 3"]:
    """Return the rotation by a rotation vector (Rodrigues)."""
    angle = float(np.linalg.norm(turn_rad))
    x, y, z = turn_rad / max(angle, 1e-12)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross)
