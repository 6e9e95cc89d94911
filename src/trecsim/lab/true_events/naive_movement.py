"""Running, and going the wrong way, read naively from their definitions."""

import math
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float64

from trecsim.lab.true_events.true_people import TruePerson
from trecsim.lab.true_events.true_places import Place
from trecsim.lab.true_events.true_spans import SAME_S, Span, spans

MEDIAN_S, LEAST_S, PAUSE_S = 1.0, 0.2, 0.1
AGAINST_MPS, AGAINST_M = 0.5, 1.5

Flags = Bool[np.ndarray, " time"]
Times = Float64[np.ndarray, " time"]


class Moved(NamedTuple):
    """How the hips moved over the floor up to each moment: velocity [m/s], in which time [s].

    Attributes
    ----------
    velocity_mps
        From first to last; NaN where that is one moment.
    took_s
        The time from first to last; NaN while the person is not there.
    """

    velocity_mps: Float64[np.ndarray, "time 2"]
    took_s: Times


def over_the_last(person: TruePerson, over_s: float) -> Moved:
    """Return how somebody moved over a time up to each moment [s]."""
    velocity_mps = np.full((len(person.t_s), 2), np.nan)
    took_s = np.full(len(person.t_s), np.nan)
    for n in np.flatnonzero(person.there):
        first = int(np.searchsorted(person.t_s, person.t_s[n] - over_s - SAME_S))
        while not person.there[first]:
            first += 1
        took_s[n] = person.t_s[n] - person.t_s[first]
        if n > first:
            velocity_mps[n] = (person.hips_m[n, :2] - person.hips_m[first, :2]) / took_s[n]
    return Moved(velocity_mps, took_s)


def running(person: TruePerson, inside: Flags, limit_mps: float) -> tuple[Flags, Times, Times]:
    """Return when somebody runs, and of each moment since when or until when.

    Running is a median speed over the last second above the limit. It begins with the first moment
    of that second from which on the speed stays above it, but for pauses of 0.1 s, and ends with
    the first of the last slow ones.
    """
    speed_mps = np.hypot(*person.velocity_mps[:, :2].T)
    holds, since_s, until_s = np.zeros(len(speed_mps), bool), person.t_s.copy(), person.t_s.copy()
    for n in np.flatnonzero(person.there):
        now = float(person.t_s[n])
        first = int(np.searchsorted(person.t_s, now - MEDIAN_S - SAME_S))
        rows = [m for m in range(first, n + 1) if person.there[m]]
        if now - person.t_s[rows[0]] < LEAST_S:
            continue
        holds[n] = inside[n] and np.median(speed_mps[rows]) > limit_mps
        fast = (speed_mps[rows] > limit_mps) & inside[rows]
        began, ended = _last_fast(person.t_s[rows], fast)
        since_s[n], until_s[n] = began, ended
    return holds, since_s, until_s


def _last_fast(t_s: Times, fast: Flags) -> tuple[float, float]:
    """Return when the last fast stretch began, and when it was over, with short pauses in it.

    Examples
    --------
    >>> _last_fast(np.arange(6) / 25, np.array([1, 0, 0, 1, 1, 0], bool))
    (0.0, 0.2)
    """
    began_s: float | None = None
    ended_s = float(t_s[0])
    was_fast = False
    for now, is_fast in zip(t_s.tolist(), fast.tolist(), strict=True):
        if is_fast:
            if began_s is None or (not was_fast and now - ended_s > PAUSE_S):
                began_s = now
        elif was_fast:
            ended_s = now
        was_fast = is_fast
    return (float(t_s[-1]) if began_s is None else began_s), ended_s


def wrong_way(
    person: TruePerson, inside: Flags, allowed: Float64[np.ndarray, " 2"]
) -> tuple[Flags, Times]:
    """Return when somebody has gone against the allowed direction for some way, and since when."""
    with np.errstate(invalid="ignore"):
        against = inside & (person.velocity_mps[:, :2] @ allowed < -AGAINST_MPS)
    holds, since_s = np.zeros(len(against), bool), person.t_s.copy()
    began = -1
    for n in range(len(against)):
        if not against[n]:
            began = -1
            continue
        began = n if began < 0 else began
        way_m = (person.hips_m[began, :2] - person.hips_m[n, :2]) @ allowed
        holds[n], since_s[n] = way_m >= AGAINST_M, person.t_s[began]
    return holds, since_s


def runs(at: Place, person: TruePerson) -> list[Span]:
    """Return when somebody runs."""
    holds, since_s, until_s = running(person, at.holds(person), at.rule.get("speed_mps", 2.2))
    return spans(
        person.t_s, holds, person.there, at.delays,
        since_s=since_s, until_s=until_s,
    )  # fmt: skip


def goes_wrong_way(at: Place, person: TruePerson) -> list[Span]:
    """Return when somebody goes the wrong way."""
    heading_rad = math.radians(at.rule["heading_deg"])
    allowed = np.array([math.cos(heading_rad), math.sin(heading_rad)])
    holds, since_s = wrong_way(person, at.holds(person), allowed)
    return spans(person.t_s, holds, person.there, at.delays, since_s=since_s)
