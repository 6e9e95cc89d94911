"""The ground under a person: learnt where two cameras see what rests on it, used where they do not.

A body rests on its lowest joint: an ankle of somebody who stands, a hip of somebody who lies. No
joint is below the ground.
"""

import math

from trecsim.compiler import inner
from trecsim.fusion.tuning import (
    GROUND_GATE,
    GROUND_MEASURE_M2,
    GROUND_MEASURE_S,
    SLOPE_M2PS,
    STAIRS_M2PS,
)


@inner
def lowest(x, contact_height_m):
    """Return the joint whose body would touch a level ground first.

    `x` are joints, (joint, 3), `contact_height_m` (joint,) the height of each that touches.
    """
    best = 0
    for j in range(1, x.shape[0]):
        if x[j, 2] - contact_height_m[j] < x[best, 2] - contact_height_m[best]:
            best = j
    return best


@inner
def learn_level(x, cov_m2, n_seen, contact_height_m, level, elapsed_s):
    """Update, in place, height and variance of the ground under one person.

    Parameters
    ----------
    x, cov_m2
        Joints and covariances, (joint, 3) and (joint, 3, 3).
    n_seen
        How many cameras support each joint, (joint,).
    contact_height_m
        See `lowest`.
    level
        Height of the ground [m] and its variance [m^2], (2,).
    elapsed_s
        Time since the last frame set [s].

    Notes
    -----
    A scalar Kalman filter, as for the lengths of limbs. It learns where two cameras see the
    lowest joint; else the ground may have risen or fallen.
    """
    if elapsed_s <= 0.0:
        return
    level[1] += SLOPE_M2PS * elapsed_s
    j = lowest(x, contact_height_m)
    if n_seen[j] < 2:
        return
    off = x[j, 2] - contact_height_m[j] - level[0]
    var = cov_m2[j, 2, 2] + GROUND_MEASURE_M2
    if off * off > GROUND_GATE * GROUND_GATE * (level[1] + var):
        level[1] += STAIRS_M2PS * elapsed_s
        return
    gain = level[1] / (level[1] + var * max(1.0, GROUND_MEASURE_S / elapsed_s))
    level[0] += gain * off
    level[1] *= 1.0 - gain


@inner
def ground_contact(x, cov_m2, contact_height_m, level):
    """Return which joint rests on the ground, how far it must rise, and the variance of that.

    The joint is -1 when nobody rests there. Parameters as for `learn_level`.
    """
    j = lowest(x, contact_height_m)
    rise_m = level[0] + contact_height_m[j] - x[j, 2]
    var = level[1] + GROUND_MEASURE_M2
    if rise_m * rise_m > GROUND_GATE * GROUND_GATE * (var + cov_m2[j, 2, 2]):
        return -1, 0.0, math.inf
    return j, rise_m, var


@inner
def raise_to_ground(level, x, cov_m2):
    """Move joints that are below the ground up to it, in place.

    Parameters
    ----------
    level
        Height of the ground [m] and its variance [m^2], (2,).
    x, cov_m2
        Joints, (joint, 3), changed in place, and their covariances, (joint, 3, 3).

    Notes
    -----
    The likeliest place if the ground is no higher than the joint: a step of the Kalman filter with
    the ground's height as measurement, only for joints below it. It moves a joint along its ray
    where that is what is uncertain. Joints too far below to lie on this ground stay: there may be
    stairs. The covariance stays, as the ground does not tell how far above it a joint is.
    """
    ground_m2 = level[1] + GROUND_MEASURE_M2
    for j in range(x.shape[0]):
        depth_m, var_m2 = level[0] - x[j, 2], cov_m2[j, 2, 2] + ground_m2
        if depth_m > 0.0 and depth_m * depth_m < GROUND_GATE * GROUND_GATE * var_m2:
            for p in range(3):
                x[j, p] += cov_m2[j, p, 2] / var_m2 * depth_m
