"""Lenses of the cameras and bodies that hide others, as arrays for the kernels."""

import numpy as np
from jaxtyping import Float64

from trecsim.fusion.kernels.visibility_kernels import BROWN, FISHEYE, PINHOLE, Lenses, Silhouette
from trecsim.geometry import Camera, Rig
from trecsim.geometry.distortion import lens
from trecsim.skeleton import Skeleton

_KIND = {"none": PINHOLE, "brown": BROWN, "fisheye": FISHEYE}
# Capsules that hide what is behind them, with radii [m]: head and neck, trunk, both legs.
_PARTS = (
    ("shoulder", "ear", 0.11),
    ("shoulder", "hip", 0.16),
    ("hip", "ankle", 0.11),
)


def lenses(rig: Rig) -> Lenses:
    """Return the parameters that decide whether points are in the cameras' raw images."""
    return Lenses(
        T_cam_world=np.array([camera.T_cam_world[:3] for camera in rig], order="C"),
        position_m=np.array([camera.position_m for camera in rig], order="C"),
        K=np.array([camera.K for camera in rig], order="C"),
        size_px=np.array([camera.size_px for camera in rig], np.float64),
        kind=np.array([_KIND[camera.distortion_model] for camera in rig], np.int64),
        coefficients=np.stack([_coefficients(camera) for camera in rig]),
        radius2_max=np.array(
            [lens(camera.distortion_model, camera.distortion).radius_max ** 2 for camera in rig]
        ),
    )


def _coefficients(camera: Camera) -> Float64[np.ndarray, "8"]:
    out = np.zeros(8)
    out[: len(camera.distortion)] = camera.distortion
    return out


def silhouette(skeleton: Skeleton) -> Silhouette:
    """Return the capsules of a body that hide others; none for which the skeleton lacks joints."""
    ends, radius_m = [], []
    for first, last, radius in _PARTS:
        names = [f"{side}_{joint}" for joint in (first, last) for side in ("left", "right")]
        if all(name in skeleton.joints for name in names):
            ends.append([skeleton.index(name) for name in names])
            radius_m.append(radius)
    return Silhouette(np.array(ends, np.int64).reshape(-1, 4), np.array(radius_m, np.float64))
