"""Slow and obvious twins of the fast code, for tests to hold the two together."""

import numpy as np
from scipy.optimize import least_squares


def triangulate(P, xy_px, weight, sigma_px):
    """Minimise each point's weighted reprojection error until nothing moves."""
    xyz_m = np.full((xy_px.shape[1], 3), np.nan)
    cov_m2 = np.full((xy_px.shape[1], 3, 3), np.nan)
    for point in range(xy_px.shape[1]):
        seen = [cam for cam in range(len(P)) if np.isfinite(xy_px[cam, point]).all()]
        if len(seen) < 2:
            continue
        rows = []
        for cam in seen:
            x, y = xy_px[cam, point]
            rows += [(x * P[cam, 2] - P[cam, 0]) / 1000, (y * P[cam, 2] - P[cam, 1]) / 1000]
        start = np.linalg.svd(np.array(rows))[2][-1]

        def residuals(xyz_m, seen=seen, point=point):
            parts = []
            for cam in seen:
                u, v, w = P[cam] @ np.append(xyz_m, 1.0)
                deviation = (np.array([u / w, v / w]) - xy_px[cam, point]) / sigma_px
                parts.append(np.sqrt(weight[cam, point]) * deviation)
            return np.concatenate(parts)

        found = least_squares(residuals, start[:3] / start[3], xtol=1e-12, ftol=1e-12, gtol=1e-12)
        xyz_m[point] = found.x
        cov_m2[point] = np.linalg.inv(found.jac.T @ found.jac)
    return xyz_m, cov_m2
