"""Which directions the limbs of a body usually take, and what that says of ends nobody sees."""

import math
from typing import NamedTuple

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.compiler import inner
from trecsim.fusion.tuning import UNSEEN_LIMB_S


class Postures(NamedTuple):
    """Which directions the limbs of a body take.

    Attributes
    ----------
    trunk
        Left and right hip, left and right shoulder; empty where the skeleton lacks one.
    joints
        Of each limb, from the trunk on: its far joint, its near one, and the one before that.
    pair
        The joints of `trunk` whose line tells left from right for the limb: 0 hips, 2 shoulders.
    side
        1 on the left of the body, -1 on the right.
    mean, mean_by_upper
        Direction that is likeliest, times how much likelier it is, for a given direction of the
        limb above: ``mean + mean_by_upper @ upper``. Axes are forwards, outwards and up, of the
        trunk.
    """

    trunk: Int64[np.ndarray, " joint_of_trunk"]
    joints: Int64[np.ndarray, "limb 3"]
    pair: Int64[np.ndarray, " limb"]
    side: Float64[np.ndarray, " limb"]
    mean: Float64[np.ndarray, "limb 3"]
    mean_by_upper: Float64[np.ndarray, "limb 3 3"]


@inner
def body_axes(x, postures, i, axes):
    """Write the axes of the trunk for limb `i` to `axes` (3, 3): forwards, outwards and up."""
    trunk, pair = postures.trunk, postures.pair[i]
    left, right = trunk[pair], trunk[pair + 1]
    for p in range(3):
        axes[2, p] = x[trunk[2], p] + x[trunk[3], p] - x[trunk[0], p] - x[trunk[1], p]
        axes[1, p] = x[left, p] - x[right, p]
    unit(axes[2])
    across = dot(axes[1], axes[2])
    for p in range(3):
        axes[1, p] -= across * axes[2, p]
    unit(axes[1])
    for p in range(3):
        q, r = (p + 1) % 3, (p + 2) % 3
        axes[0, p] = axes[1, q] * axes[2, r] - axes[1, r] * axes[2, q]
    for p in range(3):
        axes[1, p] *= postures.side[i]


@inner
def usual_direction(x, postures, i, axes, mean):
    """Write the likeliest direction of limb `i` to `mean` (3,), times how much likelier it is.

    Parameters
    ----------
    x, postures
        A person's joints, (joint, 3) [m], and `Postures`.
    axes
        Scratch, (3, 3): the axes of the trunk.
    mean
        Result: the mean of the von Mises-Fisher distribution times its concentration, in the world.
    """
    _, near, before = postures.joints[i]
    body_axes(x, postures, i, axes)
    upper_m = 0.0
    for p in range(3):
        mean[p] = 0.0
        upper_m += (x[near, p] - x[before, p]) ** 2
    upper_m = max(math.sqrt(upper_m), 1e-6)
    for a in range(3):
        along = postures.mean[i, a]
        for b in range(3):
            for p in range(3):
                upper = axes[b, p] * (x[near, p] - x[before, p]) / upper_m
                along += postures.mean_by_upper[i, a, b] * upper
        for p in range(3):
            mean[p] += along * axes[a, p]


@inner(allocates=True)
def add_directions(A, b, shifts, postures, unseen_s):
    """Add "limbs point where they usually do" to ``A d = b``, for ends that no camera sees.

    Parameters
    ----------
    A, b
        Changed in place, see `gather`.
    shifts, postures
        `Shifts` and `Postures` of the person.
    unseen_s
        For how long no camera has supported each joint, (joint,) [s].

    Notes
    -----
    About its mean the von Mises-Fisher distribution is a normal one of the limb's end, of the
    variance ``L^2 / kappa`` for the length L and the concentration kappa. Detectors miss joints for
    an image or two: only after `UNSEEN_LIMB_S` it begins to count, and fully after twice that. The
    near joint draws the end along, never the end the near joint: where nobody has looked for a
    while tells nothing of what is seen.
    """
    if postures.trunk.shape[0] == 0:
        return
    x, shift_m, unknown_of = shifts.x_m, shifts.shift_m, shifts.unknown_of
    axes, mean = np.empty((3, 3)), np.empty(3)
    for i in range(postures.joints.shape[0]):
        far, near, _ = postures.joints[i]
        end = unknown_of[far]
        share = min(unseen_s[far] / UNSEEN_LIMB_S - 1.0, 1.0)
        if end < 0 or not share > 0.0:
            continue
        usual_direction(x, postures, i, axes, mean)
        kappa, length_m = math.sqrt(dot(mean, mean)), 0.0
        for p in range(3):
            length_m += (x[far, p] - x[near, p]) ** 2
        length_m = max(math.sqrt(length_m), 1e-3)
        info = share * kappa / (length_m * length_m)
        for p in range(3):
            way_m = length_m * mean[p] / kappa - (x[far, p] - x[near, p]) + shift_m[near, p]
            A[end + p, end + p] += info
            b[end + p] += info * way_m


@inner
def unit(v):
    """Scale a vector (3,) to length one, in place."""
    length = max(math.sqrt(dot(v, v)), 1e-9)
    for p in range(3):
        v[p] /= length


@inner
def dot(v, w):
    """Return the inner product of two vectors (3,)."""
    return v[0] * w[0] + v[1] * w[1] + v[2] * w[2]
