"""The joints and limbs that benchmarks judge: arms, legs and trunk, not the face.

The joints of a face lie 5 cm apart, within two errors of a detector.
"""

from trecsim.skeleton import COCO17

LIMB_JOINTS = [
    i for i, name in enumerate(COCO17.joints) if not name.endswith(("nose", "eye", "ear"))
]
LIMBS = [limb for limb in COCO17.limbs if set(limb) <= set(LIMB_JOINTS)]
"""Pairs of joints."""
