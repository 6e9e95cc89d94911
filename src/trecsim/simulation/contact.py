"""Bodies on the floor: nothing may sink into it."""

from dataclasses import replace

import numpy as np
from jaxtyping import Float64

from trecsim.simulation.body import Body
from trecsim.simulation.paths import STEP_S, smooth
from trecsim.simulation.pose import Pose, joints

# How high each joint is over the floor at least: there is flesh around it.
LEAST_M = np.array([0.02] * 5 + [0.05] * 2 + [0.035] * 2 + [0.03] * 2 + [0.06] * 2 + [0.05] * 2)
# Knees come up by less than the hips when these are lifted and the feet stay.
GAIN = np.array([1.0] * 13 + [2.0] * 2)
SOON_S = 0.06  # a body is lifted so long before and after it would touch
ROUNDS = 3


def off_the_floor(pose: Pose, body: Body) -> Pose:
    """Return a pose lifted by as little as keeps every joint above the floor, smooth over time.

    Parameters
    ----------
    pose
        One entry per `STEP_S`. Ankles stay where they are.
    body
        Limb lengths.
    """
    for _ in range(ROUNDS):
        height_m = joints(pose, body)[:, :15, 2]
        missing_m = ((LEAST_M - height_m) * GAIN).max(axis=1)
        if missing_m.max() <= 1e-4:
            return pose
        root_m = pose.root_m.copy()
        root_m[:, 2] += _soft(np.maximum(missing_m, 0.0))
        pose = replace(pose, root_m=root_m)
    return pose


def _soft(missing_m: Float64[np.ndarray, " time"]) -> Float64[np.ndarray, " time"]:
    """Return a smooth lift that is at least what is missing."""
    if len(missing_m) < 3:
        return missing_m
    window = round(SOON_S / STEP_S)
    padded = np.pad(missing_m, window, mode="edge")
    most_m = np.lib.stride_tricks.sliding_window_view(padded, 2 * window + 1).max(axis=1)
    return smooth(most_m, SOON_S / 4)
