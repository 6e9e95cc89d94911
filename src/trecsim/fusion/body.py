"""Prior knowledge of a body: process and measurement noise per joint, usual limb lengths."""

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from jaxtyping import Bool, Float64, Int64

from trecsim.fusion.kernels import Ruler
from trecsim.fusion.settings import FusionSettings
from trecsim.fusion.tuning import LENGTH_SPREAD
from trecsim.skeleton import Skeleton

# Usual distances between an adult's joints, and their standard deviation over postures [m]. The
# spread over people covers children and tall adults. Keys are parts of joints' names, and whether
# both joints are on the same side of the body.
_USUAL_M = {
    ("nose", "eye", "any"): (0.05, 0.005),
    ("eye", "eye", "other"): (0.065, 0.005),
    ("eye", "ear", "same"): (0.10, 0.005),
    ("ear", "ear", "other"): (0.15, 0.005),
    ("nose", "shoulder", "any"): (0.27, 0.025),
    ("ear", "shoulder", "same"): (0.21, 0.025),
    ("shoulder", "shoulder", "other"): (0.34, 0.015),
    ("hip", "hip", "other"): (0.24, 0.01),
    ("shoulder", "elbow", "same"): (0.28, 0.01),
    ("elbow", "wrist", "same"): (0.25, 0.01),
    ("shoulder", "hip", "same"): (0.50, 0.015),
    ("shoulder", "hip", "other"): (0.57, 0.015),
    ("hip", "knee", "same"): (0.42, 0.01),
    ("knee", "ankle", "same"): (0.41, 0.01),
}

_HEAD = ("nose", "eye", "ear")
_ARM = ("elbow", "wrist")
_LEG = ("knee", "ankle")
_CHAIN = (("shoulder", "elbow"), ("hip", "knee"), ("elbow", "wrist"), ("knee", "ankle"))

# How far people who mark the same image put a joint from each other, as a share of the person's
# size: the constants of COCO's key-point evaluation (https://cocodataset.org/#keypoints-eval),
# which were measured on 5,000 images marked twice. An estimator that learnt from such marks errs in
# the same proportions; only the ratios to the mean of these joints are used. Joints of the face are
# missing on purpose: people agree on an eye within a third of this, estimators do not, since the
# face is turned away or covered in many views. On real video their errors are as large as those of
# the limbs, so they have the mean.
_MARKED_APART = {
    "shoulder": 0.079, "elbow": 0.072, "wrist": 0.062, "hip": 0.107, "knee": 0.087, "ankle": 0.089,
}  # fmt: skip


# In which proportions the joints have an error that all cameras share, relative to the mean of
# arms and legs:
# an estimator puts a joint where people mark it, and clothes and flesh hide where it is. Least at
# the face and at ankles, and most at hips: so on Shelf, between disjoint pairs of cameras on
# another recording, and in a gait laboratory (Needham et al. 2021, doi 10.1038/s41598-021-00212-x).
_SHARED = {
    "nose": 0.6, "eye": 0.6, "ear": 0.6, "shoulder": 0.9, "elbow": 0.95, "wrist": 1.2, "hip": 1.4,
    "knee": 0.9, "ankle": 0.65,
}  # fmt: skip


# The limbs that are across the line of sight of somebody who stands or walks.
_UPRIGHT = ({"shoulder", "hip"}, {"hip", "knee"}, {"knee", "ankle"})
# Height of a joint above the ground when the body rests on it [m].
_CONTACT_HEIGHT_M = {
    "ankle": 0.08, "knee": 0.06, "hip": 0.10, "shoulder": 0.10, "elbow": 0.05, "wrist": 0.04,
    "nose": 0.10, "eye": 0.10, "ear": 0.08,
}  # fmt: skip


def _part(joint: str) -> str:
    return joint.rpartition("_")[2]


def _side(joint: str) -> str:
    side = joint.partition("_")[0]
    return side if side in ("left", "right") else ""


@dataclass(frozen=True, slots=True, eq=False)
class UsualBody:
    """Prior knowledge of the distances between joints.

    Attributes
    ----------
    joints
        Pairs of joints that keep their distance.
    length_m, spread_m
        The distance: mean over people, and standard deviation.
    slack_m
        Its standard deviation over postures.
    bone
        Whether the pair is a limb of the skeleton.
    """

    joints: Int64[np.ndarray, "limb 2"]
    length_m: Float64[np.ndarray, " limb"]
    spread_m: Float64[np.ndarray, " limb"]
    slack_m: Float64[np.ndarray, " limb"]
    bone: Bool[np.ndarray, " limb"]


def usual_body(skeleton: Skeleton) -> UsualBody:
    """Return the pairs of joints of `skeleton` whose usual distance is known."""
    pairs, lengths, slack = [], [], []
    for a, b in combinations(range(len(skeleton.joints)), 2):
        found = _usual(skeleton.joints[a], skeleton.joints[b])
        if found is not None:
            pairs.append((a, b))
            lengths.append(found[0])
            slack.append(found[1])
    limbs = {frozenset(limb) for limb in skeleton.limbs}
    length = np.array(lengths)
    return UsualBody(
        np.array(pairs, np.int64).reshape(-1, 2),
        length,
        LENGTH_SPREAD * length,
        np.array(slack),
        np.array([frozenset(pair) in limbs for pair in pairs], bool),
    )


def _usual(first: str, second: str) -> tuple[float, float] | None:
    side = "same" if _side(first) == _side(second) else "other"
    for parts in ((_part(first), _part(second)), (_part(second), _part(first))):
        for where in (side, "any"):
            if (*parts, where) in _USUAL_M:
                return _USUAL_M[*parts, where]
    return None


def contact_height_m(skeleton: Skeleton) -> Float64[np.ndarray, " joint"]:
    """Return the height of each joint when the body rests on it [m]; 2 cm where it is unknown."""
    return np.array([_CONTACT_HEIGHT_M.get(_part(joint), 0.02) for joint in skeleton.joints])


def key_point_sigma_m(
    skeleton: Skeleton, settings: FusionSettings
) -> Float64[np.ndarray, " joint"]:
    """Return the measurement noise of each joint, as a length at the person's distance [m]."""
    return settings.joint_sigma_m * _relative_sigma(skeleton)


def common_sigma_m(skeleton: Skeleton, settings: FusionSettings) -> Float64[np.ndarray, " joint"]:
    """Return per joint and axis the error that all cameras share [m]."""
    return settings.common_sigma_m * np.array(
        [_SHARED.get(_part(joint), 1.0) for joint in skeleton.joints]
    )


def _relative_sigma(skeleton: Skeleton) -> Float64[np.ndarray, " joint"]:
    """Return the standard deviation of each joint relative to the mean of arms and legs."""
    mean = sum(_MARKED_APART.values()) / len(_MARKED_APART)
    return np.array([_MARKED_APART.get(_part(joint), mean) / mean for joint in skeleton.joints])


def chain(skeleton: Skeleton, usual: UsualBody) -> Int64[np.ndarray, "bone 3"]:
    """Return the limbs of arms and legs from the trunk on; see `Limbs.chain`."""
    names = skeleton.joints
    limb_of = {frozenset(pair): i for i, pair in enumerate(usual.joints.tolist())}
    pairs = [
        (names.index(f"{side}_{near}"), names.index(f"{side}_{far}"))
        for near, far in _CHAIN
        for side in ("left", "right")
        if f"{side}_{near}" in names and f"{side}_{far}" in names
    ]
    rows = [(*pair, limb_of[frozenset(pair)]) for pair in pairs]
    return np.array(rows, np.int64).reshape(-1, 3)


def ruler(skeleton: Skeleton, usual: UsualBody) -> Ruler:
    """Return what measures how far away somebody is whom one camera sees; see `Ruler`."""
    kinds = [_part(joint) for joint in skeleton.joints]
    upright = [
        limb
        for limb in np.flatnonzero(usual.bone).tolist()
        if {kinds[j] for j in usual.joints[limb]} in _UPRIGHT
    ]
    ankles = np.array([j for j, kind in enumerate(kinds) if kind == "ankle"], np.int64)
    height_m = float(contact_height_m(skeleton)[ankles].mean()) if len(ankles) else 0.0
    return Ruler(
        np.ascontiguousarray(usual.joints[upright]), usual.length_m[upright],
        np.array(upright, np.int64), ankles, height_m,
    )  # fmt: skip


def stiffness(skeleton: Skeleton, settings: FusionSettings) -> Float64[np.ndarray, " joint"]:
    """Return the weight of the smoothing prior per joint, ``1 / sqrt(q knot^3)`` [1/m].

    Notes
    -----
    The acceleration of a uniform cubic B-spline at a knot is the second difference of its
    control points over ``knot^2``. White acceleration of density ``q`` over one knot has variance
    ``q / knot``, so a second difference has variance ``q knot^3`` (thesis eq. 49-58, where
    lambda has no unit).
    """

    def accel(joint: str) -> float:
        part = _part(joint)
        if part in _HEAD:
            return settings.accel_head
        if part in _ARM:
            return settings.accel_arm
        return settings.accel_leg if part in _LEG else settings.accel_torso

    root_q = np.array([accel(joint) for joint in skeleton.joints])
    return np.asarray(1.0 / (root_q * settings.knot_s**1.5))
