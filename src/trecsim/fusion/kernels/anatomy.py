"""The body as a whole: limbs and ground hold the joints that few cameras see."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float64

from trecsim.compiler import inner, kernel
from trecsim.fusion.kernels.body_equations import REACH_M2, gather
from trecsim.fusion.kernels.cholesky import cholesky, invert_cholesky, joint_block, solve_cholesky
from trecsim.fusion.kernels.curve import BLOCK, locate, point
from trecsim.fusion.kernels.ground import ground_contact, learn_level
from trecsim.fusion.kernels.information import (
    control_points,
    curve_covariance,
    fold_gaussian,
    invert3,
    right_side,
)
from trecsim.fusion.kernels.lengths import learn

_STEPS = 3
# A joint less well known than this, summed over the directions, needs its body even if two cameras
# see it: they may stand side by side [m^2].
_WEAK_M2 = 0.2**2
# What the body says of a joint is new after this time, as a length that is off stays so [s].
_BODY_S = 1.3


class Workspace(NamedTuple):
    """Arrays that the kernels overwrite, allocated once per call."""

    info: Float64[np.ndarray, "3 3"]
    cov_m2: Float64[np.ndarray, "3 3"]
    zero: Float64[np.ndarray, "3"]
    y: Float64[np.ndarray, "n 3"]
    right: Float64[np.ndarray, " n"]
    step_m: Float64[np.ndarray, " n"]
    rows: Float64[np.ndarray, "3 n"]
    rows_right: Float64[np.ndarray, "3"]


@inner(allocates=True)
def workspace(n):
    """Allocate the workspace for joints of `n` unknowns."""
    return Workspace(
        np.empty((3, 3)), np.empty((3, 3)), np.empty(3), np.empty((n, 3)), np.empty(n),
        np.empty(n), np.empty((3, n)), np.empty(3),
    )  # fmt: skip


@inner
def move_joint(R, c, x, shift_m, span, weights, tmp):
    """Move a joint by `shift_m` at one time, and its trajectory as that implies, in place.

    Parameters
    ----------
    R, c, x
        The joint: square-root information, which stays, control points and place.
    shift_m
        How far the joint moves, (3,).
    span, weights
        Place of the time on the knot grid.
    tmp
        `Workspace`.

    Notes
    -----
    The control points have the covariance ``C = (R^T R)^-1``, the joint at this time ``P = B C
    B^T``. Any information about this joint that moves it by ``d`` moves the mean of the control
    points by ``C B^T P^-1 d = R^-1 Y P^-1 d``, with ``Y = R^-T B^T``.
    """
    n, first = R.shape[0], BLOCK * span
    info, y, right, step_m = tmp.info, tmp.y, tmp.right, tmp.step_m
    curve_covariance(R, span, weights, y, tmp.cov_m2)
    invert3(tmp.cov_m2, info)
    a = info[0, 0] * shift_m[0] + info[0, 1] * shift_m[1] + info[0, 2] * shift_m[2]
    b = info[1, 0] * shift_m[0] + info[1, 1] * shift_m[1] + info[1, 2] * shift_m[2]
    d = info[2, 0] * shift_m[0] + info[2, 1] * shift_m[1] + info[2, 2] * shift_m[2]
    for i in range(first):
        right[i] = 0.0
    for i in range(first, n):
        right[i] = y[i, 0] * a + y[i, 1] * b + y[i, 2] * d
    control_points(R, right, step_m)
    for i in range(n):
        c[i] += step_m[i]
    point(c, span, weights, x)


@inner
def apply_body(R, z, c, x, cov_m2, known, shift_m, white_share, new_share, span, weights, tmp):
    """Move a joint as its body says, in place, and keep `new_share` of that as information.

    Parameters
    ----------
    R, z, c, x
        The joint: square-root information, control points and place.
    cov_m2
        Covariance of the joint given its body, with the bound on its step; the bound is removed.
    known
        Information of the joint without its body, as it counts against it, (3, 3).
    shift_m
        How far the body moves the joint, (3,).
    white_share
        See `relax_body`.
    new_share
        Share of the information of the body that is new, 0 to 1.
    span, weights
        Place of the time on the knot grid.
    tmp
        `Workspace`.
    """
    move_joint(R, c, x, shift_m, span, weights, tmp)
    info, share = tmp.info, new_share / white_share
    invert3(cov_m2, info)
    least = 1e-6 * new_share * (info[0, 0] + info[1, 1] + info[2, 2])
    for p in range(3):  # how far a joint may go in one step tells nothing of where it is
        info[p, p] -= 1.0 / REACH_M2
    invert3(info, cov_m2)
    for p in range(3):
        tmp.zero[p] = 0.0
        for q in range(3):
            info[p, q] = share * (info[p, q] - known[p, q])
    # Only `R` counts here: the right side follows from the control points.
    fold_gaussian(R, z, info, tmp.zero, least, x, span, weights, tmp.rows, tmp.rows_right)
    right_side(R, c, z)


@inner
def weak_joints(cov_m2, n_seen, white_share, unknown_of, before_m2, known):
    """Find the joints that need their body; return the number of their unknowns.

    Parameters
    ----------
    cov_m2, n_seen, white_share
        As for `relax_body`.
    unknown_of
        Result, (joint,): a joint's first unknown, or -1 where it is well known.
    before_m2, known
        Results, (joint, 3, 3): covariances as they count against the body, and the inverse where
        the joint is weak.
    """
    n = 0
    for j in range(unknown_of.shape[0]):
        for p in range(3):
            for q in range(3):
                before_m2[j, p, q] = cov_m2[j, p, q] / white_share
        spread_m2 = before_m2[j, 0, 0] + before_m2[j, 1, 1] + before_m2[j, 2, 2]
        weak = n_seen[j] < 2 or spread_m2 > _WEAK_M2
        unknown_of[j] = n if weak else -1
        if weak:
            invert3(before_m2[j], known[j])
            n += 3
    return n


@inner(allocates=True)
def relax_body(
    R,
    z,
    c,
    x,
    cov_m2,
    n_seen,
    limbs,
    limb_m,
    limb_m2,
    level,
    span,
    weights,
    white_share,
    new_share,
    tmp,
):
    """Hold by limbs and ground the joints that fewer than two cameras see well, in place.

    Parameters
    ----------
    R, z, c
        One person's square-root information and control points, (joint, n, n) and (joint, n);
        changed in place.
    x, cov_m2
        Joints and covariances after the fit, (joint, 3) and (joint, 3, 3); changed in place.
    n_seen
        Number of cameras that support each joint now.
    limbs, limb_m, limb_m2
        `Limbs`, and this person's lengths with their variances.
    level
        Height and variance of the ground under the person, (2,).
    span, weights
        Place of the frame set's time on the knot grid.
    white_share
        See `Noise`. Against the body, a curve is only as sure as if nothing in the errors of its
        key points lasted.
    new_share
        Share of what the body says that is new since the last frame set, 0 to 1.
    tmp
        `Workspace`.

    Notes
    -----
    All weak joints move together: least squares over their shifts, with each joint's own
    covariance (long along the ray of the camera that sees it) and the limbs' lengths, by
    Gauss-Newton. Where a single camera sees a whole body, its size and the ground on which it
    rests are what fixes its distance.

    A trajectory follows the message of the body, but keeps little of it as information. Otherwise
    the same information would be counted again in each frame set (data incest), and the estimate
    would become certain of a distance that no camera has observed.
    """
    n_joint = x.shape[0]
    unknown_of = np.empty(n_joint, np.int64)
    before_m2, known = np.empty((n_joint, 3, 3)), np.empty((n_joint, 3, 3))
    n = weak_joints(cov_m2, n_seen, white_share, unknown_of, before_m2, known)
    if n == 0:
        return
    A, b = np.empty((n, n)), np.empty(n)
    d = np.zeros((n_joint, 3))
    contact_joint, rise_m, rise_m2 = ground_contact(x, before_m2, limbs.contact_height_m, level)
    for _ in range(_STEPS):
        gather(A, b, x, d, before_m2, known, unknown_of, limbs, limb_m, limb_m2)
        if contact_joint >= 0 and unknown_of[contact_joint] >= 0:
            A[unknown_of[contact_joint] + 2, unknown_of[contact_joint] + 2] += 1.0 / rise_m2
            b[unknown_of[contact_joint] + 2] += rise_m / rise_m2
        cholesky(A)
        solve_cholesky(A, b)
        for j in range(n_joint):
            if unknown_of[j] >= 0:
                d[j, 0], d[j, 1], d[j, 2] = (
                    b[unknown_of[j]],
                    b[unknown_of[j] + 1],
                    b[unknown_of[j] + 2],
                )
    invert_cholesky(A)
    for j in range(n_joint):
        if unknown_of[j] >= 0:
            joint_block(A, unknown_of[j], cov_m2[j])
            apply_body(
                R[j], z[j], c[j], x[j], cov_m2[j], known[j], d[j], white_share, new_share, span,
                weights, tmp,
            )  # fmt: skip


@kernel(allocates=True)
def constrain_all(
    R, z, c, x, cov_m2, n_seen, limbs, limb_m, limb_m2, level, white_share, now, elapsed_s
):
    """Learn everybody's limb lengths and ground; hold by them what few cameras see, in place.

    Parameters
    ----------
    R, z, c
        Square-root information and control points, (track, joint, n, n) and (track, joint, n).
    x, cov_m2
        Joints and covariances after the fit, (track, joint, 3) and (track, joint, 3, 3); changed
        where the body has a say.
    n_seen
        Cameras that support each joint now, (track, joint).
    limbs, limb_m, limb_m2
        `Limbs`; lengths and variances per track, (track, limb).
    level
        Height and variance of the ground under everybody, (track, 2).
    white_share
        See `relax_body`.
    now
        Time of the frame set, in knots.
    elapsed_s
        Time since the last frame set [s].
    """
    n = R.shape[2]
    weights, tmp = np.empty(4), workspace(n)
    span = locate(now, n // 3, weights)
    new_share = min(1.0, elapsed_s / _BODY_S)
    for k in range(R.shape[0]):
        learn(x[k], cov_m2[k], n_seen[k], limbs, limb_m[k], limb_m2[k], elapsed_s)
        learn_level(x[k], cov_m2[k], n_seen[k], limbs.contact_height_m, level[k], elapsed_s)
        relax_body(
            R[k], z[k], c[k], x[k], cov_m2[k], n_seen[k], limbs, limb_m[k], limb_m2[k], level[k],
            span, weights, white_share, new_share, tmp,
        )  # fmt: skip
