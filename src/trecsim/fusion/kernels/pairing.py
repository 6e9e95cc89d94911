"""Pairs of detections of two cameras that may be one person nobody knows yet."""

import math
from typing import no_type_check

import numpy as np
from numba import njit

_PARALLEL = 1e-3
_TOO_CLOSE_M = 0.2
_FEWEST = 4
# Log likelihood ratio of a limb's length: a body's spread against any length at all.
_LIMB_BEST, _LIMB_CURVE, _LIMB_WORST = 1.3, 4.0, -4.0


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def ray_midpoint(p, u, q, v, out):
    """Write the point halfway between two rays to `out`; return their distance there [m].

    NaN where a ray is missing, they are nearly parallel, or meet behind a camera.
    """
    if math.isnan(u[0]) or math.isnan(v[0]):
        return math.nan
    b = u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
    den = 1.0 - b * b
    if den < _PARALLEL:
        return math.nan
    du = dv = 0.0
    for a in range(3):
        du += (q[a] - p[a]) * u[a]
        dv += (q[a] - p[a]) * v[a]
    s = (du - b * dv) / den
    t = (b * du - dv) / den
    if s < _TOO_CLOSE_M or t < _TOO_CLOSE_M:
        return math.nan
    gap = 0.0
    for a in range(3):
        first, second = p[a] + s * u[a], q[a] + t * v[a]
        out[a] = 0.5 * (first + second)
        gap += (first - second) ** 2
    return math.sqrt(gap)


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def meeting_score(i, k, flipped, origin_m, ray, factor, noise, x):
    """Return how well the rays of detections `i` and `k` meet, and how many joints do.

    The points halfway are written to `x` (joint, 3), NaN where the rays miss each other.
    """
    total = noise.log_flip if flipped else 0.0
    close = 0
    for j in range(ray.shape[1]):
        m = noise.mirror[j] if flipped else j
        gap = ray_midpoint(origin_m[i], ray[i, j], origin_m[k], ray[k, m], x[j])
        if math.isnan(gap):
            x[j, 0] = math.nan
            continue
        sigma = noise.sigma_m[j] * math.sqrt(factor[i, j] ** 2 + factor[k, m] ** 2)
        gauss = math.exp(-0.5 * (gap / sigma) ** 2) / (sigma * 2.5066282746310002)
        total += math.log((1.0 - noise.outlier_share) * gauss + noise.outlier_share)
        if gap < 3.0 * sigma:
            close += 1
        else:
            x[j, 0] = math.nan
    return total, close


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def limb_score(x, limbs, limb_m):
    """Return how much the limbs of the joints `x` (joint, 3) have the lengths of a body."""
    total = 0.0
    for b in range(limbs.shape[0]):
        p, q = x[limbs[b, 0]], x[limbs[b, 1]]
        if math.isnan(p[0]) or math.isnan(q[0]):
            continue
        length = math.sqrt((p[0] - q[0]) ** 2 + (p[1] - q[1]) ** 2 + (p[2] - q[2]) ** 2)
        ratio = math.log(max(length, 1e-3) / limb_m[b])
        total += max(_LIMB_BEST - _LIMB_CURVE * ratio * ratio, _LIMB_WORST)
    return total


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def pair_scores(cam, origin_m, ray, factor, limbs, limb_m, noise, out, flip):
    """Score how well any two detections of different cameras are one person.

    Parameters
    ----------
    cam
        Camera of each detection, (person,).
    origin_m, ray
        Where its viewing rays start (person, 3) and their unit directions (person, joint, 3),
        NaN where the key point is missing.
    factor
        By how much each key point is less certain than a good one, (person, joint).
    limbs, limb_m
        Joints of each limb (limb, 2) and its usual length (limb,) [m].
    noise
        The detector's `Noise`.
    out, flip
        Results, (person, person), upper triangle: log ratio to chance; 1 where the two disagree
        about left and right.

    Notes
    -----
    Two rays of the same joint pass close to each other; the points halfway between them make a
    body of human size. Both are log likelihood ratios against rays and lengths at random.
    """
    x = np.empty((ray.shape[1], 3))
    for i in range(ray.shape[0]):
        for k in range(i + 1, ray.shape[0]):
            out[i, k] = -math.inf
            flip[i, k] = 0
            if cam[i] == cam[k]:
                continue
            for f in range(2):
                total, close = meeting_score(i, k, f, origin_m, ray, factor, noise, x)
                if close < _FEWEST:
                    continue
                total += limb_score(x, limbs, limb_m)
                if total > out[i, k]:
                    out[i, k] = total
                    flip[i, k] = f
