"""Which part of the tracks a film needs, and the moments of its images."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np

from trecsim.errors import InputError
from trecsim.export.motions import Motion, collect
from trecsim.films.film_settings import FilmSettings
from trecsim.films.people_at import Lookup
from trecsim.store.tracks import read_tracks

_USUAL_HZ = 25.0
_MARGIN_S = 1.0  # of tracks read before and after what is shown


def part_of(tracks: Path | str, settings: FilmSettings) -> Motion:
    """Read the part of the tracks that is shown, and what its paths need."""
    first = next(iter(read_tracks(tracks)), None)
    if first is None:
        raise InputError(f"{tracks}: nobody is in these tracks, so there is nothing to show")
    begin_s = settings.at_s if settings.at_s is not None else settings.from_s or 0.0
    end_s = settings.at_s if settings.at_s is not None else settings.to_s
    from_s = first.t_s + begin_s - settings.trail_s - _MARGIN_S
    until_s = math.inf if end_s is None else first.t_s + end_s + _MARGIN_S
    motion = collect(read_tracks(tracks, from_s=from_s, until_s=until_s))
    last_s = max((float(one.t_s[-1]) for one in motion.people), default=-math.inf)
    if begin_s < 0.0 or first.t_s + begin_s > last_s or (end_s is not None and end_s < begin_s):
        length_s = max(one.t_s for one in read_tracks(tracks)) - first.t_s
        if settings.at_s is not None:
            text = f"--at-s {begin_s:g}: expected 0 to {length_s:.3f}, the length of the tracks"
            raise InputError(text)
        end = "the end" if end_s is None else f"{end_s:g} s"
        raise InputError(
            f"there are no tracks from {begin_s:g} s to {end}; they last {length_s:.3f} s"
        )
    return replace(motion, t0_s=first.t_s)


def times_of(lookup: Lookup, settings: FilmSettings, picture: bool) -> tuple[list[float], float]:
    """Return the moments to show [s], and the frame rate."""
    motion = lookup.motion
    if picture and settings.at_s is not None:
        return [motion.t0_s + settings.at_s], math.nan
    last_s = max(float(one.t_s[-1]) for one in motion.people)
    from_s = motion.t0_s + (settings.from_s or 0.0)
    to_s = min(last_s, motion.t0_s + settings.to_s) if settings.to_s is not None else last_s
    if picture:
        return [_moment(lookup, from_s, to_s)], math.nan
    usual_hz = 1.0 / motion.step_s if motion.step_s > 0 else _USUAL_HZ
    rate_hz = settings.rate_hz or min(round(usual_hz, 3), 30.0)
    count = math.floor((to_s - from_s) * rate_hz + 1e-6) + 1
    return [from_s + number / rate_hz for number in range(count)], rate_hz


def _moment(lookup: Lookup, from_s: float, to_s: float) -> float:
    """Return a moment with the most people, in the middle of those [s]."""
    some = np.linspace(from_s, to_s, 41)
    counts = [len(lookup.at(t_s).person) for t_s in some.tolist()]
    most = np.flatnonzero(np.array(counts) == max(counts))
    return float(some[most[len(most) // 2]])
