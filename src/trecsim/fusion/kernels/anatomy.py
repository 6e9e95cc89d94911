"""The body as a whole: limbs and ground hold the joints that few cameras see."""

import math
from typing import NamedTuple

import numpy as np
from jaxtyping import Float64

from trecsim.compiler import inner, kernel
from trecsim.fusion.kernels.curve import BLOCK, locate, point
from trecsim.fusion.kernels.ground import ground_contact, learn_level
from trecsim.fusion.kernels.information import (
    REACH,
    clear_row,
    control_points,
    fold_gaussian,
    invert3,
)
from trecsim.fusion.kernels.lengths import TIE_M2, learn, message_from_body

_STEPS = 3
# Variance of how far the body moves a joint in one step [m^2]. A limb across the line of sight says
# nearly nothing about depth, and its linearised equation holds near the joint only.
_REACH_M2 = 0.3**2
# A joint less well known than this, summed over the directions, needs its body even if two cameras
# see it: they may stand side by side [m^2].
_WEAK_M2 = 0.2**2
# What the body says of a joint is new after this time, as a length that is off stays so [s].
_BODY_S = 1.3


class Held(NamedTuple):
    """Scratch arrays: a joint's information, and three equations."""

    R: Float64[np.ndarray, "n n"]
    z: Float64[np.ndarray, " n"]
    rows: Float64[np.ndarray, "3 n"]
    right: Float64[np.ndarray, "3"]


@inner
def stretch(j, k, x, d, length_m, u):
    """Return by how much the shifted joints `j`, `k` are too close, linearised about no shift.

    The direction between them is written to `u` (3,).
    """
    length = 0.0
    for p in range(3):
        u[p] = x[k, p] + d[k, p] - x[j, p] - d[j, p]
        length += u[p] * u[p]
    length = max(math.sqrt(length), 1e-3)
    residual = length_m - length
    for p in range(3):
        u[p] /= length
        residual += u[p] * (d[k, p] - d[j, p])
    return residual


@inner
def along_m2(u, cov_m2):
    """Return the variance of a joint in the direction `u`."""
    var = 0.0
    for p in range(3):
        for q in range(3):
            var += u[p] * cov_m2[p, q] * u[q]
    return var


@inner
def add_limb(A, b, first, second, u, residual, var):
    """Add "the second joint is `residual` further along `u` than the first" to ``A d = b``.

    `first` and `second` are the joints' first unknowns, -1 for one that does not move.
    """
    for m, sign in ((first, -1.0), (second, 1.0)):
        if m < 0:
            continue
        for p in range(3):
            b[m + p] += sign * u[p] * residual / var
            for q in range(3):
                A[m + p, m + q] += u[p] * u[q] / var
    if first >= 0 and second >= 0:
        for p in range(3):
            for q in range(3):
                A[first + p, second + q] -= u[p] * u[q] / var
                A[second + p, first + q] -= u[p] * u[q] / var


@inner(allocates=True)
def gather(A, b, x, d, cov_m2, unknown_of, limbs, limb_m, limb_m2):
    """Write the normal equations of the weak joints' shifts to `A`, `b`.

    `unknown_of` is the index of a joint's first unknown, -1 where the joint is well known; `x` are
    the fitted joints, `d` their shifts so far, (joint, 3).
    """
    clear_row(b)
    for i in range(b.shape[0]):
        clear_row(A[i])
    inverse = np.empty((3, 3))
    u = np.empty(3)
    for j in range(x.shape[0]):
        if unknown_of[j] >= 0:
            invert3(cov_m2[j], inverse)
            for p in range(3):
                for q in range(3):
                    A[unknown_of[j] + p, unknown_of[j] + q] = inverse[p, q]
                A[unknown_of[j] + p, unknown_of[j] + p] += 1.0 / _REACH_M2
    for i in range(limbs.joints.shape[0]):
        j, k = limbs.joints[i]
        if unknown_of[j] < 0 and unknown_of[k] < 0:
            continue
        residual = stretch(j, k, x, d, limb_m[i], u)
        var = limb_m2[i] + limbs.slack_m2[i] + TIE_M2
        for m in (j, k):
            if unknown_of[m] < 0:
                var += along_m2(u, cov_m2[m])
        add_limb(A, b, unknown_of[j], unknown_of[k], u, residual, var)


@inner
def cholesky(A):
    """Overwrite the lower triangle of the symmetric positive `A` by its Cholesky factor.

    The diagonal holds the inverse of the factor's, which is what every later step needs.
    """
    n = A.shape[0]
    for i in range(n):
        for k in range(i):
            s = A[i, k]
            for m in range(k):
                s -= A[i, m] * A[k, m]
            A[i, k] = s * A[k, k]
        s = A[i, i]
        for m in range(i):
            s -= A[i, m] * A[i, m]
        A[i, i] = 1.0 / math.sqrt(max(s, 1e-12))


@inner
def solve_cholesky(A, b):
    """Overwrite `b` by the solution of ``A x = b``, with `A` as `cholesky` leaves it."""
    n = A.shape[0]
    for i in range(n):
        s = b[i]
        for m in range(i):
            s -= A[i, m] * b[m]
        b[i] = s * A[i, i]
    for i in range(n - 1, -1, -1):
        s = b[i]
        for m in range(i + 1, n):
            s -= A[m, i] * b[m]
        b[i] = s * A[i, i]


@inner
def invert_cholesky(A):
    """Overwrite the Cholesky factor that `cholesky` leaves in `A` by its inverse."""
    n = A.shape[0]
    for i in range(n):
        for k in range(i):
            s = 0.0
            for m in range(k, i):
                s += A[i, m] * A[m, k]
            A[i, k] = -s * A[i, i]


@inner
def joint_block(A, first, out):
    """Write a joint's covariance, a diagonal block of ``A^T A``, to `out` (3, 3).

    `A` is the inverse of a Cholesky factor, `first` the joint's first unknown.
    """
    n = A.shape[0]
    for p in range(3):
        for q in range(p + 1):
            s = 0.0
            for m in range(first + p, n):
                s += A[m, first + p] * A[m, first + q]
            out[p, q] = s
            out[q, p] = s


@inner
def right_side(R, c, z):
    """Write ``R c`` to `z`: the right side whose solution is `c`."""
    n = R.shape[0]
    for i in range(n):
        z[i] = 0.0
        for k in range(i, min(n, (i // BLOCK) * BLOCK + REACH)):
            z[i] += R[i, k] * c[k]


@inner(allocates=True)
def apply_body_message(R, z, c, x, info, vector, size, white_share, new_share, span, weights, tmp):
    """Move a joint as its body says, in place, and keep `new_share` of that as information.

    Parameters
    ----------
    R, z, c, x
        The joint: square-root information, control points and place.
    info, vector, size
        The body's message; see `message_from_body`. `info` and `vector` are destroyed.
    white_share
        See `relax_body`.
    new_share
        Share of the message's information that is new, 0 to 1.
    span, weights
        Place of the time on the knot grid.
    tmp
        `Held`.
    """
    n, root = R.shape[0], math.sqrt(white_share)
    for i in range(n):
        tmp.z[i] = root * z[i]
        for k in range(n):
            tmp.R[i, k] = root * R[i, k]
    new_info, new_vector = np.empty((3, 3)), np.empty(3)
    for p in range(3):
        new_vector[p] = 0.0  # the right side follows from the control points below
        for q in range(3):
            new_info[p, q] = new_share / white_share * info[p, q]
        # How far a joint may go in one step tells nothing of where it is.
        new_info[p, p] -= new_share / white_share / _REACH_M2
    least = 1e-6 * size
    fold_gaussian(
        R, z, new_info, new_vector, new_share * least, x, span, weights, tmp.rows, tmp.right
    )
    fold_gaussian(tmp.R, tmp.z, info, vector, least, x, span, weights, tmp.rows, tmp.right)
    control_points(tmp.R, tmp.z, c)
    right_side(R, c, z)
    point(c, span, weights, x)


@inner(allocates=True)
def without_reach(held_m2, cov_m2):
    """Write the covariance of a joint held by its body, without the bound on its step.

    `held_m2` is its covariance with the bound, (3, 3).
    """
    info = np.empty((3, 3))
    invert3(held_m2, info)
    for p in range(3):
        info[p, p] -= 1.0 / _REACH_M2
    invert3(info, cov_m2)


@inner
def weak_joints(cov_m2, n_seen, white_share, unknown_of, before_m2):
    """Find the joints that need their body; return the number of their unknowns.

    Parameters
    ----------
    cov_m2, n_seen, white_share
        As for `relax_body`.
    unknown_of
        Result, (joint,): a joint's first unknown, or -1 where it is well known.
    before_m2
        Result, (joint, 3, 3): covariances as they count against the body.
    """
    n = 0
    for j in range(unknown_of.shape[0]):
        for p in range(3):
            for q in range(3):
                before_m2[j, p, q] = cov_m2[j, p, q] / white_share
        spread_m2 = before_m2[j, 0, 0] + before_m2[j, 1, 1] + before_m2[j, 2, 2]
        weak = n_seen[j] < 2 or spread_m2 > _WEAK_M2
        unknown_of[j] = n if weak else -1
        n += 3 if weak else 0
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
        `Held`.

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
    unknown_of, before_m2 = np.empty(n_joint, np.int64), np.empty((n_joint, 3, 3))
    n = weak_joints(cov_m2, n_seen, white_share, unknown_of, before_m2)
    if n == 0:
        return
    A, b = np.empty((n, n)), np.empty(n)
    d = np.zeros((n_joint, 3))
    contact_joint, rise_m, rise_m2 = ground_contact(x, before_m2, limbs.contact_height_m, level)
    for _ in range(_STEPS):
        gather(A, b, x, d, before_m2, unknown_of, limbs, limb_m, limb_m2)
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
    after, info, vector = np.empty((3, 3)), np.empty((3, 3)), np.empty(3)
    for j in range(n_joint):
        if unknown_of[j] < 0:
            continue
        joint_block(A, unknown_of[j], after)
        size = message_from_body(before_m2[j], after, d[j], info, vector)
        apply_body_message(
            R[j], z[j], c[j], x[j], info, vector, size, white_share, new_share, span, weights, tmp
        )
        without_reach(after, cov_m2[j])


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
    tmp = Held(np.empty((n, n)), np.empty(n), np.empty((3, n)), np.empty(3))
    weights = np.empty(4)
    span = locate(now, n // 3, weights)
    new_share = min(1.0, elapsed_s / _BODY_S)
    for k in range(R.shape[0]):
        learn(x[k], cov_m2[k], n_seen[k], limbs, limb_m[k], limb_m2[k], elapsed_s)
        learn_level(x[k], cov_m2[k], n_seen[k], limbs.contact_height_m, level[k], elapsed_s)
        relax_body(
            R[k], z[k], c[k], x[k], cov_m2[k], n_seen[k], limbs, limb_m[k], limb_m2[k], level[k],
            span, weights, white_share, new_share, tmp,
        )  # fmt: skip
