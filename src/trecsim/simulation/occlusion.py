"""Who, and which things, hide what from a camera."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64

from trecsim.errors import InputError

RADIUS_M = 0.17  # people block the view like upright cylinders of this radius
OVER_SHOULDERS_M = 0.25
ARM_M = 1.0  # no joint is further than this from the middle of the body


@dataclass(frozen=True, slots=True)
class Obstacle:
    """A box that no camera looks through: a pillar, a wall, a shelf.

    Attributes
    ----------
    low_m, high_m
        Its corners with the smallest and the largest coordinates; the edges are parallel to the
        axes of the world [m].

    Examples
    --------
    >>> Obstacle(low_m=(0.0, 0.0, 0.0), high_m=(0.4, 0.4, 2.0)).high_m[2]
    2.0
    """

    low_m: tuple[float, float, float]
    high_m: tuple[float, float, float]

    def __post_init__(self) -> None:
        sizes_m = [high - low for low, high in zip(self.low_m, self.high_m, strict=True)]
        if not all(0 < size_m < np.inf for size_m in sizes_m):
            raise InputError(
                "an obstacle's high_m must be larger than its low_m along x, y and z, and finite, "
                f"got low_m = {self.low_m} and high_m = {self.high_m}"
            )


def hidden_behind_obstacles(
    position_m: Float64[np.ndarray, " 3"],
    xyz_m: Float64[np.ndarray, "*batch 3"],
    obstacles: tuple[Obstacle, ...],
) -> Bool[np.ndarray, "*batch"]:
    """Return which points lie behind an obstacle, or inside one.

    Parameters
    ----------
    position_m
        Of the camera [m].
    xyz_m
        Points, NaN where absent: those are not hidden [m].
    obstacles
        What stands about.

    Notes
    -----
    A segment meets a box when the shares of it that lie between the box's three pairs of planes
    have something in common.
    """
    ray_m = xyz_m - position_m
    ray_m[ray_m == 0] = 1e-9  # a ray along a plane meets it as far away as one likes
    hidden = np.zeros(xyz_m.shape[:-1], dtype=bool)
    for obstacle in obstacles:
        to_low = (np.array(obstacle.low_m) - position_m) / ray_m
        to_high = (np.array(obstacle.high_m) - position_m) / ray_m
        enters = np.minimum(to_low, to_high).max(axis=-1)
        leaves = np.maximum(to_low, to_high).min(axis=-1)
        hidden |= (enters <= leaves) & (enters <= 1.0) & (leaves >= 0.0)
    return hidden


def hidden_behind_others(
    position_m: Float64[np.ndarray, " 3"], xyz_m: Float64[np.ndarray, "time person 17 3"]
) -> Bool[np.ndarray, "time person 17"]:
    """Return which joints somebody nearer hides from a camera.

    Parameters
    ----------
    position_m
        Of the camera [m].
    xyz_m
        Everybody's joints, NaN while absent [m].
    """
    hidden = np.zeros(xyz_m.shape[:3], dtype=bool)
    middle_m = xyz_m[..., 11:13, :2].mean(axis=-2)
    top_m = xyz_m[..., 5:7, 2].mean(axis=-1) + OVER_SHOULDERS_M
    ahead_m = middle_m - position_m[:2]
    for other in range(xyz_m.shape[1]):
        to_other_m = ahead_m[:, other]
        near = _beside_m(ahead_m, to_other_m[:, None]) < RADIUS_M + ARM_M
        near[:, other] = False
        times, people = np.nonzero(near)
        hidden[times, people] |= _blocked(
            position_m, xyz_m[times, people], to_other_m[times], top_m[times, other]
        )
    return hidden


def _beside_m(
    ray_m: Float64[np.ndarray, "*#batch 2"], point_m: Float64[np.ndarray, "*#batch 2"]
) -> Float64[np.ndarray, "*#batch"]:
    """Return how far a ray from the origin passes beside a point; infinite if behind it [m]."""
    along = (ray_m * point_m).sum(axis=-1)
    across = np.abs(ray_m[..., 0] * point_m[..., 1] - ray_m[..., 1] * point_m[..., 0])
    return np.where(along > 0, across / np.linalg.norm(ray_m, axis=-1), np.inf)


def _blocked(
    position_m: Float64[np.ndarray, " 3"],
    xyz_m: Float64[np.ndarray, "pair 17 3"],
    to_other_m: Float64[np.ndarray, "pair 2"],
    top_m: Float64[np.ndarray, " pair"],
) -> Bool[np.ndarray, "pair 17"]:
    """Return which joints of one person another, `to_other_m` from the camera, hides."""
    ray_m = xyz_m - position_m
    length_m2 = (ray_m[..., :2] ** 2).sum(axis=-1)
    share = (ray_m[..., :2] * to_other_m[:, None]).sum(axis=-1) / length_m2
    height_m = position_m[2] + share * ray_m[..., 2]
    blocked: Bool[np.ndarray, "pair 17"] = (
        (share < 1)
        & (_beside_m(ray_m[..., :2], to_other_m[:, None]) < RADIUS_M)
        & (height_m > 0)
        & (height_m < top_m[:, None])
        # Of a ray that ends within the cylinder, the end is in front, not behind.
        & ((1 - share) ** 2 * length_m2 > RADIUS_M**2)
    )
    return blocked


def faces_away(
    position_m: Float64[np.ndarray, " 3"], xyz_m: Float64[np.ndarray, "time person 17 3"]
) -> Bool[np.ndarray, "time person 5"]:
    """Return which of nose, eyes and ears lie on the far side of the head.

    Parameters
    ----------
    position_m
        Of the camera [m].
    xyz_m
        Everybody's joints, NaN while absent [m].
    """
    face_m = xyz_m[..., :5, :]
    middle_m = xyz_m[..., 3:5, :].mean(axis=-2, keepdims=True)
    outward = face_m - middle_m
    to_camera = position_m - middle_m
    cosine = (outward * to_camera).sum(axis=-1) / (
        np.linalg.norm(outward, axis=-1) * np.linalg.norm(to_camera, axis=-1)
    )
    away: Bool[np.ndarray, "time person 5"] = cosine < -0.25
    return away
