"""Who was at the site, as events list people."""

from typing import Any

import numpy as np
from jaxtyping import Float64

from trecsim.skeleton import COCO17
from trecsim.values import Snapshot

ANKLES = [COCO17.joints.index(f"{side}_ankle") for side in ("left", "right")]
HIPS = [COCO17.joints.index(f"{side}_hip") for side in ("left", "right")]
POSTURE = "unknown"  # until there are rules that tell it


def people_of(snapshot: Snapshot) -> list[dict[str, Any]]:
    """Return the confirmed people of a snapshot as events list them.

    The floor point is the mean of the ankles that a camera supports, or of the hips where none is.
    Its covariance takes the errors of both sides as independent; the speed is that of the hips over
    the floor. What is not known is None.
    """
    there = snapshot.confirmed()
    return [
        {
            "person": int(there.id[n]),
            **_floor(there, n),
            "speed_mps": _known(_speed_mps(there, n), 2),
            "posture": POSTURE,
        }
        for n in range(len(there.id))
    ]


def _floor(there: Snapshot, n: int) -> dict[str, Any]:
    joints = [joint for joint in ANKLES if there.support[n, joint] > 0] or HIPS
    xy_m = there.xyz_m[n, joints, :2].mean(axis=0)
    cov_m2 = there.cov_m2[n, joints, :2, :2].sum(axis=0) / len(joints) ** 2
    return {
        "floor_m": [_known(value, 3) for value in xy_m],
        "floor_cov_m2": [_known(cov_m2[i, j], 6) for i, j in ((0, 0), (0, 1), (1, 1))],
    }


def _speed_mps(there: Snapshot, n: int) -> float:
    velocity_mps: Float64[np.ndarray, 3] = there.velocity_mps[n, HIPS].mean(axis=0)
    return float(np.hypot(*velocity_mps[:2]))


def _known(value: float, decimals: int) -> float | None:
    return round(float(value), decimals) if np.isfinite(value) else None
