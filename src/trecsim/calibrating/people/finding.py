"""From 2D poses to a rig: the stages of the calibration from people, from top to bottom."""

from dataclasses import replace
from itertools import combinations

import numpy as np
from jaxtyping import Float64

from trecsim.calibrating.people.adjusting import adjusted
from trecsim.calibrating.people.body_pairs import BodyRelation
from trecsim.calibrating.people.body_start import start_by_bodies
from trecsim.calibrating.people.camera_records import CameraRecord
from trecsim.calibrating.people.chains import chains
from trecsim.calibrating.people.floor_tracks import floor_tracks
from trecsim.calibrating.people.found import Found, Relations
from trecsim.calibrating.people.lenses import with_lenses
from trecsim.calibrating.people.observations import observations
from trecsim.calibrating.people.pairs import relate
from trecsim.calibrating.people.priors import Distance, Priors, Upright
from trecsim.calibrating.people.state import RigState
from trecsim.calibrating.people.tracklets import Tracklet, tracklets
from trecsim.calibrating.people.tree import joined
from trecsim.calibrating.people.tuning import (
    ANNEALING,
    BODY_TILT_RAD,
    LOOSER,
    REFIT_CLOCK,
)
from trecsim.calibrating.people.uprights import Level, level
from trecsim.calibrating.people.variances import with_own_variances
from trecsim.calibrating.people.world import bodies, lowered

COARSE = ANNEALING[:-2]
FINE = (2.0, 1.0)


def start(
    records: tuple[CameraRecord, ...],
) -> tuple[list[Tracklet], tuple[Level | None, ...], Relations, RigState]:
    """Return tracklets, levels, relations, and the rig before the adjustment.

    Tracks on the floor give lags of many seconds, and match many people. If nobody walks far
    enough for that, bodies relate the cameras, provided that the clocks nearly agree.
    """
    per_camera = [tracklets(record, c) for c, record in enumerate(records)]
    levels = tuple(level(record, own) for record, own in zip(records, per_camera, strict=True))
    floors = {
        c: floor_tracks(records[c], per_camera[c], one.T_level_cam)
        for c, one in enumerate(levels)
        if one is not None
    }
    by_floor = tuple(
        found
        for a, b in combinations(floors, 2)
        if (found := relate(a, b, floors[a], floors[b])) is not None
    )
    relations: Relations = by_floor
    state = joined(levels, by_floor)
    if not state.found.any():
        relations, state = start_by_bodies(records, per_camera)
    ref_s = np.array([middle_s(record) for record in records])
    return [one for own in per_camera for one in own], levels, relations, referred(state, ref_s)


def middle_s(record: CameraRecord) -> float:
    """Return the middle of a camera's recording [s]."""
    return 0.5 * float(record.t_s[0] + record.t_s[-1]) if len(record.t_s) else 0.0


def referred(state: RigState, ref_s: Float64[np.ndarray, " cam"]) -> RigState:
    """Return the state with the stamps from which on drifts count."""
    return replace(state, ref_s=ref_s)


def find(
    records: tuple[CameraRecord, ...],
    *,
    distance: Distance | None = None,
) -> Found | None:
    """Return the rig that a recording shows; None if no two cameras could be related.

    Focal lengths and principal points are kept unless the people clearly contradict them; then
    those of all cameras are refined with a prior about what was given.
    """
    tracks, levels, relations, state = start(records)
    if state.found.sum() < 2:
        return None
    priors = Priors(_root(state, relations), (distance or _longest(state),), state.found)
    state = scaled_to(state, priors.distances[0])
    by_floor = not any(isinstance(one, BodyRelation) for one in relations)
    if not by_floor:
        upright = Upright(state.T[priors.root, :3, 2], BODY_TILT_RAD)
        priors = replace(priors, clock_sd=REFIT_CLOCK, upright=upright)
        chain = chains(tracks, records, state, by_rays=True, by_floor=False, looser=LOOSER)
        seen = observations(tracks, records, chain, state)
    else:
        chain = chains(tracks, records, state, by_rays=False)
        seen = observations(tracks, records, chain, state, spacing_s=0.6)
    if not seen.count:
        return None
    rig = adjusted(seen, state, priors, annealing=COARSE)
    state = lowered(rig.state, bodies(seen, rig.unknowns).ankle_m)
    chain = chains(tracks, records, state, by_rays=True, by_floor=by_floor)
    seen = observations(tracks, records, chain, state)
    if not seen.count:
        return None
    rig = adjusted(seen, state, priors, annealing=FINE)
    again = observations(tracks, records, chain, rig.state)
    seen = with_own_variances(seen, rig, again, least=1.0)
    rig = adjusted(seen, rig.state, priors, annealing=(1.0,))
    return with_lenses(Found(tracks, chain, levels, relations, seen, rig, priors), records)


def _root(state: RigState, relations: Relations) -> int:
    score = np.zeros(len(state.found))
    for one in relations:
        score[[one.a, one.b]] += one.score
    return int(np.argmax(np.where(state.found, score, -1.0)))


def _longest(state: RigState) -> Distance:
    """Return the distance of the two cameras that stand furthest apart, as it is now."""
    centre, known = state.centre_m, np.flatnonzero(state.found)
    pairs = list(combinations(known, 2))
    a, b = max(pairs, key=lambda pair: np.linalg.norm(centre[pair[0]] - centre[pair[1]]))
    metres = float(np.linalg.norm(centre[a] - centre[b]))
    return Distance(int(a), int(b), metres, 1e-4 * metres)


def scaled_to(state: RigState, one: Distance) -> RigState:
    """Return the rig with all distances changed by the factor that makes one right."""
    centre = state.centre_m
    factor = one.metres / float(np.linalg.norm(centre[one.a] - centre[one.b]))
    changed = state.copy()
    changed.T[:, :3, 3] *= factor
    return changed
