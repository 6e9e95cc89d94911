"""Square-root information of trajectories: folding, moving on, solving.

A trajectory of one joint is the solution of a least-squares problem in its live control points
``c``: minimise ``|R c - z|^2`` with ``R`` upper triangular, the square root of the information.
Observations and motion are rows that rotations and reflections fold into it. Because the columns
run from old to new, cutting off the first rows and columns marginalises the oldest control point
exactly, and the information can never lose its positive definiteness.
"""

import math

import numpy as np

from trecsim.compiler import inner, kernel
from trecsim.fusion.kernels.curve import BLOCK, ORDER, locate

REACH = ORDER * BLOCK
# Weight of a torso joint that no camera supports in the mean velocity of the body; supported joints
# have weight 1.
UNSEEN_WEIGHT = 0.05
# Where fewer than two cameras support the body, depth is unobserved: the velocity of the body is
# multiplied by this for each knot.
KEPT = 0.8


@inner
def clear_row(row):
    """Set a row to zero; explicit loops compile many times faster than array expressions."""
    for k in range(row.shape[0]):
        row[k] = 0.0


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
def extend(R, z, c, stiffness, memory, drift_m, work):
    """Marginalise the oldest control point of one joint and append a new one, in place.

    Parameters
    ----------
    R, z, c
        Square-root information of the joint, (n, n) and (n,), and its solution (n,).
    stiffness
        Weight of the smoothing prior, ``1 / sqrt(q knot^3)`` [1/m] (thesis eq. 49-56, second
        differences of control points).
    memory
        How much of its own velocity the joint keeps over one knot, 0 to 1.
    drift_m
        How far the body moves in one knot, (3,) [m]; the rest of the velocity.
    work
        Scratch, (n,).

    Notes
    -----
    The new equations hold exactly for the extrapolated point, so the others' solution stays.
    """
    n = R.shape[0]
    for i in range(n - BLOCK):
        for k in range(i, min(n - BLOCK, (i // BLOCK) * BLOCK + REACH)):
            R[i, k] = R[i + BLOCK, k + BLOCK]
        z[i] = z[i + BLOCK]
        c[i] = c[i + BLOCK]
    for i in range(n):
        for k in range(n - BLOCK, n):
            R[i, k] = 0.0
            R[k, i] = 0.0
    for a in range(BLOCK):
        z[n - BLOCK + a] = 0.0
    for a in range(BLOCK):
        clear_row(work)
        work[n - 9 + a] = memory * stiffness
        work[n - 6 + a] = -(1.0 + memory) * stiffness
        work[n - 3 + a] = stiffness
        step_m = (1.0 - memory) * drift_m[a]
        fold_row(R, z, work, step_m * stiffness, n - 9)
        c[n - 3 + a] = (1.0 + memory) * c[n - 6 + a] - memory * c[n - 9 + a] + step_m


@inner
def start(R, z, xyz_m, position_sigma_m, step_sigma_m, stiffness, work):
    """Set up a joint that rests at `xyz_m`, with wide uncertainty, in place.

    `step_sigma_m` is the standard deviation of the way between two control points [m].
    """
    n = R.shape[0]
    for i in range(n):
        z[i] = 0.0
        clear_row(R[i])
    for a in range(BLOCK):
        clear_row(work)
        work[a] = 1.0 / position_sigma_m
        fold_row(R, z, work, xyz_m[a] / position_sigma_m, a)
        clear_row(work)
        work[a] = -1.0 / step_sigma_m
        work[BLOCK + a] = 1.0 / step_sigma_m
        fold_row(R, z, work, 0.0, a)
    for p in range(n // BLOCK - 2):
        for a in range(BLOCK):
            clear_row(work)
            work[BLOCK * p + a] = stiffness
            work[BLOCK * (p + 1) + a] = -2.0 * stiffness
            work[BLOCK * (p + 2) + a] = stiffness
            fold_row(R, z, work, 0.0, BLOCK * p + a)


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
    older than the span drop out of it. `y` is scratch, (n, 3).
    """
    n = R.shape[0]
    first = BLOCK * span
    xx = xy = xz = yy = yz = zz = 0.0  # sums that do not wait for each other
    for i in range(first, n):
        m = i // BLOCK - span
        weight, axis = weights[m] if m < ORDER else 0.0, i % BLOCK
        p = weight if axis == 0 else 0.0
        q = weight if axis == 1 else 0.0
        r = weight if axis == 2 else 0.0
        for k in range(max(first, (i // BLOCK - 3) * BLOCK), i):
            p -= R[k, i] * y[k, 0]
            q -= R[k, i] * y[k, 1]
            r -= R[k, i] * y[k, 2]
        by_pivot = 1.0 / R[i, i]
        p, q, r = p * by_pivot, q * by_pivot, r * by_pivot
        y[i, 0], y[i, 1], y[i, 2] = p, q, r
        xx, xy, xz = xx + p * p, xy + p * q, xz + p * r
        yy, yz, zz = yy + q * q, yz + q * r, zz + r * r
    cov_m2[0, 0], cov_m2[0, 1], cov_m2[0, 2] = xx, xy, xz
    cov_m2[1, 0], cov_m2[1, 1], cov_m2[1, 2] = xy, yy, yz
    cov_m2[2, 0], cov_m2[2, 1], cov_m2[2, 2] = xz, yz, zz


@kernel(allocates=True)
def extend_all(R, z, c, seen, torso, stiffness, own_memory, drag_memory):
    """Move every track and joint on by one control point, in place.

    Parameters
    ----------
    R, z, c
        Square-root information and control points, (track, joint, n, n) and (track, joint, n).
    seen
        How many cameras support each joint, (track, joint).
    torso
        The joints whose mean velocity is that of the body.
    stiffness
        Per joint; see `extend`.
    own_memory, drag_memory
        How much of its own velocity a joint keeps over one knot, supported or not.
    """
    n = R.shape[2]
    work = np.empty(n)
    drift_m = np.empty(BLOCK)
    for k in range(R.shape[0]):
        body_step(c[k], seen[k], torso, drift_m)
        for j in range(R.shape[1]):
            memory = own_memory if seen[k, j] > 0 else drag_memory
            extend(R[k, j], z[k, j], c[k, j], stiffness[j], memory, drift_m, work)


@inner
def body_step(c, seen, torso, step_m):
    """Write how far the body moved between the two newest control points to `step_m` (3,)."""
    n = c.shape[1]
    total, most = 0.0, 0
    for a in range(BLOCK):
        step_m[a] = 0.0
    for j in torso:
        weight = 1.0 if seen[j] > 0 else UNSEEN_WEIGHT
        total += weight
        most = max(most, seen[j])
        for a in range(BLOCK):
            step_m[a] += weight * (c[j, n - 3 + a] - c[j, n - 6 + a])
    for a in range(BLOCK):
        step_m[a] *= KEPT / total if most < 2 else 1.0 / total


@kernel(allocates=True)
def start_all(R, z, c, xyz_m, position_sigma_m, step_sigma_m, stiffness):
    """Set up all joints of one new track, in place; see `start`."""
    work = np.empty(R.shape[1])
    for j in range(R.shape[0]):
        start(R[j], z[j], xyz_m[j], position_sigma_m[j], step_sigma_m, stiffness[j], work)
        control_points(R[j], z[j], c[j])


@kernel(allocates=True)
def covariance_all(R, knot_time, cov_m2):
    """Write everybody's covariances at one time (in knots) to `cov_m2` (track, joint, 3, 3)."""
    y = np.empty((R.shape[2], BLOCK))
    weights = np.empty(ORDER)
    span = locate(knot_time, R.shape[2] // BLOCK, weights)
    for k in range(R.shape[0]):
        for j in range(R.shape[1]):
            curve_covariance(R[k, j], span, weights, y, cov_m2[k, j])


@inner
def invert3(A, out):
    """Write the inverse of a symmetric positive 3 x 3 matrix to `out`."""
    a, b, c = A[0, 0], A[0, 1], A[0, 2]
    d, e, f = A[1, 1], A[1, 2], A[2, 2]
    p, q, r = d * f - e * e, c * e - b * f, b * e - c * d
    by_det = 1.0 / (a * p + b * q + c * r)
    p, q, r = p * by_det, q * by_det, r * by_det
    s, t = (b * c - a * e) * by_det, (a * f - c * c) * by_det
    out[0, 0], out[0, 1], out[0, 2] = p, q, r
    out[1, 0], out[1, 1], out[1, 2] = q, t, s
    out[2, 0], out[2, 1], out[2, 2] = r, s, (a * d - b * b) * by_det


@inner
def copy(source, out):
    """Copy a matrix; explicit loops compile many times faster than array expressions."""
    for i in range(out.shape[0]):
        for k in range(out.shape[1]):
            out[i, k] = source[i, k]


@inner
def scale(R, z, by):
    """Multiply a joint's square-root information by `by`, in place."""
    for i in range(R.shape[0]):
        z[i] *= by
        for k in range(R.shape[1]):
            R[i, k] *= by


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
