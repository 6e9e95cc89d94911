"""Annotation bias: joint positions that all cameras estimate wrongly in the same way.

An estimator learns where annotators mark joints, and annotations differ between data sets; hips,
for one, are marked at different heights. This bias is fixed to the body, changes slowly and is
common to all cameras, so no tracker can distinguish it from the truth.
"""

import numpy as np
from jaxtyping import Float64

from trecsim.lab.simulation.body_shape import JOINTS
from trecsim.lab.simulation.noise import ornstein_uhlenbeck
from trecsim.lab.simulation.rotations import unit

STEP_S = 0.08  # coarse on purpose: the bias adds no jitter
FAST, FAST_S, SLOW_S = 0.7, 0.3, 8.0  # share of the variance that changes quickly; memories

Joints = Float64[np.ndarray, "time person 17 3"]


def with_annotation_bias(
    t_s: Float64[np.ndarray, " time"],
    xyz_m: Joints,
    up_m: tuple[float, ...],
    spread_m: tuple[float, ...],
    rng: np.random.Generator,
) -> Joints:
    """Return the joints with the bias of the estimator added.

    Parameters
    ----------
    t_s
        Times; before 0 nothing changes [s].
    xyz_m
        Joints of all people, NaN while absent [m].
    up_m
        Mean bias of each joint, from the hips towards the shoulders [m].
    spread_m
        Standard deviation about that mean, over people and time, per axis and joint [m].
    rng
        Random numbers. The same generator gives the same bias at a time, whatever the other times
        are, so that cameras agree.
    """
    offset_m = np.array(spread_m)[:, None] * _wandering(t_s, xyz_m.shape[1], rng)
    offset_m[..., 2] += np.array(up_m)
    biased_m: Joints = xyz_m + np.einsum("tpia,tpja->tpji", _body_axes(xyz_m), offset_m)
    return biased_m


def _wandering(t_s: Float64[np.ndarray, " time"], people: int, rng: np.random.Generator) -> Joints:
    """Return unit processes, made on a grid from 0 and interpolated linearly."""
    grid_s = np.arange(int(np.ceil(t_s.max(initial=0.0) / STEP_S)) + 2) * STEP_S
    of_fast, of_slow = rng.spawn(2)
    fast = ornstein_uhlenbeck(of_fast, grid_s, FAST_S, people, JOINTS, 3)
    slow = ornstein_uhlenbeck(of_slow, grid_s, SLOW_S, people, JOINTS, 3)
    grid = np.sqrt(FAST) * fast + np.sqrt(1.0 - FAST) * slow
    step = np.maximum(t_s, 0.0) / STEP_S
    before = np.floor(step).astype(np.intp)
    share = (step - before)[:, None, None, None]
    at: Joints = (1.0 - share) * grid[before] + share * grid[before + 1]
    return at


def _body_axes(xyz_m: Joints) -> Float64[np.ndarray, "time person 3 axis"]:
    """Return the forward, left and up axes of each trunk, as columns."""
    up = unit(xyz_m[..., 5:7, :].mean(axis=-2) - xyz_m[..., 11:13, :].mean(axis=-2))
    forward = unit(np.cross(xyz_m[..., 11, :] - xyz_m[..., 12, :], up))
    return np.stack((forward, np.cross(up, forward), up), axis=-1)
