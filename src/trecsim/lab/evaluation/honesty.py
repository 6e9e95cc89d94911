"""Whether the uncertainty that tracks state is the one they have."""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int16

from trecsim.lab.evaluation.assignment import need_scipy

SHARES = (0.50, 0.90, 0.95)
SUPPORTS = ("0", "1", "2+")
"""Cameras that support a joint: none, so that it is carried along; one; two and more."""


@dataclass(frozen=True, slots=True)
class Honesty:
    """How often the truth lies where the tracks say it does; NaN when no joint counts.

    Attributes
    ----------
    joints
        Joints found, of people matched, that state an uncertainty above zero.
    within_50, within_90, within_95
        Share of them whose truth is within the region that should hold 50, 90 and 95 % of them.
    normalised_rms
        Root of the mean square of error over stated standard deviation, per axis; 1 is honest,
        more is too sure, less is too modest.
    """

    joints: int
    within_50: float
    within_90: float
    within_95: float
    normalised_rms: float


def radius_of(share: float) -> float:
    """Return within how many standard deviations per axis this share of a 3D Gaussian lies.

    The distance has the chi distribution with three degrees of freedom.

    Examples
    --------
    >>> [round(radius_of(share), 3) for share in (0.5, 0.9, 0.95)]
    [1.538, 2.5, 2.795]
    """
    need_scipy()
    from scipy.special import chdtri

    return math.sqrt(chdtri(3, 1.0 - share))


def honesty(
    error_m: Float64[np.ndarray, "pair joint"],
    sigma_m: Float64[np.ndarray, "pair joint"],
    counts: Bool[np.ndarray, "pair joint"] | None = None,
) -> Honesty:
    """Return how true stated uncertainties are.

    Parameters
    ----------
    error_m
        Distances to the truth, NaN where not known [m].
    sigma_m
        Stated standard deviation per axis [m].
    counts
        Which joints count; all if None.
    """
    stated = np.isfinite(error_m) & (sigma_m > 0)
    stated = stated if counts is None else stated & counts
    if not stated.any():
        nan = float("nan")
        return Honesty(0, nan, nan, nan, nan)
    ratio = error_m[stated] / sigma_m[stated]
    within_50, within_90, within_95 = (float((ratio <= radius_of(p)).mean()) for p in SHARES)
    rms = float(np.sqrt(np.mean(ratio**2) / 3))
    return Honesty(len(ratio), within_50, within_90, within_95, rms)


def honesty_by_support(
    error_m: Float64[np.ndarray, "pair joint"],
    sigma_m: Float64[np.ndarray, "pair joint"],
    support: Int16[np.ndarray, "pair joint"],
) -> dict[str, Honesty]:
    """Return the same for joints with no, one, and more cameras; the keys are :data:`SUPPORTS`."""
    masks = (support == 0, support == 1, support >= 2)
    return {
        name: honesty(error_m, sigma_m, mask) for name, mask in zip(SUPPORTS, masks, strict=True)
    }
