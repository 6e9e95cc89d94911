"""Poses as rotations of body parts: interpolation keeps limb lengths."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float64

from trecsim.lab.simulation.body_shape import JOINTS, Body
from trecsim.lab.simulation.rotations import Place, about, turn_between, unit

STRAIGHT = 0.9995  # a leg never becomes longer than this share of thigh and shin
NEARLY_STRAIGHT = 0.12  # sine of the bend below which a joint says little about its hinge

Xyz = Float64[np.ndarray, "time 3"]
Turns = Float64[np.ndarray, "time 3 3"]
Joints = Float64[np.ndarray, "time 17 3"]


@dataclass(frozen=True, slots=True, eq=False)
class Pose:
    """Pose of a body over time, independent of its limb lengths.

    The columns of each turn are the part's forward, left and up.

    Attributes
    ----------
    root_m
        Middle of the hips [m].
    hips, chest, head
        Rotations of the parts, to the world.
    arms
        Turns of the left and right upper arm to the chest; the arm points along its -up, and
        the elbow bends towards its forward.
    elbow_rad
        Bend of the left and right elbow, 0 straight [rad].
    ankles_m
        Target of the left and right ankle, which may be out of reach [m].
    hinges
        Axes of the left and right knee, seen from the hips; to the left for straight legs.
    """

    root_m: Xyz
    hips: Turns
    chest: Turns
    head: Turns
    arms: Float64[np.ndarray, "time 2 3 3"]
    elbow_rad: Float64[np.ndarray, "time 2"]
    ankles_m: Float64[np.ndarray, "time 2 3"]
    hinges: Float64[np.ndarray, "time 2 3"]


def joints(pose: Pose, body: Body) -> Joints:
    """Return the COCO-17 joints of a body in a pose [m]."""
    xyz_m = np.empty((len(pose.root_m), JOINTS, 3))
    neck_m = pose.root_m + body.trunk_m * pose.chest[:, :, 2]
    xyz_m[:, :5] = neck_m[:, None] + np.einsum("tab,jb->tja", pose.head, body.head_m)
    for side, sign in ((0, 1.0), (1, -1.0)):
        hip_m = pose.root_m + sign * body.hips_m / 2 * pose.hips[:, :, 1]
        hinge = np.einsum("tab,tb->ta", pose.hips, pose.hinges[:, side])
        knee_m, ankle_m = leg(hip_m, pose.ankles_m[:, side], hinge, body)
        shoulder_m = neck_m + sign * body.shoulders_m / 2 * pose.chest[:, :, 1]
        elbow_m, wrist_m = _arm(shoulder_m, pose, side, body)
        xyz_m[:, 5 + side], xyz_m[:, 7 + side], xyz_m[:, 9 + side] = shoulder_m, elbow_m, wrist_m
        xyz_m[:, 11 + side], xyz_m[:, 13 + side], xyz_m[:, 15 + side] = hip_m, knee_m, ankle_m
    return xyz_m


def leg(hip_m: Xyz, ankle_m: Xyz, hinge: Xyz, body: Body) -> tuple[Xyz, Xyz]:
    """Return knee and ankle for the exact lengths of thigh and shin [m].

    Parameters
    ----------
    hip_m
        Position of the hip [m].
    ankle_m
        Target of the ankle; reached as far as the leg is long [m].
    hinge
        Axis of the knee; the knee lies to the side that is ahead when the axis is to the left.
    body
        Limb lengths.
    """
    way_m = ankle_m - hip_m
    wanted_m = np.linalg.norm(way_m, axis=1, keepdims=True)
    down = way_m / np.maximum(wanted_m, 1e-9)
    length_m = np.clip(wanted_m, 0.3 * body.thigh_m, STRAIGHT * body.leg_m)
    along_m = (body.thigh_m**2 - body.shin_m**2 + length_m**2) / (2 * length_m)
    bend_m = np.sqrt(np.maximum(body.thigh_m**2 - along_m**2, 0.0))
    return (
        hip_m + along_m * down + bend_m * unit(np.cross(down, hinge)),
        hip_m + length_m * down,
    )


def _arm(shoulder_m: Xyz, pose: Pose, side: int, body: Body) -> tuple[Xyz, Xyz]:
    """Return elbow and wrist [m]."""
    arm = pose.chest @ pose.arms[:, side]
    upper = -arm[:, :, 2]
    bend = pose.elbow_rad[:, side, None]
    elbow_m = shoulder_m + body.upper_arm_m * upper
    return elbow_m, elbow_m + body.forearm_m * (np.cos(bend) * upper + np.sin(bend) * arm[:, :, 0])


def reaching(pose: Pose, body: Body, wrists_m: Float64[np.ndarray, "time 2 3"]) -> Pose:
    """Return a pose with the wrists at given points, if in reach, elbows bent towards the feet."""
    neck_m = pose.root_m + body.trunk_m * pose.chest[:, :, 2]
    left = pose.chest[:, :, 1]
    arms, elbows = np.empty_like(pose.arms), np.empty_like(pose.elbow_rad)
    for side, sign in ((0, 1.0), (1, -1.0)):
        way_m = wrists_m[:, side] - neck_m - sign * body.shoulders_m / 2 * left
        length_m = np.linalg.norm(way_m, axis=1)
        far_m = np.minimum(length_m, STRAIGHT * (body.upper_arm_m + body.forearm_m))
        both = 2 * body.upper_arm_m * body.forearm_m
        cosine = (far_m**2 - body.upper_arm_m**2 - body.forearm_m**2) / both
        bend = np.arccos(np.clip(cosine, -1.0, 1.0))
        back = np.arctan2(
            body.forearm_m * np.sin(bend), body.upper_arm_m + body.forearm_m * np.cos(bend)
        )[:, None]
        along = way_m / length_m[:, None]
        ahead = unit(np.cross(along, left))
        upper = np.cos(back) * along - np.sin(back) * ahead
        forward = np.cos(back) * ahead + np.sin(back) * along
        turn = np.stack((forward, np.cross(-upper, forward), -upper), axis=2)
        arms[:, side], elbows[:, side] = pose.chest.transpose(0, 2, 1) @ turn, bend
    return replace(pose, arms=arms, elbow_rad=elbows)


def pose_of(xyz_m: Joints, head_m: Float64[np.ndarray, "5 3"]) -> Pose:
    """Return the pose of a body with these joints.

    Parameters
    ----------
    xyz_m
        COCO-17 joints [m].
    head_m
        Nose, eyes and ears of that body, seen from its head: forward, left, up.
    """
    left_m, right_m = xyz_m[:, 5:17:2], xyz_m[:, 6:17:2]
    root_m, neck_m = (left_m[:, 3] + right_m[:, 3]) / 2, (left_m[:, 0] + right_m[:, 0]) / 2
    up = unit(neck_m - root_m)
    chest = _turn(up, left_m[:, 0] - right_m[:, 0])
    left = unit(left_m[:, 3] - right_m[:, 3])
    forward = unit(np.cross(left, up))
    hips = np.stack((forward, left, np.cross(forward, left)), axis=2)
    face, own = _face(xyz_m[:, :5]), _face(head_m[None])
    arms, elbows = zip(*(_arm_of(side, chest) for side in (left_m, right_m)), strict=True)
    hinges = [_hinge_of(side, hips) for side in (left_m, right_m)]
    return Pose(
        root_m=root_m,
        hips=hips,
        chest=chest,
        head=face @ own.transpose(0, 2, 1),
        arms=np.stack(arms, axis=1),
        elbow_rad=np.stack(elbows, axis=1),
        ankles_m=np.stack((left_m[:, 5], right_m[:, 5]), axis=1),
        hinges=np.stack(hinges, axis=1),
    )


def _turn(up: Xyz, left: Xyz) -> Turns:
    """Return the turn with this up and about this left."""
    left = unit(left - (left * up).sum(axis=1, keepdims=True) * up)
    return np.stack((np.cross(left, up), left, up), axis=2)


def _face(head_m: Float64[np.ndarray, "time 5 3"]) -> Turns:
    """Return the turn of a head by its ears and nose alone."""
    left = unit(head_m[:, 3] - head_m[:, 4])
    ahead = head_m[:, 0] - head_m[:, 3:5].mean(axis=1)
    return _turn(unit(np.cross(ahead, left)), left)


def _arm_of(side_m: Float64[np.ndarray, "time 6 3"], chest: Turns) -> tuple[Turns, np.ndarray]:
    """Return the turn of an upper arm to the chest, and how far the elbow is bent [rad]."""
    upper, fore = unit(side_m[:, 1] - side_m[:, 0]), unit(side_m[:, 2] - side_m[:, 1])
    bend = _across(fore, upper)
    sine = np.linalg.norm(bend, axis=1, keepdims=True)
    # A straight arm does not define the direction of its elbow: take forward.
    ahead = _across(chest[:, :, 0] + 0.3 * chest[:, :, 2], upper)
    forward = unit(bend + np.maximum(NEARLY_STRAIGHT - sine, 0.0) * ahead)
    turn = np.stack((forward, np.cross(-upper, forward), -upper), axis=2)
    angle = np.arctan2(sine[:, 0], (fore * upper).sum(axis=1))
    return chest.transpose(0, 2, 1) @ turn, angle


def _hinge_of(side_m: Float64[np.ndarray, "time 6 3"], hips: Turns) -> Xyz:
    """Return the axis of a knee, seen from the hips."""
    down = unit(side_m[:, 5] - side_m[:, 3])
    bend = _across(unit(side_m[:, 4] - side_m[:, 3]), down)
    sine = np.linalg.norm(bend, axis=1, keepdims=True)
    axis = np.cross(bend, down) + np.maximum(NEARLY_STRAIGHT - sine, 0.0) * hips[:, :, 1]
    hinge: Xyz = np.einsum("tab,ta->tb", hips, unit(axis))
    return hinge


def _across(vector: Xyz, axis: Xyz) -> Xyz:
    """Return the part of a vector that is square to a unit vector."""
    part: Xyz = vector - (vector * axis).sum(axis=1, keepdims=True) * axis
    return part


def cut(pose: Pose, part: slice) -> Pose:
    """Return some of the entries of a pose."""
    return Pose(*(getattr(pose, name)[part] for name in Pose.__slots__))


def at(pose: Pose, entry: int, times: int = 1) -> Pose:
    """Return one entry of a pose, as often as asked for."""
    parts = (getattr(pose, name)[entry] for name in Pose.__slots__)
    return Pose(*(np.broadcast_to(part, (times, *part.shape)) for part in parts))


def joined(poses: Sequence[Pose]) -> Pose:
    """Return poses one after the other."""
    parts = ([getattr(pose, name) for pose in poses] for name in Pose.__slots__)
    return Pose(*(np.concatenate(part) for part in parts))


def blend(a: Pose, b: Pose, share: Float64[np.ndarray, " time"]) -> Pose:
    """Interpolate from pose `a` (0) to pose `b` (1), each part by the shortest rotation."""
    one = share[:, None]
    return Pose(
        root_m=a.root_m + one * (b.root_m - a.root_m),
        hips=turn_between(a.hips, b.hips, share),
        chest=turn_between(a.chest, b.chest, share),
        head=turn_between(a.head, b.head, share),
        arms=turn_between(a.arms, b.arms, one),
        elbow_rad=a.elbow_rad + one * (b.elbow_rad - a.elbow_rad),
        ankles_m=a.ankles_m + one[..., None] * (b.ankles_m - a.ankles_m),
        hinges=unit(a.hinges + one[..., None] * (b.hinges - a.hinges)),
    )


def placed(pose: Pose, place: Place) -> Pose:
    """Return a pose that was given about the origin, facing +x, at a place on the floor."""
    turn = about("z", place.heading_rad)
    shift_m = np.array([place.x_m, place.y_m, 0.0])
    return Pose(
        root_m=pose.root_m @ turn.T + shift_m,
        hips=turn @ pose.hips,
        chest=turn @ pose.chest,
        head=turn @ pose.head,
        arms=pose.arms,
        elbow_rad=pose.elbow_rad,
        ankles_m=pose.ankles_m @ turn.T + shift_m,
        hinges=pose.hinges,
    )
