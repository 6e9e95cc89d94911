"""Compiled kernels of the fusion; each has a slow, obvious twin in ``tests/reference.py``.

A trajectory of one joint is the solution of a least-squares problem in its live control points
``c``: minimise ``|R c - z|^2`` with ``R`` upper triangular, the square root of the information.
Observations and motion are rows that Givens rotations fold into it. Because the columns run from
old to new, cutting off the first rows and columns marginalises the oldest control point exactly,
and the information can never lose its positive definiteness.

Arrays are C-contiguous float64. Axes: track, joint, view, and ``n = 3 * live`` unknowns per joint.
"""

import math
from typing import no_type_check

import numpy as np
from numba import njit

BLOCK = 3
REACH = 4 * BLOCK
LOOSEN = 25.0


@njit(cache=True, nogil=True)
@no_type_check
def fold_row(R, z, row, y):
    """Fold the equation ``row @ c = y`` into ``R c = z``, in place; `row` is destroyed.

    Notes
    -----
    Givens rotations, left to right. B-splines couple four neighbouring control points, so the
    factor is banded and a rotation touches at most twelve columns.
    """
    n = R.shape[0]
    for i in range(n):
        a = row[i]
        if a == 0.0:
            continue
        d = R[i, i]
        h = math.sqrt(d * d + a * a)
        c, s = d / h, a / h
        R[i, i] = h
        stop = min(n, (i // BLOCK) * BLOCK + REACH)
        for k in range(i + 1, stop):
            r = R[i, k]
            R[i, k] = c * r + s * row[k]
            row[k] = c * row[k] - s * r
        r = z[i]
        z[i] = c * r + s * y
        y = c * y - s * r


@njit(cache=True, nogil=True)
@no_type_check
def extend(R, z, stiffness, memory, drift_m, work):
    """Marginalise the oldest control point of one joint and append a new one, in place.

    Parameters
    ----------
    R, z
        Square-root information of the joint, (n, n) and (n,).
    stiffness
        Weight of the smoothing prior, ``1 / sqrt(q knot^3)`` [1/m] (thesis eq. 49-56, second
        differences of control points).
    memory
        How much of its own velocity the joint keeps over one knot, 0 to 1.
    drift_m
        How far the body moves in one knot, (3,) [m]; the rest of the velocity.
    work
        Scratch, (n,).
    """
    n = R.shape[0]
    for i in range(n - BLOCK):
        for k in range(n - BLOCK):
            R[i, k] = R[i + BLOCK, k + BLOCK]
        z[i] = z[i + BLOCK]
    for i in range(n):
        for k in range(n - BLOCK, n):
            R[i, k] = 0.0
            R[k, i] = 0.0
    for a in range(BLOCK):
        z[n - BLOCK + a] = 0.0
    for a in range(BLOCK):
        work[:] = 0.0
        work[n - 9 + a] = memory * stiffness
        work[n - 6 + a] = -(1.0 + memory) * stiffness
        work[n - 3 + a] = stiffness
        fold_row(R, z, work, (1.0 - memory) * drift_m[a] * stiffness)


@njit(cache=True, nogil=True)
@no_type_check
def start(R, z, xyz_m, position_sigma_m, step_sigma_m, stiffness, work):
    """Set up a joint that rests at `xyz_m`, with wide uncertainty, in place.

    `step_sigma_m` is the standard deviation of the way between two control points [m].
    """
    n = R.shape[0]
    R[:] = 0.0
    z[:] = 0.0
    for a in range(BLOCK):
        work[:] = 0.0
        work[a] = 1.0 / position_sigma_m
        fold_row(R, z, work, xyz_m[a] / position_sigma_m)
        work[:] = 0.0
        work[a] = -1.0 / step_sigma_m
        work[BLOCK + a] = 1.0 / step_sigma_m
        fold_row(R, z, work, 0.0)
    for p in range(n // BLOCK - 2):
        for a in range(BLOCK):
            work[:] = 0.0
            work[BLOCK * p + a] = stiffness
            work[BLOCK * (p + 1) + a] = -2.0 * stiffness
            work[BLOCK * (p + 2) + a] = stiffness
            fold_row(R, z, work, 0.0)


@njit(cache=True, nogil=True)
@no_type_check
def control_points(R, z, c):
    """Solve ``R c = z`` by back substitution into `c` (n,)."""
    n = R.shape[0]
    for i in range(n - 1, -1, -1):
        s = z[i]
        stop = min(n, (i // BLOCK) * BLOCK + REACH)
        for k in range(i + 1, stop):
            s -= R[i, k] * c[k]
        c[i] = s / R[i, i]


@njit(cache=True, nogil=True)
@no_type_check
def curve_covariance(R, span, weights, y, cov_m2):
    """Write the covariance of the curve's point at ``span, weights`` to `cov_m2` (3, 3).

    Notes
    -----
    With ``B`` the row of basis weights, ``cov = B (R^T R)^-1 B^T = |R^-T B^T|^2``; control points
    older than the span drop out of it. `y` is scratch, (n, 3).
    """
    n = R.shape[0]
    first = BLOCK * span
    for i in range(first, n):
        m = i // BLOCK - span
        start_k = max(first, (i // BLOCK - 3) * BLOCK)
        for a in range(BLOCK):
            s = weights[m] if (m < 4 and i % BLOCK == a) else 0.0
            for k in range(start_k, i):
                s -= R[k, i] * y[k, a]
            y[i, a] = s / R[i, i]
    for a in range(BLOCK):
        for b in range(BLOCK):
            s = 0.0
            for i in range(first, n):
                s += y[i, a] * y[i, b]
            cov_m2[a, b] = s


@njit(cache=True, nogil=True)
@no_type_check
def extend_all(R, z, stiffness, memory, drift_m):
    """Move every track and joint on by one control point, in place.

    `stiffness` is per joint, `memory` per track and joint, `drift_m` per track (track, 3).
    """
    work = np.empty(R.shape[2])
    for k in range(R.shape[0]):
        for j in range(R.shape[1]):
            extend(R[k, j], z[k, j], stiffness[j], memory[k, j], drift_m[k], work)


@njit(cache=True, nogil=True)
@no_type_check
def start_all(R, z, xyz_m, position_sigma_m, step_sigma_m, stiffness):
    """Set up all joints of one new track, in place; see `start`."""
    work = np.empty(R.shape[1])
    for j in range(R.shape[0]):
        start(R[j], z[j], xyz_m[j], position_sigma_m[j], step_sigma_m, stiffness[j], work)


@njit(cache=True, nogil=True)
@no_type_check
def solve_all(R, z, c):
    """Write the control points of every track and joint to `c` (track, joint, n)."""
    for k in range(R.shape[0]):
        for j in range(R.shape[1]):
            control_points(R[k, j], z[k, j], c[k, j])


@njit(cache=True, nogil=True)
@no_type_check
def evaluate_all(c, span, weights, xyz_m):
    """Write the curves' points at ``span, weights`` to `xyz_m` (track, joint, 3)."""
    for k in range(c.shape[0]):
        for j in range(c.shape[1]):
            for a in range(BLOCK):
                s = 0.0
                for m in range(4):
                    s += weights[m] * c[k, j, BLOCK * (span + m) + a]
                xyz_m[k, j, a] = s


@njit(cache=True, nogil=True)
@no_type_check
def covariance_all(R, span, weights, cov_m2):
    """Write the curves' covariances at ``span, weights`` to `cov_m2` (track, joint, 3, 3)."""
    y = np.empty((R.shape[2], BLOCK))
    for k in range(R.shape[0]):
        for j in range(R.shape[1]):
            curve_covariance(R[k, j], span, weights, y, cov_m2[k, j])


@njit(cache=True, nogil=True)
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


@njit(cache=True, nogil=True)
@no_type_check
def score_to_factor(score, good_score):
    """Return by how much a key point of this score is less certain than a good one."""
    if score >= good_score:
        return 1.0
    return min((good_score / max(score, 1e-3)) ** 1.7, 6.0)


@njit(cache=True, nogil=True)
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
    log_inlier
        ``log((1 - outlier_share) * outlier_area_m2)``.
    outlier_share
        Prior share of key points that have nothing to do with the joint.

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


@njit(cache=True, nogil=True)
@no_type_check
def score_view(
    P, focal_px, xyz_m, cov_m2, xy_px, score, mirror, sigma_m, floor_px, good_score,
    log_inlier, outlier_share, log_flip, reach_m, out, flip,
):
    """Score every detection of one image against every track: log likelihood ratio to clutter.

    Parameters
    ----------
    P, focal_px
        The camera: projection matrix (3, 4), mean focal length [px].
    xyz_m, cov_m2
        Tracks at the image's time, (track, joint, 3) and (track, joint, 3, 3).
    xy_px, score
        Undistorted key points (person, joint, 2), NaN where not to be used, and their scores.
    mirror
        Index of each joint's left-right counterpart.
    sigma_m, floor_px, good_score, log_inlier, outlier_share
        Noise model, see `inlier_log_ratio` and `score_to_factor`; `sigma_m` per joint.
    log_flip
        Log of the prior odds that left and right are exchanged.
    reach_m
        Detections whose key points lie further away on average are not scored (-inf).
    out, flip
        Results, (track, person): log ratio; 1 where the exchanged reading is likelier.
    """
    n_joint = xyz_m.shape[1]
    uv = np.empty((n_joint, 2))
    S = np.empty((n_joint, 2, 2))
    w = np.empty(n_joint)
    J = np.empty((2, 3))
    C = np.empty((2, 2))
    e = np.empty(2)
    for k in range(xyz_m.shape[0]):
        for j in range(n_joint):
            w[j] = project(P, xyz_m[k, j], uv[j], J)
            for a in range(2):
                for b in range(2):
                    s = 0.0
                    for p in range(3):
                        for q in range(3):
                            s += J[a, p] * cov_m2[k, j, p, q] * J[b, q]
                    S[j, a, b] = s
        for d in range(xy_px.shape[0]):
            out[k, d] = -math.inf
            flip[k, d] = 0
            distance, n = 0.0, 0
            for j in range(n_joint):
                if math.isnan(xy_px[d, j, 0]) or not w[j] > 0.05:
                    continue
                dx, dy = xy_px[d, j, 0] - uv[j, 0], xy_px[d, j, 1] - uv[j, 1]
                distance += math.sqrt(dx * dx + dy * dy) * w[j] / focal_px
                n += 1
            if n == 0 or distance > reach_m * n:
                continue
            best = -math.inf
            for f in range(2):
                total = log_flip if f else 0.0
                for j in range(n_joint):
                    m = mirror[j] if f else j
                    if math.isnan(xy_px[d, m, 0]) or not w[j] > 0.05:
                        continue
                    m_per_px = w[j] / focal_px
                    sigma = sigma_m[j] / m_per_px * score_to_factor(score[d, m], good_score)
                    var = sigma * sigma + floor_px * floor_px
                    C[:] = S[j]
                    C[0, 0] += var
                    C[1, 1] += var
                    e[0] = xy_px[d, m, 0] - uv[j, 0]
                    e[1] = xy_px[d, m, 1] - uv[j, 1]
                    ratio, _ = inlier_log_ratio(e, C, m_per_px, log_inlier, outlier_share)
                    total += ratio
                if total > best:
                    best = total
                    flip[k, d] = f
            out[k, d] = best


@njit(cache=True, nogil=True)
@no_type_check
def invert3(A, out):
    """Write the inverse of a symmetric positive 3 x 3 matrix to `out`."""
    a, b, c = A[0, 0], A[0, 1], A[0, 2]
    d, e, f = A[1, 1], A[1, 2], A[2, 2]
    p, q, r = d * f - e * e, c * e - b * f, b * e - c * d
    det = a * p + b * q + c * r
    out[0, 0], out[0, 1], out[0, 2] = p / det, q / det, r / det
    out[1, 0], out[1, 1], out[1, 2] = q / det, (a * f - c * c) / det, (b * c - a * e) / det
    out[2, 0], out[2, 1], out[2, 2] = r / det, (b * c - a * e) / det, (a * d - b * b) / det


@njit(cache=True, nogil=True)
@no_type_check
def locate_joint(
    P, focal_px, xyz_m, prior_m2, xy_px, sigma_m, floor_px, weight, log_inlier, outlier_share,
    iterations, shift_m, cov_m2, inlier,
):
    """Find one joint from its key points in several images and its predicted place, by EM.

    Parameters
    ----------
    P, focal_px
        Cameras of the images, (view, 3, 4) and (view,).
    xyz_m
        Predicted place at each image's own time, (view, 3).
    prior_m2
        Covariance of the prediction, (3, 3).
    xy_px
        Key points, (view, 2); NaN where missing.
    sigma_m, floor_px
        Noise of each key point as a length at the person's distance (view,), and its floor.
    weight
        What each observation is worth, 0 to 1 (responsibility of the person, memory of errors).
    log_inlier, outlier_share
        See `inlier_log_ratio`.
    iterations
        EM steps.
    shift_m, cov_m2, inlier
        Results: the joint lies at ``xyz_m + shift_m`` with this covariance; responsibility of
        the joint for each key point.

    Notes
    -----
    E step: thesis eq. 33 with a clutter term. M step: one Gauss-Newton step of eq. 37 with the
    Jacobian of eq. 42-46. The images of a frame set share one shift of the predicted curve.
    """
    n_view = P.shape[0]
    uv = np.empty(2)
    J = np.empty((2, 3))
    C = np.empty((2, 2))
    e = np.empty(2)
    x = np.empty(3)
    prior_inv = np.empty((3, 3))
    info = np.empty((3, 3))
    rhs = np.empty(3)
    invert3(prior_m2, prior_inv)
    shift_m[:] = 0.0
    cov_m2[:] = prior_m2
    for _ in range(iterations):
        info[:] = prior_inv
        rhs[:] = 0.0
        for v in range(n_view):
            inlier[v] = 0.0
            if math.isnan(xy_px[v, 0]):
                continue
            for a in range(3):
                x[a] = xyz_m[v, a] + shift_m[a]
            w = project(P[v], x, uv, J)
            if not w > 0.05:
                continue
            m_per_px = w / focal_px[v]
            sigma = sigma_m[v] / m_per_px
            var = sigma * sigma + floor_px * floor_px
            for a in range(2):
                e[a] = xy_px[v, a] - uv[a]
                for b in range(2):
                    s = var if a == b else 0.0
                    for p in range(3):
                        for q in range(3):
                            s += J[a, p] * cov_m2[p, q] * J[b, q]
                    C[a, b] = s
            _, r = inlier_log_ratio(e, C, m_per_px, log_inlier, outlier_share)
            inlier[v] = r
            g = r * weight[v] / var
            for a in range(2):
                along = e[a]
                for p in range(3):
                    along += J[a, p] * shift_m[p]
                for p in range(3):
                    rhs[p] += g * J[a, p] * along
                    for q in range(3):
                        info[p, q] += g * J[a, p] * J[a, q]
        invert3(info, cov_m2)
        for a in range(3):
            shift_m[a] = cov_m2[a, 0] * rhs[0] + cov_m2[a, 1] * rhs[1] + cov_m2[a, 2] * rhs[2]


@njit(cache=True, nogil=True)
@no_type_check
def fold_joint(R, z, P, focal_px, span, weights, xyz_m, xy_px, sigma_m, floor_px, weight, work):
    """Fold the key points of one joint into its trajectory, each at its image's own time.

    Parameters
    ----------
    R, z
        Square-root information of the joint, changed in place.
    P, focal_px
        Cameras, (view, 3, 4) and (view,).
    span, weights
        Place of each image on the knot grid, (view,) and (view, 4).
    xyz_m
        Points about which the projections are linearised, (view, 3).
    xy_px, sigma_m, floor_px, weight
        Key points (view, 2), their noise and worth; a weight of 0 leaves the image out.
    work
        Scratch, (n,).
    """
    uv = np.empty(2)
    J = np.empty((2, 3))
    for v in range(P.shape[0]):
        if math.isnan(xy_px[v, 0]) or not weight[v] > 1e-4:
            continue
        w = project(P[v], xyz_m[v], uv, J)
        if not w > 0.05:
            continue
        sigma = sigma_m[v] * focal_px[v] / w
        gain = math.sqrt(weight[v] / (sigma * sigma + floor_px * floor_px))
        for a in range(2):
            work[:] = 0.0
            y = xy_px[v, a] - uv[a]
            for p in range(3):
                y += J[a, p] * xyz_m[v, p]
                for m in range(4):
                    work[BLOCK * (span[v] + m) + p] = gain * J[a, p] * weights[v, m]
            fold_row(R, z, work, gain * y)


@njit(cache=True, nogil=True)
@no_type_check
def assign(gain, best):
    """Assign rows to columns so that the sum of gains is largest; write column or -1 to `best`.

    Only positive gains count: a row may stay without a column. Shortest augmenting paths
    (Jonker-Volgenant) on the gains, with one private empty column per row.
    """
    n_row, n_col = gain.shape
    m = n_col + n_row
    u = np.zeros(n_row + 1)
    v = np.zeros(m + 1)
    owner = np.zeros(m + 1, np.int64)
    way = np.zeros(m + 1, np.int64)
    low = np.empty(m + 1)
    used = np.empty(m + 1, np.bool_)
    for i in range(1, n_row + 1):
        owner[0] = i
        col = 0
        low[:] = math.inf
        used[:] = False
        while True:
            used[col] = True
            row = owner[col]
            delta = math.inf
            nxt = 0
            for j in range(1, m + 1):
                if used[j]:
                    continue
                if j <= n_col:
                    cost = -gain[row - 1, j - 1] if gain[row - 1, j - 1] > 0.0 else 1e9
                else:
                    cost = 0.0 if j - n_col == row else 1e9
                reduced = cost - u[row] - v[j]
                if reduced < low[j]:
                    low[j] = reduced
                    way[j] = col
                if low[j] < delta:
                    delta = low[j]
                    nxt = j
            for j in range(m + 1):
                if used[j]:
                    u[owner[j]] += delta
                    v[j] -= delta
                else:
                    low[j] -= delta
            col = nxt
            if owner[col] == 0:
                break
        while col:
            prev = way[col]
            owner[col] = owner[prev]
            col = prev
    best[:] = -1
    for j in range(1, n_col + 1):
        if owner[j] > 0 and gain[owner[j] - 1, j - 1] > 0.0:
            best[owner[j] - 1] = j - 1


@njit(cache=True, nogil=True)
@no_type_check
def fit_all(
    R, z, xyz_m, prior_m2, cam, P, focal_px, span, weights, xy_px, score, match, flip, worth,
    mirror, sigma_m, floor_px, good_score, log_inlier, outlier_share, inlier,
):
    """Fit every track to the detections assigned to it in one frame set, in place.

    Parameters
    ----------
    R, z
        Square-root information, (track, joint, n, n) and (track, joint, n); changed in place.
    xyz_m
        Predictions at each image's own time, (view, track, joint, 3).
    prior_m2
        Their covariance at the frame set's time, (track, joint, 3, 3).
    cam, P, focal_px
        Camera of each image (view,); projections (cam, 3, 4) and mean focal lengths (cam,).
    span, weights
        Place of each image on the knot grid, (view,) and (view, 4).
    xy_px, score
        All detections of the set, (person, joint, 2) and (person, joint).
    match, flip, worth
        Per track and view: index of its detection or -1; 1 to read it mirrored; weight 0 to 1.
    mirror, sigma_m, floor_px, good_score, log_inlier, outlier_share
        See `score_view`.
    inlier
        Result, (track, view, joint): responsibility of the joint for its key point.

    Notes
    -----
    Where two or more key points agree with each other but not with the prediction, the person
    has turned sharply: the joint's information is loosened and it is sought again.
    """
    n_view = cam.shape[0]
    n_joint = R.shape[1]
    P_v = np.empty((n_view, 3, 4))
    f_v = np.empty(n_view)
    span_v = np.empty(n_view, np.int64)
    b_v = np.empty((n_view, 4))
    where = np.empty(n_view, np.int64)
    x_v = np.empty((n_view, 3))
    m_v = np.empty((n_view, 2))
    sigma_v = np.empty(n_view)
    worth_v = np.empty(n_view)
    r_v = np.empty(n_view)
    loose_r = np.empty(n_view)
    shift = np.empty(3)
    loose = np.empty(3)
    cov = np.empty((3, 3))
    wide = np.empty((3, 3))
    work = np.empty(R.shape[2])
    inlier[:] = 0.0
    for k in range(R.shape[0]):
        n = 0
        for v in range(n_view):
            if match[k, v] >= 0:
                where[n] = v
                P_v[n] = P[cam[v]]
                f_v[n] = focal_px[cam[v]]
                span_v[n] = span[v]
                b_v[n] = weights[v]
                n += 1
        for j in range(n_joint):
            seen = 0
            for i in range(n):
                v = where[i]
                d = match[k, v]
                source = mirror[j] if flip[k, v] else j
                m_v[i] = xy_px[d, source]
                x_v[i] = xyz_m[v, k, j]
                sigma_v[i] = sigma_m[j] * score_to_factor(score[d, source], good_score)
                worth_v[i] = worth[k, v]
                if not math.isnan(m_v[i, 0]):
                    seen += 1
            if seen == 0:
                continue
            locate_joint(
                P_v[:n], f_v[:n], x_v[:n], prior_m2[k, j], m_v[:n], sigma_v[:n], floor_px,
                worth_v[:n], log_inlier, outlier_share, 3, shift, cov, r_v[:n],
            )
            if seen >= 2 and r_v[:n].sum() < 0.5 * seen:
                wide[:] = prior_m2[k, j] * LOOSEN
                for a in range(3):
                    wide[a, a] += 0.01
                locate_joint(
                    P_v[:n], f_v[:n], x_v[:n], wide, m_v[:n], sigma_v[:n], floor_px,
                    worth_v[:n], log_inlier, outlier_share, 6, loose, cov, loose_r[:n],
                )
                if loose_r[:n].sum() > max(1.5, r_v[:n].sum() + 0.5):
                    R[k, j] *= 1.0 / math.sqrt(LOOSEN)
                    z[k, j] *= 1.0 / math.sqrt(LOOSEN)
                    shift[:] = loose
                    r_v[:n] = loose_r[:n]
            for i in range(n):
                inlier[k, where[i], j] = r_v[i]
                worth_v[i] *= r_v[i]
                for a in range(3):
                    x_v[i, a] += shift[a]
            fold_joint(
                R[k, j], z[k, j], P_v[:n], f_v[:n], span_v[:n], b_v[:n], x_v[:n], m_v[:n],
                sigma_v[:n], floor_px, worth_v[:n], work,
            )


@njit(cache=True, nogil=True)
@no_type_check
def pair_scores(
    cam, origin_m, ray, factor, mirror, limbs, limb_m, sigma_m, outlier_share, log_flip,
    out, flip,
):
    """Score how well any two detections of different cameras are one person.

    Parameters
    ----------
    cam
        Camera of each detection, (person,).
    origin_m, ray
        Where its viewing rays start (person, 3) and their unit directions (person, joint, 3),
        NaN where the key point is missing.
    factor
        By how much each key point is less certain than a good one, (person, joint).
    mirror, limbs, limb_m
        Mirror joints (joint,); joints of each limb (limb, 2) and its usual length (limb,) [m].
    sigma_m
        Noise of a good key point per joint [m].
    outlier_share, log_flip
        Prior share of key points that mean nothing; log prior odds of exchanged sides.
    out, flip
        Results, (person, person), upper triangle: log ratio to chance; 1 where the two disagree
        about left and right.

    Notes
    -----
    Two rays of the same joint pass close to each other; the points halfway between them make a
    body of human size. Both are log likelihood ratios against rays and lengths at random.
    """
    n_det, n_joint = ray.shape[0], ray.shape[1]
    x = np.empty((n_joint, 3))
    for i in range(n_det):
        for k in range(i + 1, n_det):
            out[i, k] = -math.inf
            flip[i, k] = 0
            if cam[i] == cam[k]:
                continue
            for f in range(2):
                total = log_flip if f else 0.0
                close = 0
                for j in range(n_joint):
                    m = mirror[j] if f else j
                    x[j, 0] = math.nan
                    gap = ray_midpoint(origin_m[i], ray[i, j], origin_m[k], ray[k, m], x[j])
                    if math.isnan(gap):
                        continue
                    sigma = sigma_m[j] * math.sqrt(factor[i, j] ** 2 + factor[k, m] ** 2)
                    gauss = math.exp(-0.5 * (gap / sigma) ** 2) / (sigma * 2.5066282746310002)
                    total += math.log((1.0 - outlier_share) * gauss + outlier_share)
                    if gap < 3.0 * sigma:
                        close += 1
                    else:
                        x[j, 0] = math.nan
                if close < 4:
                    continue
                for b in range(limbs.shape[0]):
                    p, q = x[limbs[b, 0]], x[limbs[b, 1]]
                    if math.isnan(p[0]) or math.isnan(q[0]):
                        continue
                    length = math.sqrt(
                        (p[0] - q[0]) ** 2 + (p[1] - q[1]) ** 2 + (p[2] - q[2]) ** 2
                    )
                    ratio = math.log(max(length, 1e-3) / limb_m[b])
                    total += max(1.3 - 4.0 * ratio * ratio, -4.0)
                if total > out[i, k]:
                    out[i, k] = total
                    flip[i, k] = f


@njit(cache=True, nogil=True)
@no_type_check
def ray_midpoint(p, u, q, v, out):
    """Write the point halfway between two rays to `out`; return their distance there [m].

    NaN where a ray is missing, they are nearly parallel, or meet behind a camera.
    """
    if math.isnan(u[0]) or math.isnan(v[0]):
        return math.nan
    b = u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
    den = 1.0 - b * b
    if den < 1e-3:
        return math.nan
    d = du = dv = 0.0
    for a in range(3):
        d = q[a] - p[a]
        du += d * u[a]
        dv += d * v[a]
    s = (du - b * dv) / den
    t = (b * du - dv) / den
    if s < 0.2 or t < 0.2:
        return math.nan
    gap = 0.0
    for a in range(3):
        first, second = p[a] + s * u[a], q[a] + t * v[a]
        out[a] = 0.5 * (first + second)
        gap += (first - second) ** 2
    return math.sqrt(gap)
