"""The size of a body that two cameras triangulate: nobody is twice as large as others."""

import numpy as np
from jaxtyping import Float64

from trecsim.calibrating.people.epipolar import depths, rays_of
from trecsim.calibrating.people.tuning import HEIGHT_OF_JOINT, STATURE_M

BONES = np.array([
    [5, 11], [6, 12], [11, 13], [12, 14], [13, 15], [14, 16], [5, 7], [6, 8], [7, 9], [8, 10],
])  # fmt: skip
USUAL_M = STATURE_M * np.abs(np.diff(HEIGHT_OF_JOINT[BONES], axis=1)[:, 0])
"""Usual length of each bone: how far apart the heights of its ends are in standing [m]."""


def size_of_body(
    z_a: Float64[np.ndarray, "moment joint 2"],
    z_b: Float64[np.ndarray, "moment joint 2"],
    T_a: Float64[np.ndarray, "4 4"],
    T_b: Float64[np.ndarray, "4 4"],
) -> float:
    """Return the median of the bones' length over their usual one; NaN if no bone is triangulated.

    Parameters
    ----------
    z_a, z_b
        The same joints at the same moments in both cameras, in their planes z = 1.
    T_a, T_b
        Poses of the cameras, from the world [m].
    """
    R = T_b[:3, :3] @ T_a[:3, :3].T
    t = T_b[:3, 3] - R @ T_a[:3, 3]
    p, q = rays_of(z_a), rays_of(z_b)
    near, _ = depths(p.reshape(-1, 3), q.reshape(-1, 3), R[None], t[None])
    xyz_m = near[0].reshape(*p.shape[:2], 1) * p
    length_m = np.linalg.norm(xyz_m[:, BONES[:, 0]] - xyz_m[:, BONES[:, 1]], axis=-1)
    ratio = (length_m / USUAL_M)[np.isfinite(length_m)]
    return float(np.median(ratio)) if len(ratio) else float("nan")
