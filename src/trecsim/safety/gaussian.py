"""Probabilities of normal distributions in closed form, without SciPy.

Notes
-----
Owen's T function, ``T(h, a) = 1/(2 pi) int_0^a exp(-h^2 (1 + x^2) / 2) / (1 + x^2) dx``, is the
probability that two independent standard normal variables fall behind the line at distance h and
within the angle atan(a) of its normal. For a <= 1 the integrand is smooth and Gauss-Legendre
quadrature is exact to about 1e-12; for a > 1 the angles are exchanged (D. B. Owen, 1956).
"""

import math

import numpy as np
from jaxtyping import Float64

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(20)
_AT, _SHARE = 0.5 * (_NODES + 1.0), 0.5 * _WEIGHTS  # on [0, 1]
_NOTHING = 8.0  # standard deviations; the probability beyond is below 1e-15
_erfc = np.frompyfunc(math.erfc, 1, 1)


def normal_cdf(x: Float64[np.ndarray, "..."]) -> Float64[np.ndarray, "..."]:
    """Return the probability that a standard normal variable is below `x`.

    Examples
    --------
    >>> normal_cdf(np.array([0.0, 1.2815515655446004])).round(9)
    array([0.5, 0.9])
    """
    twice: Float64[np.ndarray, ...] = np.asarray(_erfc(-x / math.sqrt(2.0)), np.float64)
    return 0.5 * twice


def below(limit: float, mean: float, sigma: float) -> float:
    """Return the probability that a normal variable is below a limit.

    Examples
    --------
    >>> below(1.0, 1.0, 0.2), below(1.0, 0.9, 0.0), below(1.0, 1.1, 0.0)
    (0.5, 1.0, 0.0)
    """
    if not sigma > 0.0:
        return float(mean < limit)
    return 0.5 * math.erfc((mean - limit) / (sigma * math.sqrt(2.0)))


def behind_line_within_angle(
    h: Float64[np.ndarray, "*n"], s: Float64[np.ndarray, "*n"]
) -> Float64[np.ndarray, "*n"]:
    """Return Owen's T(h, s / h), for h >= 0.

    Parameters
    ----------
    h
        Distance of a line from the mean, in standard deviations.
    s
        Where on the line a point is, counted from the foot of the mean; T has the sign of it.
    """
    share: Float64[np.ndarray, "*n"] = np.zeros(h.shape)
    near = h < _NOTHING  # beyond farther lines the probability is 0
    share[near] = _behind(h[near], s[near])
    return share


def _behind(
    h: Float64[np.ndarray, " point"], s: Float64[np.ndarray, " point"]
) -> Float64[np.ndarray, " point"]:
    """Return T(h, s / h) of lines that are not far away; see `behind_line_within_angle`."""
    along = np.abs(s)
    is_near = along <= h
    farther = np.where(is_near, h, along)
    direct = np.zeros(len(h))
    some = farther < _NOTHING
    direct[some] = _direct(farther[some], np.where(is_near, along, h)[some])
    above_h, above = normal_cdf(-h), normal_cdf(-along)
    both = 0.5 * ((1.0 - above_h) * above + (1.0 - above) * above_h)
    share: Float64[np.ndarray, " point"] = np.sign(s) * np.where(is_near, direct, both - direct)
    return share


def _direct(
    h: Float64[np.ndarray, "*n"], opposite: Float64[np.ndarray, "*n"]
) -> Float64[np.ndarray, "*n"]:
    """Return T(h, opposite / h) for opposite <= h."""
    a = np.divide(opposite, h, out=np.zeros_like(h), where=h > 0.0)
    spread = 1.0 + np.square(a[..., None] * _AT)
    inside = np.exp(-0.5 * np.square(h)[..., None] * spread) / spread
    share: Float64[np.ndarray, "*n"] = a / (2.0 * math.pi) * (inside @ _SHARE)
    return share
