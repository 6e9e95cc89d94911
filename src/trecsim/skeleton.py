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

SKELETONS = {skeleton.name: skeleton for skeleton in (COCO17,)}
