"""Fitting a frame set: every joint is found, the body has its say, trajectories take it in."""

import math
from typing import NamedTuple, no_type_check

import numpy as np
from jaxtyping import Float64
from numba import njit

from trecsim.fusion.kernels.curve import locate, point
from trecsim.fusion.kernels.information import (
    control_points,
    copy,
    curve_covariance,
    fold_gaussian,
    scale,
)
from trecsim.fusion.kernels.lengths import GATE, TIE_M2, length_along, quotient, tighten
from trecsim.fusion.kernels.locating import (
    LOOSEN,
    TOGETHER,
    TURNED,
    UNSEEN,
    Observed,
    clear,
    moments,
    scratch,
    seek_joint,
    sums,
)


class Located(NamedTuple):
    """Where one person's joints are at the time of the frame set, before and after the body's say.

    Attributes
    ----------
    shift_m
        How far the key points say that a joint lies from its prediction.
    x_m, cov_m2
        Its place by the key points alone, and covariance.
    held_m, held_m2
        The same with the lengths of the limbs.
    """

    shift_m: Float64[np.ndarray, "joint 3"]
    x_m: Float64[np.ndarray, "joint 3"]
    cov_m2: Float64[np.ndarray, "joint 3 3"]
    held_m: Float64[np.ndarray, "joint 3"]
    held_m2: Float64[np.ndarray, "joint 3 3"]


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def nowhere(n_joint):
    """Allocate where one person's joints are."""
    return Located(
        np.empty((n_joint, 3)), np.empty((n_joint, 3)), np.empty((n_joint, 3, 3)),
        np.empty((n_joint, 3)), np.empty((n_joint, 3, 3)),
    )  # fmt: skip


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True, inline="always")
@no_type_check
def fold_moments(R, z, c, total, j, tmp):
    """Fold the sums of every moment into a joint's trajectory, at the moment's mean time.

    Notes
    -----
    Each residual was taken at its image's own time; only the correction of the curve is taken as
    constant over a moment. At the weighted mean time the error of that vanishes to first order.
    """
    info, rhs = total.info, total.rhs
    for m in range(total.weight.shape[1]):
        if not total.weight[j, m] > 0.0:
            continue
        span = locate(total.place[j, m] / total.weight[j, m], c.shape[0] // 3, tmp.basis)
        point(c, span, tmp.basis, tmp.x)
        least = 1e-6 * (info[j, m, 0, 0] + info[j, m, 1, 1] + info[j, m, 2, 2])
        fold_gaussian(
            R, z, info[j, m], rhs[j, m], least, tmp.x, span, tmp.basis, tmp.rows, tmp.right
        )
    control_points(R, z, c)


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def fits_body(found, j, limbs, limb_m, limb_m2):
    """Return whether most of a joint's limbs, if not all, have the lengths they should have.

    A person who falls or turns moves as a whole. Where a single joint is somewhere else, and its
    limbs are too long or too short, its key points show another limb or another person.
    """
    u = np.empty(3)
    right = wrong = 0
    for i in range(limbs.joints.shape[0]):
        a, b = limbs.joints[i]
        if a != j and b != j:
            continue
        length, var = length_along(found.x_m, found.cov_m2, a, b, u)
        var += limb_m2[i] + limbs.slack_m2[i] + TIE_M2
        if (length - limb_m[i]) ** 2 > GATE * GATE * var:
            wrong += 1
        else:
            right += 1
    return wrong == 0 or right > wrong


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def dismiss(found, j, prior_m2, total, inlier):
    """Forget what the key points said about joint `j`: it stays on its curve."""
    for a in range(3):
        found.x_m[j, a] -= found.shift_m[j, a]
        found.shift_m[j, a] = 0.0
    copy(prior_m2, found.cov_m2[j])
    clear(total, j)
    for v in range(inlier.shape[0]):
        inlier[v, j] = 0.0


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def settle_turned(R, z, found, sought, prior_m2, limbs, limb_m, limb_m2, total, inlier):
    """Loosen the trajectories of joints that have turned sharply, if the body agrees, in place.

    Parameters
    ----------
    R, z
        One person's square-root information, (joint, n, n) and (joint, n).
    found, sought
        Where the joints are, and what came of looking for each; `TURNED` becomes `UNSEEN` where
        the body does not agree.
    prior_m2
        Covariances of the predictions, (joint, 3, 3).
    limbs, limb_m, limb_m2
        `Limbs`, and this person's lengths with their variances.
    total, inlier
        The `Sums` and the responsibilities (view, joint), cleared where the body does not agree.
    """
    for j in range(sought.shape[0]):
        if sought[j] != TURNED:
            continue
        if fits_body(found, j, limbs, limb_m, limb_m2):
            scale(R[j], z[j], 1.0 / math.sqrt(LOOSEN))
        else:
            sought[j] = UNSEEN
            dismiss(found, j, prior_m2[j], total, inlier)


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def hold(found, sought, n_seen, limbs, limb_m, limb_m2, now, worth, total):
    """Add what the lengths of the limbs say about joints that are well seen to their sums.

    Parameters
    ----------
    found
        The joints as `Located`; those held by the body are written.
    sought, n_seen
        What came of looking for each joint in this frame set, and how many cameras have
        supported it lately, (joint,). What fewer than two see is left to `anatomy.relax_body`.
    limbs, limb_m, limb_m2
        `Limbs`, and this person's lengths with their variances.
    now
        Time of the frame set, in knots.
    worth
        Weight of what the body says, 0 to 1.
    total
        The `Sums`, changed in place.

    Notes
    -----
    The message to a joint is the quotient of its place with and without the limbs; it enters the
    trajectory together with the key points, for no cost of its own.
    """
    info, vector, moved = np.empty((3, 3)), np.empty(3), np.empty(3)
    for j in range(sought.shape[0]):
        copy(found.cov_m2[j], found.held_m2[j])
        for a in range(3):
            found.held_m[j, a] = found.x_m[j, a]
    tighten(found.held_m, found.held_m2, limbs, limb_m, limb_m2)
    for j in range(sought.shape[0]):
        if sought[j] == UNSEEN or n_seen[j] < 2:
            continue
        for a in range(3):
            moved[a] = found.held_m[j, a] - found.x_m[j, a]
        quotient(found.cov_m2[j], found.held_m2[j], moved, info, vector)
        size = 0.0
        for p in range(3):
            size += worth * info[p, p]
            total.rhs[j, 0, p] += worth * vector[p]
            for q in range(3):
                total.rhs[j, 0, p] += worth * info[p, q] * found.shift_m[j, q]
                total.info[j, 0, p, q] += worth * info[p, q]
        total.place[j, 0] += size * now
        total.weight[j, 0] += size


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def gather_views(seen, cam, place, moment, match, worth):
    """Copy what the matched images of one track have in common to `seen`; return how many."""
    n = 0
    for v in range(match.shape[0]):
        if match[v] >= 0:
            seen.cam[n], seen.place[n], seen.moment[n] = cam[v], place[v], moment[v]
            seen.worth[n] = worth[v]
            n += 1
    return n


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True, inline="always")
@no_type_check
def gather_joint(seen, j, xyz_m, match, flip, xy_px, factor, noise):
    """Copy the key points of joint `j` in the matched images of one track to `seen`.

    `xyz_m` is (view, joint, 3), the track's own.
    """
    n = 0
    for v in range(match.shape[0]):
        d = match[v]
        if d < 0:
            continue
        m = noise.mirror[j] if flip[v] else j
        for a in range(3):
            seen.xyz_m[n, a] = xyz_m[v, j, a]
        seen.xy_px[n, 0], seen.xy_px[n, 1] = xy_px[d, m, 0], xy_px[d, m, 1]
        seen.sigma_m[n] = noise.sigma_m[j] * factor[d, m]
        n += 1


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def fit_all(
    R, z, c, xyz_m, prior_m2, cam, P, focal_px, place,
    xy_px, factor, match, flip, worth, noise, now, n_seen, limbs, limb_m, limb_m2, body_worth,
    inlier, found_m, found_m2, x_m, cov_m2,
):  # fmt: skip
    """Fit every track to the detections assigned to it in one frame set, in place.

    Parameters
    ----------
    R, z, c
        Square-root information and control points, (track, joint, n, n) and (track, joint, n);
        changed in place.
    xyz_m
        Predictions at each image's own time, (view, track, joint, 3).
    prior_m2
        Their covariance at the frame set's time, (track, joint, 3, 3).
    cam, P, focal_px
        Camera of each image (view,); projections (cam, 3, 4) and mean focal lengths (cam,).
    place
        Time of each image, in knots, (view,).
    xy_px, factor
        All detections of the set, (person, joint, 2) and (person, joint); see `score_view`.
    match, flip, worth
        Per track and view: index of its detection or -1; 1 to read it mirrored; weight 0 to 1.
    noise
        The detector's `Noise`.
    now
        Time of the frame set, in knots.
    n_seen
        How many cameras have supported each joint lately, (track, joint).
    limbs, limb_m, limb_m2, body_worth
        `Limbs`; lengths and variances per track, (track, limb); what they are worth, 0 to 1.
    inlier
        Result, (track, view, joint): responsibility of the joint for its key point.
    found_m, found_m2
        Results: joints and covariances at the frame set's time by key points alone, (track,
        joint, 3) and (track, joint, 3, 3).
    x_m, cov_m2
        Results: the same after the fit, limbs and all.
    """
    n_view = cam.shape[0]
    seen = Observed(
        np.empty(n_view, np.int64), np.empty(n_view), np.empty(n_view, np.int64),
        np.empty((n_view, 3)), np.empty((n_view, 2)), np.empty(n_view), np.empty(n_view),
    )  # fmt: skip
    moment = np.empty(n_view, np.int64)
    total = sums(R.shape[1], moments(place, moment) if n_view else 0)
    newest = -math.inf
    for v in range(n_view):
        newest = max(newest, place[v])
    found, sought, tmp = nowhere(R.shape[1]), np.empty(R.shape[1], np.int64), scratch(R.shape[2])
    r, trial, weights = np.empty(n_view), np.empty(n_view), np.empty(4)
    span = locate(now, R.shape[2] // 3, weights)
    for k in range(R.shape[0]):
        n = gather_views(seen, cam, place, moment, match[k], worth[k])
        for j in range(R.shape[1]):
            gather_joint(seen, j, xyz_m[:, k], match[k], flip[k], xy_px, factor, noise)
            sought[j] = seek_joint(
                P, focal_px, seen, n, prior_m2[k, j], noise, total, j, found.shift_m[j],
                found.cov_m2[j], r, trial, tmp,
            )  # fmt: skip
            spread(match[k], r, inlier[k], j)
            point(c[k, j], span, weights, found.x_m[j])
            for a in range(3):
                found.x_m[j, a] += found.shift_m[j, a]
        settle_turned(R[k], z[k], found, sought, prior_m2[k], limbs, limb_m[k], limb_m2[k], total,
                      inlier[k])  # fmt: skip
        for j in range(R.shape[1]):
            copy(found.cov_m2[j], found_m2[k, j])
            for a in range(3):
                found_m[k, j, a] = found.x_m[j, a]
        if n and now - newest <= TOGETHER:  # the limbs say something about now
            hold(found, sought, n_seen[k], limbs, limb_m[k], limb_m2[k], now, body_worth, total)
        for j in range(R.shape[1]):
            if sought[j] != UNSEEN:
                fold_moments(R[k, j], z[k, j], c[k, j], total, j, tmp)
            point(c[k, j], span, weights, x_m[k, j])
            curve_covariance(R[k, j], span, weights, tmp.y, cov_m2[k, j])


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def spread(match, r, inlier, j):
    """Write the responsibilities `r` of the matched images to `inlier` (view, joint)."""
    n = 0
    for v in range(match.shape[0]):
        inlier[v, j] = 0.0
        if match[v] >= 0:
            inlier[v, j] = r[n]
            n += 1
