"""Joints, limbs and mirror pairs of the skeletons that detectors report."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Skeleton:
    """Names and topology of a set of body joints.

    Attributes
    ----------
    name
        How files and estimators call it, e.g. ``"coco17"``.
    joints
        Joint names; the index of a name is the joint's index in every array.
    limbs
        Pairs of joints that a bone (or a rigid part) joins.
    mirror
        For each joint the index of its left-right counterpart (its own index on the midline).

    Examples
    --------
    >>> COCO17.joints[COCO17.mirror[COCO17.joints.index("left_knee")]]
    'right_knee'
    """

    name: str
    joints: tuple[str, ...]
    limbs: tuple[tuple[int, int], ...]
    mirror: tuple[int, ...]

    def index(self, joint: str) -> int:
        """Return the index of the joint called `joint`."""
        return self.joints.index(joint)


def _mirror(joints: tuple[str, ...]) -> tuple[int, ...]:
    swap = {"left": "right", "right": "left"}

    def counterpart(name: str) -> str:
        side, _, rest = name.partition("_")
        return f"{swap[side]}_{rest}" if side in swap else name

    return tuple(joints.index(counterpart(name)) for name in joints)


def _skeleton(name: str, joints: str, limbs: tuple[tuple[str, str], ...]) -> Skeleton:
    names = tuple(joints.split())
    pairs = tuple((names.index(a), names.index(b)) for a, b in limbs)
    return Skeleton(name, names, pairs, _mirror(names))


COCO17 = _skeleton(
    "coco17",
    "nose left_eye right_eye left_ear right_ear left_shoulder right_shoulder left_elbow "
    "right_elbow left_wrist right_wrist left_hip right_hip left_knee right_knee left_ankle "
    "right_ankle",
    (
        ("nose", "left_eye"),
        ("nose", "right_eye"),
        ("left_eye", "left_ear"),
        ("right_eye", "right_ear"),
        ("nose", "left_shoulder"),
        ("nose", "right_shoulder"),
        ("left_shoulder", "right_shoulder"),
        ("left_shoulder", "left_elbow"),
        ("right_shoulder", "right_elbow"),
        ("left_elbow", "left_wrist"),
        ("right_elbow", "right_wrist"),
        ("left_shoulder", "left_hip"),
        ("right_shoulder", "right_hip"),
        ("left_hip", "right_hip"),
        ("left_hip", "left_knee"),
        ("right_hip", "right_knee"),
        ("left_knee", "left_ankle"),
        ("right_knee", "right_ankle"),
    ),
)

HALPE26 = _skeleton(
    "halpe26",
    " ".join(COCO17.joints) + " head neck mid_hip left_big_toe right_big_toe left_small_toe "
    "right_small_toe left_heel right_heel",
    (
        *((COCO17.joints[a], COCO17.joints[b]) for a, b in COCO17.limbs),
        ("head", "neck"),
        ("neck", "left_shoulder"),
        ("neck", "right_shoulder"),
        ("mid_hip", "left_hip"),
        ("mid_hip", "right_hip"),
        *((f"{side}_ankle", f"{side}_heel") for side in ("left", "right")),
        *((f"{side}_heel", f"{side}_big_toe") for side in ("left", "right")),
        *((f"{side}_big_toe", f"{side}_small_toe") for side in ("left", "right")),
    ),
)
"""COCO-17, then head, neck, middle of the hips, and feet."""

SKELETONS = {skeleton.name: skeleton for skeleton in (COCO17, HALPE26)}


def skeleton_with(joints: int) -> Skeleton | None:
    """Return the known skeleton with so many joints; None if there is none.

    Examples
    --------
    >>> skeleton_with(26).name
    'halpe26'
    """
    return next((one for one in SKELETONS.values() if len(one.joints) == joints), None)
