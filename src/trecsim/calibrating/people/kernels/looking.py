"""Where a camera sees a point, how much an observation counts, and what all of them cost."""

import math

import numpy as np

from trecsim.calibrating.people.tuning import BIAS_S, LEAST_WEIGHT, NOISE_PX, ROBUST
from trecsim.compiler import inner, kernel


@inner
def look(sights, unknowns, o, x, n_own, e, by_point, by_own):
    """Write the residual [m] of an observation and its derivatives; return the depth [m].

    The derivatives are those of the prediction, by the point and by the camera's own unknowns:
    turn, shift, offset, drift and, if `n_own` is 11, focal length and principal point.
    """
    c = sights.cam[o]
    T = unknowns.T[c]
    px = T[0, 0] * x[0] + T[0, 1] * x[1] + T[0, 2] * x[2] + T[0, 3]
    py = T[1, 0] * x[0] + T[1, 1] * x[1] + T[1, 2] * x[2] + T[1, 3]
    pz = T[2, 0] * x[0] + T[2, 1] * x[1] + T[2, 2] * x[2] + T[2, 3]
    if not pz > 0.05:
        return -1.0
    u, v = px / pz, py / pz
    lens = unknowns.lens[c]
    wide = 1.0 + lens[0]
    late = unknowns.clock[c, 0] + unknowns.clock[c, 1] * sights.ahead_s[o]
    e[0] = pz * (sights.z[o, 0] - sights.speed[o, 0] * late - wide * u - lens[1])
    e[1] = pz * (sights.z[o, 1] - sights.speed[o, 1] * late - wide * v - lens[2])
    for a in range(3):
        by_point[0, a] = wide * (T[0, a] - u * T[2, a])
        by_point[1, a] = wide * (T[1, a] - v * T[2, a])
    # turn w: dp = w x p; shift: dp = s
    by_own[0, 0], by_own[0, 1], by_own[0, 2] = -wide * u * py, wide * (pz + u * px), -wide * py
    by_own[1, 0], by_own[1, 1], by_own[1, 2] = -wide * (pz + v * py), wide * v * px, wide * px
    by_own[0, 3], by_own[0, 4], by_own[0, 5] = wide, 0.0, -wide * u
    by_own[1, 3], by_own[1, 4], by_own[1, 5] = 0.0, wide, -wide * v
    for a in range(2):
        by_own[a, 6] = pz * sights.speed[o, a]
        by_own[a, 7] = by_own[a, 6] * sights.ahead_s[o]
    if n_own > 8:
        by_own[0, 8], by_own[0, 9], by_own[0, 10] = pz * u, pz, 0.0
        by_own[1, 8], by_own[1, 9], by_own[1, 10] = pz * v, 0.0, pz
    return pz


@inner
def certainty(sights, s, o, depth_m, scale):
    """Return the inverse variance of an observation [1/m^2]."""
    floor_m = NOISE_PX * depth_m / sights.focal_px[sights.cam[o]]
    return 1.0 / (scale * scale * (sights.noise_m2[s] + floor_m * floor_m))


@inner
def trust(square):
    """Return the weight of a squared residual in standard deviations (Geman and McClure)."""
    s2 = ROBUST * ROBUST
    w = s2 / (s2 + square)
    return max(w * w, LEAST_WEIGHT)


@inner
def cost_of(square):
    """Return the cost that belongs to `trust`."""
    s2 = ROBUST * ROBUST
    return s2 * square / (s2 + square) + LEAST_WEIGHT * square


@kernel(allocates=True)
def total_cost(sights, unknowns, scale, seen_from):
    """Return the robust cost of all observations, biases and heights.

    Parameters
    ----------
    sights, unknowns
        `Sights` and `Unknowns`.
    scale
        Noise over its usual size.
    seen_from
        `Eliminated`, as `reduce` left it: its depths turn angles into metres, and its draws keep
        the heights from shrinking the scene.

    Notes
    -----
    Errors are sizes at the body. With depths that follow the unknowns the cost would fall when
    everybody comes nearer to the cameras, so that two of these costs can be compared only with the
    same `seen_from`.
    """
    e, by_point, by_own = np.empty(2), np.empty((2, 3)), np.empty((2, 11))
    cost = 0.0
    for s in range(sights.noise_m2.shape[0]):
        for p in range(sights.point_first[s], sights.point_first[s + 1]):
            bias = unknowns.bias_m[sights.block[p]]
            for o in range(sights.first[p], sights.first[p + 1]):
                c, from_m = sights.cam[o], seen_from.depth_m[o]
                depth = look(sights, unknowns, o, unknowns.xyz_m[p], 8, e, by_point, by_own)
                if depth < 0.0 or from_m < 0.0:
                    cost += ROBUST * ROBUST
                    continue
                x = e[0] * from_m / depth - bias[c, 0]
                y = e[1] * from_m / depth - bias[c, 1]
                cost += cost_of((x * x + y * y) * certainty(sights, s, o, from_m, scale))
                grown = depth / (from_m * (1.0 + unknowns.lens[c, 0]))
                cost -= 2.0 * seen_from.draw[p] * math.log(grown)
            high = unknowns.xyz_m[p, 2] - unknowns.level_m[s]
            cost += cost_of(high * high / sights.level_m2[s])
        for b in range(sights.block_first[s], sights.block_first[s + 1]):
            kept, info = link_of(sights, s, b)
            for c in range(unknowns.bias_m.shape[1]):
                for a in range(2):
                    step = unknowns.bias_m[b, c, a]
                    if kept > 0.0:
                        step -= kept * unknowns.bias_m[b - 1, c, a]
                    cost += info * step * step
    return cost


@inner
def link_of(sights, s, b):
    """Return how much of the bias of the block before is left, and the step's information."""
    if b == sights.block_first[s]:
        return 0.0, 1.0 / sights.bias_m2[s]
    kept = math.exp(-sights.gap_s[b] / BIAS_S)
    return kept, 1.0 / (sights.bias_m2[s] * (1.0 - kept * kept))
