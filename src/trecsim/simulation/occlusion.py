"""Who hides what from a camera."""

import numpy as np
from jaxtyping import Bool, Float64

RADIUS_M = 0.17  # people block the view like upright cylinders of this radius
OVER_SHOULDERS_M = 0.25
ARM_M = 1.0  # no joint is further than this from the middle of the body


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
