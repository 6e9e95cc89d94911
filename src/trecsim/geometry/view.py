"""What a camera sees: rays, field of view, what is in its image."""

import numpy as np
from jaxtyping import Float64

from trecsim.geometry.camera import Camera
from trecsim.geometry.distortion import Points

INWARD = np.linspace(1.0, 0.05, 96)  # where a lens has no inverse at the border, further in


def rays(camera: Camera, xy_px: Points) -> Float64[np.ndarray, "*batch 3"]:
    """Return the directions in the world from which raw pixels are lit.

    Parameters
    ----------
    camera
        The camera.
    xy_px
        Pixels of the raw image.

    Returns
    -------
    Unit vectors away from the camera; NaN where the lens has no inverse.
    """
    ideal_px = camera.undistort(xy_px)
    homogeneous = np.concatenate((ideal_px, np.ones((*ideal_px.shape[:-1], 1))), axis=-1)
    directions = homogeneous @ np.linalg.inv(camera.K).T @ camera.T_cam_world[:3, :3]
    unit: Float64[np.ndarray, "*batch 3"] = directions / np.linalg.norm(
        directions, axis=-1, keepdims=True
    )
    return unit


def field_of_view_deg(camera: Camera) -> tuple[float, bool]:
    """Return the angle between the middles of the left and right borders [degrees].

    Returns
    -------
    The angle, and whether it is all: False where the lens model ends before the border does.
    """
    width, height = camera.size_px
    middle = (height - 1) / 2
    corners = np.array([[-0.5, middle], [width - 0.5, middle]])
    reached, complete = _furthest_in(camera, corners)
    left, right = rays(camera, reached)
    centre = camera.T_cam_world[2, :3]
    angle = sum(float(np.arccos(np.clip(ray @ centre, -1, 1))) for ray in (left, right))
    return float(np.rad2deg(angle)), complete


def share_without_inverse(camera: Camera) -> float:
    """Return the share of the image where the lens model cannot be undone."""
    width, height = camera.size_px
    x, y = np.meshgrid(np.linspace(0, width - 1, 33), np.linspace(0, height - 1, 33))
    return float(np.isnan(camera.undistort(np.stack((x, y), axis=-1))[..., 0]).mean())


def image_margin(
    camera: Camera, xyz_m: Float64[np.ndarray, "*batch 3"]
) -> Float64[np.ndarray, "*batch"]:
    """Return how far inside the image points appear, as a share of its width.

    Parameters
    ----------
    camera
        The camera.
    xyz_m
        World points [m].

    Returns
    -------
    Distance to the nearest border over the width of the image: positive inside, negative
    outside; -1 where a point has no image.
    """
    x, y = np.moveaxis(camera.project(xyz_m), -1, 0)
    width, height = camera.size_px
    inside_px = np.minimum(
        np.minimum(x + 0.5, width - 0.5 - x), np.minimum(y + 0.5, height - 0.5 - y)
    )
    margin: Float64[np.ndarray, "*batch"] = np.nan_to_num(inside_px / width, nan=-1.0)
    return margin


def _furthest_in(camera: Camera, xy_px: Points) -> tuple[Points, bool]:
    """Return the points nearest to `xy_px`, towards the image's centre, that have a ray."""
    centre = camera.K[:2, 2]
    tried = centre + INWARD[:, None, None] * (xy_px - centre)
    good = np.isfinite(camera.undistort(tried)[..., 0])
    first = np.argmax(good, axis=0)
    reached: Points = tried[first, np.arange(len(xy_px))]
    return reached, bool((first == 0).all())
