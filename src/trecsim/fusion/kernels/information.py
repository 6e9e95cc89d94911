"""Square-root information of trajectories: folding, moving on, solving.

A trajectory of one joint is the solution of a least-squares problem in its live control points
``c``: minimise ``|R c - z|^2`` with ``R`` upper triangular, the square root of the information.
Observations and motion are rows that rotations and reflections fold into it. Because the columns
run from old to new, cutting off the first rows and columns marginalises the oldest control point
exactly, and the information can never lose its positive definiteness.
"""

import math

import numpy as np

from trecsim.compiler import inner
from trecsim.fusion.kernels.curve import BLOCK, ORDER, locate

REACH = ORDER * BLOCK


@inner
def fold_row(R, z, row, y, first):
    """Fold the equation ``row @ c = y`` into ``R c = z``, in place; `row` is destroyed.

    The columns of `row` before `first` must be zero.

    Notes
    -----
    Givens rotations, left to right. B-splines couple four neighbouring control points, so the
    factor is banded and a rotation touches at most twelve columns.
    """
    n = R.shape[0]
    for i in range(first, n):
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


@inner
def control_points(R, z, c):
    """Solve ``R c = z`` by back substitution into `c` (n,).

    Notes
    -----
    Three rows at a time: sums that do not wait for each other take a third of the time.
    """
    n = R.shape[0]
    for i in range(n - BLOCK, -1, -BLOCK):
        x, y, w = z[i], z[i + 1], z[i + 2]
        for k in range(i + BLOCK, min(n, i + REACH)):
            x -= R[i, k] * c[k]
            y -= R[i + 1, k] * c[k]
            w -= R[i + 2, k] * c[k]
        w /= R[i + 2, i + 2]
        y = (y - R[i + 1, i + 2] * w) / R[i + 1, i + 1]
        c[i] = (x - R[i, i + 1] * y - R[i, i + 2] * w) / R[i, i]
        c[i + 1], c[i + 2] = y, w


@inner
def right_side(R, c, z):
    """Write ``R c`` to `z`: the right side whose solution is `c`; three rows at a time."""
    n = R.shape[0]
    for i in range(0, n, BLOCK):
        x = R[i, i] * c[i] + R[i, i + 1] * c[i + 1] + R[i, i + 2] * c[i + 2]
        y = R[i + 1, i + 1] * c[i + 1] + R[i + 1, i + 2] * c[i + 2]
        w = R[i + 2, i + 2] * c[i + 2]
        for k in range(i + BLOCK, min(n, i + REACH)):
            x += R[i, k] * c[k]
            y += R[i + 1, k] * c[k]
            w += R[i + 2, k] * c[k]
        z[i], z[i + 1], z[i + 2] = x, y, w


@inner
def curve_covariance(R, span, weights, y, cov_m2):
    """Write the covariance of the curve's point at ``span, weights`` to `cov_m2` (3, 3).

    Notes
    -----
    With ``B`` the row of basis weights, ``cov = B (R^T R)^-1 B^T = |R^-T B^T|^2``; control points
    older than the span drop out of it. `y` is scratch, (n, 3). Three rows at a time, as for
    `control_points`.
    """
    n = R.shape[0]
    first = BLOCK * span
    xx = xy = xz = yy = yz = zz = 0.0  # sums that do not wait for each other
    for i in range(first, n, BLOCK):
        m = i // BLOCK - span
        a = e = j = weights[m] if m < ORDER else 0.0
        b = c = d = f = g = h = 0.0
        for k in range(max(first, i + BLOCK - REACH), i):
            u, v, w = y[k, 0], y[k, 1], y[k, 2]
            s, t, r = R[k, i], R[k, i + 1], R[k, i + 2]
            a, b, c = a - s * u, b - s * v, c - s * w
            d, e, f = d - t * u, e - t * v, f - t * w
            g, h, j = g - r * u, h - r * v, j - r * w
        by = 1.0 / R[i, i]
        a, b, c = a * by, b * by, c * by
        s, by = R[i, i + 1], 1.0 / R[i + 1, i + 1]
        d, e, f = (d - s * a) * by, (e - s * b) * by, (f - s * c) * by
        s, t, by = R[i, i + 2], R[i + 1, i + 2], 1.0 / R[i + 2, i + 2]
        g, h, j = (g - s * a - t * d) * by, (h - s * b - t * e) * by, (j - s * c - t * f) * by
        y[i, 0], y[i, 1], y[i, 2] = a, b, c
        y[i + 1, 0], y[i + 1, 1], y[i + 1, 2] = d, e, f
        y[i + 2, 0], y[i + 2, 1], y[i + 2, 2] = g, h, j
        xx, xy, xz = (
            xx + a * a + d * d + g * g,
            xy + a * b + d * e + g * h,
            xz + a * c + d * f + g * j,
        )
        yy, yz, zz = (
            yy + b * b + e * e + h * h,
            yz + b * c + e * f + h * j,
            zz + c * c + f * f + j * j,
        )
    cov_m2[0, 0], cov_m2[0, 1], cov_m2[0, 2] = xx, xy, xz
    cov_m2[1, 0], cov_m2[1, 1], cov_m2[1, 2] = xy, yy, yz
    cov_m2[2, 0], cov_m2[2, 1], cov_m2[2, 2] = xz, yz, zz


@inner(allocates=True)
def covariance_all(R, knot_time, cov_m2):
    """Write everybody's covariances at one time (in knots) to `cov_m2` (track, joint, 3, 3)."""
    y = np.empty((R.shape[2], BLOCK))
    weights = np.empty(ORDER)
    span = locate(knot_time, R.shape[2] // BLOCK, weights)
    for k in range(R.shape[0]):
        for j in range(R.shape[1]):
            curve_covariance(R[k, j], span, weights, y, cov_m2[k, j])


@inner
def fold_block(R, z, rows, y, first):
    """Fold the three equations ``rows @ c = y`` into ``R c = z``, in place; both are destroyed.

    The columns of `rows` (3, n) before `first` must be zero.

    Notes
    -----
    Householder reflections, one per column for the three rows together: a third of the square
    roots and divisions, whose waiting times are most of what three times `fold_row` would cost.
    """
    n = R.shape[0]
    for i in range(first, n):
        a, b, c = rows[0, i], rows[1, i], rows[2, i]
        s = a * a + b * b + c * c
        if s == 0.0:
            continue
        d = R[i, i]
        h = math.sqrt(d * d + s)
        e = -s / (d + h)
        f = 2.0 / (e * e + s)
        R[i, i] = h
        for k in range(i + 1, min(n, (i // BLOCK) * BLOCK + REACH)):
            w = f * (e * R[i, k] + a * rows[0, k] + b * rows[1, k] + c * rows[2, k])
            R[i, k] -= w * e
            rows[0, k] -= w * a
            rows[1, k] -= w * b
            rows[2, k] -= w * c
        w = f * (e * z[i] + a * y[0] + b * y[1] + c * y[2])
        z[i] -= w * e
        y[0] -= w * a
        y[1] -= w * b
        y[2] -= w * c


@inner
def fold_gaussian(R, z, info, rhs, least, x, span, weights, rows, y):
    """Fold what is known about a joint's place at one time into its trajectory, in place.

    Parameters
    ----------
    R, z
        Square-root information of the joint.
    info, rhs
        Information (3, 3) and information vector (3,) of the joint's shift from `x`; both are
        destroyed.
    least
        Information in a direction [1/m^2] that is worth a row.
    x
        Where the shift is counted from, (3,) [m].
    span, weights
        Place on the knot grid; see `locate`.
    rows, y
        Scratch, (3, n) and (3,).

    Notes
    -----
    The rows of the Cholesky factor of `info` are folded: three, however many images the
    information comes from.
    """
    first = BLOCK * span
    for i in range(BLOCK):
        y[i] = 0.0
        for k in range(first, rows.shape[1]):
            rows[i, k] = 0.0
        pivot = info[i, i]
        if not pivot > least:
            continue
        root = math.sqrt(pivot)
        y[i] = rhs[i] / root
        for q in range(i, BLOCK):
            g = info[i, q] / root
            y[i] += g * x[q]
            for m in range(ORDER):
                rows[i, first + BLOCK * m + q] = g * weights[m]
        for p in range(i + 1, BLOCK):
            share = info[p, i] / pivot
            rhs[p] -= share * rhs[i]
            for q in range(i + 1, BLOCK):
                info[p, q] -= share * info[i, q]
    fold_block(R, z, rows, y, first)
