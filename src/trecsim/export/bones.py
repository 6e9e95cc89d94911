"""A body of rigid bones fitted to joints: inverse kinematics on the learnt limb lengths.

Spine, neck and shoulder girdle bend between what the joints say, so that hips, shoulders and ears
are met although every bone has one length. Arms and legs have the median of their lengths over
time; elbows, wrists, knees and ankles move to the nearest place where that is so. Upper arms and
thighs twist with the plane in which elbow and knee are bent, steadily, so that nothing flips where
a limb is straight; all other bones turn from their parent by the shortest rotation.

Coordinates have y up; the rest pose stands with arms to the sides and looks along z.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Float64

from trecsim.export.feet import Shares, rested
from trecsim.export.turns3d import (
    Rotations,
    Vectors,
    across,
    best_rotation,
    frame_of,
    steady_twist,
    swing,
    twist,
    unit,
)
from trecsim.skeleton import COCO17

_LEFT, _UP, _FRONT = np.eye(3)
_DOWN, _BACK = -_UP, -_FRONT
_FACE = ("nose", "left_eye", "right_eye", "left_ear", "right_ear")
_CLAVICLE = 1.3  # its length by half the shoulder width: it meets all widths that occur
_BENT = 1.05  # length of spine and neck by the longest distance that they span
_SACRUM, _STERNUM = 0.1, 0.15
_ROUNDS = 30
_HELD = 0.7  # how much less the end gives where it is held
_END_GIVES = 0.15  # how far a wrist or ankle moves for 1 that an elbow or knee does


@dataclass(frozen=True, slots=True, eq=False)
class Bone:
    """One joint of the body, over time.

    Attributes
    ----------
    name
        As motion capture files call it.
    parent
        Index of the parent; -1 for the root.
    offset_m
        From the parent's joint, in the rest pose [m].
    turn
        Rotation against the parent; None where it never turns.
    order
        Usual order of its angles, in which the middle one mostly stays small.
    """

    name: str
    parent: int
    offset_m: Float64[np.ndarray, " 3"]
    turn: Rotations | None
    order: str = "ZXY"


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """A body of rigid bones over time; `root_m` is where its root is [m]."""

    bones: tuple[Bone, ...]
    root_m: Vectors


def _seen_from(turns: Rotations, vectors: Vectors) -> Vectors:
    """Return world vectors in the coordinates of bones."""
    return np.asarray(np.einsum("fji,fj->fi", turns, vectors))


class _Builder:
    """Adds bones from the root outwards and keeps where each is, in world coordinates."""

    def __init__(self, root_m: Vectors, turn: Rotations) -> None:
        self.bones = [Bone("Hips", -1, np.zeros(3), turn, "YXZ")]
        self.turns = [turn]
        self.places = [root_m]

    def add(
        self,
        name: str,
        parent: int,
        offset_m: Float64[np.ndarray, " 3"],
        turn: Rotations | None = None,
        order: str = "ZXY",
    ) -> int:
        """Add a bone with its rotation against the parent."""
        self.bones.append(Bone(name, parent, offset_m, turn, order))
        above = self.turns[parent]
        self.places.append(self.places[parent] + above @ offset_m)
        self.turns.append(above if turn is None else above @ turn)
        return len(self.bones) - 1

    def pointing(
        self,
        name: str,
        parent: int,
        offset_m: Float64[np.ndarray, " 3"],
        rest: Float64[np.ndarray, " 3"],
        target_m: Vectors,
        order: str = "ZXY",
        then_m: Vectors | None = None,
    ) -> int:
        """Add a bone whose direction `rest` points to a target; it twists with what comes then."""
        above = self.turns[parent]
        place = self.places[parent] + above @ offset_m
        turn = swing(rest, _seen_from(above, unit(target_m - place)))
        if then_m is not None:
            lower = _seen_from(above @ turn, unit(then_m - target_m))
            bend = _BACK if rest[1] else _FRONT
            turn = turn @ twist(rest, steady_twist(rest, bend, lower))
        return self.add(name, parent, offset_m, turn, order)

    def oriented(
        self, name: str, parent: int, offset_m: Float64[np.ndarray, " 3"], turn: Rotations
    ) -> int:
        """Add a bone with its rotation in the world."""
        local = self.turns[parent].transpose(0, 2, 1) @ turn
        return self.add(name, parent, offset_m, local)


def fitted_body(
    joints_m: Float64[np.ndarray, "frame joint 3"], rate_hz: float | None = None
) -> Body:
    """Fit a body to joints.

    Parameters
    ----------
    joints_m
        COCO-17 with y up; none is missing [m].
    rate_hz
        Frames per second, for feet that are held where they rest; None leaves them.
    """
    at = {name: joints_m[:, number] for number, name in enumerate(COCO17.joints)}
    hips_m = (at["left_hip"] + at["right_hip"]) / 2
    shoulders_m = (at["left_shoulder"] + at["right_shoulder"]) / 2
    builder = _Builder(hips_m, frame_of(at["left_hip"] - at["right_hip"], shoulders_m - hips_m))
    chest = _add_trunk(builder, at, shoulders_m)
    _add_head(builder, at, chest, joints_m)
    for side, sign in (("left", 1.0), ("right", -1.0)):
        _add_leg(builder, at, side, sign, rate_hz)
    return Body(tuple(builder.bones), hips_m)


def _add_trunk(builder: _Builder, at: dict[str, Vectors], shoulders_m: Vectors) -> int:
    """Add spine, chest and arms; return the chest."""
    across_m = at["left_shoulder"] - at["right_shoulder"]
    half_m = np.linalg.norm(across_m, axis=1) / 2
    width_m = float(np.median(half_m))
    start_m = _STERNUM * width_m
    clavicle_m = _CLAVICLE * (width_m - start_m)
    below_m = np.sqrt(np.maximum(clavicle_m**2 - (half_m - start_m) ** 2, 1e-6))
    left = unit(across_m)
    up = across(shoulders_m - builder.places[0], left)
    chest_m = shoulders_m - below_m[:, None] * up
    height_m = float(np.median(np.linalg.norm(chest_m - builder.places[0], axis=1)))
    spine = builder.add("Spine", 0, _SACRUM * height_m * _UP)
    back = -np.cross(left, up)
    middle = _bent(builder, "Spine", spine, chest_m, back)
    chest = builder.oriented("Spine2", *middle, frame_of(across_m, up))
    drop_m = float(np.sqrt(max(clavicle_m**2 - (width_m - start_m) ** 2, 1e-6)))
    for side, sign in (("left", 1.0), ("right", -1.0)):
        _add_arm(builder, at, side, sign, chest, start_m, (width_m - start_m, drop_m))
    return chest


def _bent(
    builder: _Builder, name: str, first: int, target_m: Vectors, bend: Vectors
) -> tuple[int, Float64[np.ndarray, " 3"]]:
    """Make bone `first` and a second one span to a target; return the second and its end."""
    start_m = builder.places[first]
    span_m = np.linalg.norm(target_m - start_m, axis=1)
    half_m = _BENT * float(np.quantile(span_m, 0.995)) / 2
    aside_m = np.sqrt(np.maximum(half_m**2 - (span_m / 2) ** 2, 0.0))
    direction = across(bend, unit(target_m - start_m))
    knee_m = (start_m + target_m) / 2 + aside_m[:, None] * direction
    _point(builder, first, _UP, knee_m)
    second = builder.pointing(f"{name}1", first, half_m * _UP, _UP, target_m)
    return second, half_m * _UP


def _point(
    builder: _Builder, bone: int, rest: Float64[np.ndarray, " 3"], target_m: Vectors
) -> None:
    """Turn a bone that has no children yet towards a target."""
    old = builder.bones.pop(bone)
    builder.turns.pop()
    builder.places.pop()
    builder.pointing(old.name, old.parent, old.offset_m, rest, target_m, old.order)


def _add_arm(
    builder: _Builder,
    at: dict[str, Vectors],
    side: str,
    sign: float,
    chest: int,
    start_m: float,
    reach_m: tuple[float, float],
) -> None:
    rest = sign * _LEFT
    title = side.capitalize()
    to_shoulder = np.array([sign * reach_m[0], reach_m[1], 0.0])
    clavicle = builder.pointing(
        f"{title}Shoulder", chest, start_m * rest, unit(to_shoulder[None])[0],
        at[f"{side}_shoulder"],
    )  # fmt: skip
    names = (f"{title}Arm", f"{title}ForeArm", f"{title}Hand")
    joints = [at[f"{side}_{joint}"] for joint in ("shoulder", "elbow", "wrist")]
    _add_limb(builder, names, joints, _lengths(joints), clavicle, to_shoulder, rest, "ZXY")


def _add_leg(
    builder: _Builder, at: dict[str, Vectors], side: str, sign: float, rate_hz: float | None
) -> None:
    half_m = float(np.median(np.linalg.norm(at["left_hip"] - at["right_hip"], axis=1))) / 2
    title = side.capitalize()
    names = (f"{title}UpLeg", f"{title}Leg", f"{title}Foot")
    joints = [at[f"{side}_{joint}"] for joint in ("hip", "knee", "ankle")]
    lengths_m = _lengths(joints)
    held = None
    if rate_hz is not None:
        resting = rested(joints[2], rate_hz)
        joints[2], held = resting.place_m, resting.share
    _add_limb(builder, names, joints, lengths_m, 0, sign * half_m * _LEFT, _DOWN, "XZY", held)


def _lengths(joints: list[Vectors]) -> list[float]:
    """Return the lengths of a limb's two parts [m]."""
    return [float(np.median(np.linalg.norm(b - a, axis=1))) for a, b in pairwise(joints)]


def _add_limb(
    builder: _Builder,
    names: tuple[str, ...],
    joints: list[Vectors],
    lengths_m: list[float],
    parent: int,
    offset_m: Float64[np.ndarray, " 3"],
    rest: Float64[np.ndarray, " 3"],
    order: str,
    held: Shares | None = None,
) -> None:
    start_m = builder.places[parent] + builder.turns[parent] @ offset_m
    middle_m, end_m = with_lengths(start_m, joints[1], joints[2], lengths_m, held)
    upper = builder.pointing(names[0], parent, offset_m, rest, middle_m, order, end_m)
    lower = builder.pointing(names[1], upper, lengths_m[0] * rest, rest, end_m, order)
    builder.add(names[2], lower, lengths_m[1] * rest)


def with_lengths(
    start_m: Vectors,
    middle_m: Vectors,
    end_m: Vectors,
    lengths_m: list[float],
    held: Shares | None = None,
) -> tuple[Vectors, Vectors]:
    """Return the nearest elbow and wrist, or knee and ankle, that fit two lengths.

    Parameters
    ----------
    start_m, middle_m, end_m
        Shoulder, elbow and wrist, or hip, knee and ankle [m].
    lengths_m
        Of the upper and the lower part [m].
    held
        How firmly the end stays where it is, from 0 to 1; None for 0.

    Notes
    -----
    Both lengths are corrected in turn along the limb; the end gives way less than the middle, so
    that hands and feet stay where they are. There is no angle in it, hence nothing that flips.
    """
    upper_m, lower_m = lengths_m
    loose = np.ones(len(end_m)) if held is None else 1.0 - _HELD * held
    gives = (1.0 / (1.0 + _END_GIVES * loose))[:, None]
    for _ in range(_ROUNDS):
        along = end_m - middle_m
        excess = (1.0 - lower_m / np.maximum(np.linalg.norm(along, axis=1), 1e-6))[:, None] * along
        middle_m = middle_m + gives * excess
        end_m = end_m - (1.0 - gives) * excess
        middle_m = start_m + upper_m * unit(middle_m - start_m)
    return middle_m, middle_m + lower_m * unit(end_m - middle_m)


def _add_head(
    builder: _Builder,
    at: dict[str, Vectors],
    chest: int,
    joints_m: Float64[np.ndarray, "frame joint 3"],
) -> None:
    ears_m = (at["left_ear"] + at["right_ear"]) / 2
    face_m = joints_m[:, : len(_FACE)] - ears_m[:, None]
    rough = _head_frames(at, ears_m, builder.turns[chest])
    rest_m = np.median(np.einsum("fji,fpj->fpi", rough, face_m), axis=0)
    turn = best_rotation(rest_m, face_m)
    shoulders = [index for index, bone in enumerate(builder.bones) if bone.name.endswith("Arm")]
    lift_m = float(builder.bones[shoulders[0]].offset_m[1])
    neck = builder.add("Neck", chest, lift_m * _UP)
    back = -builder.turns[chest][:, :, 2]
    head = builder.oriented("Head", *_bent(builder, "Neck", neck, ears_m, back), turn)
    for name, place_m in zip(_FACE, rest_m, strict=True):
        title = "".join(part.capitalize() for part in name.split("_"))
        builder.add(title, head, place_m)


def _head_frames(at: dict[str, Vectors], ears_m: Vectors, chest: Rotations) -> Rotations:
    """Return rough axes of the head: x to the left ear, z to the nose."""
    left = at["left_ear"] - at["right_ear"]
    left = np.where(np.linalg.norm(left, axis=1, keepdims=True) > 1e-3, left, chest[:, :, 0])
    x = unit(left)
    z = across(at["nose"] - ears_m, x)
    return np.stack([x, np.cross(z, x), z], axis=-1)


def joints_of(body: Body) -> dict[str, Vectors]:
    """Return where the joints of a body are, by their names in COCO-17 [m]."""
    places: list[Vectors] = []
    turns: list[Rotations] = []
    for bone in body.bones:
        above = turns[bone.parent] if bone.parent >= 0 else np.eye(3)[None]
        base = places[bone.parent] if bone.parent >= 0 else body.root_m
        places.append(base + above @ bone.offset_m)
        turns.append(above if bone.turn is None else above @ bone.turn)
    named = {bone.name: place for bone, place in zip(body.bones, places, strict=True)}
    return {joint: named[bone] for joint, bone in BONE_OF.items()}


_PARTS = {
    "shoulder": "Arm", "elbow": "ForeArm", "wrist": "Hand", "hip": "UpLeg", "knee": "Leg",
    "ankle": "Foot", "eye": "Eye", "ear": "Ear",
}  # fmt: skip
BONE_OF = {
    joint: "Nose" if joint == "nose" else joint.split("_")[0].capitalize()
    + _PARTS[joint.split("_")[1]]
    for joint in COCO17.joints
}  # fmt: skip
"""The bone at whose root each joint is."""
