"""Marker names and axes of other tools."""

import numpy as np
from jaxtyping import Float

MARKERS = [
    "Nose",
    "LEye",
    "REye",
    "LEar",
    "REar",
    "LShoulder",
    "RShoulder",
    "LElbow",
    "RElbow",
    "LWrist",
    "RWrist",
    "LHip",
    "RHip",
    "LKnee",
    "RKnee",
    "LAnkle",
    "RAnkle",
]
"""COCO-17 as Pose2Sim names it, in the order of our joints."""


def pose2sim_axes(xyz_m: Float[np.ndarray, "*row 3"]) -> Float[np.ndarray, "*row 3"]:
    """Return positions with y up as Pose2Sim writes them to TRC: (x, y, z) becomes (y, z, x)."""
    return xyz_m[..., [1, 2, 0]]


def y_up(xyz_m: Float[np.ndarray, "*row 3"]) -> Float[np.ndarray, "*row 3"]:
    """Return positions with y up as glTF and BVH have them: (x, y, z) becomes (x, z, -y).

    Blender turns this back when it imports them, so its coordinates are ours.
    """
    turned = xyz_m[..., [0, 2, 1]]
    turned[..., 2] *= -1.0
    return turned
