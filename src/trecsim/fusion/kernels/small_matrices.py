"""Small matrices and vectors in explicit loops, which compile many times faster than arrays."""

import math

from trecsim.compiler import inner


@inner
def clear_row(row):
    """Set a row to zero."""
    for k in range(row.shape[0]):
        row[k] = 0.0


@inner
def copy(source, out):
    """Copy a matrix."""
    for i in range(out.shape[0]):
        for k in range(out.shape[1]):
            out[i, k] = source[i, k]


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
def sandwich3(A, B, out):
    """Write ``A B A`` to `out` (3, 3), for symmetric `A` and `B`."""
    for i in range(3):
        for k in range(i, 3):
            total = 0.0
            for p in range(3):
                for q in range(3):
                    total += A[i, p] * B[p, q] * A[q, k]
            out[i, k] = out[k, i] = total


@inner
def scale(R, z, by):
    """Multiply a joint's square-root information by `by`, in place."""
    for i in range(R.shape[0]):
        z[i] *= by
        for k in range(R.shape[1]):
            R[i, k] *= by


@inner
def largest(values):
    """Return the largest value; minus infinity if there is none."""
    most = -math.inf
    for i in range(values.shape[0]):
        most = max(most, values[i])
    return most
