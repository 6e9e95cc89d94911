"""What the adjustment sees, estimates and keeps: arrays as the kernels take them."""

from typing import NamedTuple

import numpy as np


class Sights(NamedTuple):
    """What was seen: arrays of observations in the order of series, points and cameras.

    A series is one joint of one person over time; it has points and blocks of time.

    Attributes
    ----------
    point_first, block_first
        Of each series its first point and block; one more entry than series.
    noise_m2, bias_m2, level_m2
        Variances of each series: fast noise, slow bias, change of the joint's height.
    gap_s
        Of each block the time since the one before.
    block, first
        Of each point its block and its first observation (one more entry than points).
    cam, z, speed, ahead_s
        Of each observation the camera, the place in its plane z = 1, its speed there, and the stamp
        since the camera's reference stamp.
    focal_px
        Of each camera.
    """

    point_first: np.ndarray
    block_first: np.ndarray
    noise_m2: np.ndarray
    bias_m2: np.ndarray
    level_m2: np.ndarray
    gap_s: np.ndarray
    block: np.ndarray
    first: np.ndarray
    cam: np.ndarray
    z: np.ndarray
    speed: np.ndarray
    ahead_s: np.ndarray
    focal_px: np.ndarray


class Unknowns(NamedTuple):
    """What is estimated.

    Attributes
    ----------
    T
        Poses of the cameras, from the world.
    clock, lens
        Change of the clocks since the observations were sampled, and of the lenses.
    xyz_m, level_m
        Places of all points, and height of each series.
    bias_m
        Of each block and camera, along the camera's axes.
    """

    T: np.ndarray
    clock: np.ndarray
    lens: np.ndarray
    xyz_m: np.ndarray
    level_m: np.ndarray
    bias_m: np.ndarray


class Eliminated(NamedTuple):
    """What is kept of the elimination, to find the inner unknowns from the cameras'.

    Attributes
    ----------
    inverse, pull
        Of each point the inverse of its normal matrix, and its right-hand side.
    cross
        Of each observation the coupling of its point with bias and camera.
    factor, border, side
        Of each block the Cholesky factor, the coupling with cameras and height, solved, and the
        right-hand side, solved.
    along
        Of each block the coupling with the next one (a number on the diagonal), and solved.
    rise
        Of each series the normal number of its height, the couplings and the right-hand side.
    depth_m
        Of each observation the distance of the point from the camera's plane [m]; -1 behind it.
    draw
        Of each point the force on the logarithm of each depth that makes up for its height, which
        is measured in metres and would be less wrong were the scene smaller.
    """

    inverse: np.ndarray
    pull: np.ndarray
    cross: np.ndarray
    factor: np.ndarray
    border: np.ndarray
    side: np.ndarray
    along: np.ndarray
    rise: np.ndarray
    depth_m: np.ndarray
    draw: np.ndarray
