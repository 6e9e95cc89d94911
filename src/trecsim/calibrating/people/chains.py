"""Who is who: tracklets of all cameras, in chains of one person each."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.calibrating.people.body_sizes import size_of_body
from trecsim.calibrating.people.camera_records import CameraRecord
from trecsim.calibrating.people.floor_tracks import floor_positions, on_grid
from trecsim.calibrating.people.kernels.matching_rays import ray_distances
from trecsim.calibrating.people.state import RigState
from trecsim.calibrating.people.tracklets import Tracklet
from trecsim.calibrating.people.tuning import (
    CHAIN_FLOOR_M,
    CHAIN_OVERLAP_S,
    CHAIN_RAY_M,
    TICK_S,
)
from trecsim.geometry.rigid import inverse

LARGEST = 1.8  # bodies larger than the usual one by this factor, or smaller, are no single person
UNEQUAL = 0.35  # standard deviation of the logarithm of a body's size; chance matches have any size
OVERLAPPING_S = 0.15  # tracklets of one camera may have so much in common and be one person


@dataclass(frozen=True, slots=True, eq=False)
class Candidate:
    """Two tracklets of different cameras that may be the same person.

    Attributes
    ----------
    first, second
        Numbers of the tracklets.
    apart_m, common_s
        How far apart they are [m], over how much time in common [s].
    unequal
        Logarithm of the ratio of the body that both triangulate to the usual size.
    """

    first: int
    second: int
    apart_m: float
    common_s: float
    unequal: float = 0.0


def chains(
    tracks: list[Tracklet],
    records: tuple[CameraRecord, ...],
    state: RigState,
    *,
    by_rays: bool,
    by_floor: bool = True,
    looser: float = 1.0,
) -> Int64[np.ndarray, " tracklet"]:
    """Return the number of each tracklet's person; -1 for those whom no second camera sees.

    Parameters
    ----------
    tracks
        Tracklets of all cameras.
    records, state
        What the cameras saw, and how they stand.
    by_rays
        Whether viewing rays of all joints must meet, in a body of usual size.
    by_floor
        Whether positions on the floor must agree; False if the floor is hardly known.
    looser
        By how much the limits grow, for a rig that may be wrong.
    """
    known = [k for k, track in enumerate(tracks) if state.found[track.camera]]
    places = {k: _places(tracks[k], records, state) for k in known}
    found = []
    scale = looser * (CHAIN_RAY_M if by_rays else CHAIN_FLOOR_M)
    floor_m = looser * CHAIN_FLOOR_M * (2.0 if by_rays else 1.0) if by_floor else np.inf
    for i, a in enumerate(known):
        for b in known[i + 1 :]:
            if tracks[a].camera == tracks[b].camera:
                continue
            apart_m, common_s = apart_on_floor(places[a], places[b])
            if common_s < CHAIN_OVERLAP_S or not apart_m <= floor_m:
                continue
            unequal = 0.0
            if by_rays:
                apart_m, unequal = _rays_apart(tracks[a], tracks[b], records, state)
            if apart_m < scale and abs(unequal) < np.log(LARGEST):
                found.append(Candidate(a, b, apart_m, common_s, unequal))
    found.sort(key=lambda one: _doubt(one, scale))
    return _merged(tracks, found, state)


def _doubt(one: Candidate, scale_m: float) -> float:
    """Return a cost of taking two tracklets for one person."""
    return (
        one.apart_m / scale_m
        + 0.5 / float(np.sqrt(one.common_s))
        + 0.5 * (one.unequal / UNEQUAL) ** 2
    )


Places = tuple[int, Float64[np.ndarray, "..."]]


def _places(track: Tracklet, records: tuple[CameraRecord, ...], state: RigState) -> Places:
    """Return where a tracklet walks, on the grid of common time."""
    camera = track.camera
    xy_m = floor_positions(records[camera].xy[track.detections], inverse(state.T[camera]))
    return on_grid(state.time_s(camera, track.t_s), xy_m)


def apart_on_floor(one: Places, other: Places) -> tuple[float, float]:
    """Return the median distance of two ways [m], and how long both are known [s]."""
    start = max(one[0], other[0])
    stop = min(one[0] + len(one[1]), other[0] + len(other[1]))
    if stop - start < 2:
        return np.inf, 0.0
    p, q = one[1][start - one[0] : stop - one[0]], other[1][start - other[0] : stop - other[0]]
    return float(np.median(np.hypot(*(p - q).T))), (stop - start) * TICK_S


def _rays_apart(
    a: Tracklet, b: Tracklet, records: tuple[CameraRecord, ...], state: RigState
) -> tuple[float, float]:
    """Return the distance of the joints' viewing rays [m], and the logarithm of the body's size.

    The distance is the median over time of the median over the joints; the size is relative to the
    usual one.
    """
    t_a, t_b = state.time_s(a.camera, a.t_s), state.time_s(b.camera, b.t_s)
    at = np.searchsorted(t_b, t_a)
    at = np.clip(at, 1, len(t_b) - 1)
    at -= t_a - t_b[at - 1] < t_b[at] - t_a
    near = np.flatnonzero(np.abs(t_b[at] - t_a) < TICK_S)
    near = near[:: max(1, len(near) // 60)]
    if not len(near):
        return np.inf, 0.0
    distance = np.full(len(near), np.nan)
    T_a, T_b = (np.ascontiguousarray(state.T[one.camera]) for one in (a, b))
    xy_a, xy_b = records[a.camera].xy, records[b.camera].xy
    of_a, of_b = a.detections[near], b.detections[at[near]]
    ray_distances(T_a, T_b, xy_a, xy_b, of_a, of_b, distance)
    known = np.isfinite(distance)
    if known.sum() < 3:
        return np.inf, 0.0
    size = size_of_body(xy_a[of_a], xy_b[of_b], T_a, T_b)
    return float(np.median(distance[known])), float(np.log(size)) if size > 0.0 else 0.0


def _merged(
    tracks: list[Tracklet], found: list[Candidate], state: RigState
) -> Int64[np.ndarray, " tracklet"]:
    """Join tracklets, the surest first, unless somebody would be twice in one image."""
    member = {k: [k] for one in found for k in (one.first, one.second)}
    chain = {k: k for k in member}
    span = {k: state.time_s(tracks[k].camera, tracks[k].t_s[[0, -1]]) for k in member}
    for one in found:
        a, b = chain[one.first], chain[one.second]
        if a == b or any(_clash(tracks, span, p, q) for p in member[a] for q in member[b]):
            continue
        for k in member[b]:
            chain[k] = a
        member[a] += member.pop(b)
    number = np.full(len(tracks), -1, dtype=np.int64)
    several = [own for own in member.values() if len({tracks[k].camera for k in own}) > 1]
    for person, own in enumerate(several):
        number[own] = person
    return number


def _clash(
    tracks: list[Tracklet], span: dict[int, Float64[np.ndarray, " 2"]], p: int, q: int
) -> bool:
    if tracks[p].camera != tracks[q].camera:
        return False
    common = min(span[p][1], span[q][1]) - max(span[p][0], span[q][0])
    return bool(common > OVERLAPPING_S)
