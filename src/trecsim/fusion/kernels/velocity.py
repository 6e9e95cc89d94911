"""Velocities of the trajectories: the splines' derivative, and its covariance."""

import numpy as np

from trecsim.compiler import inner, kernel
from trecsim.fusion.kernels.curve import BLOCK, ORDER, derivative, locate, point
from trecsim.fusion.kernels.information import curve_covariance


@inner(allocates=True)
def velocity_all(R, c, knot_time, knot_s, velocity_mps, cov_m2ps2):
    """Write the velocities of all joints of all tracks at one time, and their covariances.

    Parameters
    ----------
    R, c
        Square-root information and control points, (track, joint, n, n) and (track, joint, n).
    knot_time, knot_s
        Time in knots since the oldest live one, and distance between knots [s].
    velocity_mps, cov_m2ps2
        Results, (track, joint, 3) [m/s] and (track, joint, 3, 3) [m^2/s^2].

    Notes
    -----
    The derivative is linear in the control points, as the position is: only the four basis weights
    differ, so position and velocity share `point` and `curve_covariance`.
    """
    y = np.empty((R.shape[2], BLOCK))
    weights = np.empty(ORDER)
    span = derivative(knot_time, R.shape[2] // BLOCK, knot_s, weights)
    for k in range(R.shape[0]):
        for j in range(R.shape[1]):
            point(c[k, j], span, weights, velocity_mps[k, j])
            curve_covariance(R[k, j], span, weights, y, cov_m2ps2[k, j])


@kernel(allocates=True)
def torso_motion(c, torso, knot_time, knot_s, motion):
    """Write the mean place and velocity of one person's torso at one time.

    Parameters
    ----------
    c, torso
        Control points of the person, (joint, n), and the joints of the torso.
    knot_time, knot_s
        As for `velocity_all`.
    motion
        Result, (2, 3): place [m] and velocity [m/s].
    """
    weights, x = np.empty(ORDER), np.empty(3)
    for row in range(2):
        if row:
            span = derivative(knot_time, c.shape[1] // BLOCK, knot_s, weights)
        else:
            span = locate(knot_time, c.shape[1] // BLOCK, weights)
        for a in range(3):
            motion[row, a] = 0.0
        for j in torso:
            point(c[j], span, weights, x)
            for a in range(3):
                motion[row, a] += x[a] / torso.shape[0]
