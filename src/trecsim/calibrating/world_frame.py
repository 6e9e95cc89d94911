"""A world frame for cameras that were placed relative to each other: z up, floor at z = 0."""

from dataclasses import replace

import numpy as np
from jaxtyping import Float64

from trecsim.geometry.rig import Rig
from trecsim.geometry.rigid import RigidMotion, inverse, rigid_motion

LEVEL = 0.15  # least spread of the cameras' rows for the vertical to follow from them


def moved(rig: Rig, T_new_old: RigidMotion) -> Rig:
    """Return the rig in another world frame."""
    T_old_new = inverse(T_new_old)
    return Rig(tuple(replace(c, T_cam_world=c.T_cam_world @ T_old_new) for c in rig))


def upright(rig: Rig, seen_m: Float64[np.ndarray, "point 3"]) -> RigidMotion:
    """Return the motion to a frame in which the cameras stand upright, about.

    Parameters
    ----------
    rig
        The cameras, in any frame.
    seen_m
        Points that were seen, in that frame; the lowest of them comes to lie at z = 0 [m].

    Returns
    -------
    The motion to a frame with z up, its origin amid the points, and x to the right of the first
    camera.

    Notes
    -----
    The rows of upright images are level: up is at right angles to all of them. Where all cameras
    look the same way or the opposite, it is the mean of the directions up in their images.
    """
    rows = np.array([camera.T_cam_world[0, :3] for camera in rig])
    above = -np.array([camera.T_cam_world[1, :3] for camera in rig])
    _, spread, axes = np.linalg.svd(rows)
    up = axes[-1] if _spread(spread) > LEVEL else _mean(above)
    if up @ above.sum(axis=0) < 0:
        up = -up
    x = rows[0] - (rows[0] @ up) * up
    x = x / np.linalg.norm(x)
    R = np.stack((x, np.cross(up, x), up))
    turned = seen_m @ R.T
    origin = np.array([*np.median(turned[:, :2], axis=0), turned[:, 2].min()])
    T: RigidMotion = rigid_motion(R, -origin)
    return T


def _spread(values: Float64[np.ndarray, " value"]) -> float:
    return float(values[1] / values[0]) if len(values) > 1 else 0.0


def _mean(vectors: Float64[np.ndarray, "many 3"]) -> Float64[np.ndarray, " 3"]:
    total = vectors.sum(axis=0)
    mean: Float64[np.ndarray, " 3"] = total / np.linalg.norm(total)
    return mean
