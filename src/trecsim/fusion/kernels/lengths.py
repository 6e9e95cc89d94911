"""Limb lengths: learnt where two cameras see both ends, and what they say about joints."""

import math
from typing import NamedTuple

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.compiler import inner
from trecsim.fusion.tuning import (
    LENGTH_MEASURE_M2,
    LENGTH_MEASURE_S,
    LIMB_GATE,
    LIMB_SWEEPS,
    SUREST_LENGTH_M2,
    TIE_M2,
)


class Limbs(NamedTuple):
    """The distances between joints that a body keeps.

    Attributes
    ----------
    joints
        The two joints of each.
    slack_m2
        Variance about a person's mean length: what posture changes.
    contact_height_m
        How high each joint is when the body rests on it.
    chain
        Of each limb of arms and legs, from the trunk on: the joint nearer to the trunk, the other
        one, and which of `joints` they are.
    """

    joints: Int64[np.ndarray, "limb 2"]
    slack_m2: Float64[np.ndarray, " limb"]
    contact_height_m: Float64[np.ndarray, " joint"]
    chain: Int64[np.ndarray, "bone 3"]


@inner
def length_along(x, cov_m2, a, b, d):
    """Write the unit vector from joint `a` to `b` to `d`; return length and its variance."""
    length = 0.0
    for p in range(3):
        d[p] = x[b, p] - x[a, p]
        length += d[p] * d[p]
    length = math.sqrt(length)
    if length < 1e-6:
        return 0.0, math.inf
    var = 0.0
    for p in range(3):
        d[p] /= length
    for p in range(3):
        for q in range(3):
            var += d[p] * (cov_m2[a, p, q] + cov_m2[b, p, q]) * d[q]
    return length, var


@inner(allocates=True)
def learn(x, cov_m2, n_seen, limbs, body, elapsed_s):
    """Update, in place, the lengths of the limbs in one person's `Bodies`, and their variances.

    Notes
    -----
    A scalar Kalman filter per limb, fed only where two cameras see both ends. Errors persist, so
    a measurement counts by the time that has passed and not by the image.
    """
    joints, slack_m2, limb_m, limb_m2 = limbs.joints, limbs.slack_m2, body.limb_m, body.limb_m2
    d = np.empty(3)
    share = min(1.0, elapsed_s / LENGTH_MEASURE_S)
    if share <= 0.0:
        return
    for i in range(limb_m.shape[0]):
        a, b = joints[i]
        if n_seen[a] < 2 or n_seen[b] < 2:
            continue
        length, var = length_along(x, cov_m2, a, b, d)
        gain = limb_m2[i] / (limb_m2[i] + (var + LENGTH_MEASURE_M2 + slack_m2[i]) / share)
        limb_m[i] += gain * (length - limb_m[i])
        limb_m2[i] = max(limb_m2[i] * (1.0 - gain), SUREST_LENGTH_M2)


@inner(allocates=True)
def tighten(x, cov_m2, limbs, body):
    """Move one person's joints, in place, towards the lengths of the limbs, by how sure each is.

    Parameters
    ----------
    x, cov_m2
        Joints and covariances, (joint, 3) and (joint, 3, 3), changed in place.
    limbs, body
        `Limbs`, and this person's `Bodies`.

    Notes
    -----
    One limb after the other is taken as a measurement of the distance of two joints, which are
    treated as independent (Gauss-Seidel). Covariances shrink in the first sweep only, as later
    ones bring no new information.

    A limb that is off by more than `LIMB_GATE` standard deviations shows that one of its ends is
    elsewhere: the variance of the less certain one grows until the limb is off by no more, in all
    directions, as nothing tells in which one it is off. Then the limb holds it like any other.
    """
    joints, slack_m2, limb_m, limb_m2 = limbs.joints, limbs.slack_m2, body.limb_m, body.limb_m2
    u, gain = np.empty(3), np.empty(3)
    for sweep in range(LIMB_SWEEPS):
        for i in range(limb_m.shape[0]):
            a, b = joints[i]
            length, var = length_along(x, cov_m2, a, b, u)
            var += limb_m2[i] + slack_m2[i] + TIE_M2
            residual = limb_m[i] - length
            if length == 0.0:
                continue
            excess_m2 = residual * residual / (LIMB_GATE * LIMB_GATE) - var
            if excess_m2 > 0.0:
                worse = b if along_m2(u, cov_m2[b]) > along_m2(u, cov_m2[a]) else a
                for p in range(3):
                    cov_m2[worse, p, p] += excess_m2
                var += excess_m2
            informed = sweep == 0 and excess_m2 <= 0.0
            pull(x[a], cov_m2[a], u, -residual, var, informed, gain)
            pull(x[b], cov_m2[b], u, residual, var, informed, gain)


@inner
def along_m2(u, cov_m2):
    """Return the variance of a joint in the direction `u`."""
    var = 0.0
    for p in range(3):
        for q in range(3):
            var += u[p] * cov_m2[p, q] * u[q]
    return var


@inner
def pull(x, cov_m2, u, residual, var, informed, gain):
    """Move a joint along `u` by its share of `residual`, in place.

    Its covariance shrinks if `informed` is set.
    """
    for p in range(3):
        gain[p] = cov_m2[p, 0] * u[0] + cov_m2[p, 1] * u[1] + cov_m2[p, 2] * u[2]
    for p in range(3):
        x[p] += gain[p] * residual / var
        if informed:
            for q in range(3):
                cov_m2[p, q] -= gain[p] * gain[q] / var
