"""Occlusion of joints by other people and by boxes."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64

from trecsim.errors import InputError
from trecsim.lab.simulation.kernels import hidden_by_bodies


@dataclass(frozen=True, slots=True)
class Obstacle:
    """An opaque box: a pillar, a wall, a shelf.

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
    """Return which points lie behind an obstacle or inside one; absent points (NaN) do not.

    Notes
    -----
    A segment meets a box when the shares of it that lie between the box's three pairs of planes
    have something in common.
    """
    ray_m = xyz_m - position_m
    ray_m[ray_m == 0] = 1e-9  # avoids a division by zero; the ray is parallel to the plane
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
    """Return which joints are occluded by another person.

    Notes
    -----
    A body blocks the view with its trunk, head and legs, whatever its posture: capsules between
    joints. Nobody hides parts of themselves; that is among what a detector misses anyway.
    """
    hidden = np.zeros(xyz_m.shape[:3], dtype=bool)
    hidden_by_bodies(position_m, np.ascontiguousarray(xyz_m), hidden)
    return hidden


def faces_away(
    position_m: Float64[np.ndarray, " 3"], xyz_m: Float64[np.ndarray, "time person 17 3"]
) -> Bool[np.ndarray, "time person 5"]:
    """Return which of nose, eyes and ears lie on the far side of the head."""
    face_m = xyz_m[..., :5, :]
    middle_m = xyz_m[..., 3:5, :].mean(axis=-2, keepdims=True)
    outward = face_m - middle_m
    to_camera = position_m - middle_m
    cosine = (outward * to_camera).sum(axis=-1) / (
        np.linalg.norm(outward, axis=-1) * np.linalg.norm(to_camera, axis=-1)
    )
    away: Bool[np.ndarray, "time person 5"] = cosine < -0.25
    return away
