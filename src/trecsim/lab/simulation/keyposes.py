"""Static poses: sitting, bent, kneeling, lying.

All are given about the place where the person stands, or would stand: +x is ahead, +y left.
"""

from dataclasses import replace

import numpy as np
from jaxtyping import Float64

from trecsim.lab.simulation.body_shape import Body
from trecsim.lab.simulation.pose import Pose
from trecsim.lab.simulation.rotations import about, unit

FLESH_M = 0.09  # distance of the joints of the trunk from what they rest on
KNEE_M, ANKLE_M = 0.055, 0.06
FEET = 0.4  # lateral distance of the ankles as a share of that of the hips
LYING = 0.97  # stretch of the legs when lying

Turn = Float64[np.ndarray, "3 3"]
Arm = tuple[Turn, float]


def arm(
    side: int, forward_rad: float, out_rad: float = 0.12, elbow_rad: float = 0.3, twist: float = 0.0
) -> Arm:
    """Return the rotation of an arm and the bend of its elbow.

    Parameters
    ----------
    side
        0 left, 1 right.
    forward_rad
        Swing forward and up [rad].
    out_rad
        Spread away from the body, applied before [rad].
    elbow_rad
        Bend of the elbow [rad].
    twist
        Outward rotation about its own axis, applied before [rad].
    """
    sign = 1.0 - 2.0 * side
    return about("y", -forward_rad) @ about("x", sign * out_rad) @ about(
        "z", sign * twist
    ), elbow_rad


def _pose(
    root_m: tuple[float, float, float],
    ankles_m: tuple[tuple[float, float, float], tuple[float, float, float]],
    hips: Turn,
    chest: Turn,
    head: Turn,
    arms: tuple[Arm, Arm],
    spread: float = 0.1,
) -> Pose:
    """Return one pose; knees are spread outwards by a little."""
    return Pose(
        root_m=np.array([root_m]),
        hips=hips[None],
        chest=chest[None],
        head=head[None],
        arms=np.stack([one[0] for one in arms])[None],
        elbow_rad=np.array([[one[1] for one in arms]]),
        ankles_m=np.array([ankles_m], dtype=float),
        hinges=unit(np.array([[[-spread, 1.0, 0.0], [spread, 1.0, 0.0]]])),
    )


def _feet(
    body: Body, x_m: float = 0.0, z_m: float | None = None, wide: float = FEET
) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    height_m = body.ankle_m if z_m is None else z_m
    aside_m = wide * body.hips_m
    return (x_m, aside_m, height_m), (x_m, -aside_m, height_m)


def _both(forward_rad: float, out_rad: float = 0.12, elbow_rad: float = 0.3) -> tuple[Arm, Arm]:
    return arm(0, forward_rad, out_rad, elbow_rad), arm(1, forward_rad, out_rad, elbow_rad)


def pitched(angle_rad: float) -> Turn:
    """Return the turn of a part that leans forward [rad]."""
    return about("y", angle_rad)


def bent(body: Body, angle_rad: float) -> Pose:
    """Return the pose of a person who bends forward from the hips, the hips behind the feet."""
    back_m = -0.13 * body.stature_m * np.sin(min(angle_rad, 1.5)) * 0.8
    drop_m = 0.985 * body.leg_m
    height_m = body.ankle_m + np.sqrt(drop_m**2 - back_m**2)
    return _pose(
        (back_m, 0.0, float(height_m)),
        _feet(body),
        pitched(0.6 * angle_rad),
        pitched(angle_rad),
        pitched(0.7 * angle_rad),
        _both(0.9 * angle_rad, 0.08, 0.15),
    )


def sitting(body: Body, seat_m: float) -> Pose:
    """Return the pose on a seat, hands on the thighs."""
    height_m = seat_m + FLESH_M
    knee_m = body.ankle_m + body.shin_m
    reach_m = np.sqrt(max(body.thigh_m**2 - (knee_m - height_m) ** 2, 0.1**2))
    return _pose(
        (-0.95 * float(reach_m), 0.0, height_m),
        _feet(body),
        pitched(-0.1),
        pitched(-0.08),
        pitched(0.05),
        _both(0.35, 0.1, 1.0),
    )


def leaning(body: Body, seat_m: float) -> Pose:
    """Return the pose between standing and sitting: hips over the seat, trunk ahead."""
    seat = sitting(body, seat_m)
    height_m = 0.45 * seat.root_m[0, 2] + 0.55 * (body.ankle_m + body.leg_m)
    return _pose(
        (0.95 * seat.root_m[0, 0], 0.0, float(height_m)),
        _feet(body),
        pitched(0.5),
        pitched(0.95),
        pitched(0.35),
        _both(0.5, 0.1, 0.8),
    )


def squatting(body: Body) -> Pose:
    """Return the pose of a person who squats, arms ahead for balance."""
    return _pose(
        (-0.11 * body.stature_m, 0.0, 0.22 * body.stature_m),
        _feet(body),
        pitched(0.2),
        pitched(0.75),
        pitched(0.2),
        _both(1.5, 0.15, 0.2),
        spread=0.35,
    )


def on_the_floor(body: Body) -> Pose:
    """Return the pose of a person who sits on the floor, knees up, leaning on the hands behind."""
    return _pose(
        (-0.6 * body.leg_m, 0.0, FLESH_M),
        _feet(body),
        pitched(-0.5),
        pitched(-0.4),
        pitched(-0.1),
        _both(-0.85, 0.25, 0.25),
    )


def on_the_back(body: Body) -> Pose:
    """Return the pose of a person who lies on the back, legs stretched."""
    root_m = -0.6 * body.leg_m
    return _pose(
        (root_m, 0.0, FLESH_M),
        _feet(body, root_m + LYING * body.leg_m, ANKLE_M, wide=0.9),
        pitched(-np.pi / 2),
        pitched(-np.pi / 2 + 0.03),
        pitched(-np.pi / 2 + 0.2),
        _both(-0.05, 0.3, 0.15),
        spread=0.3,
    )


def on_the_side(body: Body, side: int) -> Pose:
    """Return the pose of lying on the left (0) or right (1) side, knees and elbows bent."""
    sign = 1.0 - 2.0 * side
    rolled = pitched(-np.pi / 2) @ about("z", sign * np.pi / 2)
    root_m = -0.6 * body.leg_m
    # The shoulders are wider than the hips, so the trunk slopes up to them.
    slope = (body.shoulders_m - body.hips_m) / 2 / body.trunk_m
    lower = (root_m + 0.86 * body.leg_m, 0.10 * sign, ANKLE_M)
    upper = (root_m + 0.78 * body.leg_m, 0.14 * sign, ANKLE_M + 0.10)
    arms = [arm(side, 1.3, 0.0, 1.3), arm(1 - side, 0.9, -0.35, 0.9)]
    return _pose(
        (root_m, 0.0, FLESH_M - 0.02 + body.hips_m / 2),
        (lower, upper) if side == 0 else (upper, lower),
        rolled,
        about("y", slope) @ rolled,
        about("y", slope / 2) @ rolled,
        (arms[0], arms[1]) if side == 0 else (arms[1], arms[0]),
        spread=0.0,
    )


def kneeling(body: Body, lean_rad: float) -> Pose:
    """Return the pose on the right knee, the left foot ahead, the trunk leaning forward."""
    (_, left_m, height_m), (_, right_m, _) = _feet(body)
    return _pose(
        (body.shin_m, 0.0, KNEE_M + 0.985 * body.thigh_m),
        ((body.shin_m + 0.9 * body.thigh_m, left_m, height_m), (0.0, right_m, height_m + 0.02)),
        pitched(0.2 * lean_rad),
        pitched(lean_rad),
        pitched(0.8 * lean_rad),
        _both(0.25 + lean_rad, 0.15, 0.7),
        spread=0.0,
    )


def crouching(body: Body) -> Pose:
    """Return the pose half way between kneeling and standing, one foot ahead."""
    (_, left_m, height_m), (_, right_m, _) = _feet(body)
    return _pose(
        (body.shin_m + 0.1 * body.thigh_m, 0.0, body.ankle_m + 0.75 * body.leg_m),
        (
            (body.shin_m + 0.9 * body.thigh_m, left_m, height_m),
            (0.1 * body.shin_m, right_m, height_m + 0.05),
        ),
        pitched(0.25),
        pitched(0.5),
        pitched(0.3),
        _both(0.5, 0.15, 0.6),
        spread=0.0,
    )


def on_the_front(body: Body) -> Pose:
    """Return the pose of lying on the front, hands beside the shoulders, face to the left."""
    root_m = body.shin_m + body.thigh_m
    arms = arm(0, 0.0, 1.2, 1.9, np.pi / 2), arm(1, 0.0, 1.2, 1.9, np.pi / 2)
    return _pose(
        (root_m, 0.0, FLESH_M),
        _feet(body, root_m - 0.998 * body.leg_m, ANKLE_M + 0.01, wide=0.7),
        pitched(np.pi / 2),
        pitched(np.pi / 2 - 0.04),
        pitched(np.pi / 2 - 0.1) @ about("z", 1.3),
        arms,
        spread=0.0,
    )


def buckling(body: Body, to: str) -> Pose:
    """Return the pose in the middle of a fall, knees giving way, feet in place."""
    lean, roll, ahead, aside, height = {
        "back": (0.1, 0.0, -0.36, 0.0, 0.62),
        "front": (0.7, 0.0, 0.75, 0.0, 0.75),
        "left": (0.15, -0.5, 0.0, 0.32, 0.62),
        "right": (0.15, 0.5, 0.0, -0.32, 0.62),
    }[to]
    trunk = about("x", roll) @ pitched(lean)
    return _pose(
        (ahead * body.leg_m, aside * body.leg_m, height * body.leg_m),
        _feet(body),
        about("x", 0.7 * roll) @ pitched(-0.3 if to == "back" else 0.5 * lean),
        trunk,
        trunk,
        _both(1.2, 0.6, 0.8),
    )


def with_arms_up(pose: Pose, arms: str) -> Pose:
    """Return a standing pose with the "left", the "right" or "both" arms raised over the head."""
    turns, elbow_rad = pose.arms.copy(), pose.elbow_rad.copy()
    for side, name in enumerate(("left", "right")):
        if arms in ("both", name):
            turns[:, side], elbow_rad[:, side] = arm(side, 2.85, 0.22, 0.2)
    return replace(pose, arms=turns, elbow_rad=elbow_rad)
