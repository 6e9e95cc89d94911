"""Small dense systems, written out for the compiler."""

import math

from trecsim.compiler import inner


@inner
def invert_three(A):
    """Overwrite a symmetric positive 3 x 3 matrix by its inverse."""
    a, b, c = A[0, 0], A[0, 1], A[0, 2]
    d, e, f = A[1, 1], A[1, 2], A[2, 2]
    p, q, r = d * f - e * e, c * e - b * f, b * e - c * d
    by = 1.0 / (a * p + b * q + c * r)
    A[0, 0] = p * by
    A[0, 1] = A[1, 0] = q * by
    A[0, 2] = A[2, 0] = r * by
    A[1, 1] = (a * f - c * c) * by
    A[1, 2] = A[2, 1] = (b * c - a * e) * by
    A[2, 2] = (a * d - b * b) * by


@inner
def factor(A):
    """Overwrite the lower triangle of the square in the first columns by its Cholesky factor.

    The diagonal holds the inverse of the factor's.
    """
    n = A.shape[0]
    for i in range(n):
        for j in range(i):
            total = A[i, j]
            for k in range(j):
                total -= A[i, k] * A[j, k]
            A[i, j] = total * A[j, j]
        total = A[i, i]
        for k in range(i):
            total -= A[i, k] * A[i, k]
        A[i, i] = 1.0 / math.sqrt(max(total, 1e-12))


@inner
def solve_columns(A, B, b):
    """Overwrite `B` and `b` by ``L^-1 B`` and ``L^-1 b``, with `A` as `factor` leaves it."""
    n, width = B.shape
    for i in range(n):
        for k in range(i):
            w = A[i, k]
            if w != 0.0:
                b[i] -= w * b[k]
                for m in range(width):
                    B[i, m] -= w * B[k, m]
        b[i] *= A[i, i]
        for m in range(width):
            B[i, m] *= A[i, i]


@inner
def insert(value, n, ordered):
    """Insert a value among the first `n` of an ordered array, in place."""
    k = n
    while k > 0 and ordered[k - 1] > value:
        ordered[k] = ordered[k - 1]
        k -= 1
    ordered[k] = value
