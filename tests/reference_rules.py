"""Slow and obvious twins of the rules' kernels, for tests to hold the two together."""

import math
from itertools import pairwise

import numpy as np
from scipy.special import owens_t
from scipy.stats import norm

LEAST_M = 1e-6


def known(cov_m2):
    """Return a positive definite covariance, also where it is unknown or zero."""
    return np.where(np.isfinite(cov_m2), cov_m2, 0.0) + LEAST_M**2 * np.eye(len(cov_m2))


def sides(corners):
    return list(zip(corners, np.roll(corners, -1, axis=0), strict=True))


def is_inside(corners, at):
    """Count the sides that a ray to the right leaves through."""
    count = 0
    for a, b in sides(corners):
        if (a[1] > at[1]) != (b[1] > at[1]):
            count += at[0] < a[0] + (at[1] - a[1]) * (b[0] - a[0]) / (b[1] - a[1])
    return count % 2 == 1


def nearest_on(a, b, at):
    share = np.dot(at - a, b - a) / np.dot(b - a, b - a)
    return a + min(max(share, 0.0), 1.0) * (b - a)


def to_border(corners, at):
    """Return the distance to the border, positive inside, and the direction in which it grows."""
    places = [nearest_on(a, b, at) for a, b in sides(corners)]
    place = min(places, key=lambda one: np.linalg.norm(at - one))
    away = at - place
    distance = np.linalg.norm(away)
    sign = 1.0 if is_inside(corners, at) else -1.0
    return sign * distance, sign * away / distance


def inside(corners, mean, cov_m2):
    """Sum the shares of the triangles that the sides form with the mean, after whitening."""
    white = np.linalg.inv(np.linalg.cholesky(known(cov_m2)))
    total = 0.0
    for a, b in sides(corners):
        p, q = white @ (a - mean), white @ (b - mean)
        length = np.linalg.norm(q - p)
        h = (p[0] * q[1] - q[0] * p[1]) / length
        start, end = np.dot(p, q - p) / length, np.dot(q, q - p) / length
        angle = math.atan2(end, abs(h)) - math.atan2(start, abs(h))
        with np.errstate(divide="ignore", invalid="ignore"):
            behind = owens_t(abs(h), end / abs(h)) - owens_t(abs(h), start / abs(h))
        total += np.sign(h) * (angle / (2.0 * math.pi) - behind)
    return min(max(total, 0.0), 1.0)


def inside_prism(corners, z_m, mean, cov_m2, slices=16):
    """Cut the prism into slices of constant height."""
    cov_m2 = known(cov_m2)
    sigma = math.sqrt(cov_m2[2, 2])
    low, high = (z_m[0] - mean[2]) / sigma, (z_m[1] - mean[2]) / sigma
    nodes, weights = np.polynomial.legendre.leggauss(slices)
    low_5, high_5 = max(low, -5.5), min(high, 5.5)
    if high_5 <= low_5:
        return 0.0
    shift = cov_m2[:2, 2] / sigma
    rest = cov_m2[:2, :2] - np.outer(shift, shift)
    total = all_weights = 0.0
    for node, weight in zip(nodes, weights, strict=True):
        at = 0.5 * (low_5 + high_5) + 0.5 * (high_5 - low_5) * node
        weight = weight * norm.pdf(at)
        total += weight * inside(corners, mean[:2] + at * shift, rest)
        all_weights += weight
    return (norm.cdf(high) - norm.cdf(low)) * total / all_weights


def from_edge(points, at):
    """Return the distance from an edge, NaN before and behind it, and where it grows to."""
    pairs = list(pairwise(points))
    places = [nearest_on(a, b, at) for a, b in pairs]
    n = int(np.argmin([np.linalg.norm(at - one) for one in places]))
    shares = [np.dot(at - a, b - a) / np.dot(b - a, b - a) for a, b in pairs]
    rights = [np.array([(b - a)[1], -(b - a)[0]]) / np.linalg.norm(b - a) for a, b in pairs]
    other = n - 1 if shares[n] < 0.0 else n + 1 if shares[n] > 1.0 else n
    facing = rights[n] + rights[min(max(other, 0), len(pairs) - 1)]
    away = at - places[n]
    side = 1.0 if np.dot(away, facing) >= 0.0 else -1.0
    distance = np.linalg.norm(away)
    normal = side * away / distance
    outside = (n == 0 and shares[0] < 0.0) or (n == len(pairs) - 1 and shares[-1] > 1.0)
    return (math.nan if outside else side * distance), normal


def at_edge(points, within_m, depth_m, mean, cov_m2):
    """Return how surely a joint is near an edge and beyond it, and how far away it is."""
    distance, normal = from_edge(points, mean[:2])
    if not distance >= -depth_m:
        return 0.0, 0.0, math.inf
    flat = np.where(np.isfinite(cov_m2[:2, :2]), cov_m2[:2, :2], 0.0)
    sigma = math.sqrt(normal @ flat @ normal) + LEAST_M
    return norm.cdf((within_m - distance) / sigma), norm.cdf(-distance / sigma), distance


def reach(joints_m, z_m, towards):
    counts = [one for one in joints_m if z_m[0] <= one[2] <= z_m[1]]
    return max((np.dot(one[:2], towards) for one in counts), default=-math.inf)


def reached_zone(parts, z_m, xy_m, cov_m2, joints_m, paths=16, grid=4000):
    """Return the probability that one person will have been in a zone, per mode and step.

    `parts` has the corners of the convex parts at each step. For some second components of z,
    each of many first ones is tried at each step; where a part holds some at two steps, it holds
    those in between at a time in between.
    """
    there = np.zeros(xy_m.shape[:2])
    if z_m is not None and reach(joints_m, z_m, np.zeros(2)) == -math.inf:
        return there
    first = norm.ppf((np.arange(grid) + 0.5) / grid)
    for mode in range(len(xy_m)):
        for second in norm.ppf((np.arange(paths) + 0.5) / paths):
            was = np.zeros(grid, bool)
            before = {}
            for step, mean in enumerate(xy_m[mode]):
                root = np.linalg.cholesky(known(cov_m2[mode, step]))
                for n, corners in enumerate(parts[step]):
                    low, high = _held(corners, mean, root, second, joints_m, z_m)
                    now = [low, high] if low < high else []
                    if now:
                        both = now + before.get(n, [])
                        was |= (first > min(both)) & (first < max(both))
                    before[n] = now
                there[mode, step] += was.mean() / paths
    return there


def _held(corners, mean, root, second, joints_m, z_m):
    """Return which first components of z are inwards of all sides, moved by the joints' reach."""
    low, high = -math.inf, math.inf
    for a, b in sides(corners):
        inwards = np.array([-(b - a)[1], (b - a)[0]]) / np.linalg.norm(b - a)
        out = 0.0 if z_m is None else reach(joints_m, z_m, inwards)
        missing = -((mean + root[:, 1] * second - a) @ inwards + out)
        slope = root[:, 0] @ inwards
        if slope > 0.0:
            low = max(low, missing / slope)
        elif slope < 0.0:
            high = min(high, missing / slope)
        elif missing > 0.0:
            return math.inf, -math.inf
    return low, high


def reached_edge(points, depth_m, xy_m, cov_m2, joints_m):
    """Return the probability that one person's joints will have been beyond an edge."""
    there = np.zeros(xy_m.shape[:2])
    for mode, step in np.ndindex(*there.shape):
        distance, normal = from_edge(points, xy_m[mode, step])
        if distance >= -depth_m:
            sigma = math.sqrt(normal @ cov_m2[mode, step] @ normal) + LEAST_M
            out = reach(joints_m, (-math.inf, math.inf), -normal)
            there[mode, step] = norm.cdf((out - distance) / sigma)
    return np.maximum.accumulate(there, axis=1)
