"""The mixture model: how likely a key point, a detection, is under each person or clutter."""

import math
from typing import NamedTuple, no_type_check

import numpy as np
from jaxtyping import Float64, Int64
from numba import njit

# A joint nearer than this to a camera's plane is not compared with its image [m].
NEAR_M = 0.05
# How the noise of a key point grows as its score falls, and by how much at most.
SCORE_POWER, LARGEST_FACTOR = 1.7, 6.0


class Noise(NamedTuple):
    """What the kernels assume of a detector.

    Attributes
    ----------
    sigma_m
        Noise of a good key point per joint, as a length at the person's distance [m].
    mirror
        Index of each joint's left-right counterpart.
    floor_px
        Noise that even the best key point has [px].
    good_score
        Score from which on a key point is as good as it gets.
    log_inlier
        ``log((1 - outlier_share) * outlier_area_m2)``.
    outlier_share
        Prior share of key points that have nothing to do with the joint.
    log_flip
        Log prior odds that a detection has left and right exchanged.
    tail
        Degrees of freedom of the inliers' distribution; few mean heavy tails.
    """

    sigma_m: Float64[np.ndarray, " joint"]
    mirror: Int64[np.ndarray, " joint"]
    floor_px: float
    good_score: float
    log_inlier: float
    outlier_share: float
    log_flip: float
    tail: float


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def project(P, x, uv, J):
    """Project the world point `x` by `P` (3, 4); write pixel and Jacobian, return the depth [m].

    Notes
    -----
    Thesis eq. 12-19 and 42-46. ``K`` ends in (0, 0, 1), so the third row of ``P`` gives depth.
    """
    w = P[2, 0] * x[0] + P[2, 1] * x[1] + P[2, 2] * x[2] + P[2, 3]
    for i in range(2):
        h = P[i, 0] * x[0] + P[i, 1] * x[1] + P[i, 2] * x[2] + P[i, 3]
        uv[i] = h / w if w > 0.0 else math.nan
        for a in range(3):
            J[i, a] = (P[i, a] - uv[i] * P[2, a]) / w
    return w


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def image_covariance(J, cov_m2, var_px2, out):
    """Write ``J cov J^T + var I``, the covariance of a residual, to `out` (2, 2) [px^2]."""
    for a in range(2):
        for b in range(2):
            s = var_px2 if a == b else 0.0
            for p in range(3):
                for q in range(3):
                    s += J[a, p] * cov_m2[p, q] * J[b, q]
            out[a, b] = s


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def score_to_factor(score, good_score):
    """Return by how much a key point of this score is less certain than a good one.

    Notes
    -----
    The median error of OpenPose on Shelf is 10 px at scores above 0.8, 15 px at 0.6 to 0.8 and
    26 px at 0.4 to 0.6: a power of -1.7.
    """
    if score >= good_score:
        return 1.0
    return min((good_score / max(score, 1e-3)) ** SCORE_POWER, LARGEST_FACTOR)


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def inlier_log_ratio(e, C, m_per_px, log_inlier, outlier_share):
    """Return the log density of a residual, relative to clutter, and the inlier responsibility.

    Parameters
    ----------
    e
        Residual, (2,) [px].
    C
        Its covariance, (2, 2) [px^2].
    m_per_px
        Length of a pixel at the person's distance [m].
    log_inlier, outlier_share
        See `Noise`.

    Notes
    -----
    Density of a key point: ``(1 - eps) N(e; 0, C) + eps / A`` in metres at the person's distance,
    divided by that of clutter, ``1 / A``; the sum by log-sum-exp (thesis eq. 25-26).
    """
    det = C[0, 0] * C[1, 1] - C[0, 1] * C[1, 0]
    d2 = (C[1, 1] * e[0] * e[0] - 2.0 * C[0, 1] * e[0] * e[1] + C[0, 0] * e[1] * e[1]) / det
    gauss = -0.5 * d2 - 0.5 * math.log(det) - 2.0 * math.log(m_per_px) - 1.8378770664093453
    a = log_inlier + gauss
    b = math.log(outlier_share)
    top = max(a, b)
    total = top + math.log(math.exp(a - top) + math.exp(b - top))
    return total, math.exp(a - total)


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def project_person(P, xyz_m, cov_m2, uv, S, depth_m):
    """Write a person's projected joints, their covariance and depth to `uv`, `S`, `depth_m`."""
    J = np.empty((2, 3))
    for j in range(xyz_m.shape[0]):
        depth_m[j] = project(P, xyz_m[j], uv[j], J)
        image_covariance(J, cov_m2[j], 0.0, S[j])


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def mean_distance_m(uv, depth_m, focal_px, xy_px):
    """Return the mean distance between joints and key points at the person's distance [m]."""
    total, n = 0.0, 0
    for j in range(uv.shape[0]):
        if math.isnan(xy_px[j, 0]) or not depth_m[j] > NEAR_M:
            continue
        dx, dy = xy_px[j, 0] - uv[j, 0], xy_px[j, 1] - uv[j, 1]
        total += math.sqrt(dx * dx + dy * dy) * depth_m[j] / focal_px
        n += 1
    return total / n if n else math.inf


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def person_log_ratio(uv, S, depth_m, focal_px, xy_px, score, noise, flipped, e, C):
    """Return the log likelihood ratio of one detection and one person to clutter."""
    total = noise.log_flip if flipped else 0.0
    for j in range(uv.shape[0]):
        m = noise.mirror[j] if flipped else j
        if math.isnan(xy_px[m, 0]) or not depth_m[j] > NEAR_M:
            continue
        m_per_px = depth_m[j] / focal_px
        sigma = noise.sigma_m[j] / m_per_px * score_to_factor(score[m], noise.good_score)
        var = sigma * sigma + noise.floor_px * noise.floor_px
        C[0, 0], C[0, 1] = S[j, 0, 0] + var, S[j, 0, 1]
        C[1, 0], C[1, 1] = S[j, 1, 0], S[j, 1, 1] + var
        e[0], e[1] = xy_px[m, 0] - uv[j, 0], xy_px[m, 1] - uv[j, 1]
        ratio, _ = inlier_log_ratio(e, C, m_per_px, noise.log_inlier, noise.outlier_share)
        total += ratio
    return total


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def score_view(P, focal_px, xyz_m, cov_m2, xy_px, score, noise, reach_m, out, flip):
    """Score every detection of one image against every track: log likelihood ratio to clutter.

    Parameters
    ----------
    P, focal_px
        The camera: projection matrix (3, 4), mean focal length [px].
    xyz_m, cov_m2
        Tracks at the image's time, (track, joint, 3) and (track, joint, 3, 3); NaN where a joint
        is not known.
    xy_px, score
        Undistorted key points (person, joint, 2), NaN where not to be used, and their scores.
    noise
        The detector's `Noise`.
    reach_m
        Detections whose key points lie further away on average are not scored (-inf).
    out, flip
        Results, (track, person): log ratio; 1 where the exchanged reading is likelier.
    """
    n_joint = xyz_m.shape[1]
    uv = np.empty((n_joint, 2))
    S = np.empty((n_joint, 2, 2))
    depth_m = np.empty(n_joint)
    e = np.empty(2)
    C = np.empty((2, 2))
    for k in range(xyz_m.shape[0]):
        project_person(P, xyz_m[k], cov_m2[k], uv, S, depth_m)
        for d in range(xy_px.shape[0]):
            out[k, d] = -math.inf
            flip[k, d] = 0
            if mean_distance_m(uv, depth_m, focal_px, xy_px[d]) > reach_m:
                continue
            for f in range(2):
                ratio = person_log_ratio(
                    uv, S, depth_m, focal_px, xy_px[d], score[d], noise, f, e, C
                )
                if ratio > out[k, d]:
                    out[k, d] = ratio
                    flip[k, d] = f
