"""How cameras that were calibrated stand now: their poses and clocks refitted to people."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float64, Int64

from trecsim.calibrating.people.adjusting import Adjusted, adjusted
from trecsim.calibrating.people.agreeing import dense, most_that_agree
from trecsim.calibrating.people.camera_records import CameraRecord
from trecsim.calibrating.people.chains import chains
from trecsim.calibrating.people.lags import with_lags
from trecsim.calibrating.people.observations import Observations, observations
from trecsim.calibrating.people.priors import WITHOUT_LENS, Priors, pose_change
from trecsim.calibrating.people.state import RigState
from trecsim.calibrating.people.tracklets import Tracklet, tracklets
from trecsim.calibrating.people.tuning import (
    AGREE_DEG,
    FAR_LAG_S,
    KNOCK_SHIFT_M,
    KNOCK_TURN_DEG,
    LATE_S,
    LOOSER,
    REFIT_CLOCK,
    REFIT_SAMPLE_S,
    REFIT_SAMPLES,
    STAY_SHIFT_M,
    STAY_TURN_DEG,
)
from trecsim.calibrating.people.variances import with_own_variances
from trecsim.geometry import Rig

UNKNOWN_LEVEL_M2 = 1e4  # the old rig says where up is


@dataclass(frozen=True, slots=True, eq=False)
class Watched:
    """A recording beside a rig.

    Attributes
    ----------
    records, tracks, chain
        What the cameras saw, tracklets, and whose they are.
    state
        The rig as given.
    begin
        The same with clocks that are far off put right to a tenth of a second.
    """

    records: tuple[CameraRecord, ...]
    tracks: list[Tracklet]
    chain: Int64[np.ndarray, " tracklet"]
    state: RigState
    begin: RigState

    @property
    def span_s(self) -> tuple[float, float]:
        """From when to when two cameras see people [s]."""
        times = [
            self.begin.time_s(one.camera, one.t_s[[0, -1]])
            for one, person in zip(self.tracks, self.chain, strict=True)
            if person >= 0
        ]
        return (min(t[0] for t in times), max(t[1] for t in times)) if times else (0.0, 0.0)


@dataclass(frozen=True, slots=True, eq=False)
class Refit:
    """A rig refitted to a part of a recording.

    Attributes
    ----------
    seen, rig, own
        What was adjusted, the result, and how many unknowns each camera has.
    turn_deg, shift_m, late_s
        Of each camera, by how much it is off its given pose and clock, and
    view_deg
        by how much the people in its image are; NaN where it sees nobody.
    agrees
        Which cameras agree with each other as given.
    """

    seen: Observations
    rig: Adjusted
    own: int
    turn_deg: Float64[np.ndarray, " cam"]
    shift_m: Float64[np.ndarray, " cam"]
    late_s: Float64[np.ndarray, " cam"]
    view_deg: Float64[np.ndarray, " cam"]
    agrees: Bool[np.ndarray, " cam"]


def given(rig: Rig) -> RigState:
    """Return the state of a rig as its file has it."""
    state = RigState.empty(len(rig))
    for c, camera in enumerate(rig):
        state.T[c] = camera.T_cam_world
        state.clock[c] = camera.time_offset_s, 1e-6 * camera.time_drift_ppm
        state.ref_s[c] = camera.time_ref_s
        state.found[c] = True
    return state


def watched(recorded: tuple[CameraRecord, ...], state: RigState) -> Watched:
    """Return who is who in a recording, by a rig that may be a little wrong.

    Drifts count from the middle of the recording on: far from where they count from, an offset that
    is found says nothing of the clock here, as a drift undoes it.
    """
    state = state.referred(np.array([
        0.5 * (r.t_s[0] + r.t_s[-1]) if len(r.t_s) else ref_s
        for r, ref_s in zip(recorded, state.ref_s, strict=True)
    ]))  # fmt: skip
    tracks = [one for c, record in enumerate(recorded) for one in tracklets(record, c)]
    lagged = with_lags(recorded, tracks, state, FAR_LAG_S)
    chain = chains(tracks, recorded, lagged, by_rays=True, looser=LOOSER)
    return Watched(recorded, tracks, chain, state, lagged)


def refit(
    scene: Watched, between: tuple[float, float] = (-np.inf, np.inf), start: RigState | None = None
) -> Refit | None:
    """Return how the cameras stand in a part of a recording; None if too little is seen there.

    Parameters
    ----------
    scene
        The recording.
    between
        The part [s].
    start
        Where to begin; None begins at the given rig, where the cameras are drawn to in any case.
    """
    low, high = scene.span_s
    seconds = min(high, between[1]) - max(low, between[0])
    spacing_s = max(REFIT_SAMPLE_S, seconds / REFIT_SAMPLES)
    begin = start or scene.begin
    seen = observations(
        scene.tracks, scene.records, scene.chain, begin, spacing_s=spacing_s, between=between
    )
    if seen.count < 200:
        return None
    seen = replace(
        seen,
        sights=seen.sights._replace(
            level_m2=np.full_like(seen.sights.level_m2, UNKNOWN_LEVEL_M2)
        ),
    )  # fmt: skip
    known = np.isin(np.arange(len(scene.records)), seen.sights.cam)
    agree = most_that_agree(dense(seen, len(known)), scene.state.T, AGREE_DEG)
    sd = np.tile([np.radians(KNOCK_TURN_DEG), KNOCK_SHIFT_M], (len(known), 1))
    sd[list(agree)] = np.radians(STAY_TURN_DEG), STAY_SHIFT_M
    root = int(np.flatnonzero(known)[0])
    firm = np.isin(np.arange(len(known)), agree)
    priors = Priors(
        root, (), known, pose=scene.state.T, pose_sd=sd, firm=firm, clock_sd=REFIT_CLOCK
    )
    begin = replace(begin, found=known)
    rig = adjusted(seen, begin, priors, annealing=(3.0, 1.5, 1.0))
    seen = with_own_variances(seen, rig)
    rig = adjusted(seen, begin, priors, annealing=(1.0,), start=rig.unknowns)
    return _told(scene, seen, rig, agree)


def _told(scene: Watched, seen: Observations, rig: Adjusted, agree: tuple[int, ...]) -> Refit:
    n = len(scene.records)
    changes = [pose_change(scene.state.T[c], rig.state.T[c]) for c in range(n)]
    centre_m = rig.state.centre_m - scene.state.centre_m
    late = rig.state.clock[:, 0] - scene.state.clock[:, 0]
    late -= _of_most(late[rig.state.found])
    view = np.array([_in_view(scene.state, seen, rig, c) for c in range(n)])
    return Refit(
        seen,
        rig,
        WITHOUT_LENS,
        np.degrees([np.linalg.norm(turn) for turn, _ in changes]),
        np.linalg.norm(centre_m, axis=1),
        late,
        view,
        np.isin(np.arange(n), agree),
    )


def _of_most(late_s: Float64[np.ndarray, " cam"]) -> float:
    """Return the lateness on which most clocks agree [s]: few are wrong at a time."""
    near = np.abs(late_s[:, None] - late_s[None, :]) < LATE_S / 2
    best = int(np.argmax(near.sum(axis=1)))
    return float(late_s[near[best]].mean())


def _in_view(state: RigState, seen: Observations, rig: Adjusted, c: int) -> float:
    """Return by how much a camera's people are off in its view, median over the key points."""
    points = np.repeat(np.arange(len(seen.sights.block)), np.diff(seen.sights.first))
    own = points[seen.sights.cam == c]
    if not len(own):
        return float("nan")
    xyz_m = rig.unknowns.xyz_m[own]
    before, after = (_rays(xyz_m, T[c]) for T in (state.T, rig.state.T))
    return float(np.degrees(np.median(np.linalg.norm(after - before, axis=1))))


def _rays(
    xyz_m: Float64[np.ndarray, "point 3"], T: Float64[np.ndarray, "4 4"]
) -> Float64[np.ndarray, "point 3"]:
    """Return the directions in which a camera sees points."""
    there = xyz_m @ T[:3, :3].T + T[:3, 3]
    rays: Float64[np.ndarray, "point 3"] = there / np.linalg.norm(there, axis=1)[:, None]
    return rays
