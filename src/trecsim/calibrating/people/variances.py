"""How large the errors of key points are in this recording: slow bias and fast noise."""

from dataclasses import replace

import numpy as np

from trecsim.calibrating.people.adjusting import Adjusted
from trecsim.calibrating.people.kernels.residuals import residuals
from trecsim.calibrating.people.observations import Observations
from trecsim.calibrating.people.tuning import (
    BIAS_M,
    BIAS_S,
    LEAST_VARIANCE,
    MOST_VARIANCE,
    NOISE_M,
)

MEDIAN_OF_TWO = 2.0 * np.log(2.0)  # of a squared distance in units of one axis's variance


def with_own_variances(
    seen: Observations,
    adjusted: Adjusted,
    of: Observations | None = None,
    *,
    least: float = LEAST_VARIANCE,
) -> Observations:
    """Return observations whose variances are those that an adjustment found.

    Parameters
    ----------
    seen
        What was adjusted.
    adjusted
        The result.
    of
        The observations to return; None takes those that were adjusted.
    least
        Least factor on the variances. Below 1 a rig follows the people of a short recording more
        readily, and its covariance is too small.

    Notes
    -----
    One step of expectation-maximisation for two variance components, common to all joints. Of the
    ``2 m`` numbers that `m` cameras say of a joint its place takes up three, and what lies in their
    direction is no bias: so much of the variance is missing from what was found.
    """
    sights, wanted = seen.sights, seen if of is None else of
    cameras = len(sights.cam) / max(len(sights.block), 1)
    left = 1.0 - 1.5 / cameras
    bias = _within(_bias_ratio(seen, adjusted) / left, least)
    noise = _within(_noise_ratio(seen, adjusted) / left, least)
    own = wanted.sights
    return replace(
        wanted, sights=own._replace(bias_m2=bias * own.bias_m2, noise_m2=noise * own.noise_m2)
    )


def with_variances_of(known: Observations, seen: Observations) -> Observations:
    """Return observations with the variances that others of the same people have."""
    of, own = known.sights, seen.sights
    if not len(of.noise_m2):
        return seen
    bias = of.bias_m2[0] / BIAS_M[known.joint[0]] ** 2
    noise = of.noise_m2[0] / NOISE_M[known.joint[0]] ** 2
    sights = own._replace(
        bias_m2=bias * BIAS_M[seen.joint] ** 2, noise_m2=noise * NOISE_M[seen.joint] ** 2
    )
    return replace(seen, sights=sights)


def _within(ratio: float, least: float) -> float:
    return float(np.clip(ratio, least, MOST_VARIANCE))


def _bias_ratio(seen: Observations, adjusted: Adjusted) -> float:
    """Return the mean square of the biases' steps over what was expected of them."""
    sights, bias_m = seen.sights, adjusted.unknowns.bias_m
    begins = np.zeros(len(sights.gap_s), dtype=bool)
    begins[sights.block_first[:-1]] = True
    kept = np.where(begins, 0.0, np.exp(-sights.gap_s / BIAS_S))
    before = np.roll(bias_m, 1, axis=0)
    series = np.repeat(np.arange(len(sights.bias_m2)), np.diff(sights.block_first))
    expected = sights.bias_m2[series] * (1.0 - kept**2)
    square = (bias_m - kept[:, None, None] * before) ** 2 / expected[:, None, None]
    there = np.zeros(bias_m.shape[:2], dtype=bool)
    there[np.repeat(sights.block, np.diff(sights.first)), sights.cam] = True
    return float(np.minimum(square[there], 16.0).mean()) if there.any() else 1.0


def _noise_ratio(seen: Observations, adjusted: Adjusted) -> float:
    """Return the median square of the residuals over that of their distribution."""
    sights = seen.sights
    n = len(sights.cam)
    off_m, depth_m, weight = np.zeros((n, 2)), np.zeros(n), np.zeros(n)
    residuals(sights, adjusted.unknowns, off_m, depth_m, weight)
    point = np.repeat(np.arange(len(sights.block)), np.diff(sights.first))
    series = np.repeat(np.arange(len(sights.noise_m2)), np.diff(sights.point_first))[point]
    off_m = off_m - adjusted.unknowns.bias_m[sights.block[point], sights.cam]
    square = (off_m**2).sum(axis=1) / sights.noise_m2[series]
    known = depth_m > 0
    return float(np.median(square[known])) / MEDIAN_OF_TWO if known.any() else 1.0
