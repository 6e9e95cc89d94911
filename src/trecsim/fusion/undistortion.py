"""What undistorts key points, as the kernels want it."""

import numpy as np

from trecsim.fusion.kernels.undistortion_kernels import BROWN, FISHEYE, IDEAL, Undistortion
from trecsim.geometry import Rig
from trecsim.geometry.distortion import TABLE_LENGTH, Brown, Fisheye, lens


def undistortion(rig: Rig) -> Undistortion:
    """Return the inverses of the lenses of `rig`, one row per camera."""
    n = len(rig)
    packed = Undistortion(
        np.full(n, IDEAL, np.int64), np.zeros((n, 5)), np.zeros((n, 8)), np.zeros((n, 2)),
        np.zeros((n, 2, TABLE_LENGTH)),
    )  # fmt: skip
    for cam, camera in enumerate(rig):
        (fx, skew, cx), (_, fy, cy), _ = camera.K
        packed.pinhole[cam] = fx, skew, cx, fy, cy
        packed.coefficient[cam, : len(camera.distortion)] = camera.distortion
        match lens(camera.distortion_model, camera.distortion):
            case Brown() as brown:
                packed.model[cam] = BROWN
                packed.limit[cam] = brown.radius_max, brown.reach
                packed.table[cam] = brown.table
            case Fisheye() as fisheye:
                packed.model[cam] = FISHEYE
                packed.limit[cam, 0] = fisheye.angle_max
                packed.table[cam] = fisheye.table
    return packed
