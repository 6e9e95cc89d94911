"""What is known about a body before it is seen: which joints bend how fast, usual limb lengths."""

import numpy as np
from jaxtyping import Float64

from trecsim.fusion.settings import FusionSettings
from trecsim.skeleton import Skeleton

# Usual lengths of an adult's limbs [m], to tell a person from a chance meeting of rays; the
# spread allowed for covers children and tall people.
_USUAL_LIMB_M = {
    frozenset(("shoulder",)): 0.34,
    frozenset(("hip",)): 0.24,
    frozenset(("shoulder", "elbow")): 0.28,
    frozenset(("elbow", "wrist")): 0.25,
    frozenset(("shoulder", "hip")): 0.50,
    frozenset(("hip", "knee")): 0.42,
    frozenset(("knee", "ankle")): 0.41,
}

_HEAD = ("nose", "eye", "ear")
_ARM = ("elbow", "wrist")
_LEG = ("knee", "ankle")

# Error of a detector relative to body height, per joint and axis, measured on OpenPose
# detections of the Shelf sequence, set in relation to their mean.
_RELATIVE_SIGMA = {
    "ankle": 0.0135,
    "knee": 0.0175,
    "hip": 0.019,
    "wrist": 0.013,
    "elbow": 0.0105,
    "shoulder": 0.0145,
}


def _part(joint: str) -> str:
    return joint.rpartition("_")[2]


def usual_limbs(skeleton: Skeleton) -> tuple[list[tuple[int, int]], Float64[np.ndarray, " limb"]]:
    """Return the limbs of `skeleton` whose usual length is known, and those lengths [m]."""
    pairs, lengths = [], []
    for a, b in skeleton.limbs:
        key = frozenset((_part(skeleton.joints[a]), _part(skeleton.joints[b])))
        if key in _USUAL_LIMB_M:
            pairs.append((a, b))
            lengths.append(_USUAL_LIMB_M[key])
    return pairs, np.array(lengths)


def key_point_sigma_m(
    skeleton: Skeleton, settings: FusionSettings
) -> Float64[np.ndarray, " joint"]:
    """Return each joint's key-point noise as a length at the person's distance [m]."""
    mean = sum(_RELATIVE_SIGMA.values()) / len(_RELATIVE_SIGMA)
    return np.array(
        [
            settings.joint_sigma_m * _RELATIVE_SIGMA.get(_part(joint), mean) / mean
            for joint in skeleton.joints
        ]
    )


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
