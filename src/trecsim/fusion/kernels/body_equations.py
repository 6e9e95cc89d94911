"""Least squares over the joints that need their body: limb lengths tie them to each other."""

import math
from typing import NamedTuple

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.compiler import inner
from trecsim.fusion.kernels.lengths import along_m2
from trecsim.fusion.kernels.small_matrices import clear_row
from trecsim.fusion.tuning import REACH_M2, TIE_M2


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
def add_limb(A, b, first, second, u, residual, var):
    """Add "the second joint is `residual` further along `u` than the first" to ``A d = b``.

    `first` and `second` are the joints' first unknowns, -1 for one that does not move.
    """
    by_var = 1.0 / var
    for m, sign in ((first, -by_var), (second, by_var)):
        if m < 0:
            continue
        for p in range(3):
            b[m + p] += sign * u[p] * residual
            for q in range(3):
                A[m + p, m + q] += by_var * u[p] * u[q]
    if first >= 0 and second >= 0:
        for p in range(3):
            for q in range(3):
                A[first + p, second + q] -= by_var * u[p] * u[q]
                A[second + p, first + q] -= by_var * u[p] * u[q]


class Shifts(NamedTuple):
    """Joints of one person of which the weak ones move.

    Attributes
    ----------
    x_m, shift_m
        The fitted joints, and how far they have moved.
    cov_m2, info
        Their covariances, and the inverse of those of the weak joints.
    unknown_of
        Index of a joint's first unknown, -1 where the joint is well known.
    """

    x_m: Float64[np.ndarray, "joint 3"]
    shift_m: Float64[np.ndarray, "joint 3"]
    cov_m2: Float64[np.ndarray, "joint 3 3"]
    info: Float64[np.ndarray, "joint 3 3"]
    unknown_of: Int64[np.ndarray, " joint"]


@inner(allocates=True)
def gather(A, b, shifts, limbs, body):
    """Write the normal equations of the weak joints' shifts to `A`, `b`.

    Parameters
    ----------
    A, b
        Results, (unknown, unknown) and (unknown,).
    shifts, limbs, body
        `Shifts`, `Limbs`, and `Bodies` of the person.
    """
    x, d, cov_m2, known, unknown_of = shifts
    limb_joints, slack_m2, limb_m, limb_m2 = limbs.joints, limbs.slack_m2, body.limb_m, body.limb_m2
    clear_row(b)
    for i in range(b.shape[0]):
        clear_row(A[i])
    u = np.empty(3)
    for j in range(x.shape[0]):
        if unknown_of[j] >= 0:
            for p in range(3):
                for q in range(3):
                    A[unknown_of[j] + p, unknown_of[j] + q] = known[j, p, q]
                A[unknown_of[j] + p, unknown_of[j] + p] += 1.0 / REACH_M2
    for i in range(limb_m.shape[0]):
        j, k = limb_joints[i]
        if unknown_of[j] < 0 and unknown_of[k] < 0:
            continue
        residual = stretch(j, k, x, d, limb_m[i], u)
        var = limb_m2[i] + slack_m2[i] + TIE_M2
        for m in (j, k):
            if unknown_of[m] < 0:
                var += along_m2(u, cov_m2[m])
        add_limb(A, b, unknown_of[j], unknown_of[k], u, residual, var)
