"""Calls for help, read naively: both hands above the head, or one that waves."""

import math
from itertools import pairwise

import numpy as np

from trecsim.lab.true_events.true_people import SHOULDERS, WRISTS, TruePerson
from trecsim.lab.true_events.true_places import Place
from trecsim.lab.true_events.true_spans import SAME_S, Span, Times, spans

ABOVE_M = 0.1
"""Hands are so far above the head [m]."""
WAVE_M, WAVED_S = 0.25, 3.0
"""A hand that waves goes so far each way [m], and has done so for so long [s]."""
SLOWEST_S, MOST_PS = 1.0, 3.0
"""From turn to turn, half a wave, a hand takes no longer [s], and it waves no more often [1/s]."""


def distress(at: Place, person: TruePerson) -> list[Span]:
    """Return when somebody holds up both hands, or waves.

    A hand that will have waved for long enough does so from its first turn on, but nobody knows.
    """
    with np.errstate(invalid="ignore"):
        above = person.xyz_m[:, WRISTS, 2] > person.head_m[:, None] + ABOVE_M
    holds = above[:, 0] & above[:, 1]
    known = holds.copy()
    for wrist in WRISTS:
        for first_s, last_s in waves_of(person, wrist):
            into_s = person.t_s - first_s
            holds |= (into_s >= 0.0) & (person.t_s <= last_s)
            known |= (into_s >= WAVED_S - SAME_S) & (person.t_s <= last_s)
    found = []
    for span in spans(person.t_s, holds & at.holds(person), person.there, at.delays):
        knows = person.t_s[known & (person.t_s >= span.told_s - SAME_S)]
        if len(knows) and (span.end_s is None or knows[0] <= span.end_s):
            found.append(span._replace(told_s=float(knows[0])))
    return found


def waves_of(person: TruePerson, wrist: int) -> list[tuple[float, float]]:
    """Return from when to when a hand waved for long enough: from its first turn to its last [s].

    Only while the hand is raised, above both shoulders, it counts where it is. The last wave of a
    recording has no end where the hand may wave on.
    """
    with np.errstate(invalid="ignore"):
        raised = person.xyz_m[:, wrist, 2] > person.xyz_m[:, SHOULDERS, 2].max(axis=1)
    rows = np.flatnonzero(person.there & raised)
    if not len(rows):
        return []
    breaks = np.flatnonzero(np.diff(person.t_s[rows]) > SLOWEST_S + SAME_S) + 1
    waves_s: list[list[float]] = []
    for part in np.split(rows, breaks):
        waves_s += _in_step(turns(person.t_s[part], _across_m(person, wrist)[part]))
        begins_anew_s = float(person.t_s[part[0]])
    found = []
    for wave_s in waves_s:
        first_s, last_s = wave_s[0], wave_s[-1]
        waved_s = last_s - first_s
        if waved_s >= WAVED_S - SAME_S and (len(wave_s) - 1) / 2 <= MOST_PS * waved_s:
            is_last = wave_s is waves_s[-1] and last_s >= begins_anew_s
            may_go_on = is_last and person.t_s[-1] - last_s <= 2.0 * SLOWEST_S
            found.append((first_s, math.inf if may_go_on else last_s))
    return found


def _across_m(person: TruePerson, wrist: int) -> Times:
    """Return how far a hand is to the left of the middle between the shoulders [m]."""
    left_m, right_m = np.moveaxis(person.xyz_m[:, SHOULDERS, :2], 1, 0)
    along = (left_m - right_m) / np.linalg.norm(left_m - right_m, axis=1)[:, None]
    return np.asarray(((person.xyz_m[:, wrist, :2] - (left_m + right_m) / 2) * along).sum(axis=1))


def turns(t_s: Times, at_m: Times) -> list[float]:
    """Return when something that goes back and forth turns, but for short ways [s].

    Of all places where it turns, the two between which the way is shortest are left out, again and
    again, until all ways are long enough.

    Examples
    --------
    >>> turns(np.arange(6.0), np.array([0.0, 0.4, 0.3, 0.5, 0.0, 0.1]))
    [3.0]
    """
    ends = _ends(at_m)
    while len(ends) > 1:
        ways_m = [abs(at_m[b] - at_m[a]) for a, b in pairwise(ends)]
        n = int(np.argmin(ways_m))
        if ways_m[n] >= WAVE_M:
            break
        if n == 0:
            del ends[0]
        elif n == len(ways_m) - 1:
            del ends[-1]
        else:
            del ends[n : n + 2]
    return [float(t_s[n]) for n in ends[1:-1]]


def _ends(at_m: Times) -> list[int]:
    """Return where it begins, where it turns, and where it ends."""
    ends, last, way = [0], 0, 0.0
    for n in range(1, len(at_m)):
        step = float(at_m[n] - at_m[n - 1])
        if step == 0.0:
            continue
        if step * way < 0.0:
            ends.append(last)
        last, way = n, step
    return [*ends, last]


def _in_step(turned_s: list[float]) -> list[list[float]]:
    """Return all turns that follow each other soon enough, together."""
    found: list[list[float]] = []
    for now in turned_s:
        if found and now - found[-1][-1] <= SLOWEST_S + SAME_S:
            found[-1].append(now)
        else:
            found.append([now])
    return found
