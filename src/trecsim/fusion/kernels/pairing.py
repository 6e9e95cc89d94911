"""Pairs of detections of two cameras that may be one person nobody knows yet."""

import math

import numpy as np

from trecsim.compiler import inner, kernel
from trecsim.fusion.tuning import (
    LIMB_BEST,
    LIMB_CURVE,
    LIMB_WORST,
    PAIR_JOINTS,
    PAIR_MPS,
    PARALLEL,
    RAY_GATE,
    TOO_CLOSE_M,
)

_SHORTEST_M = 1e-3
_SQRT_2_PI = math.sqrt(2.0 * math.pi)


@inner
def ray_midpoint(p, u, q, v, out):
    """Write the point halfway between two rays to `out`; return their distance there [m].

    NaN where a ray is missing, they are nearly parallel, or meet behind a camera.
    """
    if math.isnan(u[0]) or math.isnan(v[0]):
        return math.nan
    b = u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
    den = 1.0 - b * b
    if den < PARALLEL:
        return math.nan
    du = dv = 0.0
    for a in range(3):
        du += (q[a] - p[a]) * u[a]
        dv += (q[a] - p[a]) * v[a]
    s = (du - b * dv) / den
    t = (b * du - dv) / den
    if s < TOO_CLOSE_M or t < TOO_CLOSE_M:
        return math.nan
    gap = 0.0
    for a in range(3):
        first, second = p[a] + s * u[a], q[a] + t * v[a]
        out[a] = 0.5 * (first + second)
        gap += (first - second) ** 2
    return math.sqrt(gap)


@kernel
def midpoints(p, u, q, v, most_m, out):
    """Write the points halfway between the rays of two detections to `out`; count them.

    Parameters
    ----------
    p, u, q, v
        Where the rays start, (3,), and their directions, (joint, 3).
    most_m
        Rays that pass further from each other do not meet [m].
    out
        Result, (joint, 3); NaN where rays do not meet.
    """
    n = 0
    for j in range(u.shape[0]):
        meet = ray_midpoint(p, u[j], q, v[j], out[j]) < most_m
        n += meet
        if not meet:
            for a in range(3):
                out[j, a] = math.nan
    return n


@inner
def meeting_score(one, other, flipped, noise, moved_m, x):
    """Return how well the rays of two detections meet, and how many joints do.

    Each detection is the origin of its rays (3,), their directions (joint, 3) and factors of
    uncertainty (joint,). A person has moved by `moved_m` between the two, per axis. The points
    halfway are written to `x` (joint, 3), NaN where the rays miss each other.
    """
    (p, u, u_scale), (q, v, v_scale) = one, other
    sigma_m, mirror, share = noise.sigma_m, noise.mirror, noise.outlier_share
    total = noise.log_flip if flipped else 0.0
    close = 0
    for j in range(u.shape[0]):
        m = mirror[j] if flipped else j
        gap = ray_midpoint(p, u[j], q, v[m], x[j])
        if math.isnan(gap):
            x[j, 0] = math.nan
            continue
        seen_m2 = sigma_m[j] * sigma_m[j] * (u_scale[j] ** 2 + v_scale[m] ** 2)
        sigma = math.sqrt(seen_m2 + moved_m * moved_m)
        gauss = math.exp(-0.5 * (gap / sigma) ** 2) / (sigma * _SQRT_2_PI)
        total += math.log((1.0 - share) * gauss + share)
        if gap < RAY_GATE * sigma:
            close += 1
        else:
            x[j, 0] = math.nan
    return total, close


@inner
def limb_score(x, bones):
    """Return how much the limbs of the joints `x` (joint, 3) have the lengths of a body."""
    limbs, limb_m = bones
    total = 0.0
    for b in range(limbs.shape[0]):
        p, q = x[limbs[b, 0]], x[limbs[b, 1]]
        if math.isnan(p[0]) or math.isnan(q[0]):
            continue
        length = math.sqrt((p[0] - q[0]) ** 2 + (p[1] - q[1]) ** 2 + (p[2] - q[2]) ** 2)
        ratio = math.log(max(length, _SHORTEST_M) / limb_m[b])
        total += max(LIMB_BEST - LIMB_CURVE * ratio * ratio, LIMB_WORST)
    return total


@kernel(allocates=True)
def pair_scores(rays, bones, noise, out, flip):
    """Score how well any two detections of different cameras are one person.

    Parameters
    ----------
    rays, bones, noise
        `Rays` of the detections, `Bones` and `Noise`.
    out, flip
        Results, (person, person), upper triangle: log ratio to chance; 1 where the two disagree
        about left and right.

    Notes
    -----
    Two rays of the same joint pass close to each other; the points halfway between them make a
    body of human size. Both are log likelihood ratios against rays and lengths at random. Rays of
    images of different times pass each other where the person has moved between them.
    """
    cam, origin_m, direction, sigma_scale, t_s = rays
    x = np.empty((direction.shape[1], 3))
    for i in range(cam.shape[0]):
        one = origin_m[i], direction[i], sigma_scale[i]
        for k in range(i + 1, cam.shape[0]):
            out[i, k] = -math.inf
            flip[i, k] = 0
            if cam[i] == cam[k]:
                continue
            other = origin_m[k], direction[k], sigma_scale[k]
            moved_m = PAIR_MPS * abs(t_s[i] - t_s[k])
            for f in range(2):
                total, close = meeting_score(one, other, f, noise, moved_m, x)
                if close < PAIR_JOINTS:
                    continue
                total += limb_score(x, bones)
                if total > out[i, k]:
                    out[i, k] = total
                    flip[i, k] = f
