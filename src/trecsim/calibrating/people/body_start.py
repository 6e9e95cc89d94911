"""The first rig from bodies alone: a spanning tree over the relations of pairs of cameras."""

from itertools import combinations

import numpy as np

from trecsim.calibrating.people.body_pairs import (
    BodyRelation,
    relate_by_bodies,
    reversed_relation,
)
from trecsim.calibrating.people.camera_records import CameraRecord
from trecsim.calibrating.people.state import RigState
from trecsim.calibrating.people.tracklets import Tracklet


def start_by_bodies(
    records: tuple[CameraRecord, ...], per_camera: list[list[Tracklet]]
) -> tuple[tuple[BodyRelation, ...], RigState]:
    """Return the relations by bodies, and the rig; cameras without a relation are not found."""
    relations = tuple(
        found
        for a, b in combinations(range(len(records)), 2)
        if (found := relate_by_bodies(a, b, per_camera[a], per_camera[b], records)) is not None
    )
    return relations, joined_by_bodies(len(records), relations)


def joined_by_bodies(cameras: int, relations: tuple[BodyRelation, ...]) -> RigState:
    """Return poses and offsets along the spanning tree of the best relations.

    The frame is upright, its origin below the camera that agrees best with the others, at the
    height of the ankles.
    """
    state = RigState.empty(cameras)
    if not relations:
        return state
    score = np.zeros(cameras)
    for one in relations:
        score[[one.a, one.b]] += one.score
    root = int(np.argmax(score))
    both = [*relations, *(reversed_relation(one) for one in relations)]
    own = [one for one in both if one.a == root]
    up = np.sum([one.score * one.up for one in own], axis=0)
    up /= np.linalg.norm(up)
    state.T[root, :3, :3] = _upright(up)
    state.T[root, :3, 3] = up * float(np.median([up @ one.ankles_m for one in own]))
    state.found[root] = True
    while True:
        edges = [one for one in both if state.found[one.a] and not state.found[one.b]]
        if not edges:
            return state
        best = max(edges, key=lambda one: one.score)
        state.T[best.b] = best.T_b_a @ state.T[best.a]
        state.clock[best.b, 0] = state.clock[best.a, 0] + best.lag_s
        state.found[best.b] = True


def _upright(up: np.ndarray) -> np.ndarray:
    """Return the rotation from an upright frame to a camera in which `up` is the vertical."""
    ahead = np.array([0.0, 0.0, 1.0]) - up[2] * up
    if np.linalg.norm(ahead) < 0.05:
        ahead = np.array([0.0, -1.0, 0.0]) + up[1] * up
    ahead /= np.linalg.norm(ahead)
    return np.stack((ahead, np.cross(up, ahead), up), axis=1)
