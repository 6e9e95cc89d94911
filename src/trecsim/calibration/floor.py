"""The floor in the frame of a calibration file: the rigid motion from there to the world, z up."""

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

STEEPEST = 0.3  # cosine: a camera may look up or down by as much as 72 degrees
ROLL = 0.35  # sine: and be rolled about its line of sight by as much as 20 degrees
AGREEING = 2 / 3  # share of the cameras


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
        The axis that points up after both. None takes z, unless the file does not say its axes
        and the cameras clearly stand upright about another axis.

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


def upright_axis(
    cameras: Sequence[Camera], R_ground_file: Float64[np.ndarray, "3 3"]
) -> UpAxis | None:
    """Return the axis that points up if the images were taken upright; None if it is not clear.

    An upright camera has the up axis somewhere above it in its image, and its rows are level. It
    is clear when this holds for one axis in at least two thirds of the cameras and for no other
    axis. Cameras mounted in portrait, or parallel cameras that look down steeply, leave it open.

    Parameters
    ----------
    cameras
        The cameras, in the frame of the file.
    R_ground_file
        Rotation from that frame to the one of which an axis is up.
    """
    right = np.array([R_ground_file @ camera.T_cam_world[0, :3] for camera in cameras])
    above = np.array([-R_ground_file @ camera.T_cam_world[1, :3] for camera in cameras])
    axes = {axis: R[2] for axis, R in UP.items()}
    upright = {
        axis: float(((above @ up > STEEPEST) & (np.abs(right @ up) < ROLL)).mean())
        for axis, up in axes.items()
    }
    clear = [axis for axis, share in upright.items() if share >= AGREEING]
    return clear[0] if len(clear) == 1 else None


def put_on_floor(camera: Camera, T_world_file: RigidMotion) -> RigidMotion:
    """Return the camera's pose in the world, from its pose in the file's frame."""
    T_cam_world: RigidMotion = camera.T_cam_world @ inverse(T_world_file)
    return T_cam_world
