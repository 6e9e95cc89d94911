"""Fitting a frame set: EM on each joint's place, then folding the images at their own times."""

import math
from typing import NamedTuple, no_type_check

import numpy as np
from jaxtyping import Float64, Int64
from numba import njit

from trecsim.fusion.kernels.information import BLOCK, copy, fold_row, invert3, marked, scale
from trecsim.fusion.kernels.mixture import (
    NEAR_M,
    image_covariance,
    inlier_log_ratio,
    project,
    score_to_factor,
)

# By how much the variance of a joint grows when its key points say it has turned sharply.
LOOSEN = 25.0
LOOSEN_M2 = 0.01
# Typed, so that one compiled function serves both.
_STEPS = np.array([3, 6])


class Observed(NamedTuple):
    """Key points of one joint in several images, and where those images stand.

    Attributes
    ----------
    P, focal_px
        Cameras of the images.
    span, weights
        Place of each image on the knot grid.
    xyz_m
        Predicted place of the joint at each image's own time.
    xy_px
        Key points; NaN where missing.
    sigma_m
        Noise of each key point as a length at the person's distance.
    worth
        What each observation is worth, 0 to 1.
    """

    P: Float64[np.ndarray, "view 3 4"]
    focal_px: Float64[np.ndarray, " view"]
    span: Int64[np.ndarray, " view"]
    weights: Float64[np.ndarray, "view 4"]
    xyz_m: Float64[np.ndarray, "view 3"]
    xy_px: Float64[np.ndarray, "view 2"]
    sigma_m: Float64[np.ndarray, " view"]
    worth: Float64[np.ndarray, " view"]


class Scratch(NamedTuple):
    """Arrays that the kernels overwrite, allocated once per call."""

    uv: Float64[np.ndarray, "2"]
    J: Float64[np.ndarray, "2 3"]
    C: Float64[np.ndarray, "2 2"]
    e: Float64[np.ndarray, "2"]
    x: Float64[np.ndarray, "3"]
    prior_inv: Float64[np.ndarray, "3 3"]
    info: Float64[np.ndarray, "3 3"]
    rhs: Float64[np.ndarray, "3"]
    row: Float64[np.ndarray, " n"]


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def scratch(n):
    """Allocate the scratch arrays for joints of `n` unknowns."""
    return Scratch(
        np.empty(2), np.empty((2, 3)), np.empty((2, 2)), np.empty(2), np.empty(3),
        np.empty((3, 3)), np.empty((3, 3)), np.empty(3), np.empty(n),
    )  # fmt: skip


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def tail_weight(e, var, tail):
    """Return what a residual is worth under Student's t, relative to a Gaussian of its scale.

    Notes
    -----
    The E step of a scale mixture of Gaussians: ``(nu + 2) / (nu + d^2)`` in two dimensions.
    """
    return (tail + 2.0) / (tail + (e[0] * e[0] + e[1] * e[1]) / var)


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def weigh(seen, v, shift_m, cov_m2, noise, tmp):
    """Return the inlier responsibility of image `v` (E step) and the weight of its equations.

    Leaves residual and Jacobian at ``xyz_m + shift_m`` in `tmp`.
    """
    if math.isnan(seen.xy_px[v, 0]):
        return 0.0, 0.0
    for a in range(3):
        tmp.x[a] = seen.xyz_m[v, a] + shift_m[a]
    depth = project(seen.P[v], tmp.x, tmp.uv, tmp.J)
    if not depth > NEAR_M:
        return 0.0, 0.0
    m_per_px = depth / seen.focal_px[v]
    sigma = seen.sigma_m[v] / m_per_px
    var = sigma * sigma + noise.floor_px * noise.floor_px
    tmp.e[0] = seen.xy_px[v, 0] - tmp.uv[0]
    tmp.e[1] = seen.xy_px[v, 1] - tmp.uv[1]
    image_covariance(tmp.J, cov_m2, var, tmp.C)
    _, r = inlier_log_ratio(tmp.e, tmp.C, m_per_px, noise.log_inlier, noise.outlier_share)
    return r, r * seen.worth[v] * tail_weight(tmp.e, var, noise.tail) / var


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def locate_joint(seen, prior_m2, noise, steps, shift_m, cov_m2, inlier, tmp):
    """Find one joint from its key points in several images and its predicted place, by EM.

    Parameters
    ----------
    seen
        The `Observed` key points.
    prior_m2
        Covariance of the prediction, (3, 3).
    noise
        The detector's `Noise`.
    steps
        EM steps.
    shift_m, cov_m2, inlier
        Results: the joint lies at ``xyz_m + shift_m`` with this covariance; responsibility of
        the joint for each key point.
    tmp
        `Scratch`.

    Notes
    -----
    E step: thesis eq. 33 with a clutter term. M step: one Gauss-Newton step of eq. 37 with the
    Jacobian of eq. 42-46. The images of a frame set share one shift of the predicted curve.
    """
    invert3(prior_m2, tmp.prior_inv)
    shift_m[:] = 0.0
    copy(prior_m2, cov_m2)
    for _ in range(steps):
        copy(tmp.prior_inv, tmp.info)
        tmp.rhs[:] = 0.0
        for v in range(seen.P.shape[0]):
            inlier[v], g = weigh(seen, v, shift_m, cov_m2, noise, tmp)
            if g == 0.0:
                continue
            for a in range(2):
                along = tmp.e[a]
                for p in range(3):
                    along += tmp.J[a, p] * shift_m[p]
                for p in range(3):
                    tmp.rhs[p] += g * tmp.J[a, p] * along
                    for q in range(3):
                        tmp.info[p, q] += g * tmp.J[a, p] * tmp.J[a, q]
        invert3(tmp.info, cov_m2)
        for a in range(3):
            shift_m[a] = (
                cov_m2[a, 0] * tmp.rhs[0] + cov_m2[a, 1] * tmp.rhs[1] + cov_m2[a, 2] * tmp.rhs[2]
            )


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def fold_joint(R, z, seen, shift_m, inlier, noise, tmp):
    """Fold the key points of one joint into its trajectory, each at its image's own time.

    Parameters
    ----------
    R, z
        Square-root information of the joint, changed in place.
    seen
        The `Observed` key points.
    shift_m
        The projections are linearised about ``xyz_m + shift_m``.
    inlier
        Responsibility of the joint for each key point.
    noise, tmp
        The detector's `Noise`; `Scratch`.
    """
    for v in range(seen.P.shape[0]):
        if math.isnan(seen.xy_px[v, 0]) or not inlier[v] * seen.worth[v] > 1e-4:
            continue
        for a in range(3):
            tmp.x[a] = seen.xyz_m[v, a] + shift_m[a]
        depth = project(seen.P[v], tmp.x, tmp.uv, tmp.J)
        if not depth > NEAR_M:
            continue
        sigma = seen.sigma_m[v] * seen.focal_px[v] / depth
        var = sigma * sigma + noise.floor_px * noise.floor_px
        tmp.e[0] = seen.xy_px[v, 0] - tmp.uv[0]
        tmp.e[1] = seen.xy_px[v, 1] - tmp.uv[1]
        weight = inlier[v] * seen.worth[v] * tail_weight(tmp.e, var, noise.tail)
        gain = math.sqrt(weight / var)
        for a in range(2):
            tmp.row[:] = 0.0
            y = tmp.e[a]
            for p in range(3):
                y += tmp.J[a, p] * tmp.x[p]
                for m in range(4):
                    column = BLOCK * (seen.span[v] + m) + p
                    tmp.row[column] = gain * tmp.J[a, p] * seen.weights[v, m]
            fold_row(R, z, tmp.row, gain * y)


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def loosen_if_turned(R, z, seen, prior_m2, noise, shift_m, cov_m2, inlier, trial, tmp):
    """Seek a joint again with a wide prior where its key points agree, but not with the curve.

    A person has turned sharply when two or more key points fit each other and not the
    prediction. Then the joint's information is loosened, in place, and shift and responsibilities
    are those of the second search; otherwise nothing changes. `trial` is scratch, (3 + view,).
    """
    n = seen.P.shape[0]
    wide = np.empty((3, 3))
    for a in range(3):
        for b in range(3):
            wide[a, b] = LOOSEN * prior_m2[a, b] + (LOOSEN_M2 if a == b else 0.0)
    loose_shift, loose_inlier = trial[:3], trial[3:]
    locate_joint(seen, wide, noise, _STEPS[1], loose_shift, cov_m2, loose_inlier, tmp)
    before, after = 0.0, 0.0
    for v in range(n):
        before += inlier[v]
        after += loose_inlier[v]
    if after > max(1.5, before + 0.5):
        scale(R, z, 1.0 / math.sqrt(LOOSEN))
        for a in range(3):
            shift_m[a] = loose_shift[a]
        for v in range(n):
            inlier[v] = loose_inlier[v]


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def fit_joint(R, z, seen, prior_m2, noise, inlier, trial, tmp):
    """Locate one joint and fold its key points into the trajectory, in place."""
    n = 0
    for v in range(seen.P.shape[0]):
        inlier[v] = 0.0
        if not math.isnan(seen.xy_px[v, 0]):
            n += 1
    if n == 0:
        return
    shift_m = np.empty(3)
    cov_m2 = np.empty((3, 3))
    locate_joint(seen, prior_m2, noise, _STEPS[0], shift_m, cov_m2, inlier, tmp)
    agree = 0.0
    for v in range(seen.P.shape[0]):
        agree += inlier[v]
    if n >= 2 and agree < 0.5 * n:
        loosen_if_turned(R, z, seen, prior_m2, noise, shift_m, cov_m2, inlier, trial, tmp)
    fold_joint(R, z, seen, shift_m, inlier, noise, tmp)


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def fit_all(
    R, z, xyz_m, prior_m2, cam, P, focal_px, span, weights,
    xy_px, score, match, flip, worth, noise, inlier,
):  # fmt: skip
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
    noise
        The detector's `Noise`.
    inlier
        Result, (track, view, joint): responsibility of the joint for its key point.
    """
    n_view = cam.shape[0]
    seen = Observed(
        np.empty((n_view, 3, 4)), np.empty(n_view), np.empty(n_view, np.int64),
        np.empty((n_view, 4)), np.empty((n_view, 3)), np.empty((n_view, 2)), np.empty(n_view),
        np.empty(n_view),
    )  # fmt: skip
    tmp = scratch(R.shape[2])
    trial = np.empty(3 + n_view)
    r = np.empty(n_view)
    views = np.empty(n_view, np.int64)
    for k in range(R.shape[0]):
        n = marked(match[k], views)
        part = Observed(
            seen.P[:n], seen.focal_px[:n], seen.span[:n], seen.weights[:n], seen.xyz_m[:n],
            seen.xy_px[:n], seen.sigma_m[:n], seen.worth[:n],
        )  # fmt: skip
        for i in range(n):
            v = views[i]
            copy(P[cam[v]], part.P[i])
            part.focal_px[i], part.span[i] = focal_px[cam[v]], span[v]
            part.worth[i] = worth[k, v]
            for m in range(4):
                part.weights[i, m] = weights[v, m]
        for j in range(R.shape[1]):
            for i in range(n):
                v = views[i]
                d, m = match[k, v], noise.mirror[j] if flip[k, v] else j
                for a in range(3):
                    part.xyz_m[i, a] = xyz_m[v, k, j, a]
                part.xy_px[i, 0], part.xy_px[i, 1] = xy_px[d, m, 0], xy_px[d, m, 1]
                part.sigma_m[i] = noise.sigma_m[j] * score_to_factor(score[d, m], noise.good_score)
            fit_joint(R[k, j], z[k, j], part, prior_m2[k, j], noise, r[:n], trial[: 3 + n], tmp)
            for i in range(n):
                inlier[k, views[i], j] = r[i]
