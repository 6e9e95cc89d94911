"""Trajectories in time: where they begin, and how control points are appended to them."""

import numpy as np

from trecsim.compiler import inner, kernel
from trecsim.fusion.kernels.curve import BLOCK
from trecsim.fusion.kernels.information import REACH, control_points, fold_row
from trecsim.fusion.kernels.small_matrices import clear_row
from trecsim.fusion.tuning import KEPT, KEPT_UNSEEN, UNSEEN_WEIGHT


@inner
def extend(R, z, c, stiffness, memory, drift_m, work):
    """Marginalise the oldest control point of one joint and append a new one, in place.

    Parameters
    ----------
    R, z, c
        Square-root information of the joint, (n, n) and (n,), and its solution (n,).
    stiffness
        Weight of the smoothing prior, ``1 / sqrt(q knot^3)`` [1/m] (thesis eq. 49-56, second
        differences of control points).
    memory
        How much of its own velocity the joint keeps over one knot, 0 to 1.
    drift_m
        How far the body moves in one knot, (3,) [m]; the rest of the velocity.
    work
        Scratch, (n,).

    Notes
    -----
    The new equations hold exactly for the extrapolated point, so the others' solution stays.
    """
    n = R.shape[0]
    for i in range(n - BLOCK):
        for k in range(i, min(n - BLOCK, (i // BLOCK) * BLOCK + REACH)):
            R[i, k] = R[i + BLOCK, k + BLOCK]
        z[i] = z[i + BLOCK]
        c[i] = c[i + BLOCK]
    for i in range(n):
        for k in range(n - BLOCK, n):
            R[i, k] = 0.0
            R[k, i] = 0.0
    for a in range(BLOCK):
        z[n - BLOCK + a] = 0.0
    for a in range(BLOCK):
        clear_row(work)
        work[n - 9 + a] = memory * stiffness
        work[n - 6 + a] = -(1.0 + memory) * stiffness
        work[n - 3 + a] = stiffness
        step_m = (1.0 - memory) * drift_m[a]
        fold_row(R, z, work, step_m * stiffness, n - 9)
        c[n - 3 + a] = (1.0 + memory) * c[n - 6 + a] - memory * c[n - 9 + a] + step_m


@inner
def start(R, z, xyz_m, position_sigma_m, step_sigma_m, stiffness, first, work):
    """Set up a joint that rests at `xyz_m`, with wide uncertainty, in place.

    `step_sigma_m` is the standard deviation of the way between two control points [m], from the
    control point `first` on. Those before it, which a lag needs, follow by their smoothness alone:
    so the present is as certain with a lag as without one.
    """
    n = R.shape[0]
    for i in range(n):
        z[i] = 0.0
        clear_row(R[i])
    for a in range(BLOCK):
        clear_row(work)
        work[BLOCK * first + a] = 1.0 / position_sigma_m
        fold_row(R, z, work, xyz_m[a] / position_sigma_m, BLOCK * first + a)
        clear_row(work)
        work[BLOCK * first + a] = -1.0 / step_sigma_m
        work[BLOCK * (first + 1) + a] = 1.0 / step_sigma_m
        fold_row(R, z, work, 0.0, BLOCK * first + a)
    for p in range(n // BLOCK - 2):
        for a in range(BLOCK):
            clear_row(work)
            work[BLOCK * p + a] = stiffness
            work[BLOCK * (p + 1) + a] = -2.0 * stiffness
            work[BLOCK * (p + 2) + a] = stiffness
            fold_row(R, z, work, 0.0, BLOCK * p + a)


@inner(allocates=True)
def extend_all(tracks, seen, torso, stiffness, own_memory, coasting_memory):
    """Move every track and joint on by one control point, in place.

    Parameters
    ----------
    tracks
        `Trajectories`, of which the joints' places at the frame set's time stay.
    seen
        How many cameras support each joint, (track, joint).
    torso
        The joints whose mean velocity is that of the body.
    stiffness
        Per joint; see `extend`.
    own_memory, coasting_memory
        How much of its own velocity a joint keeps over one knot, supported or not.
    """
    R, z, c = tracks.R, tracks.z, tracks.c
    work = np.empty(R.shape[2])
    drift_m = np.empty(BLOCK)
    for k in range(R.shape[0]):
        body_step(c[k], seen[k], torso, drift_m)
        for j in range(R.shape[1]):
            memory = own_memory if seen[k, j] > 0 else coasting_memory
            extend(R[k, j], z[k, j], c[k, j], stiffness[j], memory, drift_m, work)


@inner
def body_step(c, seen, torso, step_m):
    """Write how far the body moved between the two newest control points to `step_m` (3,)."""
    n = c.shape[1]
    total, most = 0.0, 0
    for a in range(BLOCK):
        step_m[a] = 0.0
    for j in torso:
        weight = 1.0 if seen[j] > 0 else UNSEEN_WEIGHT
        total += weight
        most = max(most, seen[j])
        for a in range(BLOCK):
            step_m[a] += weight * (c[j, n - 3 + a] - c[j, n - 6 + a])
    kept = 1.0 if most >= 2 else KEPT if most else KEPT_UNSEEN
    for a in range(BLOCK):
        step_m[a] *= kept / total


@kernel(allocates=True)
def start_all(R, z, c, xyz_m, position_sigma_m, step_sigma_m, stiffness, first):
    """Set up all joints of one new track, in place; see `start`."""
    work = np.empty(R.shape[1])
    for j in range(R.shape[0]):
        start(R[j], z[j], xyz_m[j], position_sigma_m[j], step_sigma_m, stiffness[j], first, work)
        control_points(R[j], z[j], c[j])
