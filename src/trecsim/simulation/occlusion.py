"""Who hides what from a camera."""

import numpy as np
from jaxtyping import Bool, Float64

RADIUS_M = 0.17  # people block the view like upright cylinders of this radius
OVER_SHOULDERS_M = 0.25


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
    people = xyz_m.shape[1]
    hidden = np.zeros(xyz_m.shape[:3], dtype=bool)
    middle_m = xyz_m[..., 11:13, :2].mean(axis=-2)
    top_m = xyz_m[..., 5:7, 2].mean(axis=-1) + OVER_SHOULDERS_M
    ray_m = xyz_m - position_m
    length_m2 = (ray_m[..., :2] ** 2).sum(axis=-1)
    for other in range(people):
        to_other_m = (middle_m[:, other] - position_m[:2])[:, None, None]
        share = (ray_m[..., :2] * to_other_m).sum(axis=-1) / length_m2
        beside_m = to_other_m - share[..., None] * ray_m[..., :2]
        height_m = position_m[2] + share * ray_m[..., 2]
        blocks = (
            (share > 0)
            & (share < 1)
            & ((beside_m**2).sum(axis=-1) < RADIUS_M**2)
            & (height_m > 0)
            & (height_m < top_m[:, other, None, None])
            # Of a ray that ends within the cylinder, the end is in front, not behind.
            & (((1 - share) ** 2) * length_m2 > RADIUS_M**2)
        )
        blocks[:, other] = False
        hidden |= blocks
    return hidden


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
