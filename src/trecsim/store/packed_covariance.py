"""Round covariances to few bits, relative to their own size; the result is positive definite.

Each covariance has its own step ``s``, the largest power of two up to 3.9 % of its mean variance
and up to a twelfth of its smallest eigenvalue. The variances are rounded to multiples of ``s``, the
other three numbers to multiples of ``4 s``. So

- the standard deviation (root of the mean variance) changes by less than 1 %, as the mean variance
  changes by at most ``s / 2``;
- the matrix stays positive definite: rounding changes it by at most ``4.5 s`` in norm, which is
  at most 3/8 of the smallest eigenvalue;
- every number fits into a float32 whose last bits are zero, which compresses well.

A matrix whose numbers are multiples of half its step was rounded before and stays as it is, as
rounding makes a step at most twice as large. So rounding again changes nothing.

Where the largest and the smallest standard deviation differ by more than a factor of about 700,
the variances are raised by 4e-6 of their sum, so that a float32 still holds all multiples.
"""

import numpy as np
from jaxtyping import Bool, Float64

UPPER = ([0, 0, 0, 1, 1, 2], [0, 1, 2, 1, 2, 2])
"""Rows and columns of the six numbers of a covariance matrix."""
VARIANCES, COVARIANCES = [0, 3, 5], [1, 2, 4]
"""Where among the six numbers the variances and the others are."""

_SHARE_OF_MEAN = 0.039
_SHARE_OF_SMALLEST = 1.0 / 12.0
_COARSER = np.array([1.0, 4.0, 4.0, 1.0, 4.0, 1.0])
_LEAST, _RAISED = 2.0**-19, 2.0**-18  # smallest eigenvalue, as a share of the trace
_SMALLEST_M2, _LARGEST_M2 = 1e-30, 1e30  # of the trace, far inside the range of float32

Upper = Float64[np.ndarray, "*n 6"]


def packed(cov_m2: Float64[np.ndarray, "*n 3 3"]) -> Upper:
    """Return the rounded upper triangles of covariances, each a float32 with few bits.

    NaN where a number is not finite or the trace is negative; zeros stay zeros.

    Examples
    --------
    >>> packed(np.diag([4.1e-4, 1.0e-4, 1.0e-4])) * 1e4
    array([4.11987305, 0.        , 0.        , 0.99182129, 0.        ,
           0.99182129])
    """
    upper = _usable(cov_m2[..., *UPPER].reshape(-1, 6))
    smallest = _smallest_eigenvalue(upper)
    step = _step(upper, smallest)
    before = _is_packed(upper, step, smallest)
    kept = np.where(before[:, None], upper, _multiple(upper, step))
    weak = ~before & (smallest < _LEAST * _trace(upper))
    if weak.any():
        kept[weak] = _raised(upper[weak], smallest[weak])
    kept += 0.0  # no minus before a zero
    return kept.reshape(*cov_m2.shape[:-2], 6)


def unpacked(upper: Upper) -> Float64[np.ndarray, "*n 3 3"]:
    """Return the matrices of upper triangles."""
    cov_m2 = np.empty((*upper.shape[:-1], 3, 3))
    cov_m2[..., *UPPER] = cov_m2[..., *UPPER[::-1]] = upper
    return cov_m2


def is_possible(upper: Upper) -> Bool[np.ndarray, "*n"]:
    """Return which triangles are of a covariance, or unknown (NaN); rounding is allowed for."""
    unknown: Bool[np.ndarray, "*n"] = np.isnan(upper).any(axis=-1)
    with np.errstate(all="ignore"):
        trace = upper[..., VARIANCES].sum(axis=-1)
        known = np.isfinite(upper).all(axis=-1) & (upper[..., VARIANCES] >= 0).all(axis=-1)
        definite = _smallest_eigenvalue(upper) >= -1e-6 * trace
    possible: Bool[np.ndarray, "*n"] = unknown & ~np.isinf(upper).any(axis=-1) | known & definite
    return possible


def _usable(upper: Upper) -> Upper:
    with np.errstate(all="ignore"):
        trace = upper[..., VARIANCES].sum(axis=-1, keepdims=True)
        fits = np.isfinite(upper).all(axis=-1, keepdims=True) & (trace <= _LARGEST_M2)
    kept = np.where(trace < _SMALLEST_M2, 0.0, upper)
    return np.where(fits & (trace >= 0), kept, np.nan)


def _raised(upper: Upper, smallest: Float64[np.ndarray, " n"]) -> Upper:
    """Return nearly singular matrices with larger variances, rounded."""
    raised = upper.copy()
    raised[:, VARIANCES] += (_RAISED * _trace(upper) - smallest)[:, None]
    return _multiple(raised, _step(raised, _RAISED * _trace(upper)))


def _trace(upper: Upper) -> Float64[np.ndarray, " n"]:
    trace: Float64[np.ndarray, " n"] = upper[:, 0] + upper[:, 3] + upper[:, 5]
    return trace


def _step(upper: Upper, smallest: Float64[np.ndarray, " n"]) -> Upper:
    """Return the steps of the six numbers of each matrix, powers of two."""
    limit = np.minimum(_SHARE_OF_MEAN / 3.0 * _trace(upper), _SHARE_OF_SMALLEST * smallest)
    _, exponent = np.frexp(np.where(limit > 0, limit, 1.0))  # 2^(exponent - 1) <= limit
    step: Upper = np.ldexp(1.0, exponent - 1)[:, None] * _COARSER
    return step


def _multiple(upper: Upper, step: Upper) -> Upper:
    nearest: Upper = np.rint(upper / step) * step
    return nearest


def _is_packed(
    upper: Upper, step: Upper, smallest: Float64[np.ndarray, " n"]
) -> Bool[np.ndarray, " n"]:
    """Return which matrices have been rounded before."""
    short = (_multiple(upper, 0.5 * step) == upper) & (upper.astype(np.float32) == upper)
    before: Bool[np.ndarray, " n"] = short.all(axis=-1) & (smallest > 0)
    return before


def _smallest_eigenvalue(upper: Upper) -> Float64[np.ndarray, "*n"]:
    """Return the smallest eigenvalue of each symmetric matrix, in closed form."""
    xx, xy, xz, yy, yz, zz = np.moveaxis(upper, -1, 0)
    mean = (xx + yy + zz) / 3.0
    dx, dy, dz = xx - mean, yy - mean, zz - mean
    squares = dx**2 + dy**2 + dz**2 + 2.0 * (xy**2 + xz**2 + yz**2)
    spread = np.sqrt(squares / 6.0)
    half = dx * (dy * dz - yz**2) - xy * (xy * dz - yz * xz) + xz * (xy * yz - dy * xz)
    cubed = np.where(spread > 0, spread**3, 1.0)
    angle = np.arccos(np.clip(0.5 * half / cubed, -1.0, 1.0)) / 3.0
    smallest: Float64[np.ndarray, "*n"] = mean + 2.0 * spread * np.cos(angle + 2.0 * np.pi / 3.0)
    return smallest
