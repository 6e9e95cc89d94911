"""Finding one joint by EM: where it is, and what its key points say about that."""

import math
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float64, Int64

from trecsim.compiler import inner
from trecsim.fusion.kernels.mixture import image_covariance, inlier_odds, project, widened
from trecsim.fusion.kernels.small_matrices import copy, invert3
from trecsim.fusion.tuning import EM_STEPS, NEAR_M, STILL_M2, TOGETHER


class Observed(NamedTuple):
    """Key points of one joint in several images.

    Attributes
    ----------
    cam
        Cameras of the images.
    knot_time, moment
        When they were taken, in knots, and the number of the moment each belongs to.
    xyz_m
        Predicted place of the joint at each image's own time.
    xy_px
        Key points; NaN where missing.
    sigma_m
        Noise of each key point as a length at the person's distance.
    credit
        What each observation is worth, 0 to 1.
    slack
        How much further than usual the joint may be from its prediction.
    """

    cam: Int64[np.ndarray, " view"]
    knot_time: Float64[np.ndarray, " view"]
    moment: Int64[np.ndarray, " view"]
    xyz_m: Float64[np.ndarray, "view 3"]
    xy_px: Float64[np.ndarray, "view 2"]
    sigma_m: Float64[np.ndarray, " view"]
    credit: Float64[np.ndarray, " view"]
    slack: Float64[np.ndarray, " view"]


class Located(NamedTuple):
    """Where one person's joints are found, and what the images of each moment say about them.

    Attributes
    ----------
    info, rhs
        Information and information vector of a joint's shift from its prediction, summed over the
        cameras; linearised at the last EM step but one.
    knot_time, weight
        Weighted sum of the images' times in knots, and sum of the weights.
    is_known
        Whether there is a key point of the joint.
    shift_m, cov_m2
        How far the joint lies from its prediction, and its covariance.
    inlier, innovation_px, off_px, weight_px, m_per_px
        Of the joint that was located last; see `Fitted`.
    """

    info: Float64[np.ndarray, "joint moment 3 3"]
    rhs: Float64[np.ndarray, "joint moment 3"]
    knot_time: Float64[np.ndarray, "joint moment"]
    weight: Float64[np.ndarray, "joint moment"]
    is_known: Bool[np.ndarray, " joint"]
    shift_m: Float64[np.ndarray, "joint 3"]
    cov_m2: Float64[np.ndarray, "joint 3 3"]
    inlier: Float64[np.ndarray, " view"]
    innovation_px: Float64[np.ndarray, "view 2"]
    off_px: Float64[np.ndarray, "view 2"]
    weight_px: Float64[np.ndarray, " view"]
    m_per_px: Float64[np.ndarray, " view"]


class Scratch(NamedTuple):
    """Arrays that the kernels overwrite, allocated once per call."""

    x: Float64[np.ndarray, "3"]
    basis: Float64[np.ndarray, "4"]
    info: Float64[np.ndarray, "3 3"]
    prior: Float64[np.ndarray, "3 3"]
    known: Float64[np.ndarray, "3 3"]
    rows: Float64[np.ndarray, "3 n"]
    right: Float64[np.ndarray, "3"]
    y: Float64[np.ndarray, "n 3"]


@inner(allocates=True)
def scratch(n):
    """Allocate the scratch arrays for joints of `n` unknowns."""
    return Scratch(
        np.empty(3), np.empty(4), np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)),
        np.empty((3, n)), np.empty(3), np.empty((n, 3)),
    )  # fmt: skip


@inner(allocates=True)
def observed(n_view):
    """Allocate room for the key points of one joint in `n_view` images."""
    return Observed(
        np.empty(n_view, np.int64), np.empty(n_view), np.empty(n_view, np.int64),
        np.empty((n_view, 3)), np.empty((n_view, 2)), np.empty(n_view), np.empty(n_view),
        np.empty(n_view),
    )  # fmt: skip


@inner(allocates=True)
def located(n_joint, n_moment, n_view):
    """Allocate room for one person's joints, found in `n_view` images of `n_moment` moments."""
    return Located(
        np.empty((n_joint, n_moment, 3, 3)), np.empty((n_joint, n_moment, 3)),
        np.empty((n_joint, n_moment)), np.empty((n_joint, n_moment)), np.empty(n_joint, np.bool_),
        np.empty((n_joint, 3)), np.empty((n_joint, 3, 3)), np.empty(n_view), np.empty((n_view, 2)),
        np.empty((n_view, 2)), np.empty(n_view), np.empty(n_view),
    )  # fmt: skip


@inner
def moments(knot_time, moment):
    """Write the moment each image belongs to, counted back from the newest; return how many."""
    newest = -math.inf
    for v in range(knot_time.shape[0]):
        newest = max(newest, knot_time[v])
    most = 0
    for v in range(knot_time.shape[0]):
        moment[v] = int((newest - knot_time[v]) / TOGETHER)
        most = max(most, moment[v])
    return most + 1


@inner
def add_image(info, rhs, weight, du, dv, eu, ev, shift_m):
    """Add an image's equations for the shift to `info` and `rhs`; return their information."""
    along_u = eu + du[0] * shift_m[0] + du[1] * shift_m[1] + du[2] * shift_m[2]
    along_v = ev + dv[0] * shift_m[0] + dv[1] * shift_m[1] + dv[2] * shift_m[2]
    size = 0.0
    for p in range(3):
        gu, gv = weight * du[p], weight * dv[p]
        rhs[p] += gu * along_u + gv * along_v
        size += gu * du[p] + gv * dv[p]
        for q in range(3):
            info[p, q] += gu * du[q] + gv * dv[q]
    return size


@inner
def begin_em(prior_m2, located, j, tmp):
    """Put a joint where it was predicted."""
    shift_m = located.shift_m[j]
    for a in range(3):
        shift_m[a] = 0.0
    copy(prior_m2, located.cov_m2[j])
    invert3(prior_m2, tmp.known)


@inner
def locate_joint(cameras, noise, seen, n, located, j, tmp):
    """Find one joint from its key points in several images by EM, from where it is now.

    Parameters
    ----------
    cameras, noise
        `Cameras` and `Noise`.
    seen, n
        The `Observed` key points; only the first `n` count.
    located, j
        Result: `Located`, of which the part of joint `j` is written; `begin_em` prepares it.
    tmp
        `Scratch`.

    Notes
    -----
    E step: thesis eq. 33 with a clutter term. M step: one Gauss-Newton step of eq. 37 with the
    Jacobian of eq. 42-46. The images of a frame set share one shift of the predicted curve.
    """
    # Out of the tuples once, as every access to one of their arrays costs more than its use; and
    # all steps in one function, as a call with these tuples costs as much as a camera.
    P, focal_px, error_px2 = cameras.P, cameras.focal_px, cameras.error_px2
    cam, moment, knot_time, credit = seen.cam, seen.moment, seen.knot_time, seen.credit
    xyz_m, xy_px, sigma_m, slack = seen.xyz_m, seen.xy_px, seen.sigma_m, seen.slack
    info, rhs, inlier = located.info[j], located.rhs[j], located.inlier
    innovation_px, off_px = located.innovation_px, located.off_px
    weight_px, scale_m = located.weight_px, located.m_per_px
    sum_time, sum_weight = located.knot_time[j], located.weight[j]
    shift_m, cov_m2, known, total, vector = (
        located.shift_m[j], located.cov_m2[j], tmp.known, tmp.info, tmp.x,
    )  # fmt: skip
    white_share = noise.white_share
    tail, odds_m2, least_px2 = noise.tail, noise.odds_m2, noise.floor_px * noise.floor_px
    for step in range(EM_STEPS):
        clear(info, rhs, sum_time, sum_weight)
        for v in range(n):
            inlier[v] = weight_px[v] = scale_m[v] = 0.0
            if math.isnan(xy_px[v, 0]):
                continue
            w, u, v_, du, dv = project(
                P, cam[v], xyz_m[v, 0] + shift_m[0], xyz_m[v, 1] + shift_m[1],
                xyz_m[v, 2] + shift_m[2],
            )  # fmt: skip
            if not w > NEAR_M:
                continue
            eu, ev, m_per_px = xy_px[v, 0] - u, xy_px[v, 1] - v_, w / focal_px[cam[v]]
            var = (sigma_m[v] / m_per_px) ** 2 + least_px2
            uu, uv, vv = widened(*image_covariance(du, dv, cov_m2), m_per_px, slack[v])
            wide = var + error_px2[cam[v]]
            odds = inlier_odds(eu, ev, uu + wide, uv, vv + wide, m_per_px, odds_m2)
            inlier[v] = odds / (1.0 + odds)
            # Student's t as a scale mixture of Gaussians, in two dimensions.
            heavy = (tail + 2.0) / (tail + (eu * eu + ev * ev) / var)
            weight = inlier[v] * credit[v] * heavy / (white_share * var)
            if step == 0:
                innovation_px[v, 0], innovation_px[v, 1] = eu, ev
            off_px[v, 0], off_px[v, 1], weight_px[v], scale_m[v] = eu, ev, weight, m_per_px
            m = moment[v]
            size = add_image(info[m], rhs[m], weight, du, dv, eu, ev, shift_m)
            sum_time[m] += size * knot_time[v]
            sum_weight[m] += size
        copy(known, total)
        if newton_step(info, rhs, total, vector, shift_m, cov_m2) < STILL_M2:
            return


@inner
def clear(info, rhs, knot_time, weight):
    """Set the sums of one joint to zero; loops compile much faster than array expressions."""
    for m in range(weight.shape[0]):
        knot_time[m] = weight[m] = 0.0
        for p in range(3):
            rhs[m, p] = 0.0
            for q in range(3):
                info[m, p, q] = 0.0


@inner
def newton_step(info, rhs, total, vector, shift_m, cov_m2):
    """Write the best shift and its covariance given all moments; return how far it moved [m^2].

    Parameters
    ----------
    info, rhs
        Information of one joint's shift from each moment, (moment, 3, 3) and (moment, 3).
    total
        Information of the prediction, (3, 3); overwritten by that of all.
    vector
        Scratch, (3,).
    shift_m, cov_m2
        The shift so far, (3,), and results.
    """
    for a in range(3):
        vector[a] = 0.0
    for m in range(rhs.shape[0]):
        for p in range(3):
            vector[p] += rhs[m, p]
            for q in range(3):
                total[p, q] += info[m, p, q]
    invert3(total, cov_m2)
    moved = 0.0
    for a in range(3):
        there = cov_m2[a, 0] * vector[0] + cov_m2[a, 1] * vector[1] + cov_m2[a, 2] * vector[2]
        moved += (there - shift_m[a]) ** 2
        shift_m[a] = there
    return moved
