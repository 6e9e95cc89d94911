"""Simulated cameras: pose, field of view and lens."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float64

from trecsim.errors import InputError
from trecsim.geometry.camera import Camera
from trecsim.geometry.distortion import DistortionModel, lens
from trecsim.geometry.rigid import rotation_matrix

LensName = Literal["pinhole", "brown", "fisheye"]
LENSES: dict[LensName, tuple[DistortionModel, tuple[float, ...]]] = {
    "pinhole": ("none", ()),
    "brown": ("brown", (-0.28, 0.09, 0.0006, -0.0004, -0.008)),
    "fisheye": ("fisheye", (0.02, -0.012, 0.004, -0.001)),
}
"""Typical distortion of each kind of lens: a surveillance camera, a cheap wide-angle one."""

NARROWEST_DEG, WIDEST_DEG = 5.0, 170.0
STEEP = 1e-6  # a camera that faces straight down has +y of the world at the top of its image


@dataclass(frozen=True, slots=True)
class Make:
    """Make of a camera: image, field of view and lens.

    Attributes
    ----------
    size_px
        Image width and height [px].
    view_deg
        Horizontal field of view through the lens [degrees].
    lens
        `pinhole`, `brown` (a usual lens) or `fisheye`.
    distortion
        Distortion coefficients; typical ones if empty.
    """

    size_px: tuple[int, int] = (1920, 1080)
    view_deg: float = 80.0
    lens: LensName = "pinhole"
    distortion: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        if not NARROWEST_DEG <= self.view_deg <= WIDEST_DEG:
            raise InputError(
                f"a camera sees from {NARROWEST_DEG:g} to {WIDEST_DEG:g} degrees, "
                f"got view_deg = {self.view_deg:g}"
            )

    def camera(
        self,
        name: str,
        T_cam_world: Float64[np.ndarray, "4 4"],
        time_offset_s: float = 0.0,
    ) -> Camera:
        """Return one camera of this make.

        Parameters
        ----------
        name
            Unique within a rig.
        T_cam_world
            Where it is and looks; see :func:`look_at`.
        time_offset_s
            What has to be added to its time stamps [s].

        Raises
        ------
        CalibrationError
            Coefficients or an image that cannot be.
        InputError
            A lens that does not see as wide as it should.

        Examples
        --------
        >>> T_cam_world = look_at(np.array([0.0, -3.0, 2.0]), np.array([0.0, 0.0, 1.0]))
        >>> camera = Make(view_deg=90.0).camera("north", T_cam_world)
        >>> float(camera.K[0, 0].round(9))
        960.0
        """
        model, usual = LENSES[self.lens]
        coefficients = np.array(self.distortion or usual, dtype=np.float64)
        width_px, height_px = self.size_px
        # Built once with any focal length so that invalid coefficients are refused here.
        K = np.array([[1.0, 0.0, (width_px - 1) / 2], [0.0, 1.0, (height_px - 1) / 2], [0, 0, 1]])
        Camera(name, self.size_px, K, T_cam_world, model, coefficients, time_offset_s)
        border = np.array([np.tan(np.radians(self.view_deg / 2)), 0.0])
        bent = float(lens(model, coefficients).distort(border)[0])
        if not bent > 0:
            raise InputError(
                f"camera {name!r}: its lens ({self.lens}) does not reach {self.view_deg:g} "
                "degrees; take a smaller view_deg or another lens"
            )
        K[0, 0] = K[1, 1] = width_px / 2 / bent
        return Camera(name, self.size_px, K, T_cam_world, model, coefficients, time_offset_s)


def look_at(
    position_m: Float64[np.ndarray, " 3"], target_m: Float64[np.ndarray, " 3"]
) -> Float64[np.ndarray, "4 4"]:
    """Return `T_cam_world` of an upright camera that faces a point.

    Parameters
    ----------
    position_m, target_m
        Camera and point in the world, not the same [m].

    Raises
    ------
    InputError
        Camera and point are the same.

    Examples
    --------
    >>> T_cam_world = look_at(np.array([0.0, -3.0, 1.0]), np.array([0.0, 0.0, 1.0]))
    >>> T_cam_world @ [1.0, 0.0, 2.0, 1.0]  # right of and above the point, 3 m away
    array([ 1., -1.,  3.,  1.])
    """
    forward = target_m - position_m
    distance_m = float(np.linalg.norm(forward))
    if distance_m < STEEP:
        raise InputError("a camera must look at another point than the one where it hangs")
    forward = forward / distance_m
    steep = np.hypot(forward[0], forward[1]) < STEEP
    right = np.cross(forward, [0.0, 1.0, 0.0] if steep else [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    T_cam_world = np.eye(4)
    T_cam_world[:3, :3] = np.stack((right, np.cross(forward, right), forward))
    T_cam_world[:3, 3] = -T_cam_world[:3, :3] @ position_m
    return T_cam_world


def rolled(T_cam_world: Float64[np.ndarray, "4 4"], roll_deg: float) -> Float64[np.ndarray, "4 4"]:
    """Return the pose of a camera rotated about its line of sight, clockwise seen from behind."""
    turned = np.eye(4)
    turned[:3, :3] = rotation_matrix(np.array([0.0, 0.0, -np.radians(roll_deg)]))
    pose: Float64[np.ndarray, "4 4"] = turned @ T_cam_world
    return pose
