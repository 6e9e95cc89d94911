"""Limb lengths: learnt where two cameras see both ends, used where they do not."""

import math
from typing import NamedTuple, no_type_check

import numpy as np
from jaxtyping import Float64, Int64
from numba import njit

from trecsim.fusion.kernels.curve import locate, point
from trecsim.fusion.kernels.information import (
    control_points,
    copy,
    curve_covariance,
    fold_gaussian,
    invert3,
)

# How a length is learnt: spread of one measurement, and time after which the next is new [s].
_MEASURE_M2 = 0.02**2
_MEASURE_S = 0.5
# A length is never surer than this, so that it can be learnt anew [m^2].
_SUREST_M2 = 0.005**2
# A limb's equation is never surer than this [m^2].
_TIE_M2 = 0.01**2
_STEPS = 3
# Sweeps over the limbs that hold a body together whose joints are all seen.
_SWEEPS = 2
# A limb whose length is off by more standard deviations has no say: one end is elsewhere.
_GATE = 3.0


class Limbs(NamedTuple):
    """The distances between joints that a body keeps.

    Attributes
    ----------
    joints
        The two joints of each.
    slack_m2
        Variance about a person's mean length: what posture changes.
    """

    joints: Int64[np.ndarray, "limb 2"]
    slack_m2: Float64[np.ndarray, " limb"]


class Held(NamedTuple):
    """Scratch arrays: three equations, their right sides, and a block of columns."""

    rows: Float64[np.ndarray, "3 n"]
    right: Float64[np.ndarray, "3"]
    y: Float64[np.ndarray, "n 3"]


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def length_along(x, cov_m2, a, b, d):
    """Write the unit vector from joint `a` to `b` to `d`; return length and its variance."""
    length = 0.0
    for p in range(3):
        d[p] = x[b, p] - x[a, p]
        length += d[p] * d[p]
    length = math.sqrt(length)
    if length < 1e-6:
        return 0.0, math.inf
    var = 0.0
    for p in range(3):
        d[p] /= length
    for p in range(3):
        for q in range(3):
            var += d[p] * (cov_m2[a, p, q] + cov_m2[b, p, q]) * d[q]
    return length, var


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def learn(x, cov_m2, n_seen, limbs, limb_m, limb_m2, elapsed_s):
    """Update, in place, one person's limb lengths `limb_m` and their variances `limb_m2`.

    Notes
    -----
    A scalar Kalman filter per limb, fed only where two cameras see both ends. Errors persist, so
    a measurement counts by the time that has passed and not by the image.
    """
    d = np.empty(3)
    share = min(1.0, elapsed_s / _MEASURE_S)
    if share <= 0.0:
        return
    for i in range(limbs.joints.shape[0]):
        a, b = limbs.joints[i]
        if n_seen[a] < 2 or n_seen[b] < 2:
            continue
        length, var = length_along(x, cov_m2, a, b, d)
        gain = limb_m2[i] / (limb_m2[i] + (var + _MEASURE_M2 + limbs.slack_m2[i]) / share)
        limb_m[i] += gain * (length - limb_m[i])
        limb_m2[i] = max(limb_m2[i] * (1.0 - gain), _SUREST_M2)


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def stretch(j, k, x, d, length_m, u):
    """Return by how much the shifted joints `j`, `k` are too close, linearised about no shift.

    The direction between them is written to `u` (3,).
    """
    length = 0.0
    for p in range(3):
        u[p] = x[k, p] + d[k, p] - x[j, p] - d[j, p]
        length += u[p] * u[p]
    length = max(math.sqrt(length), 1e-3)
    rest = length_m - length
    for p in range(3):
        u[p] /= length
        rest += u[p] * (d[k, p] - d[j, p])
    return rest


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def along_m2(u, cov_m2):
    """Return the variance of a joint in the direction `u`."""
    var = 0.0
    for p in range(3):
        for q in range(3):
            var += u[p] * cov_m2[p, q] * u[q]
    return var


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def add_limb(A, b, first, second, u, rest, var):
    """Add "the second joint is `rest` further along `u` than the first" to ``A d = b``.

    `first` and `second` are the joints' first unknowns, -1 for one that does not move.
    """
    for m, sign in ((first, -1.0), (second, 1.0)):
        if m < 0:
            continue
        for p in range(3):
            b[m + p] += sign * u[p] * rest / var
            for q in range(3):
                A[m + p, m + q] += u[p] * u[q] / var
    if first >= 0 and second >= 0:
        for p in range(3):
            for q in range(3):
                A[first + p, second + q] -= u[p] * u[q] / var
                A[second + p, first + q] -= u[p] * u[q] / var


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def gather(A, b, x, d, cov_m2, place, limbs, limb_m, limb_m2):
    """Write the normal equations of the weak joints' shifts to `A`, `b`.

    `place` is the index of a joint's first unknown, or -1 where the joint is well known; `x` are
    joints as fitted, `d` their shifts so far, (joint, 3).
    """
    A[:] = 0.0
    b[:] = 0.0
    inverse = np.empty((3, 3))
    u = np.empty(3)
    for j in range(x.shape[0]):
        if place[j] >= 0:
            invert3(cov_m2[j], inverse)
            copy(inverse, A[place[j] : place[j] + 3, place[j] : place[j] + 3])
    for i in range(limbs.joints.shape[0]):
        j, k = limbs.joints[i]
        if place[j] < 0 and place[k] < 0:
            continue
        rest = stretch(j, k, x, d, limb_m[i], u)
        var = limb_m2[i] + limbs.slack_m2[i] + _TIE_M2
        for m in (j, k):
            if place[m] < 0:
                var += along_m2(u, cov_m2[m])
        add_limb(A, b, place[j], place[k], u, rest, var)


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def factor(A):
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


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def solve_factored(A, b):
    """Overwrite `b` by the solution of ``A x = b``, with `A` as `factor` leaves it."""
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


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def invert_factor(A):
    """Overwrite the Cholesky factor that `factor` leaves in `A` by its inverse."""
    n = A.shape[0]
    for i in range(n):
        for k in range(i):
            s = 0.0
            for m in range(k, i):
                s += A[i, m] * A[m, k]
            A[i, k] = -s * A[i, i]


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
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


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def quotient(before_m2, after_m2, shift_m, info, vector):
    """Write what the body says of a joint beyond its trajectory; return the information of both.

    Parameters
    ----------
    before_m2
        Covariance of the joint as its trajectory has it, (3, 3).
    after_m2, shift_m
        Covariance and shift of the joint with the body taken into account.
    info, vector
        Results: the quotient of the two Gaussians, information ``after^-1 - before^-1`` and
        information vector ``after^-1 shift``.
    """
    before = np.empty((3, 3))
    invert3(before_m2, before)
    invert3(after_m2, info)
    size = info[0, 0] + info[1, 1] + info[2, 2]
    for p in range(3):
        vector[p] = 0.0
        for q in range(3):
            vector[p] += info[p, q] * shift_m[q]
            info[p, q] -= before[p, q]
    return size


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def tighten(x, cov_m2, limbs, limb_m, limb_m2):
    """Move one person's joints, in place, towards the lengths of the limbs, by how sure each is.

    Parameters
    ----------
    x, cov_m2
        Joints and covariances, (joint, 3) and (joint, 3, 3), changed in place.
    limbs, limb_m, limb_m2
        `Limbs`, and this person's lengths with their variances.

    Notes
    -----
    One limb after the other is taken as a measurement of the distance of two joints, which are
    treated as independent (Gauss-Seidel). Covariances shrink in the first sweep only, as later
    ones bring no new information.
    """
    u, gain = np.empty(3), np.empty(3)
    for sweep in range(_SWEEPS):
        for i in range(limbs.joints.shape[0]):
            a, b = limbs.joints[i]
            length, var = length_along(x, cov_m2, a, b, u)
            var += limb_m2[i] + limbs.slack_m2[i] + _TIE_M2
            rest = limb_m[i] - length
            if length == 0.0 or rest * rest > _GATE * _GATE * var:
                continue
            pull(x[a], cov_m2[a], u, -rest, var, sweep == 0, gain)
            pull(x[b], cov_m2[b], u, rest, var, sweep == 0, gain)


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def pull(x, cov_m2, u, rest, var, informed, gain):
    """Move one joint along `u` by its share of `rest`, in place; shrink its covariance if told."""
    for p in range(3):
        gain[p] = cov_m2[p, 0] * u[0] + cov_m2[p, 1] * u[1] + cov_m2[p, 2] * u[2]
    for p in range(3):
        x[p] += gain[p] * rest / var
        if informed:
            for q in range(3):
                cov_m2[p, q] -= gain[p] * gain[q] / var


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def relax_body(R, z, c, x, cov_m2, n_seen, limbs, limb_m, limb_m2, span, weights, worth, tmp):
    """Hold the joints that fewer than two cameras see by the lengths of the limbs, in place.

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
    span, weights
        Place of the frame set's time on the knot grid.
    worth
        Weight of this frame set, 0 to 1.
    tmp
        Scratch.

    Notes
    -----
    All weak joints move together: least squares over their shifts, with each joint's own
    covariance (long along the ray of the camera that sees it) and the limbs' lengths, by
    Gauss-Newton. Where a single camera sees a whole body, this is what fixes its distance.
    """
    n_joint = x.shape[0]
    place = np.empty(n_joint, np.int64)
    n = 0
    for j in range(n_joint):
        place[j] = n if n_seen[j] < 2 else -1
        n += 3 if n_seen[j] < 2 else 0
    if n == 0:
        return
    A, b = np.empty((n, n)), np.empty(n)
    d = np.zeros((n_joint, 3))
    for _ in range(_STEPS):
        gather(A, b, x, d, cov_m2, place, limbs, limb_m, limb_m2)
        factor(A)
        solve_factored(A, b)
        for j in range(n_joint):
            if place[j] >= 0:
                d[j, 0], d[j, 1], d[j, 2] = b[place[j]], b[place[j] + 1], b[place[j] + 2]
    invert_factor(A)
    after, info, vector = np.empty((3, 3)), np.empty((3, 3)), np.empty(3)
    for j in range(n_joint):
        if place[j] < 0:
            continue
        joint_block(A, place[j], after)
        size = quotient(cov_m2[j], after, d[j], info, vector)
        for p in range(3):
            vector[p] *= worth
            for q in range(3):
                info[p, q] *= worth
        fold_gaussian(
            R[j], z[j], info, vector, 1e-6 * size * worth, x[j], span, weights, tmp.rows, tmp.right
        )
        control_points(R[j], z[j], c[j])
        point(c[j], span, weights, x[j])
        curve_covariance(R[j], span, weights, tmp.y, cov_m2[j])


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def constrain_all(
    R, z, c, found_m, found_m2, x, cov_m2, n_seen, limbs, limb_m, limb_m2, now, elapsed_s, worth
):
    """Learn everybody's limb lengths, and hold by them what few cameras see, in place.

    Parameters
    ----------
    R, z, c
        Square-root information and control points, (track, joint, n, n) and (track, joint, n).
    found_m, found_m2
        Joints and covariances by key points alone, (track, joint, 3) and (track, joint, 3, 3):
        lengths are learnt from what they did not help to find.
    x, cov_m2
        The same after the fit; changed where the body has a say.
    n_seen
        Cameras that support each joint now, (track, joint).
    limbs, limb_m, limb_m2
        `Limbs`; lengths and variances per track, (track, limb).
    now
        Time of the frame set, in knots.
    elapsed_s, worth
        Time since the last frame set; weight of this one, 0 to 1.
    """
    tmp = Held(np.empty((3, R.shape[2])), np.empty(3), np.empty((R.shape[2], 3)))
    weights = np.empty(4)
    span = locate(now, R.shape[2] // 3, weights)
    for k in range(R.shape[0]):
        learn(found_m[k], found_m2[k], n_seen[k], limbs, limb_m[k], limb_m2[k], elapsed_s)
        relax_body(
            R[k], z[k], c[k], x[k], cov_m2[k], n_seen[k], limbs, limb_m[k], limb_m2[k],
            span, weights, worth, tmp,
        )  # fmt: skip
