"""How far the viewing rays of two detections' joints pass each other."""

import math

import numpy as np

from trecsim.calibrating.people.kernels.small import insert
from trecsim.compiler import inner, kernel


@kernel(allocates=True)
def ray_distances(T_a, T_b, xy_a, xy_b, of_a, of_b, distance):
    """Write the median distance of the joints' viewing rays of pairs of detections [m].

    Parameters
    ----------
    T_a, T_b
        Poses of the two cameras, from the world.
    xy_a, xy_b
        Key points of each in the plane z = 1.
    of_a, of_b
        Numbers of the detections, one pair after the other.
    distance
        Changed in place; NaN where fewer than six joints are seen by both.
    """
    n_joints = xy_a.shape[1]
    turn, shift = np.zeros((3, 3)), np.zeros(3)  # from camera b to camera a
    from_other(T_a, T_b, turn, shift)
    found, ray = np.empty(n_joints), np.empty(3)
    for p in range(of_a.shape[0]):
        n = 0
        for j in range(n_joints):
            ax, ay = xy_a[of_a[p], j, 0], xy_a[of_a[p], j, 1]
            bx, by = xy_b[of_b[p], j, 0], xy_b[of_b[p], j, 1]
            for i in range(3):
                ray[i] = turn[i, 0] * bx + turn[i, 1] * by + turn[i, 2]
            d = between(ax, ay, ray, shift)
            if d >= 0.0:
                insert(d, n, found)
                n += 1
        distance[p] = found[n // 2] if n >= 6 else math.nan


@inner
def from_other(T_a, T_b, turn, shift):
    """Write the motion from camera b to camera a; both arrays are 0 before."""
    for i in range(3):
        shift[i] = T_a[i, 3]
        for j in range(3):
            for k in range(3):
                turn[i, j] += T_a[i, k] * T_b[j, k]
    for i in range(3):
        for j in range(3):
            shift[i] -= turn[i, j] * T_b[j, 3]


@inner
def between(ax, ay, ray, origin):
    """Return the distance of the ray (ax, ay, 1) from 0 and `ray` from `origin`; inf if behind."""
    aa, ab = ax * ax + ay * ay + 1.0, ax * ray[0] + ay * ray[1] + ray[2]
    bb = ray[0] * ray[0] + ray[1] * ray[1] + ray[2] * ray[2]
    ao = ax * origin[0] + ay * origin[1] + origin[2]
    bo = ray[0] * origin[0] + ray[1] * origin[1] + ray[2] * origin[2]
    det = aa * bb - ab * ab
    if not det > 1e-9 * aa * bb:
        return math.nan
    s = (ao * bb - bo * ab) / det
    t = (ao * ab - bo * aa) / det
    if not (s > 0.0 and t > 0.0):
        return math.inf if s <= 0.0 or t <= 0.0 else math.nan
    x = s * ax - origin[0] - t * ray[0]
    y = s * ay - origin[1] - t * ray[1]
    z = s - origin[2] - t * ray[2]
    return math.sqrt(x * x + y * y + z * z)
