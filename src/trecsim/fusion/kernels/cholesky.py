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

    Notes
    -----
    Joints without a common limb leave zeros in the factor, which are skipped.
    """
    n = A.shape[0]
    for i in range(n):
        by_pivot = 1.0 / math.sqrt(max(A[i, i], 1e-12))  # rounding may leave none of a pivot
        A[i, i] = by_pivot
        stop = i + 1
        for k in range(i + 1, n):
            if A[i, k] != 0.0:
                A[i, k] *= by_pivot
                stop = k + 1
        for p in range(i + 1, stop):
            share = A[i, p]
            if share == 0.0:
                continue
            for q in range(p, stop):
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
            if share == 0.0:
                continue
            for j in range(k, n):
                A[i, j] -= share * A[k, j]


@inner
def joint_block(A, first, out):
    """Write a joint's covariance, a diagonal block of ``A A^T``, to `out` (3, 3).

    `A` is the inverse of a Cholesky factor, `first` the joint's first unknown.
    """
    xx = xy = xz = yy = yz = zz = 0.0  # sums that do not wait for each other
    for m in range(first, A.shape[0]):
        x = A[first, m]
        y = A[first + 1, m] if m > first else 0.0
        z = A[first + 2, m] if m > first + 1 else 0.0
        xx, xy, xz = xx + x * x, xy + y * x, xz + z * x
        yy, yz, zz = yy + y * y, yz + z * y, zz + z * z
    out[0, 0], out[0, 1], out[0, 2] = xx, xy, xz
    out[1, 0], out[1, 1], out[1, 2] = xy, yy, yz
    out[2, 0], out[2, 1], out[2, 2] = xz, yz, zz
