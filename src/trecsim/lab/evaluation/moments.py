"""Tracks as flat arrays, frame by frame, with the frames in which nobody was tracked."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt
from jaxtyping import Float, Float64, Int16, Int64

from trecsim.errors import InputError
from trecsim.skeleton import COCO17
from trecsim.store.timing_csv import Timing, read_timing, timing_in
from trecsim.store.tracks import read_tracks
from trecsim.values import Snapshot

_MOST_EMPTY = 5_000_000  # two days at 25 per second; more means wrong times
_SAME_S = 1e-3

Frame = tuple[float, tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]]
"""Time; identity, position, standard deviation and support of each person."""


@dataclass(frozen=True, slots=True, eq=False)
class Moments:
    """Tracks in all frames; each frame has one row per person.

    Attributes
    ----------
    t_s
        Times of the frames, increasing [s].
    first
        The rows of frame `i` are ``first[i]`` to ``first[i + 1]``.
    id
        Identity of each row.
    xyz_m
        Joints in the world frame, NaN where unknown [m].
    sigma_m
        Standard deviation of each [m].
    support
        Number of cameras that support each.
    """

    t_s: Float64[np.ndarray, " moment"]
    first: Int64[np.ndarray, " edge"]
    id: Int64[np.ndarray, " row"]
    xyz_m: Float[np.ndarray, "row joint 3"]
    sigma_m: Float[np.ndarray, "row joint"]
    support: Int16[np.ndarray, "row joint"]

    @property
    def people(self) -> Int64[np.ndarray, " moment"]:
        """Number of people in each frame."""
        return np.diff(self.first)

    @property
    def moment(self) -> Int64[np.ndarray, " row"]:
        """Frame of each row."""
        return np.repeat(np.arange(len(self.t_s)), self.people)


@dataclass(frozen=True, slots=True, eq=False)
class Recorded:
    """Tracks from a file, and the times of all frames.

    Attributes
    ----------
    path
        The file.
    moments
        Frames of the file: all have at least one person.
    frame_set_t_s
        Times of all frames, empty ones included; None if unknown.
    other_timing
        A file with times that belong to other tracks; None if there is none.
    """

    path: Path
    moments: Moments
    frame_set_t_s: Float64[np.ndarray, " step"] | None
    other_timing: Path | None

    def shifted(self, by_s: float) -> "Recorded":
        """Return the tracks with `by_s` added to all times [s]."""
        frames_s = None if self.frame_set_t_s is None else self.frame_set_t_s + by_s
        moments = replace(self.moments, t_s=self.moments.t_s + by_s)
        return replace(self, moments=moments, frame_set_t_s=frames_s)


def gather(snapshots: Iterable[Snapshot], dtype: npt.DTypeLike = np.float64) -> Moments:
    """Convert snapshots to flat arrays.

    Raises
    ------
    InputError
        The numbers of joints differ.
    """
    return joined_frames([frame_of(snapshot, dtype) for snapshot in snapshots], dtype)


def frame_of(snapshot: Snapshot, dtype: npt.DTypeLike) -> Frame:
    """Return time, identities, positions, standard deviations and support of a snapshot."""
    sigma_m = snapshot.sigma_m.astype(dtype)
    support = np.minimum(snapshot.support, 2**15 - 1).astype(np.int16)
    return snapshot.t_s, (snapshot.id, snapshot.xyz_m.astype(dtype), sigma_m, support)


def joined_frames(frames: Sequence[Frame], dtype: npt.DTypeLike) -> Moments:
    """Return frames as flat arrays.

    Raises
    ------
    InputError
        The numbers of joints differ.
    """
    parts = [part for _, part in frames if len(part[0])]
    joints = {part[1].shape[1] for part in parts} or {len(COCO17.joints)}
    if len(joints) > 1:
        raise InputError(f"people have different numbers of joints: {sorted(joints)}")
    shape = (0, joints.pop())
    nobody = (
        *(np.empty(0, np.int64), np.empty((*shape, 3), dtype)),
        *(np.empty(shape, dtype), np.empty(shape, np.int16)),
    )
    rows = (np.concatenate(arrays) for arrays in zip(nobody, *parts, strict=True))
    first = np.cumsum([0, *(len(part[0]) for _, part in frames)])
    return Moments(np.array([t_s for t_s, _ in frames], np.float64), first, *rows)


def read_moments(path: Path | str) -> Recorded:
    """Read tracks, and the times of all frame sets if there is a ``timing.csv`` beside them.

    Raises
    ------
    InputError
        One of the files is invalid.
    """
    path = Path(path)
    moments = gather(read_tracks(path), np.float32)
    timing = timing_in(path if path.is_dir() else path.parent)
    if timing is None:
        return Recorded(path, moments, None, None)
    times_s = _times_of(moments, read_timing(timing))
    return Recorded(path, moments, times_s, timing if times_s is None else None)


def _times_of(moments: Moments, timing: Timing) -> Float64[np.ndarray, " step"] | None:
    """Return the times of all frame sets minus the lag; None if they belong to other tracks."""
    for lag_s in (_lag_s(moments, timing), 0.0):
        times_s = np.unique(timing.t_s) - lag_s
        if len(times_s) and (_nearest_s(moments.t_s, times_s) <= _SAME_S).all():
            return times_s
    return None


def _lag_s(moments: Moments, timing: Timing) -> float:
    """Return the lag of the tracks behind the frame sets, if they are of the same run.

    Each frame set with people has a frame in the tracks; the lag is the time between the two.
    """
    occupied_s = timing.t_s[timing.people > 0]
    if not len(moments.t_s) or len(occupied_s) != len(moments.t_s):
        return 0.0
    return float(np.median(occupied_s - moments.t_s))


def with_empty_moments(
    recorded: Recorded, from_s: float, until_s: float, otherwise_s: Float64[np.ndarray, " time"]
) -> Moments:
    """Return the frames from one time until another, empty ones included.

    A file of tracks has no row for a frame without people; without these frames, people who were
    missed in them would not count. The times are those of the frame sets where known. Otherwise
    frames are one median interval apart, from the beginning to the end.

    Parameters
    ----------
    recorded
        The tracks.
    from_s, until_s
        The time to evaluate [s].
    otherwise_s
        The frames of tracks too short to have an interval [s].

    Raises
    ------
    InputError
        There would be millions of empty frames.
    """
    there = within(recorded.moments, from_s, until_s)
    if recorded.frame_set_t_s is not None:
        times_s = recorded.frame_set_t_s
        nearest = _nearest_s(times_s, recorded.moments.t_s)
        empty_s = times_s[nearest > _SAME_S]
    elif len(recorded.moments.t_s) < 2:
        empty_s = otherwise_s[~np.isin(otherwise_s, recorded.moments.t_s)]
    else:
        step_s = interval_s(recorded.moments)
        empty_s = _missing_s(there.t_s, step_s, from_s, until_s)
    return _merged(there, empty_s[(empty_s >= from_s) & (empty_s <= until_s)])


def interval_s(moments: Moments) -> float:
    """Return the median frame period [s]; NaN with fewer than two frames."""
    return float(np.median(np.diff(moments.t_s))) if len(moments.t_s) > 1 else float("nan")


def within(moments: Moments, from_s: float, until_s: float) -> Moments:
    """Return the frames from one time until another, both included [s]."""
    begin = int(np.searchsorted(moments.t_s, from_s))
    end = max(int(np.searchsorted(moments.t_s, until_s, side="right")), begin)
    rows = slice(moments.first[begin], moments.first[end])
    return Moments(
        moments.t_s[begin:end],
        moments.first[begin : end + 1] - moments.first[begin],
        *(array[rows] for array in (moments.id, moments.xyz_m, moments.sigma_m, moments.support)),
    )


def _nearest_s(
    t_s: Float64[np.ndarray, " one"], others_s: Float64[np.ndarray, " other"]
) -> Float64[np.ndarray, " one"]:
    """Return the distance of each time to the nearest of the others."""
    if not len(others_s):
        return np.full(len(t_s), np.inf)
    after = np.searchsorted(others_s, t_s).clip(0, len(others_s) - 1)
    before = (after - 1).clip(0)
    before_s, after_s = np.abs(others_s[before] - t_s), np.abs(others_s[after] - t_s)
    nearest_s: Float64[np.ndarray, " one"] = np.minimum(before_s, after_s)
    return nearest_s


def _missing_s(
    t_s: Float64[np.ndarray, " moment"], step_s: float, from_s: float, until_s: float
) -> Float64[np.ndarray, " empty"]:
    """Return the times of empty frames before, between and after the given ones."""
    if not len(t_s):
        return from_s + step_s * np.arange(_steps(until_s - from_s, step_s) + 1)
    before = np.arange(_steps(t_s[0] - from_s, step_s), 0, -1)
    behind = np.arange(1, _steps(until_s - t_s[-1], step_s) + 1)
    gaps_s = np.diff(t_s)
    missing = np.maximum(np.rint(gaps_s / step_s) - 1, 0)
    _steps(float(missing.sum()), 1.0)
    count = missing.astype(np.int64)
    start = np.repeat(np.arange(len(gaps_s)), count)
    number = np.arange(len(start)) - np.repeat(np.cumsum(count) - count, count) + 1
    inside_s = t_s[start] + gaps_s[start] * number / (count[start] + 1)
    empty_s = np.concatenate([t_s[0] - step_s * before, inside_s, t_s[-1] + step_s * behind])
    return empty_s.clip(from_s, until_s)  # rounding


def _steps(span_s: float, step_s: float) -> int:
    """Return the number of whole steps in a span of time."""
    steps = span_s / step_s + 1e-6
    if steps > _MOST_EMPTY:
        raise InputError(
            f"with one frame every {step_s:.3g} s, as in the tracks, {steps:.3g} frames would be "
            "empty: check the times of tracks and ground truth"
        )
    return int(steps)


def _merged(there: Moments, empty_s: Float64[np.ndarray, " empty"]) -> Moments:
    t_s = np.concatenate([there.t_s, empty_s])
    people = np.concatenate([there.people, np.zeros(len(empty_s), np.int64)])
    order = np.argsort(t_s, kind="stable")
    first = np.concatenate([[0], np.cumsum(people[order])])
    return replace(there, t_s=t_s[order], first=first)
