"""What a camera sees: rays, field of view, the part of the floor in its image."""

import numpy as np
from jaxtyping import Float64

from trecsim.geometry.camera import Camera
from trecsim.geometry.distortion import Points

BORDER_POINTS = 24  # per side of the image
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


def floor_in_view(camera: Camera, range_m: float) -> Float64[np.ndarray, "corner 2"]:
    """Return the outline of the floor in the camera's image, up to a distance [m].

    Parameters
    ----------
    camera
        The camera.
    range_m
        Distance from the point below the camera at which the outline is cut.

    Returns
    -------
    Corners (x, y) on the floor, in order.
    """
    border, _ = _furthest_in(camera, _border_px(camera.size_px))
    directions = rays(camera, border)
    flat = np.linalg.norm(directions[:, :2], axis=-1)
    with np.errstate(all="ignore"):
        reach_m = camera.position_m[2] * flat / -directions[:, 2]
    meets_floor = (directions[:, 2] < 0) & (reach_m >= 0) & (reach_m < range_m)
    distance_m = np.where(meets_floor, reach_m, range_m)
    away = directions[:, :2] / np.maximum(flat, 1e-12)[:, None]
    outline: Float64[np.ndarray, "corner 2"] = camera.position_m[:2] + distance_m[:, None] * away
    return outline


def _border_px(size_px: tuple[int, int]) -> Float64[np.ndarray, "point 2"]:
    """Return points around the border of the image, in order."""
    right, bottom = size_px[0] - 0.5, size_px[1] - 0.5
    corners = np.array([[-0.5, bottom], [right, bottom], [right, -0.5], [-0.5, -0.5]])
    steps = np.linspace(0, 1, BORDER_POINTS, endpoint=False)[:, None]
    sides = zip(corners, np.roll(corners, -1, axis=0), strict=True)
    return np.concatenate([start + steps * (end - start) for start, end in sides])


def _furthest_in(camera: Camera, xy_px: Points) -> tuple[Points, bool]:
    """Return the points nearest to `xy_px`, towards the image's centre, that have a ray."""
    centre = camera.K[:2, 2]
    tried = centre + INWARD[:, None, None] * (xy_px - centre)
    good = np.isfinite(camera.undistort(tried)[..., 0])
    first = np.argmax(good, axis=0)
    reached: Points = tried[first, np.arange(len(xy_px))]
    return reached, bool((first == 0).all())
