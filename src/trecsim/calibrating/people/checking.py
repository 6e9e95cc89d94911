"""Whether a rig is still right, by the people in a recording; and the rig as it is now."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from jaxtyping import Float64

from trecsim.calibrating.people.agreeing import dense, displaced_deg, most_that_agree
from trecsim.calibrating.people.camera_records import CameraRecord, records
from trecsim.calibrating.people.observations import observations
from trecsim.calibrating.people.pose_uncertainty import clock_sd
from trecsim.calibrating.people.refitting import Refit, Watched, given, refit, watched
from trecsim.calibrating.people.shortcomings import HOW, refuse
from trecsim.calibrating.people.tuning import (
    AGREE_DEG,
    LATE_S,
    MOST_WINDOWS,
    REFIT_SAMPLE_S,
    WINDOW_CHECK_S,
)
from trecsim.errors import CalibrationError
from trecsim.geometry import Rig
from trecsim.values import Poses2D

FINE_S = 0.5  # steps in which the time of a knock is told
AGREES, OFF, CLEARLY_OFF = 1.0, 0.0, -1.0
CLEAR_TIMES = 2.0  # off by so many limits is off clearly: one part of a recording is enough
SURE = 4.0  # standard deviations from which a clock is off


@dataclass(frozen=True, slots=True)
class CameraCheck:
    """What the people say of one camera; NaN where nothing can be said.

    Attributes
    ----------
    name
        The camera.
    ok
        Whether it fits; None where nobody was seen.
    since_s
        From when on it is off, on the clock of the poses [s].
    rotation_deg, shift_m, time_offset_s
        How far it is off at the end; the last is to be added to the rig's `time_offset_s`.
    """

    name: str
    ok: bool | None
    since_s: float
    rotation_deg: float
    shift_m: float
    time_offset_s: float

    def row(self) -> dict[str, Any]:
        """Return its numbers by their names, without that of the camera."""
        return {name: getattr(self, name) for name in self.__slots__ if name != "name"}


@dataclass(frozen=True, slots=True, eq=False)
class Check:
    """What the people in a recording say of a rig.

    Attributes
    ----------
    cameras
        In the order of the rig.
    remarks
        What else is to be said.
    end
        The cameras at the end of the recording.
    scene
        The recording.
    from_s
        Since when all cameras stand as they do at the end [s].
    """

    cameras: tuple[CameraCheck, ...]
    remarks: tuple[str, ...]
    end: Refit
    scene: Watched
    from_s: float

    @property
    def off(self) -> tuple[str, ...]:
        """The cameras that are off."""
        return tuple(one.name for one in self.cameras if one.ok is False)


def check_rig(poses: Iterable[Poses2D], rig: Rig) -> Check:
    """Return which cameras are not where the rig says, or not at the time it says.

    Parameters
    ----------
    poses
        2D poses of a recording, in any order.
    rig
        The cameras.

    Raises
    ------
    CalibrationError
        Too few people are seen by two cameras; the message says how to record.
    """
    recorded = records(poses, rig)
    refuse(recorded)
    scene = watched(recorded, given(rig))
    low, high = scene.span_s
    if high <= low:
        raise CalibrationError(f"no two cameras see the same people where the rig says; {HOW}")
    parts, agrees = agreement_over_time(scene)
    from_s, since_s = changes(scene, parts, agrees)
    end = refit(scene, (from_s, np.inf)) or refit(scene)
    if end is None:
        raise CalibrationError(
            f"too little of people is seen by two cameras to judge the rig; {HOW}"
        )
    off = _off_at_end(end, agrees)
    found = tuple(
        _told(name, c, end, recorded[c], bool(off[c]), since_s[c], scene)
        for c, name in enumerate(rig.names)
    )
    return Check(found, tuple(_remarks(rig, end, off)), end, scene, from_s)


Flags = Float64[np.ndarray, "part cam"]


def agreement_over_time(scene: Watched) -> tuple[list[tuple[float, float]], Flags]:
    """Return parts of a recording, and whether each camera agrees in each; NaN: unknown."""
    low, high = scene.span_s
    count = int(np.clip((high - low) // WINDOW_CHECK_S, 1, MOST_WINDOWS))
    edges = np.linspace(low - 1e-3, high + 1e-3, count + 1)
    parts = [(float(a), float(b)) for a, b in pairwise(edges)]
    agrees = np.full((count, len(scene.records)), np.nan)
    for w, part in enumerate(parts):
        spacing_s = max(REFIT_SAMPLE_S, (part[1] - part[0]) / 40.0)
        seen = observations(
            scene.tracks, scene.records, scene.chain, scene.begin, spacing_s=spacing_s,
            between=part,
        )  # fmt: skip
        points = dense(seen, len(scene.records))
        there = tuple(int(c) for c in np.unique(seen.sights.cam))
        which = most_that_agree(points, scene.state.T, AGREE_DEG, among=there)
        if which:
            agrees[w, list(there)] = CLEARLY_OFF
            far = most_that_agree(points, scene.state.T, CLEAR_TIMES * AGREE_DEG, among=there)
            agrees[w, [c for c in far if len(far) > len(which)]] = OFF
            agrees[w, list(which)] = AGREES
        elif len(there) == 2:
            agrees[w, list(there)] = OFF
    return parts, agrees


def changes(
    scene: Watched, parts: list[tuple[float, float]], agrees: Flags
) -> tuple[float, Float64[np.ndarray, " cam"]]:
    """Return since when nothing changed any more, and since when each camera is off [s]."""
    since_s = np.full(agrees.shape[1], np.nan)
    from_s = -np.inf
    for c in range(agrees.shape[1]):
        known = np.flatnonzero(np.isfinite(agrees[:, c]))
        right = known[agrees[known, c] == AGREES]
        if not len(known) or agrees[known[-1], c] == AGREES:
            continue
        if not len(right):
            since_s[c] = parts[known[0]][0]
            continue
        since_s[c] = _knocked_s(scene, c, parts[int(right[-1])])
        from_s = max(from_s, since_s[c])
    if scene.span_s[1] - from_s < 1.0:
        from_s = scene.span_s[1] - WINDOW_CHECK_S
    return from_s, since_s


def _knocked_s(scene: Watched, c: int, last_right: tuple[float, float]) -> float:
    """Return when a camera stopped to agree: during the last part in which it did, or after."""
    low, high = last_right[0], last_right[1] + (last_right[1] - last_right[0])
    seen = observations(
        scene.tracks, scene.records, scene.chain, scene.begin, spacing_s=0.1, between=(low, high)
    )
    points = dense(seen, len(scene.records))
    times = np.arange(low, high, FINE_S)
    off = np.full(len(times), np.nan)
    for i, t_s in enumerate(times):
        own = (seen.t_s >= t_s) & (seen.t_s < t_s + FINE_S)
        part = replace(points, z=points.z[own])
        off[i] = np.nanmax(
            [displaced_deg(part, scene.state.T, (c, o))[0] for o in range(len(scene.records))
             if o != c] or [np.nan]
        )  # fmt: skip
    known = np.flatnonzero(np.isfinite(off))
    if len(known) < 3:
        return high
    split = min(range(1, len(known)), key=lambda k: _left(off[known], k))
    return float(times[known[split]])


def _left(off: Float64[np.ndarray, " time"], k: int) -> float:
    """Return the sum of squares left of a series by two means."""
    return float(sum(((part - part.mean()) ** 2).sum() for part in (off[:k], off[k:])))


def _off_at_end(end: Refit, agrees: Flags) -> Float64[np.ndarray, " cam"]:
    """Return which cameras are off at the end: 1, 0, or NaN where nothing is known."""
    n = agrees.shape[1]
    off = np.full(n, np.nan)
    sd_s, _ = clock_sd(end.rig, end.own)
    for c in range(n):
        known = np.flatnonzero(np.isfinite(agrees[:, c]))
        if not len(known):
            continue
        late = abs(end.late_s[c]) > max(LATE_S, SURE * float(sd_s[c]))
        last = agrees[known[-2:], c] if len(known) > 1 else agrees[known[-1:], c]
        off[c] = float((last != AGREES).all() or last[-1] == CLEARLY_OFF or late)
    return off


def _told(
    name: str, c: int, end: Refit, record: CameraRecord, off: bool, since_s: float, scene: Watched
) -> CameraCheck:
    known = bool(np.isin(c, end.seen.sights.cam))
    if not known:
        return CameraCheck(name, None, np.nan, np.nan, np.nan, np.nan)
    if off and not np.isfinite(since_s):
        since_s = scene.span_s[0]
    stamp_s = float(scene.begin.stamp_s(c, np.array([since_s]))[0]) if off else np.nan
    if off and len(record.t_s):
        stamp_s = float(np.clip(stamp_s, record.t_s[0], record.t_s[-1]))
    return CameraCheck(
        name, not off, stamp_s, float(end.turn_deg[c]), float(end.shift_m[c]), float(end.late_s[c])
    )


def _remarks(rig: Rig, end: Refit, off: Float64[np.ndarray, " cam"]) -> Iterable[str]:
    unknown = [name for name, flag in zip(rig.names, off, strict=True) if np.isnan(flag)]
    if unknown:
        yield (
            f"nothing can be said of {', '.join(map(repr, unknown))}: nobody is seen there and in "
            "another camera"
        )
    if (off == 1.0).sum() >= 2 and len(rig) - len(unknown) == 2:
        yield "with two cameras nobody can tell which of them is off"
