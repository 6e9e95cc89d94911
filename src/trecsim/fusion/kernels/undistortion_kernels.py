"""Key points as the ideal pinhole camera would see them; the twin is `Camera.undistort`.

The inner functions take and return numbers instead of arrays, as those of the mixture do.
"""

import math
from typing import NamedTuple

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.compiler import inner
from trecsim.geometry.distortion import NEWTON_STEPS, TOLERANCE

IDEAL, BROWN, FISHEYE = 0, 1, 2
# What is further from its image than this has not been found.
MISSED = 1e3 * TOLERANCE


class Undistortion(NamedTuple):
    """What inverts the lenses of all cameras.

    Attributes
    ----------
    model
        `IDEAL`, `BROWN` or `FISHEYE`.
    pinhole
        The entries ``fx, skew, cx, fy, cy`` of K [px].
    coefficient
        ``k1 k2 p1 p2 k3 k4 k5 k6`` or ``k1 k2 k3 k4``; zeros after them.
    limit
        Brown: the largest radius of ideal and of distorted points. Fisheye: the largest angle.
    table
        Increasing distorted radii or angles, and the ideal ones that belong to them.
    """

    model: Int64[np.ndarray, " cam"]
    pinhole: Float64[np.ndarray, "cam 5"]
    coefficient: Float64[np.ndarray, "cam 8"]
    limit: Float64[np.ndarray, "cam 2"]
    table: Float64[np.ndarray, "cam 2 start"]


@inner
def look_up(table, bent):
    """Return the ideal radius or angle of a distorted one, by linear interpolation."""
    low, high = 0, table.shape[1] - 1
    if not bent < table[0, high]:
        return table[1, high]
    while high - low > 1:
        middle = (low + high) // 2
        if table[0, middle] <= bent:
            low = middle
        else:
            high = middle
    slope = (table[1, high] - table[1, low]) / (table[0, high] - table[0, low])
    return slope * (bent - table[0, low]) + table[1, low]


@inner
def invert_brown(k, limit, table, x_d, y_d):
    """Return the ideal point that a lens of Brown's model images at ``x_d, y_d``, or NaN.

    `k`, `limit` and `table` are the camera's rows of `Undistortion`.
    """
    radius = math.sqrt(x_d * x_d + y_d * y_d)
    if not radius <= limit[1]:
        return math.nan, math.nan
    start = look_up(table, radius) / radius if radius > 0.0 else 1.0
    x, y, s, off = x_d * start, y_d * start, 0.0, 0.0
    k1, k2, p1, p2, k3, k4, k5, k6 = k[0], k[1], k[2], k[3], k[4], k[5], k[6], k[7]
    for _ in range(NEWTON_STEPS):
        s = x * x + y * y
        high = 1.0 / (1.0 + s * (k4 + s * (k5 + s * k6)))
        factor = (1.0 + s * (k1 + s * (k2 + s * k3))) * high
        slope = k1 + s * (2.0 * k2 + s * 3.0 * k3)
        slope = (slope - factor * (k4 + s * (2.0 * k5 + s * 3.0 * k6))) * high
        spread = factor + 2.0 * (p1 * y + p2 * x)
        dx, dy = x_d - x * spread - p2 * s, y_d - y * spread - p1 * s
        off = abs(dx) + abs(dy)
        if off <= TOLERANCE * (1.0 + s):
            break
        xx = spread + 2.0 * x * (x * slope + 2.0 * p2)
        xy = 2.0 * (x * y * slope + p1 * x + p2 * y)
        yy = spread + 2.0 * y * (y * slope + 2.0 * p1)
        by_det = 1.0 / (xx * yy - xy * xy)
        x, y = x + (yy * dx - xy * dy) * by_det, y + (xx * dy - xy * dx) * by_det
    if off <= MISSED * (1.0 + s) and s <= limit[0] * limit[0]:
        return x, y
    return math.nan, math.nan


@inner
def invert_fisheye(k, limit, table, x_d, y_d):
    """Return the ideal point that a fisheye lens images at ``x_d, y_d``, or NaN."""
    bent = math.sqrt(x_d * x_d + y_d * y_d)
    angle = look_up(table, bent)
    for _ in range(NEWTON_STEPS):
        q = angle * angle
        reached = angle * (1.0 + q * (k[0] + q * (k[1] + q * (k[2] + q * k[3]))))
        growth = 1.0 + q * (3.0 * k[0] + q * (5.0 * k[1] + q * (7.0 * k[2] + q * 9.0 * k[3])))
        step = (bent - reached) / growth
        angle = min(max(angle + step, 0.0), limit[0])
        if not abs(step) > TOLERANCE:
            break
    q = angle * angle
    reached = angle * (1.0 + q * (k[0] + q * (k[1] + q * (k[2] + q * k[3]))))
    if not abs(reached - bent) <= MISSED:
        return math.nan, math.nan
    scale = math.tan(angle) / bent if bent > 0.0 else 1.0
    return x_d * scale, y_d * scale


@inner
def undistort(lenses, cam, xy_px):
    """Turn raw pixels into those that the ideal pinhole camera of the same K would see, in place.

    Parameters
    ----------
    lenses
        The `Undistortion` of all cameras.
    cam
        The one that took the image.
    xy_px
        Key points (person, joint, 2); they become NaN where the lens has no inverse [px].
    """
    model = lenses.model[cam]
    if model == IDEAL:
        return
    K = lenses.pinhole[cam]
    fx, skew, cx, fy, cy = K[0], K[1], K[2], K[3], K[4]
    k, limit, table = lenses.coefficient[cam], lenses.limit[cam], lenses.table[cam]
    for d in range(xy_px.shape[0]):
        for j in range(xy_px.shape[1]):
            y = (xy_px[d, j, 1] - cy) / fy
            x = (xy_px[d, j, 0] - cx - skew * y) / fx
            if model == BROWN:
                x, y = invert_brown(k, limit, table, x, y)
            else:
                x, y = invert_fisheye(k, limit, table, x, y)
            xy_px[d, j, 0], xy_px[d, j, 1] = fx * x + skew * y + cx, fy * y + cy
