"""Probabilities of normal distributions behind lines.

Notes
-----
Owen's T function, ``T(h, a) = 1/(2 pi) int_0^a exp(-h^2 (1 + x^2) / 2) / (1 + x^2) dx``, is the
probability that two independent standard normal variables fall behind the line at distance h and
within the angle atan(a) of its normal. For a <= 1 the integrand is smooth, and Gauss-Legendre
quadrature with ten nodes is exact to 1e-13; for a > 1 the angles are exchanged (D. B. Owen, 1956).
"""

import math

import numpy as np

from trecsim.compiler import inner, kernel

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(10)
_SQUARED_AT = (0.5 * (_NODES + 1.0)) ** 2  # on [0, 1]
_SHARE = 0.25 / math.pi * _WEIGHTS
_NOTHING = 8.0  # standard deviations; the probability beyond is below 1e-15
_SQRT_HALF = math.sqrt(0.5)


@inner
def cdf(x):
    """Return the probability that a standard normal variable is below x."""
    return 0.5 * math.erfc(-x * _SQRT_HALF)


@inner
def _direct(h, a):
    """Return T(h, a) for 0 <= a <= 1."""
    total = 0.0
    for k in range(_SHARE.shape[0]):
        spread = 1.0 + a * a * _SQUARED_AT[k]
        total += _SHARE[k] * math.exp(-0.5 * h * h * spread) / spread
    return a * total


@kernel
def behind_line(h, s):
    """Return Owen's T(h, s / h) for h >= 0; it has the sign of s.

    Parameters
    ----------
    h
        Distance of a line from the mean, in standard deviations.
    s
        Where on the line a point is, counted from the foot of the mean.
    """
    if h >= _NOTHING:
        return 0.0
    along = abs(s)
    if along <= h:
        share = _direct(h, along / h) if h > 0.0 else 0.0
    else:
        above_h, above = cdf(-h), cdf(-along)
        share = 0.5 * ((1.0 - above_h) * above + (1.0 - above) * above_h)
        if along < _NOTHING:
            share -= _direct(along, h / along)
    return share if s >= 0.0 else -share
