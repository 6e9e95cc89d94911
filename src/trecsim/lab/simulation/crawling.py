"""Crawling: hands and knees are planted where the body will pass over them."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float64

from trecsim.lab.simulation.actions import Point
from trecsim.lab.simulation.body_shape import Body
from trecsim.lab.simulation.frame_times import even
from trecsim.lab.simulation.keyposes import ANKLE_M, FEET, KNEE_M, pitched
from trecsim.lab.simulation.locomotion import Segment, end_of, path_along, segments_along, stay
from trecsim.lab.simulation.on_foot import strides
from trecsim.lab.simulation.paths import STEP_S, FloorPath, interpolated, smooth
from trecsim.lab.simulation.pose import Pose, reaching
from trecsim.lab.simulation.rotations import Place, about, forward_left, unit

STRIDE = 0.29  # stride length as a share of the stature
STANCE = 0.62  # share of a stride during which a hand or knee rests
MID_STANCE = 0.31  # the body passes over it here
HAND_M, LIFT_M = 0.04, 0.05  # height of a resting wrist, and its lift
TURN_RADPS, STEP_RAD = 0.6, 0.6  # angular speed, and angle per stride
LEVEL_RAD = 1.45  # pitch of the trunk

Flat = Float64[np.ndarray, "time 2"]


def on_all_fours(body: Body) -> Pose:
    """Return the pose on hands and knees, with the ankles at the origin."""
    hips_m = np.array([[body.shin_m, 0.0]])
    knees_m = np.stack([hips_m + _knee(body, sign) for sign in (1, -1)], axis=1)
    hands_m = np.stack([hips_m + _hand(body, sign) for sign in (1, -1)], axis=1)
    rest = np.full((1, 2, 1), HAND_M)
    return _held(body, hips_m, np.zeros(1), knees_m, np.concatenate((hands_m, rest), axis=2))


def crawl(body: Body, place: Place, to_m: Sequence[Point], speed_mps: float) -> tuple[Pose, Place]:
    """Return the poses of a crawl along way points of the hips, one per `STEP_S`, and its end."""
    hips, segments = place.ahead(body.shin_m), [stay(place.ahead(body.shin_m), 0.1)]
    for point_m in to_m:
        segments += segments_along(hips, [((point_m,), speed_mps)], turning_radps=TURN_RADPS)
        hips = end_of(segments, hips)
    path = path_along(segments, 0.0, False, False)
    return _crawling(body, path, segments), hips.ahead(-body.shin_m)


def _crawling(body: Body, path: FloorPath, segments: Sequence[Segment]) -> Pose:
    """Return the poses along a path."""
    turning_hz = np.abs(np.gradient(path.heading_rad, STEP_S)) / STEP_RAD
    rate_hz = path.speed_mps / (STRIDE * body.stature_m) + turning_hz
    phase, _ = strides(rate_hz, segments, MID_STANCE)
    inside = (path.t_s >= path.enter_s - STEP_S / 2) & (path.t_s < path.leave_s - STEP_S / 2)
    knees_m, hands_m = [], []
    for side, sign in enumerate((1, -1)):
        knees_m.append(
            _resting(path, phase, 0.5 * side, np.array([0.0, sign * FEET * body.hips_m]))
        )
        hands_m.append(_resting(path, phase, 0.5 - 0.5 * side, _hand(body, sign)))
    return _held(
        body,
        path.xy_m[inside],
        path.heading_rad[inside],
        np.stack(knees_m, axis=1)[inside, :, :2],
        np.stack(hands_m, axis=1)[inside],
    )


def _knee(body: Body, sign: int) -> np.ndarray:
    """Return the resting place of a knee, ahead and to the left of the hips [m]."""
    return np.array([0.0, sign * FEET * body.hips_m])


def _hand(body: Body, sign: int) -> np.ndarray:
    """Return the resting place of a hand, ahead and to the left of the hips [m]."""
    return np.array([np.sin(LEVEL_RAD) * body.trunk_m, sign * 0.5 * body.shoulders_m])


def _resting(
    path: FloorPath, phase: Float64[np.ndarray, " step"], offset: float, reach_m: np.ndarray
) -> Float64[np.ndarray, "step 3"]:
    """Return the position of a hand or knee that alternately rests and swings [m]."""
    stride = np.floor(phase + offset)
    swing = np.clip((phase + offset - stride - STANCE) / (1 - STANCE), 0.0, 1.0)
    here_m, next_m = (
        _plant(path, phase, stride + k + MID_STANCE - offset, reach_m) for k in (0, 1)
    )
    xy_m = here_m + even(swing)[:, None] * (next_m - here_m)
    return np.column_stack((xy_m, HAND_M + LIFT_M * np.sin(np.pi * swing) ** 2))


def _plant(path: FloorPath, phase: np.ndarray, wanted: np.ndarray, reach_m: np.ndarray) -> Flat:
    """Return the point that has this reach from the body when the phase is as wanted [m]."""
    t_s = np.interp(wanted, phase, path.t_s, left=path.t_s[0], right=path.t_s[-1])
    heading_rad = np.interp(t_s, path.t_s, path.heading_rad)
    xy_m = interpolated(t_s, path.t_s, path.xy_m)
    c, s = np.cos(heading_rad), np.sin(heading_rad)
    plant_m: Flat = xy_m + np.stack(
        (c * reach_m[0] - s * reach_m[1], s * reach_m[0] + c * reach_m[1]), axis=1
    )
    return plant_m


def _held(
    body: Body,
    hips_m: Flat,
    heading_rad: Float64[np.ndarray, " time"],
    knees_m: Float64[np.ndarray, "time 2 2"],
    hands_m: Float64[np.ndarray, "time 2 3"],
) -> Pose:
    """Return the pose with hips, knees and hands over these points of the floor."""
    zero = np.zeros(len(hips_m))
    ahead, left = forward_left(heading_rad)
    turn = np.stack((ahead, left, np.cross(ahead, left)), axis=2)
    sides = ((0, 1.0), (1, -1.0))
    away_m = [
        np.column_stack((knees_m[:, side] - hips_m, zero)) - sign * body.hips_m / 2 * left
        for side, sign in sides
    ]
    drop_m = [_drop(body, offset_m) for offset_m in away_m]
    height_m = KNEE_M + np.maximum(*drop_m)
    if len(height_m) > 1:
        height_m = smooth(height_m, 0.04)
    ankles_m, hinges = np.empty((len(hips_m), 2, 3)), np.empty((len(hips_m), 2, 3))
    hips = turn @ pitched(LEVEL_RAD - 0.05)
    for side, _ in sides:
        thigh_m = away_m[side] - drop_m[side][:, None] * [0.0, 0.0, 1.0]
        hip_m = (
            np.column_stack((hips_m, height_m))
            + np.column_stack((knees_m[:, side] - hips_m, zero))
            - away_m[side]
        )
        knee_m = hip_m + thigh_m
        fall_m = np.clip(knee_m[:, 2:] - ANKLE_M, -0.1, 0.2)
        shin_m = np.sqrt(body.shin_m**2 - fall_m**2) * -ahead - fall_m * [0.0, 0.0, 1.0]
        ankles_m[:, side] = knee_m + shin_m
        hinges[:, side] = np.einsum("tab,ta->tb", hips, unit(np.cross(thigh_m, shin_m)))
    pose = Pose(
        root_m=np.column_stack((hips_m, height_m)),
        hips=hips,
        chest=turn @ pitched(LEVEL_RAD),
        head=turn @ pitched(0.9),
        arms=np.tile(about("y", 0.0), (len(hips_m), 2, 1, 1)),
        elbow_rad=np.zeros((len(hips_m), 2)),
        ankles_m=ankles_m,
        hinges=hinges,
    )
    return reaching(pose, body, hands_m)


def _drop(body: Body, offset_m: Float64[np.ndarray, "time 3"]) -> Float64[np.ndarray, " time"]:
    """Return the height of the hip above a knee at this lateral distance [m]."""
    aside_m = np.linalg.norm(offset_m, axis=1)
    drop_m: Float64[np.ndarray, " time"] = np.sqrt(
        np.maximum(body.thigh_m**2 - aside_m**2, (0.5 * body.thigh_m) ** 2)
    )
    return drop_m
