"""A simulated recording for tests of the calibration from people; made once for all of them."""

from dataclasses import replace
from functools import cache

import numpy as np

from trecsim.geometry import Rig
from trecsim.geometry.rigid import rotation_vector
from trecsim.lab.simulation import Simulation, room_scene, simulate
from trecsim.lab.simulation.camera_clocks import Clock
from trecsim.lab.simulation.detector_errors import CLOTHED
from trecsim.lab.simulation.failures import Knock

LATE_S = (3.1, -1.7, 0.4)


@cache
def recording(
    people: int = 2, seconds: float = 20.0, seed: int = 5, knocks: tuple[Knock, ...] = ()
) -> Simulation:
    """Return people who wander before three cameras whose clocks are wrong."""
    scene = room_scene(people=people, cameras=3, seconds=seconds)
    clocks = tuple(Clock(stamp_error_s=late) for late in LATE_S)
    return simulate(replace(scene, clocks=clocks, detector=CLOTHED, knocks=knocks), seed)


def turns_deg(rig: Rig, truth: Rig) -> np.ndarray:
    """Return how far each camera is turned, after the best common turn [degrees]."""
    R, Q = (np.array([one[name].T_cam_world[:3, :3] for name in rig.names]) for one in (rig, truth))
    left, _, right = np.linalg.svd(np.einsum("cji,cjk->ik", R, Q))
    common = left @ np.diag([1, 1, np.linalg.det(left @ right)]) @ right
    return np.degrees(
        [np.linalg.norm(rotation_vector(R[i] @ common @ Q[i].T)) for i in range(len(R))]
    )
