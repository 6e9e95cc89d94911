"""Clocks of cameras whose poses are known: the lags that bring their floor tracks together."""

from itertools import combinations

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.calibrating.people.camera_records import CameraRecord
from trecsim.calibrating.people.floor_tracks import floor_tracks
from trecsim.calibrating.people.pairs import Relation, relate
from trecsim.calibrating.people.state import RigState
from trecsim.calibrating.people.tracklets import Tracklet
from trecsim.calibrating.people.tuning import ANKLE, CLEAR_LAG_S, STATURE_M
from trecsim.geometry.rigid import inverse


def lag_relations(
    recorded: tuple[CameraRecord, ...],
    tracks: list[Tracklet],
    state: RigState,
    longest_s: float,
) -> list[Relation]:
    """Return the lags of all pairs of cameras that see the same people, clocks as in `state`."""
    floors = {}
    for c in np.flatnonzero(state.found):
        own = [
            Tracklet(one.camera, one.detections, state.time_s(int(c), one.t_s))
            for one in tracks
            if one.camera == c
        ]
        T = inverse(state.T[c])
        T[2, 3] -= ANKLE * STATURE_M
        floors[int(c)] = floor_tracks(recorded[c], own, T)
    found = [
        relate(a, b, floors[a], floors[b], turns=False, longest_s=longest_s)
        for a, b in combinations(floors, 2)
    ]
    return [one for one in found if one is not None]


def lags(
    relations: list[Relation], cameras: int
) -> tuple[Float64[np.ndarray, " cam"], Int64[np.ndarray, " cam"]]:
    """Return what is to be added to each clock [s], along the best relations, and the group.

    Returns
    -------
    Lags, and the number of the first camera of each camera's group: others are not related to it.
    """
    lag, group = np.zeros(cameras), np.arange(cameras)
    for one in sorted(relations, key=lambda one: -one.score):
        if group[one.a] == group[one.b]:
            continue
        joining = group == group[one.b]
        lag[joining] += lag[one.a] + one.lag_s - lag[one.b]
        group[joining] = group[one.a]
    return lag, group


def with_lags(
    recorded: tuple[CameraRecord, ...],
    tracks: list[Tracklet],
    state: RigState,
    longest_s: float,
) -> RigState:
    """Return the rig with clocks that are clearly wrong put right to a tenth of a second."""
    lag, _ = lags(lag_relations(recorded, tracks, state, longest_s), len(recorded))
    lag -= np.median(lag)
    changed = state.copy()
    changed.clock[:, 0] += np.where(np.abs(lag) > CLEAR_LAG_S, lag, 0.0)
    return changed
