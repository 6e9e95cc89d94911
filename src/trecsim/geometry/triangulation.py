"""Points in space from where several cameras see them, and how sure that is."""

import numpy as np
from jaxtyping import Float64

STEPS = 2  # of Gauss and Newton: the linear start is within their quadratic reach
LEAST_SPREAD = 1e-9  # of the information's axes: rays closer to parallel than 0.002 degrees

Information = Float64[np.ndarray, "point 3 3"]


def triangulate(
    P: Float64[np.ndarray, "cam 3 4"],
    xy_px: Float64[np.ndarray, "cam *batch 2"],
    weight: Float64[np.ndarray, "cam *batch"] | None = None,
    sigma_px: float = 1.0,
) -> tuple[Float64[np.ndarray, "*batch 3"], Float64[np.ndarray, "*batch 3 3"]]:
    """Return the points that best explain what the cameras see, and their covariance.

    Parameters
    ----------
    P
        Projections ``K [R | t]``, as `Rig.P` has them: the third row gives the depth [m].
    xy_px
        Undistorted pixels (see `Camera.undistort`); NaN where a camera does not see the point.
    weight
        Confidence per observation: its variance is ``sigma_px**2 / weight``. 0 means unseen.
    sigma_px
        Standard deviation of an observation of weight 1, per axis [px].

    Returns
    -------
    xyz_m
        World points [m]; NaN where fewer than two cameras see the point, where their rays are
        parallel or the same, and where the point would lie behind one of them.
    cov_m2
        Their covariance [m^2], NaN alike: it follows from geometry, weights and `sigma_px`,
        not from how well the views agree.

    Notes
    -----
    The start minimises the distances to the planes that each pixel's column and row span with
    the camera (the direct linear transform, its rows scaled to metres, so that the result does
    not depend on where the world's origin lies). Gauss-Newton steps then minimise the weighted
    reprojection error; the inverse of their matrix is the covariance.

    Examples
    --------
    >>> left = np.array([[500.0, 0, 320, 0], [0, 500, 240, 0], [0, 0, 1, 0]])
    >>> right = left - [[0, 0, 0, 500.0], [0, 0, 0, 0], [0, 0, 0, 0]]  # one metre to the right
    >>> xyz_m, cov_m2 = triangulate(np.stack((left, right)), np.array([[570.0, 240], [320, 240]]))
    >>> xyz_m.round(6) + 0.0
    array([1., 0., 2.])
    >>> np.sqrt(np.diagonal(cov_m2)).round(4)
    array([0.004 , 0.0028, 0.0113])
    """
    batch = xy_px.shape[1:-1]
    pixels = xy_px.reshape(len(P), -1, 2)
    given = np.ones(pixels.shape[:2]) if weight is None else weight.reshape(pixels.shape[:2])
    with np.errstate(all="ignore"):
        seen = np.isfinite(pixels).all(axis=-1) & (given > 0)
        information = np.where(seen, given, 0.0) / sigma_px**2
        pixels = np.where(seen[..., None], pixels, 0.0)
        xyz_m = _linear(P, pixels, information)
        for _ in range(STEPS):
            matrix, slope, _ = _normal_equations(P, pixels, information, xyz_m)
            xyz_m = xyz_m + _solve(matrix, slope[..., None])[..., 0]
        matrix, _, depth_m = _normal_equations(P, pixels, information, xyz_m)
        behind = (seen & ~(depth_m > 0)).any(axis=0)
        xyz_m = np.where(behind[:, None], np.nan, xyz_m)
        cov_m2 = _solve(matrix, np.broadcast_to(np.eye(3), matrix.shape))
    cov_m2 = np.where(np.isfinite(xyz_m).all(axis=-1)[:, None, None], cov_m2, np.nan)
    xyz_m = np.where(np.isfinite(cov_m2).all(axis=(-2, -1))[:, None], xyz_m, np.nan)
    return xyz_m.reshape(*batch, 3), cov_m2.reshape(*batch, 3, 3)


def _linear(
    P: Float64[np.ndarray, "cam 3 4"],
    xy_px: Float64[np.ndarray, "cam point 2"],
    information: Float64[np.ndarray, "cam point"],
) -> Float64[np.ndarray, "point 3"]:
    """Return the points nearest to the planes through each pixel's column and row."""
    planes = P[:, None, :2] - xy_px[..., None] * P[:, None, 2:]
    planes = planes / np.linalg.norm(planes[..., :3], axis=-1, keepdims=True)
    normals, offsets = planes[..., :3], planes[..., 3]
    weighted = normals * information[..., None, None]
    matrix = np.einsum("cnki,cnkj->nij", weighted, normals)
    return _solve(matrix, -np.einsum("cnki,cnk->ni", weighted, offsets)[..., None])[..., 0]


def _normal_equations(
    P: Float64[np.ndarray, "cam 3 4"],
    xy_px: Float64[np.ndarray, "cam point 2"],
    information: Float64[np.ndarray, "cam point"],
    xyz_m: Float64[np.ndarray, "point 3"],
) -> tuple[Information, Float64[np.ndarray, "point 3"], Float64[np.ndarray, "cam point"]]:
    """Return the information matrices, the gradients and the depths at `xyz_m`."""
    homogeneous = np.einsum("cij,nj->cni", P[..., :3], xyz_m) + P[:, None, :, 3]
    depth_m = homogeneous[..., 2]
    used_depth_m = np.where(information > 0, depth_m, 1.0)[..., None]
    predicted_px = homogeneous[..., :2] / used_depth_m
    residual_px = xy_px - predicted_px
    jacobian = P[:, None, :2, :3] - predicted_px[..., None] * P[:, None, 2:, :3]
    jacobian /= used_depth_m[..., None]
    weighted = jacobian * information[..., None, None]
    matrix = np.einsum("cnki,cnkj->nij", weighted, jacobian)
    return matrix, np.einsum("cnki,cnk->ni", weighted, residual_px), depth_m


def _solve(
    matrix: Information, right: Float64[np.ndarray, "point 3 column"]
) -> Float64[np.ndarray, "point 3 column"]:
    """Return the solutions, NaN where the matrix does not determine all three axes."""
    scale = np.trace(matrix, axis1=-2, axis2=-1) / 3
    sound = np.linalg.det(matrix) > LEAST_SPREAD * scale**3
    solvable = np.where(sound[:, None, None], matrix, np.eye(3))
    return np.where(sound[:, None, None], np.linalg.solve(solvable, right), np.nan)
