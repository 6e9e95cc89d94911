"""Where the floor is in the frame of a file: the way from there to our world, z up."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from jaxtyping import Float64

from trecsim.errors import CalibrationError
from trecsim.geometry.camera import Camera
from trecsim.geometry.rigid import RigidMotion, inverse, rigid_motion, rotation_matrix

Triple = tuple[float, float, float]
UpAxis = Literal["z", "y", "-y", "-z"]

UP: dict[UpAxis, Float64[np.ndarray, "3 3"]] = {
    "z": np.array([[1.0, 0, 0], [0, 1, 0], [0, 0, 1]]),
    "y": np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]),
    "-y": np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]]),
    "-z": np.array([[1.0, 0, 0], [0, -1, 0], [0, 0, -1]]),
}
"""Rotations that take the axis which points up to z."""


@dataclass(frozen=True, slots=True, eq=False)
class Floor:
    """The rigid motion from the frame of a calibration file to the floor.

    Attributes
    ----------
    rotation_deg
        Rotation vector: its direction is the axis, its length the angle [degrees].
    translation_m
        Shift after the rotation [m].
    up
        The axis that points up after both; None takes the one about which the cameras stand most
        upright.

    Examples
    --------
    The thesis' room, where camera 0 hangs 2.3 m above the floor and y points up:

    >>> floor = Floor((146.12, 1.79, -1.2), (0.0, 2.3, 0.0), up="y")
    >>> floor.T_world_file("y")[:3, 3]
    array([0. , 0. , 2.3])
    """

    rotation_deg: Triple = (0.0, 0.0, 0.0)
    translation_m: Triple = (0.0, 0.0, 0.0)
    up: UpAxis | None = None

    def __post_init__(self) -> None:
        for name, values in (("rotation", self.rotation_deg), ("translation", self.translation_m)):
            if (
                np.shape(values) != (3,)
                or not np.isfinite(np.array(values, dtype=np.float64)).all()
            ):
                raise CalibrationError(
                    f"the floor's {name} must be three finite numbers, got {values}"
                )
        if self.up is not None and self.up not in UP:
            axes = ", ".join(get_args(UpAxis))
            raise CalibrationError(f"the floor's up axis must be one of {axes}, got {self.up!r}")

    def T_world_file(self, up: UpAxis) -> RigidMotion:  # noqa: N802
        """Return the rigid motion from the file's frame to the world."""
        R = rotation_matrix(np.deg2rad(self.rotation_deg))
        T_ground_file = rigid_motion(R, np.asarray(self.translation_m, dtype=np.float64))
        T_world_file: RigidMotion = rigid_motion(UP[up], np.zeros(3)) @ T_ground_file
        return T_world_file


def upright_axis(cameras: Sequence[Camera], R_ground_file: Float64[np.ndarray, "3 3"]) -> UpAxis:
    """Return the axis about which the cameras stand most upright: images are taken head up."""
    ups = [-R_ground_file @ camera.T_cam_world[1, :3] for camera in cameras]
    mean_up = np.mean(ups, axis=0)
    return max(UP, key=lambda axis: float((UP[axis] @ mean_up)[2]))


def put_on_floor(camera: Camera, T_world_file: RigidMotion) -> RigidMotion:
    """Return the camera's pose in the world, from its pose in the file's frame."""
    T_cam_world: RigidMotion = camera.T_cam_world @ inverse(T_world_file)
    return T_cam_world
