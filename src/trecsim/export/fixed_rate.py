"""Motion at a fixed rate, with gaps kept as gaps or filled up to a length."""

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

import numpy as np
from jaxtyping import Bool, Float32, Float64, Int64

from trecsim.export.cubic import cubic_through
from trecsim.export.motions import Motion, PersonMotion

SNAP_S = 1e-5
"""A sample this close to a frame is that frame: at 5 m/s a difference of 0.05 mm [s]."""
_WHOLE_RATE_S = 5e-4  # a whole number of frames per second is meant if it drifts less than this


def usual_rate_hz(motion: Motion) -> float:
    """Return the rate of the recorded times [1/s]: frames of the median step over the whole time.

    Times rounded to milliseconds have a median step of 33 ms for 30 frames per second; over the
    whole time that error vanishes.
    """
    steps = np.diff(_all_times(motion))
    frames = float(np.maximum(np.rint(steps / motion.step_s), 1.0).sum())
    rate_hz = frames / float(steps.sum())
    whole = round(rate_hz)
    if whole and abs(1.0 / rate_hz - 1.0 / whole) * frames < _WHOLE_RATE_S:
        return float(whole)
    return rate_hz


def _all_times(motion: Motion) -> Float64[np.ndarray, " moment"]:
    return np.unique(np.concatenate([one.t_s for one in motion.people]))


def resampled(motion: Motion, rate_hz: float, fill_s: float = 0.0) -> Motion:
    """Return the motion at a fixed rate; its first time is kept.

    Positions are those of the cubic spline through the samples on both sides of a frame. A frame
    in a gap stays NaN, unless the gap is at most `fill_s` long.

    Parameters
    ----------
    motion
        At the recorded times.
    rate_hz
        Frames per second.
    fill_s
        Gaps up to this length are filled by the spline, with support 0 [s].
    """
    people = tuple(_resampled_person(one, motion, rate_hz, fill_s) for one in motion.people)
    return replace(
        motion,
        people=tuple(one for one in people if len(one.t_s)),
        step_s=1.0 / rate_hz,
        rate_hz=rate_hz,
    )


def filled(motion: Motion, fill_s: float) -> Motion:
    """Return the motion at its own times with gaps up to `fill_s` filled by samples [s]."""
    times_s = _all_times(motion)
    people = []
    for one in motion.people:
        first, last = np.searchsorted(times_s, (one.t_s[0], one.t_s[-1]))
        own = _with_times_in_long_gaps(times_s[first : last + 1], motion, fill_s)
        person = _at(one, own, motion.longest_step_s, fill_s)
        people.append(_rows(person, person.present))
    return replace(motion, people=tuple(people))


def _with_times_in_long_gaps(
    times_s: Float64[np.ndarray, " moment"], motion: Motion, fill_s: float
) -> Float64[np.ndarray, " moment"]:
    """Add times where the whole recording has none."""
    steps = np.diff(times_s)
    gaps = np.flatnonzero((steps > motion.longest_step_s) & (steps <= fill_s))
    more = [
        np.linspace(times_s[at], times_s[at + 1], round(steps[at] / motion.step_s) + 1)[1:-1]
        for at in gaps
    ]
    return np.unique(np.concatenate([times_s, *more]))


def _resampled_person(
    one: PersonMotion, motion: Motion, rate_hz: float, fill_s: float
) -> PersonMotion:
    first = math.ceil((one.t_s[0] - motion.t0_s - SNAP_S) * rate_hz)
    last = math.floor((one.t_s[-1] - motion.t0_s + SNAP_S) * rate_hz)
    at_s = motion.t0_s + np.arange(first, last + 1) / rate_hz
    person = _at(one, at_s, motion.longest_step_s, fill_s)
    there = np.flatnonzero(person.present)
    if not len(there):
        return person.part(slice(0, 0))
    return person.part(slice(int(there[0]), int(there[-1]) + 1))


def _at(
    one: PersonMotion, at_s: Float64[np.ndarray, " time"], longest_s: float, fill_s: float
) -> PersonMotion:
    """Evaluate one person at other times."""
    joints = one.xyz_m.shape[1]
    xyz_m = np.full((len(at_s), joints, 3), np.nan, np.float32)
    sigma_m = np.full((len(at_s), joints), np.nan, np.float32)
    support = np.zeros((len(at_s), joints), np.uint16)
    known = one.known
    for which in _alike(known):
        samples = np.flatnonzero(known[:, which[0]])
        if not len(samples):
            continue
        t_s = one.t_s[samples]
        near = _nearest(t_s, at_s)
        exact = np.abs(t_s[near] - at_s) <= SNAP_S
        inside = _covered(t_s, at_s, max(longest_s, fill_s)) & ~exact
        found = _splined(t_s, one.xyz_m[samples][:, which], at_s[inside], max(longest_s, fill_s))
        xyz_m[np.ix_(inside, which)] = found
        xyz_m[np.ix_(exact, which)] = one.xyz_m[np.ix_(samples[near[exact]], which)]
        either = exact | inside
        sigma_m[np.ix_(either, which)] = one.sigma_m[np.ix_(samples[near[either]], which)]
        seen = exact | (inside & _covered(t_s, at_s, longest_s))
        support[np.ix_(seen, which)] = one.support[np.ix_(samples[near[seen]], which)]
    return PersonMotion(one.person, at_s, xyz_m, sigma_m, support)


def _splined(
    t_s: Float64[np.ndarray, " sample"],
    xyz_m: Float32[np.ndarray, "sample joint 3"],
    at_s: Float64[np.ndarray, " time"],
    longest_s: float,
) -> Float32[np.ndarray, "time joint 3"]:
    """Evaluate one spline per stretch without a gap longer than `longest_s`."""
    out = np.full((len(at_s), *xyz_m.shape[1:]), np.nan, np.float32)
    if not len(at_s):
        return out
    flat = xyz_m.reshape(len(t_s), -1).astype(np.float64)
    for stretch in stretches(t_s, longest_s):
        if stretch.stop - stretch.start < 2:
            continue
        times = t_s[stretch]
        within = slice(*np.searchsorted(at_s, (times[0], times[-1])))
        if within.stop > within.start:
            value = cubic_through(times, flat[stretch], at_s[within])
            out[within] = value.reshape(-1, *xyz_m.shape[1:])
    return out


def stretches(t_s: Float64[np.ndarray, " sample"], longest_s: float) -> Iterator[slice]:
    """Yield the stretches of samples that have no gap longer than `longest_s` in them [s]."""
    breaks = np.flatnonzero(np.diff(t_s) > longest_s) + 1
    edges = [0, *breaks.tolist(), len(t_s)]
    for start, stop in pairwise(edges):
        if stop > start:
            yield slice(start, stop)


def _alike(known: Bool[np.ndarray, "frame joint"]) -> Iterator[list[int]]:
    """Yield groups of joints that are missing at the same frames; mostly there is one."""
    groups: dict[bytes, list[int]] = {}
    for joint, column in enumerate(known.T):
        groups.setdefault(np.packbits(column).tobytes(), []).append(joint)
    yield from groups.values()


def _nearest(
    t_s: Float64[np.ndarray, " sample"], at_s: Float64[np.ndarray, " time"]
) -> Int64[np.ndarray, " time"]:
    right = np.clip(np.searchsorted(t_s, at_s), 0, len(t_s) - 1)
    left = np.maximum(right - 1, 0)
    return np.where(np.abs(t_s[left] - at_s) <= np.abs(t_s[right] - at_s), left, right)


def _covered(
    t_s: Float64[np.ndarray, " sample"], at_s: Float64[np.ndarray, " time"], longest_s: float
) -> Bool[np.ndarray, " time"]:
    """Return which times lie between two samples that are no further apart than `longest_s`."""
    right = np.searchsorted(t_s, at_s, side="right")
    inside = (right > 0) & (right < len(t_s))
    right = np.clip(right, 1, max(len(t_s) - 1, 1))
    if len(t_s) < 2:
        return np.zeros(len(at_s), bool)
    return np.asarray(inside & (t_s[right] - t_s[right - 1] <= longest_s + SNAP_S))


def _rows(person: PersonMotion, kept: Bool[np.ndarray, " frame"]) -> PersonMotion:
    return replace(
        person,
        t_s=person.t_s[kept],
        xyz_m=person.xyz_m[kept],
        sigma_m=person.sigma_m[kept],
        support=person.support[kept],
    )
