"""Which cameras have places in view, and how exactly they can locate them."""

import numpy as np
from jaxtyping import Bool, Float64

from trecsim.geometry.rig import Rig

Points = Float64[np.ndarray, "point 3"]


def in_view(rig: Rig, xyz_m: Points) -> Bool[np.ndarray, "cam point"]:
    """Return which cameras have each point within their image; nothing is taken to hide it.

    Parameters
    ----------
    rig
        The cameras.
    xyz_m
        World points [m].
    """
    rows = []
    for camera in rig.cameras:
        x, y = camera.project(xyz_m).T
        width, height = camera.size_px
        with np.errstate(invalid="ignore"):
            rows.append((x >= 0.0) & (x < width) & (y >= 0.0) & (y < height))
    return np.array(rows, dtype=bool).reshape(len(rig.cameras), len(xyz_m))


def located(
    rig: Rig, xyz_m: Points, sigma_m: float, floor_px: float
) -> Float64[np.ndarray, "point 3 3"]:
    """Return the covariance of points that are seen once by each camera that has them in view.

    Parameters
    ----------
    rig
        The cameras.
    xyz_m
        World points [m].
    sigma_m
        Standard deviation of a key point, across the ray [m].
    floor_px
        The same, but never less than this in the image [px].

    Returns
    -------
    The inverse of the information of all observations [m^2]; NaN where it does not determine the
    point, as where fewer than two cameras see it.
    """
    seen = in_view(rig, xyz_m)
    information = np.zeros((len(xyz_m), 3, 3))
    for camera, row in zip(rig.cameras, seen, strict=True):
        if not row.any():
            continue
        _, jacobian = camera.project_with_jacobian(xyz_m[row])
        per_m = np.sqrt(np.square(jacobian).sum(axis=(-2, -1)) / 2.0)  # pixels per metre
        sigma_px = np.maximum(sigma_m * per_m, floor_px)
        scaled = jacobian / sigma_px[:, None, None]
        information[row] += np.einsum("nki,nkj->nij", scaled, scaled)
    known = seen.sum(axis=0) >= 2
    cov_m2 = np.full_like(information, np.nan)
    cov_m2[known] = np.linalg.pinv(information[known], hermitian=True)
    return cov_m2
