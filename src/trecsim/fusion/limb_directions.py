"""The distribution of the directions of limbs: a knee bends backwards, an elbow forwards."""

from typing import NamedTuple

import numpy as np

from trecsim.fusion.kernels import Postures
from trecsim.skeleton import Skeleton

_TRUNK = ("left_hip", "right_hip", "left_shoulder", "right_shoulder")


class _Directions(NamedTuple):
    """The mean direction of a limb, times its concentration, forwards, outwards and up.

    `by_upper` is what the direction of the limb above adds: a row for each of these, columns are
    the upper limb's.
    """

    mean: tuple[float, ...]
    by_upper: tuple[tuple[float, ...], ...] = ((0.0,) * 3,) * 3


# Fitted to recorded motion (``benchmarks/posture_fit.py``: 17 clips of DeepMimic, MIT: walks, runs,
# dances, kicks, lying down and getting up), so that the true place of a limb's end is likelier than
# the other one on the ray of a camera anywhere around the person.
_LIMBS = {
    ("hip", "knee"): _Directions((1.4, 0.3, -2.8)),
    ("shoulder", "elbow"): _Directions((0.0, 1.6, -3.0)),
    ("hip", "knee", "ankle"): _Directions(
        (-0.4, -0.2, -2.5), ((0.4, -0.1, 0.7), (-0.1, 0.0, -0.1), (-1.0, 0.0, 1.7))
    ),
    ("shoulder", "elbow", "wrist"): _Directions(
        (1.2, 0.2, -1.7), ((1.0, 0.8, -0.5), (-0.8, 0.3, -0.1), (0.7, -0.3, 1.9))
    ),
}


def postures(skeleton: Skeleton) -> Postures:
    """Return what is known of a skeleton's limbs; nothing, if it has no hips or shoulders."""
    names = skeleton.joints
    trunk = [names.index(joint) for joint in _TRUNK if joint in names]
    limbs = [
        (side, chain)
        for chain in _LIMBS
        for side in ("left", "right")
        if len(trunk) == len(_TRUNK) and all(f"{side}_{part}" in names for part in chain)
    ]
    ends = [[names.index(f"{side}_{part}") for part in reversed(chain)] for side, chain in limbs]
    known = [_LIMBS[chain] for _, chain in limbs]
    return Postures(
        np.array(trunk if limbs else [], np.int64),
        np.array([(*end, end[-1])[:3] for end in ends], np.int64).reshape(-1, 3),
        np.array([0 if chain[0] == "hip" else 2 for _, chain in limbs], np.int64),
        np.array([1.0 if side == "left" else -1.0 for side, _ in limbs]),
        np.array([one.mean for one in known]).reshape(-1, 3),
        np.array([one.by_upper for one in known]).reshape(-1, 3, 3),
    )
