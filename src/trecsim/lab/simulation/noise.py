"""Correlated noise: most errors of one image persist in the next."""

import math
from statistics import NormalDist

import numpy as np
from jaxtyping import Bool, Float64

from trecsim.lab.simulation.kernels import remember


def ornstein_uhlenbeck(
    rng: np.random.Generator, t_s: Float64[np.ndarray, " time"], tau_s: float, *shape: int
) -> Float64[np.ndarray, "time ..."]:
    """Return independent Ornstein-Uhlenbeck processes of unit variance.

    Parameters
    ----------
    rng
        Random numbers.
    t_s
        Increasing times, not necessarily equidistant [s].
    tau_s
        Time after which the correlation has fallen to 1/e [s].
    shape
        Shape of the processes.

    Notes
    -----
    The exact discretisation ``x' = a x + sqrt(1 - a^2) n`` with ``a = exp(-dt / tau)``, stationary
    from the first step.
    """
    values = rng.standard_normal((len(t_s), *shape))
    keep = np.exp(-np.diff(t_s) / tau_s)
    fresh = np.sqrt(1.0 - keep**2)
    remember(values.reshape(len(t_s), math.prod(shape)), keep, fresh)
    return values


def spells(
    rng: np.random.Generator,
    t_s: Float64[np.ndarray, " time"],
    tau_s: float,
    share: float | Float64[np.ndarray, "..."],
    *shape: int,
) -> Bool[np.ndarray, "time ..."]:
    """Return on/off processes that are on for a given share of the time.

    Parameters
    ----------
    rng
        Random numbers.
    t_s
        Increasing times [s].
    tau_s
        Approximate duration of a spell [s].
    share
        Share of the time, 0 to 1; an array is broadcast over `shape`.
    shape
        Shape of the processes.
    """
    shares = np.asarray(share, dtype=np.float64)
    threshold = np.array([_quantile(value) for value in shares.ravel()]).reshape(shares.shape)
    below: Bool[np.ndarray, "time ..."] = ornstein_uhlenbeck(rng, t_s, tau_s, *shape) < threshold
    return below


def _quantile(share: float) -> float:
    if share <= 0.0:
        return -np.inf
    return np.inf if share >= 1.0 else NormalDist().inv_cdf(share)
