"""The first rig: cameras joined one after the other by the relations of their floors."""

from collections.abc import Sequence

import numpy as np

from trecsim.calibrating.people.pairs import Relation
from trecsim.calibrating.people.state import RigState
from trecsim.calibrating.people.uprights import Level
from trecsim.geometry.rigid import inverse


def joined(levels: Sequence[Level | None], relations: Sequence[Relation]) -> RigState:
    """Return poses and offsets along the spanning tree of the best relations.

    The frame is the level frame of the camera that agrees best with the others. Cameras that no
    relation reaches are not found.
    """
    n = len(levels)
    state = RigState.empty(n)
    score = np.zeros(n)
    for one in relations:
        score[[one.a, one.b]] += one.score
    root = int(np.argmax(score))
    if not relations or score[root] == 0.0:
        return state
    motion: dict[int, np.ndarray] = {root: np.eye(4)}
    offset = {root: 0.0}
    while True:
        edges = [one for one in relations if (one.a in motion) != (one.b in motion)]
        if not edges:
            break
        best = max(edges, key=lambda one: one.score)
        T_a_b = _motion(best)
        if best.a in motion:
            motion[best.b] = motion[best.a] @ T_a_b
            offset[best.b] = offset[best.a] + best.lag_s
        else:
            motion[best.a] = motion[best.b] @ inverse(T_a_b)
            offset[best.a] = offset[best.b] - best.lag_s
    for camera, T in motion.items():
        own = levels[camera]
        assert own is not None
        T_cam_world = inverse(T @ own.T_level_cam)
        state.T[camera], state.clock[camera, 0] = T_cam_world, offset[camera]
        state.found[camera] = True
    return state


def _motion(one: Relation) -> np.ndarray:
    T = np.eye(4)
    c, s = np.cos(one.angle_rad), np.sin(one.angle_rad)
    T[:2, :2] = [[c, -s], [s, c]]
    T[:2, 3] = one.shift_m
    return T
