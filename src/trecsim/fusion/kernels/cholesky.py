"""Small dense systems of equations: Cholesky factor, solution, inverse.

Written out, as NumPy's own in compiled code would need SciPy at run time. The innermost loops run
along rows and their turns do not wait for each other, as those of a scalar product would.
"""

import math

from trecsim.compiler import inner


@inner
def cholesky(A):
    """Overwrite the upper triangle of the symmetric positive `A` by ``U``, with ``A = U^T U``.

    The diagonal holds the inverse of the factor's, which is what every later step needs.
    """
    n = A.shape[0]
    for i in range(n):
        by_pivot = 1.0 / math.sqrt(max(A[i, i], 1e-12))  # rounding may leave none of a pivot
        A[i, i] = by_pivot
        for k in range(i + 1, n):
            A[i, k] *= by_pivot
        for p in range(i + 1, n):
            share = A[i, p]
            for q in range(p, n):
                A[p, q] -= share * A[i, q]


@inner
def solve_cholesky(A, b):
    """Overwrite `b` by the solution of ``A x = b``, with `A` as `cholesky` leaves it."""
    n = A.shape[0]
    for i in range(n):
        b[i] *= A[i, i]
        for k in range(i + 1, n):
            b[k] -= A[i, k] * b[i]
    for i in range(n - 1, -1, -1):
        s = b[i]
        for k in range(i + 1, n):
            s -= A[i, k] * b[k]
        b[i] = s * A[i, i]


@inner
def invert_cholesky(A):
    """Overwrite the Cholesky factor that `cholesky` leaves in `A` by its inverse."""
    n = A.shape[0]
    for i in range(n - 1, -1, -1):
        for k in range(n - 1, i, -1):
            share = A[i, k] * A[i, i]
            A[i, k] = 0.0
            for j in range(k, n):
                A[i, j] -= share * A[k, j]


@inner
def joint_block(A, first, out):
    """Write a joint's covariance, a diagonal block of ``A A^T``, to `out` (3, 3).

    `A` is the inverse of a Cholesky factor, `first` the joint's first unknown.
    """
    n = A.shape[0]
    for p in range(3):
        for q in range(p + 1):
            s = 0.0
            for m in range(first + p, n):
                s += A[first + p, m] * A[first + q, m]
            out[p, q] = s
            out[q, p] = s
