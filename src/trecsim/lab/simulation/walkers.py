"""People who walk and run: all 17 joints from a path over the floor, at any time."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float64

from trecsim.lab.simulation.body_shape import JOINTS, Body
from trecsim.lab.simulation.paths import STEP_S, FloorPath, smooth
from trecsim.lab.simulation.rotations import forward_left

STANCE = 0.55  # share of a stride in stance
MID_STANCE = 0.26  # phase at which the body passes over the foot
RUNNING_STANCE = 0.36  # less than a half: between two steps both feet are in the air
RUNNING_MID_STANCE = 0.17
RUNNING_LIFT = 0.16  # heels go up behind, as a share of the stature
WALKING_MPS, RUNNING_MPS = 2.0, 2.4  # walked below, run above
BOUNCE_M = 0.02  # vertical motion of a runner's pelvis
HEEL_OFF = 0.76  # share of the stance after which the heel comes up
STRIDE = 0.64  # stride length at 1 m/s as a share of the stature
LIFT = 0.055  # height of the swinging ankle as a share of the stature
STRETCH = 0.988  # largest stretch of a leg
TURN_STEP_RAD = 1.4  # angle per stride when turning on the spot
FASTEST_TURN_HZ = 1.0
DIP_S = 0.08  # time by which the pelvis drops before a leg is stretched

Xyz = Float64[np.ndarray, "time 3"]
Scalar = Float64[np.ndarray, " time"]


@runtime_checkable
class Motion(Protocol):
    """Motion of one person: joints as a function of time."""

    def __call__(self, t_s: Scalar) -> Float64[np.ndarray, "time 17 3"]:
        """Return the COCO-17 joints [m] at the times `t_s`; NaN while the person is absent."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class Walker:
    """A person who walks along a path; made by :func:`walker`.

    Attributes
    ----------
    body
        Limb lengths.
    path
        Path of the pelvis.
    phase
        Cumulative number of strides, one entry per time of the path.
    vigour
        Vigour of the walk, from 0 (standing) to 1.2 (brisk), per time of the path.
    running
        0 for a walk to 1 for a run, per time of the path.
    pelvis_m
        Height of the hips over the floor, per time of the path [m].
    style
        Phase of this person's small idle motions.
    """

    body: Body
    path: FloorPath
    phase: Float64[np.ndarray, " step"]
    vigour: Float64[np.ndarray, " step"]
    running: Float64[np.ndarray, " step"]
    pelvis_m: Float64[np.ndarray, " step"]
    style: float = 0.0

    def __call__(self, t_s: Scalar) -> Float64[np.ndarray, "time 17 3"]:
        """Return the COCO-17 joints [m] at the times `t_s`; NaN while the person is absent."""
        xyz_m = np.full((len(t_s), JOINTS, 3), np.nan)
        here = (t_s >= self.path.enter_s) & (t_s <= self.path.leave_s)
        xyz_m[here] = _joints(self, t_s[here])
        return xyz_m


def walker(body: Body, path: FloorPath, style: float = 0.0) -> Walker:
    """Return a person with this body who walks along this path.

    Notes
    -----
    The feet come first: each is planted where the body will pass over it and stays there for more
    than half a stride, so feet do not skate. The hips are then as high as the legs allow, and the
    knees follow from the lengths of thigh and shin.
    """
    return stepping(body, path, np.cumsum(cadence_hz(body, path)) * STEP_S, style)


def cadence_hz(body: Body, path: FloorPath) -> Float64[np.ndarray, " step"]:
    """Return the strides per second along a path, turning included."""
    speed_mps = path.speed_mps
    # Stride length grows with the root of the speed, so the cadence does too.
    cadence = np.sqrt(speed_mps) / (STRIDE * body.stature_m)
    cadence = np.where(speed_mps > 0.02, cadence, cadence * speed_mps / 0.02)
    turning = np.minimum(_turning_radps(path) / TURN_STEP_RAD, FASTEST_TURN_HZ)
    total: Float64[np.ndarray, " step"] = cadence + _on_the_spot(path) * turning
    return total


def stepping(
    body: Body,
    path: FloorPath,
    phase: Float64[np.ndarray, " step"],
    style: float,
    treading: Float64[np.ndarray, " step"] | float = 0.0,
) -> Walker:
    """Return a person who follows a path with strides at given times.

    `treading` is the least vigour, for steps without speed or turn.
    """
    turning = np.minimum(0.2 * _on_the_spot(path) * _turning_radps(path), 0.3)
    speed_mps = path.speed_mps
    vigour = np.maximum(np.clip(speed_mps / 1.25 + turning, 0.0, 1.2), treading)
    running = np.clip((speed_mps - WALKING_MPS) / (RUNNING_MPS - WALKING_MPS), 0.0, 1.0)
    vigour, running = smooth(vigour, 0.1), smooth(running, 0.15)
    person = Walker(body, path, phase, vigour, running, np.zeros(len(vigour)), style)
    return replace(person, pelvis_m=_pelvis_height(person))


def _turning_radps(path: FloorPath) -> Float64[np.ndarray, " step"]:
    turning: Float64[np.ndarray, " step"] = np.abs(np.gradient(path.heading_rad, STEP_S))
    return turning


def _on_the_spot(path: FloorPath) -> Float64[np.ndarray, " step"]:
    """Return 1 while standing, 0 while walking."""
    spot: Float64[np.ndarray, " step"] = np.clip(1.0 - path.speed_mps / 0.3, 0.0, 1.0)
    return spot


def _pelvis_height(person: Walker) -> Float64[np.ndarray, " step"]:
    """Return the largest height of the hips with both ankles in reach, smoothed [m]."""
    body, t_s = person.body, person.path.t_s
    reach_m = STRETCH * body.leg_m
    hips_m = _hips(person, t_s)
    highest_m = np.full(len(t_s), body.ankle_m + reach_m)
    for hip_m, ankle_m in zip(hips_m, _ankles(person, t_s), strict=True):
        flat_m = np.linalg.norm(hip_m[:, :2] - ankle_m[:, :2], axis=1)
        free_m = np.sqrt(np.maximum(reach_m**2 - flat_m**2, (0.7 * reach_m) ** 2))
        highest_m = np.minimum(highest_m, ankle_m[:, 2] + free_m)
    window = round(DIP_S / STEP_S)
    padded = np.pad(highest_m, window, mode="edge")
    lowest_m = np.lib.stride_tricks.sliding_window_view(padded, 2 * window + 1).min(axis=1)
    # Highest while both feet are in the air, half way between two steps.
    flight = np.cos(4 * np.pi * (person.phase - RUNNING_STANCE / 2 - 0.25))
    runs = smooth(person.running, 0.25)  # from a walk to a run in a step or two
    exact_m, even_m = smooth(lowest_m, DIP_S / 4), smooth(lowest_m, DIP_S)
    bounce_m = BOUNCE_M * (flight - 1.2)
    pelvis_m: Float64[np.ndarray, " step"] = exact_m + runs * (even_m - exact_m + bounce_m)
    return pelvis_m


def _joints(person: Walker, t_s: Scalar) -> Float64[np.ndarray, "time 17 3"]:
    """Return all joints at times when the person is present [m]."""
    xyz_m = np.empty((len(t_s), JOINTS, 3))
    hips_m = _hips(person, t_s)
    for side, (hip_m, ankle_m) in enumerate(zip(hips_m, _ankles(person, t_s), strict=True)):
        knee_m, ankle_m = _leg(person, t_s, hip_m, ankle_m)
        xyz_m[:, 11 + side], xyz_m[:, 13 + side], xyz_m[:, 15 + side] = hip_m, knee_m, ankle_m
    _put_upper_body(person, t_s, (hips_m[0] + hips_m[1]) / 2, xyz_m)
    return xyz_m


def _at(person: Walker, values: Float64[np.ndarray, " step"], t_s: Scalar) -> Scalar:
    value: Scalar = np.interp(t_s, person.path.t_s, values)
    return value


def _place(person: Walker, t_s: Scalar) -> Xyz:
    """Return where the path is, at floor level [m]."""
    x, y = (_at(person, column, t_s) for column in person.path.xy_m.T)
    return np.stack((x, y, np.zeros_like(x)), axis=1)


def _hips(person: Walker, t_s: Scalar) -> tuple[Xyz, Xyz]:
    """Return the left and right hip [m]: the pelvis turns with the legs and sways a little."""
    stride = 2 * np.pi * _at(person, person.phase, t_s)
    vigour = _at(person, person.vigour, t_s)
    facing = _at(person, person.path.heading_rad, t_s)
    _, left = forward_left(facing - 0.12 * vigour * np.cos(stride))
    _, aside = forward_left(facing)
    sway_m = 0.015 * vigour * np.sin(stride) + 0.008 * np.sin(0.7 * t_s + person.style)
    middle_m = _place(person, t_s) + sway_m[:, None] * aside
    middle_m[:, 2] = _at(person, person.pelvis_m, t_s)
    half_m = person.body.hips_m / 2 * left
    return middle_m + half_m, middle_m - half_m


def _ankles(person: Walker, t_s: Scalar) -> tuple[Xyz, Xyz]:
    """Return the left and right ankle [m]."""
    phase = _at(person, person.phase, t_s)
    vigour = _at(person, person.vigour, t_s)
    left, right = (_ankle(person, phase, vigour, side) for side in (0, 1))
    return left, right


def _ankle(person: Walker, phase: Scalar, vigour: Scalar, side: int) -> Xyz:
    """Return an ankle: planted during stance, then swinging to the next plant [m]."""
    offset = 0.5 * side
    stride = np.floor(phase + offset)
    share = phase + offset - stride
    runs, will_run = (_running_from(person, stride + k - offset) for k in (0, 1))
    stance = STANCE + (RUNNING_STANCE - STANCE) * runs
    swing = np.clip((share - stance) / (1 - stance), 0.0, 1.0)
    swing = swing**2 * (3 - 2 * swing)  # starts and ends at rest
    mid, next_mid = (MID_STANCE + (RUNNING_MID_STANCE - MID_STANCE) * r for r in (runs, will_run))
    here_m = _plant(person, stride + mid - offset, side)
    next_m = _plant(person, stride + 1 + next_mid - offset, side)
    ankle_m: Xyz = here_m + swing[:, None] * (next_m - here_m)
    lifted = np.clip((share - HEEL_OFF * stance) / (1 - HEEL_OFF * stance), 0.0, 1.0)
    lift_m = (LIFT + (RUNNING_LIFT - LIFT) * runs) * person.body.stature_m
    lift_m *= np.sin(np.pi * lifted) ** 2 * np.clip(vigour / 0.3, 0.0, 1.0)
    ankle_m[:, 2] = person.body.ankle_m + lift_m
    return ankle_m


def _running_from(person: Walker, phase: Scalar) -> Scalar:
    """Return the share of running of the strides that begin at `phase`."""
    runs: Scalar = np.interp(phase, person.phase, person.running)
    return runs


def _plant(person: Walker, phase: Scalar, side: int) -> Xyz:
    """Return the plant of a foot over which the body passes at `phase` [m]."""
    grid_s = person.path.t_s
    t_s = np.interp(phase, person.phase, grid_s, left=grid_s[0], right=grid_s[-1])
    _, left = forward_left(_at(person, person.path.heading_rad, t_s))
    aside_m = 0.4 * person.body.hips_m * (1 - 2 * side)
    plant_m: Xyz = _place(person, t_s) + aside_m * left
    return plant_m


def _leg(person: Walker, t_s: Scalar, hip_m: Xyz, ankle_m: Xyz) -> tuple[Xyz, Xyz]:
    """Return knee and ankle for the exact lengths of thigh and shin, knee to the front [m]."""
    body = person.body
    leg_m = ankle_m - hip_m
    length_m = np.linalg.norm(leg_m, axis=1, keepdims=True)
    down = leg_m / length_m
    length_m = np.minimum(length_m, 0.9995 * body.leg_m)
    along_m = (body.thigh_m**2 - body.shin_m**2 + length_m**2) / (2 * length_m)
    forward, _ = forward_left(_at(person, person.path.heading_rad, t_s))
    forward = forward - (forward * down).sum(axis=1, keepdims=True) * down
    forward /= np.linalg.norm(forward, axis=1, keepdims=True)
    bend_m = np.sqrt(np.maximum(body.thigh_m**2 - along_m**2, 0.0))
    return hip_m + along_m * down + bend_m * forward, hip_m + length_m * down


def _put_upper_body(
    person: Walker, t_s: Scalar, pelvis_m: Xyz, xyz_m: Float64[np.ndarray, "time 17 3"]
) -> None:
    """Fill in shoulders, arms and head: the trunk leans, shoulders turn against the hips."""
    body, style = person.body, person.style
    stride = 2 * np.pi * _at(person, person.phase, t_s)
    vigour = _at(person, person.vigour, t_s)
    facing = _at(person, person.path.heading_rad, t_s)
    forward, left = forward_left(facing + 0.08 * vigour * np.cos(stride))
    runs = _at(person, person.running, t_s)
    lean = (0.03 + 0.06 * vigour + 0.08 * runs + 0.02 * np.sin(0.5 * t_s + style))[:, None]
    up = np.sin(lean) * forward + np.cos(lean) * np.array([0.0, 0.0, 1.0])
    chest_m = pelvis_m + body.trunk_m * up
    ahead = np.cos(lean) * forward - np.sin(lean) * np.array([0.0, 0.0, 1.0])
    for side, sign in ((0, 1.0), (1, -1.0)):
        shoulder_m = chest_m + sign * body.shoulders_m / 2 * left
        swing = -sign * 0.45 * vigour * np.cos(stride) + 0.05 * np.sin(0.9 * t_s + style + sign)
        bend = 0.25 + 0.25 * vigour + 0.3 * vigour * np.maximum(0.0, np.sin(swing)) + 0.9 * runs
        upper = _arm_direction(swing, ahead, up, sign * left)
        fore = _arm_direction(swing + bend, ahead, up, 0.3 * sign * left)
        elbow_m = shoulder_m + body.upper_arm_m * upper
        xyz_m[:, 5 + side], xyz_m[:, 7 + side] = shoulder_m, elbow_m
        xyz_m[:, 9 + side] = elbow_m + body.forearm_m * fore
    look = facing + 0.35 * np.sin(0.6 * t_s + 2 * style)
    xyz_m[:, :5] = chest_m[:, None] + _head(body, look)


def _arm_direction(swing: Scalar, ahead: Xyz, up: Xyz, out: Xyz) -> Xyz:
    """Return the direction of an arm that hangs, swung forward by an angle and a little out."""
    arm = np.sin(swing)[:, None] * ahead - np.cos(swing)[:, None] * up + 0.15 * out
    direction: Xyz = arm / np.linalg.norm(arm, axis=1, keepdims=True)
    return direction


def _head(body: Body, look_rad: Scalar) -> Float64[np.ndarray, "time 5 3"]:
    """Return nose, eyes and ears from the middle of the shoulders [m]."""
    forward, left = forward_left(look_rad)
    up = np.broadcast_to([0.0, 0.0, 1.0], forward.shape)
    head_m: Float64[np.ndarray, "time 5 3"] = np.einsum(
        "ja,atx->tjx", body.head_m, np.stack((forward, left, up))
    )
    return head_m


def poses(motions: Sequence[Motion], t_s: Scalar) -> Float64[np.ndarray, "person time 17 3"]:
    """Return the joints of all people at given times [m]; NaN while absent."""
    if not motions:
        return np.empty((0, len(t_s), JOINTS, 3))
    return np.stack([motion(t_s) for motion in motions])
