"""Contact with the floor: no joint may be below it."""

from dataclasses import replace

import numpy as np
from jaxtyping import Float64

from trecsim.lab.simulation.body_shape import Body
from trecsim.lab.simulation.paths import STEP_S, smooth
from trecsim.lab.simulation.pose import STRAIGHT, Joints, Pose, joints
from trecsim.lab.simulation.rotations import unit

WRIST_M = 0.03
SOFT_M = 0.006  # hands slow down within this height
# How high face, shoulders, elbows, wrists, hips and knees are at least: there is flesh around them.
LEAST_M = np.repeat([0.02, 0.05, 0.035, 0.0, 0.06, 0.05], [5, 2, 2, 2, 2, 2])
SOON_S = 0.06  # time before and after contact over which a body is lifted
ROUNDS = 5


def on_the_floor(pose: Pose, body: Body) -> Joints:
    """Return the joints of a body, lifted so that none is below the floor [m].

    The trunk is lifted by as little as is needed, smoothly over time; ankles stay where they are.
    Arms give way: hands that would go through the floor glide over it.
    """
    for _ in range(ROUNDS):
        xyz_m = _with_hands_up(joints(pose, body), body)
        missing_m = np.maximum(_missing(xyz_m), 0.0)
        if missing_m.max() <= 1e-4:
            break
        root_m = pose.root_m.copy()
        root_m[:, 2] += _soft(missing_m)
        pose = replace(pose, root_m=root_m)
    return _with_hands_up(joints(pose, body), body)


def _missing(xyz_m: Joints) -> Float64[np.ndarray, " time"]:
    """Return the least height by which the trunk must be lifted [m]."""
    missing_m = LEAST_M - xyz_m[:, :15, 2]
    # Knees are lifted by half as much as the hips because the feet stay.
    missing_m[:, 13:] *= 2
    most_m: Float64[np.ndarray, " time"] = missing_m.max(axis=1)
    return most_m


def _soft(missing_m: Float64[np.ndarray, " time"]) -> Float64[np.ndarray, " time"]:
    """Return a smooth lift of at least the required height."""
    window = round(SOON_S / STEP_S)
    padded = np.pad(missing_m, window, mode="edge")
    most_m = np.lib.stride_tricks.sliding_window_view(padded, 2 * window + 1).max(axis=1)
    return smooth(most_m, SOON_S / 4)


def _with_hands_up(xyz_m: Joints, body: Body) -> Joints:
    """Return joints with the hands brought above the floor [m].

    The elbow stays in the plane it was in.
    """
    a_m, b_m = body.upper_arm_m, body.forearm_m
    for side in (0, 1):
        low = xyz_m[:, 9 + side, 2] < WRIST_M + 8 * SOFT_M
        shoulder_m, elbow_m = xyz_m[low, 5 + side], xyz_m[low, 7 + side]
        way_m = xyz_m[low, 9 + side] - shoulder_m
        way_m[:, 2] += SOFT_M * np.log1p(np.exp((WRIST_M - xyz_m[low, 9 + side, 2]) / SOFT_M))
        wanted_m = np.linalg.norm(way_m, axis=1, keepdims=True)
        along = way_m / wanted_m
        length_m = np.clip(wanted_m, abs(a_m - b_m) + 0.02, STRAIGHT * (a_m + b_m))
        share_m = (a_m**2 - b_m**2 + length_m**2) / (2 * length_m)
        bend = elbow_m - shoulder_m
        bend = unit(bend - (bend * along).sum(axis=1, keepdims=True) * along)
        xyz_m[low, 7 + side] = shoulder_m + share_m * along + np.sqrt(a_m**2 - share_m**2) * bend
        xyz_m[low, 9 + side] = shoulder_m + length_m * along
    return xyz_m
