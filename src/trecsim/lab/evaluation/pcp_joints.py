"""Annotated joints and parts of Shelf and Campus, computed from the joints of COCO-17."""

import numpy as np
from jaxtyping import Bool, Float64

from trecsim.skeleton import COCO17

JOINTS = (
    *("right_ankle", "right_knee", "right_hip", "left_hip", "left_knee", "left_ankle"),
    *("right_wrist", "right_elbow", "right_shoulder"),
    *("left_shoulder", "left_elbow", "left_wrist"),
    *("bottom_head", "top_head"),
)
"""The annotated joints in the order of the annotation; the first 12 are those of the limbs."""

LIMB_JOINTS = 12

GROUPS = ("head", "torso", "upper arms", "lower arms", "upper legs", "lower legs")
_PARTS = (  # ends as indices of JOINTS, and the group; the torso joins them as the last
    *((0, 1, "lower legs"), (1, 2, "upper legs"), (3, 4, "upper legs"), (4, 5, "lower legs")),
    *((6, 7, "lower arms"), (7, 8, "upper arms"), (9, 10, "upper arms"), (10, 11, "lower arms")),
    (12, 13, "head"),
)
_STARTS = [start for start, _, _ in _PARTS]
_ENDS = [end for _, end, _ in _PARTS]
_HIPS, _BOTTOM_HEAD = [2, 3], 12
N_PARTS = len(_PARTS) + 1
GROUP_OF_PART = np.array([GROUPS.index(group) for _, _, group in _PARTS] + [GROUPS.index("torso")])

_COCO = [COCO17.index(joint) for joint in JOINTS[:LIMB_JOINTS]]
_NOSE = COCO17.index("nose")
_EARS = [COCO17.index("left_ear"), COCO17.index("right_ear")]
_SHOULDERS = [COCO17.index("left_shoulder"), COCO17.index("right_shoulder")]


def annotated_joints(
    xyz_m: Float64[np.ndarray, "*batch 17 3"],
) -> Float64[np.ndarray, "*batch 14 3"]:
    """Return the joints that the annotation has, computed from those of COCO-17 [m].

    Notes
    -----
    COCO-17 lacks the two ends of the head; they come from nose, ears and shoulders by the rule of
    VoxelPose for Shelf.

    Examples
    --------
    >>> annotated_joints(np.ones((2, 17, 3))).shape
    (2, 14, 3)
    """
    shoulders_m, ears_m = (xyz_m[..., pair, :].mean(axis=-2) for pair in (_SHOULDERS, _EARS))
    neck_m = (shoulders_m + ears_m) / 2
    crown_m = neck_m + 2 * (ears_m - neck_m)
    up_m = xyz_m[..., _NOSE, :] - shoulders_m
    near_m, far_m = shoulders_m + 0.5 * up_m, shoulders_m + up_m * [0.75, 0.75, 1.5]
    bottom_m, top_m = 0.75 * near_m + 0.25 * neck_m, 0.75 * far_m + 0.25 * crown_m
    return np.concatenate(
        [xyz_m[..., _COCO, :], bottom_m[..., None, :], top_m[..., None, :]], axis=-2
    )


def parts_correct(
    found_m: Float64[np.ndarray, "*batch 14 3"], truth_m: Float64[np.ndarray, "*batch 14 3"]
) -> Bool[np.ndarray, "*batch 10"]:
    """Return which parts are correct: the mean error of both ends is at most half its length.

    A part with an end of NaN is wrong.
    """
    found_starts_m, found_ends_m = _ends(found_m)
    starts_m, ends_m = _ends(truth_m)
    off_m = (_length(found_starts_m - starts_m) + _length(found_ends_m - ends_m)) / 2
    right: Bool[np.ndarray, "*batch 10"] = off_m <= 0.5 * _length(ends_m - starts_m)
    return right


def _ends(
    joints_m: Float64[np.ndarray, "*batch 14 3"],
) -> tuple[Float64[np.ndarray, "*batch 10 3"], Float64[np.ndarray, "*batch 10 3"]]:
    hips_m = joints_m[..., _HIPS, :].mean(axis=-2, keepdims=True)
    starts_m = np.concatenate([joints_m[..., _STARTS, :], hips_m], axis=-2)
    return starts_m, joints_m[..., [*_ENDS, _BOTTOM_HEAD], :]


def _length(vector: Float64[np.ndarray, "*batch 3"]) -> Float64[np.ndarray, "*batch"]:
    return np.asarray(np.linalg.norm(vector, axis=-1))
