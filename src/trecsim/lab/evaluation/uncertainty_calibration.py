"""Uncertainty calibration: errors against the reported standard deviations."""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int16

from trecsim.lab.evaluation.assignment import need_scipy

SHARES = (0.50, 0.90, 0.95)
SUPPORTS = ("0", "1", "2+")
"""Number of cameras that support a joint; without any it is predicted."""


@dataclass(frozen=True, slots=True)
class UncertaintyCalibration:
    """Errors relative to the reported standard deviations; NaN without any joint.

    Attributes
    ----------
    joints
        Joints of matched people with a reported standard deviation above zero.
    within_50, within_90, within_95
        Share of them with the ground truth inside the reported 50, 90 and 95 % region.
    normalised_rms
        Root of the normalised estimation error squared (NEES) per axis: 1 is calibrated, above 1
        is overconfident, below 1 underconfident.
    """

    joints: int
    within_50: float
    within_90: float
    within_95: float
    normalised_rms: float


def radius_of(share: float) -> float:
    """Return the radius in standard deviations per axis that contains a share of a 3D Gaussian.

    The distance has the chi distribution with three degrees of freedom.

    Examples
    --------
    >>> [round(radius_of(share), 3) for share in (0.5, 0.9, 0.95)]
    [1.538, 2.5, 2.795]
    """
    need_scipy()
    from scipy.special import chdtri

    return math.sqrt(chdtri(3, 1.0 - share))


def uncertainty_calibration(
    error_m: Float64[np.ndarray, "pair joint"],
    sigma_m: Float64[np.ndarray, "pair joint"],
    counts: Bool[np.ndarray, "pair joint"] | None = None,
) -> UncertaintyCalibration:
    """Compare errors with the reported standard deviations, of the joints that count.

    Unknown errors are NaN.
    """
    stated = np.isfinite(error_m) & (sigma_m > 0)
    stated = stated if counts is None else stated & counts
    if not stated.any():
        nan = float("nan")
        return UncertaintyCalibration(0, nan, nan, nan, nan)
    ratio = error_m[stated] / sigma_m[stated]
    within_50, within_90, within_95 = (float((ratio <= radius_of(p)).mean()) for p in SHARES)
    rms = float(np.sqrt(np.mean(ratio**2) / 3))
    return UncertaintyCalibration(len(ratio), within_50, within_90, within_95, rms)


def calibration_by_support(
    error_m: Float64[np.ndarray, "pair joint"],
    sigma_m: Float64[np.ndarray, "pair joint"],
    support: Int16[np.ndarray, "pair joint"],
) -> dict[str, UncertaintyCalibration]:
    """Return the same by the number of supporting cameras; the keys are :data:`SUPPORTS`."""
    masks = (support == 0, support == 1, support >= 2)
    return {
        name: uncertainty_calibration(error_m, sigma_m, mask)
        for name, mask in zip(SUPPORTS, masks, strict=True)
    }
