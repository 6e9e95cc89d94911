"""From chains of tracklets to observations: every joint of every person at evenly spaced times."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.calibrating.people.camera_records import JOINTS, CameraRecord
from trecsim.calibrating.people.kernels.sampling import sample
from trecsim.calibrating.people.kernels.starting import meet
from trecsim.calibrating.people.kernels.unknowns import Sights, Unknowns
from trecsim.calibrating.people.state import RigState
from trecsim.calibrating.people.tracklets import Tracklet
from trecsim.calibrating.people.tuning import (
    BIAS_M,
    FEWEST_SAMPLES,
    KNOT_S,
    LEVEL_M,
    MOST_SAMPLES,
    NOISE_M,
    REFIT_SAMPLE_S,
    SAMPLE_S,
)


@dataclass(frozen=True, slots=True, eq=False)
class Observations:
    """What is adjusted.

    Attributes
    ----------
    sights
        As the kernels take it.
    person, joint
        Of each series.
    t_s
        Common time of each point [s].
    """

    sights: Sights
    person: Int64[np.ndarray, " series"]
    joint: Int64[np.ndarray, " series"]
    t_s: Float64[np.ndarray, " point"]

    @property
    def count(self) -> int:
        """How many observations there are."""
        return len(self.sights.cam)


def observations(
    tracks: list[Tracklet],
    records: tuple[CameraRecord, ...],
    chain: Int64[np.ndarray, " tracklet"],
    state: RigState,
    *,
    spacing_s: float | None = None,
    between: tuple[float, float] = (-np.inf, np.inf),
) -> Observations:
    """Return the key points of all people at evenly spaced times, where two cameras see them.

    Parameters
    ----------
    tracks, records, chain, state
        Tracklets, what the cameras saw, the person of each tracklet, and the cameras' clocks.
    spacing_s
        Distance of the times [s]; None takes that of `spacing`.
    between
        Only times in this range are taken [s].
    """
    spacing_s = spacing_s or spacing(tracks, chain, state)
    n_cam, people = len(records), int(chain.max(initial=-1)) + 1
    parts: list[Sampled] = []
    for person in range(people):
        own = [tracks[k] for k in np.flatnonzero(chain == person)]
        parts.append(_sampled(own, records, state, spacing_s, between))
    return _flat(parts, records, n_cam)


def spacing(
    tracks: list[Tracklet], chain: Int64[np.ndarray, " tracklet"], state: RigState
) -> float:
    """Return the spacing of the moments that are used [s]: wider for long recordings."""
    total_s = 0.0
    for person in range(int(chain.max(initial=-1)) + 1):
        own = [tracks[k] for k in np.flatnonzero(chain == person)]
        span = [state.time_s(one.camera, one.t_s[[0, -1]]) for one in own]
        if span:
            total_s += max(s[1] for s in span) - min(s[0] for s in span)
    return max(
        float(np.clip(total_s / FEWEST_SAMPLES, REFIT_SAMPLE_S, SAMPLE_S)), total_s / MOST_SAMPLES
    )


Sampled = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]


def _sampled(
    own: list[Tracklet],
    records: tuple[CameraRecord, ...],
    state: RigState,
    spacing_s: float,
    between: tuple[float, float],
) -> Sampled:
    """Return times, places, speeds and stamps since the reference of one person."""
    span = [state.time_s(one.camera, one.t_s[[0, -1]]) for one in own] or [np.zeros(2)]
    first = int(np.ceil(max(min(s[0] for s in span), between[0]) / spacing_s))
    last = int(np.floor(min(max(s[1] for s in span), between[1]) / spacing_s))
    t_s = np.arange(first, max(last, first - 1) + 1) * spacing_s
    n_cam = len(records)
    z = np.full((n_cam, len(t_s), JOINTS, 2), np.nan)
    speed, ahead = np.full(z.shape, np.nan), np.zeros((n_cam, len(t_s)))
    for c in range(n_cam):
        ahead[c] = state.stamp_s(c, t_s) - state.ref_s[c]
    for one in own:
        c, record = one.camera, records[one.camera]
        low, high = np.searchsorted(t_s, state.time_s(c, one.t_s[[0, -1]]))
        if high <= low:
            continue
        stamps_s = ahead[c, low:high] + state.ref_s[c]
        place, pace = np.empty((high - low, JOINTS, 2)), np.empty((high - low, JOINTS, 2))
        detections = one.detections
        sample(one.t_s, record.xy[detections], record.size[detections], stamps_s, place, pace)
        new = np.isnan(z[c, low:high])
        z[c, low:high] = np.where(new, place, z[c, low:high])
        speed[c, low:high] = np.where(new, pace, speed[c, low:high])
    return t_s, z, speed, ahead


def _flat(parts: list[Sampled], records: tuple[CameraRecord, ...], n_cam: int) -> Observations:
    person, joint, points_of, blocks_of = [], [], [], []
    t_all, gap, block, count = [], [], [], []
    cam, z_all, speed_all, ahead_all = [], [], [], []
    blocks = 0
    for number, (t_s, z, speed, ahead) in enumerate(parts):
        seen = np.asarray(np.isfinite(z + speed).all(axis=-1))  # cam time joint
        enough = np.asarray(seen.sum(axis=0) >= 2)
        for j in range(JOINTS):
            at = np.flatnonzero(enough[:, j])
            if len(at) < 3:
                continue
            which, c = np.nonzero(seen[:, at, j].T)
            rows = at[which]
            knot = np.floor(t_s[at] / KNOT_S)
            starts = np.flatnonzero(np.diff(knot, prepend=-np.inf))
            middle = (knot[starts] + 0.5) * KNOT_S
            person.append(number)
            joint.append(j)
            points_of.append(len(at))
            blocks_of.append(len(starts))
            t_all.append(t_s[at])
            gap.append(np.diff(middle, prepend=middle[0]))
            block.append(blocks + np.searchsorted(starts, np.arange(len(at)), side="right") - 1)
            blocks += len(starts)
            count.append(np.bincount(which, minlength=len(at)))
            cam.append(c)
            z_all.append(z[c, rows, j])
            speed_all.append(speed[c, rows, j])
            ahead_all.append(ahead[c, rows])
    joints = np.array(joint, dtype=np.int64)
    sights = Sights(
        _starts(points_of),
        _starts(blocks_of),
        NOISE_M[joints] ** 2,
        BIAS_M[joints] ** 2,
        LEVEL_M[joints] ** 2,
        _joined(gap, np.float64),
        _joined(block, np.int64),
        _starts(_joined(count, np.int64)),
        _joined(cam, np.int64),
        _joined(z_all, np.float64, (0, 2)),
        _joined(speed_all, np.float64, (0, 2)),
        _joined(ahead_all, np.float64),
        np.array([record.focal_px for record in records]),
    )
    return Observations(
        sights, np.array(person, dtype=np.int64), joints, _joined(t_all, np.float64)
    )


def _joined(parts: list[np.ndarray], kind: type, empty: tuple[int, ...] = (0,)) -> np.ndarray:
    return np.concatenate([np.zeros(empty, kind), *parts]).astype(kind)


def _starts(counts: list[int] | np.ndarray) -> np.ndarray:
    return np.concatenate(([0], np.cumsum(np.asarray(counts, dtype=np.int64)))).astype(np.int64)


def first_guess(seen: Observations, state: RigState) -> Unknowns:
    """Return the unknowns before the adjustment: points where the rays meet, no bias."""
    sights = seen.sights
    points, n_cam = len(sights.block), len(state.T)
    xyz_m = np.zeros((points, 3))
    T = np.ascontiguousarray(state.T)
    meet(sights.first, sights.cam, sights.z, T, xyz_m)
    series = np.repeat(np.arange(len(seen.joint)), np.diff(sights.point_first))
    level_m = np.zeros(len(seen.joint))
    for s in range(len(level_m)):
        level_m[s] = np.median(xyz_m[series == s, 2])
    return Unknowns(
        T.copy(), np.zeros((n_cam, 2)), state.lens.copy(), xyz_m, level_m,
        np.zeros((len(sights.gap_s), n_cam, 2)),
    )  # fmt: skip
