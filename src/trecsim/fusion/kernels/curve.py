"""Points on the trajectories: uniform cubic B-splines over the live control points."""

import math

import numpy as np

from trecsim.compiler import inner

BLOCK = 3
ORDER = 4


@inner
def knots(t_s, now):
    """Return a time in knots since the oldest live control point; see `Now`."""
    return (t_s - now.origin_s) / now.knot_s - now.first


@inner
def locate(knot_time, live, weights):
    """Write the weights of the four control points active at `knot_time`; return the first of them.

    Parameters
    ----------
    knot_time
        Time in knots since the oldest live one; beyond the live part it is taken at its end.
    live
        Number of live control points.
    weights
        Result, (4,).

    Notes
    -----
    Uniform cubic B-spline basis (thesis eq. 38-41).
    """
    span = min(max(math.floor(knot_time), 0), live - ORDER)
    u = min(max(knot_time - span, 0.0), 1.0)
    v = 1.0 - u
    weights[0] = v * v * v / 6.0
    weights[1] = (3.0 * u * u * u - 6.0 * u * u + 4.0) / 6.0
    weights[2] = (3.0 * v * v * v - 6.0 * v * v + 4.0) / 6.0
    weights[3] = u * u * u / 6.0
    return span


@inner
def derivative(knot_time, live, knot_s, weights):
    """Write the weights of the control points in the curve's velocity; return the first of them.

    Parameters
    ----------
    knot_time, live
        As for `locate`.
    knot_s
        Distance between knots [s].
    weights
        Result, (4,) [1/s].
    """
    span = min(max(math.floor(knot_time), 0), live - ORDER)
    u = min(max(knot_time - span, 0.0), 1.0)
    v = 1.0 - u
    weights[0] = -v * v / 2.0 / knot_s
    weights[1] = (3.0 * u * u - 4.0 * u) / 2.0 / knot_s
    weights[2] = (4.0 * v - 3.0 * v * v) / 2.0 / knot_s
    weights[3] = u * u / 2.0 / knot_s
    return span


@inner
def point(c, span, weights, xyz_m):
    """Write one joint's place at ``span, weights`` to `xyz_m` (3,)."""
    for a in range(BLOCK):
        xyz_m[a] = (
            weights[0] * c[BLOCK * span + a]
            + weights[1] * c[BLOCK * span + 3 + a]
            + weights[2] * c[BLOCK * span + 6 + a]
            + weights[3] * c[BLOCK * span + 9 + a]
        )


@inner(allocates=True)
def evaluate_all(c, knot_time, xyz_m):
    """Write everybody's joints at several times to `xyz_m` (time, track, joint, 3).

    `c` are control points (track, joint, n), `knot_time` the times in knots (time,); see `locate`.
    """
    weights = np.empty(ORDER)
    for v in range(knot_time.shape[0]):
        span = locate(knot_time[v], c.shape[2] // BLOCK, weights)
        for k in range(c.shape[0]):
            for j in range(c.shape[1]):
                point(c[k, j], span, weights, xyz_m[v, k, j])
