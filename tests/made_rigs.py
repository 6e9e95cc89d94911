"""Cameras and rigs made for tests, and the strategies that draw them."""

import cv2
import numpy as np
from hypothesis import strategies as st

from trecsim.geometry.camera import Camera
from trecsim.geometry.rig import Rig

K_1080P = np.array([[1100.0, 0.0, 965.0], [0.0, 1110.0, 535.0], [0.0, 0.0, 1.0]])

LENSES = {
    "none": np.empty(0),
    "brown": np.array([-0.28, 0.09, 4e-4, -3e-4, -0.015]),
    "rational": np.array([0.5, -0.1, 1e-3, -2e-3, 0.02, 0.6, -0.05, 0.03]),
    "fisheye": np.array([-0.02, 0.01, -0.003, 0.0005]),
}


def look_at(position_m, target_m, up=(0.0, 0.0, 1.0)):
    """Return T_cam_world of a camera that looks from one point at another, upright."""
    forward = np.subtract(target_m, position_m)
    forward = forward / np.linalg.norm(forward)
    right = np.cross(forward, up)
    right = right / np.linalg.norm(right)
    R = np.stack((right, np.cross(forward, right), forward))
    T = np.eye(4)
    T[:3, :3] = R
    T[:3, 3] = -R @ position_m
    return T


def camera(name="north", lens="none", position_m=(-4.0, -3.0, 2.5), target_m=(0.0, 0.0, 1.0)):
    """Return a camera of 1920 x 1080 pixels with one of `LENSES`."""
    model = "brown" if lens == "rational" else lens
    T = look_at(np.array(position_m), np.array(target_m))
    return Camera(name, (1920, 1080), K_1080P, T, model, LENSES[lens])


def ring(count=4, lens="none", radius_m=5.0):
    """Return a rig of cameras evenly on a circle, looking at its middle."""
    angles = 2 * np.pi * np.arange(count) / count
    return Rig(
        tuple(
            camera(f"cam{i}", lens, (radius_m * np.cos(a), radius_m * np.sin(a), 2.5 + 0.2 * i))
            for i, a in enumerate(angles)
        )
    )


def brown_coefficients():
    """Draw what real lenses have: five coefficients."""
    radial = st.tuples(st.floats(-0.45, 0.2), st.floats(-0.05, 0.25), st.floats(-0.08, 0.08))
    small = st.floats(-0.002, 0.002)
    return st.builds(lambda k, p1, p2: np.array([k[0], k[1], p1, p2, k[2]]), radial, small, small)


def fisheye_coefficients():
    """Draw what real fisheye lenses have: four coefficients."""
    return st.builds(
        lambda a, b, c, d: np.array([a, b, c, d]),
        st.floats(-0.1, 0.1),
        st.floats(-0.05, 0.05),
        st.floats(-0.01, 0.01),
        st.floats(-0.002, 0.002),
    )


def rotations():
    """Draw any rotation matrix."""
    return st.integers(0, 2**32 - 1).map(
        lambda seed: cv2.Rodrigues(np.random.default_rng(seed).normal(size=3) * 2)[0]
    )
