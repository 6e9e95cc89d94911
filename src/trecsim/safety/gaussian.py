"""Probabilities of normal distributions in closed form, without SciPy."""

import math

import numpy as np
from jaxtyping import Float64

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
