"""People who act together or belong together, read naively: many begin to run, one stays behind."""

import math
from collections.abc import Iterator, Sequence
from itertools import combinations

import numpy as np

from trecsim.lab.true_events.naive_crowds import looks
from trecsim.lab.true_events.naive_movement import PAUSE_S, over_the_last, running
from trecsim.lab.true_events.true_people import TruePerson
from trecsim.lab.true_events.true_places import Happening, Place, of_place
from trecsim.lab.true_events.true_spans import SAME_S, Flags, Times, spans

TOGETHER_S = 2.0
"""Who begin to run within so long do so together [s]."""
NEAR_M, ALIKE_MPS, WALKS_MPS, STEPS_S = 1.5, 0.4, 0.3, 1.0
"""Who walk together are nearer than this [m], at velocities that differ by less, each faster than
this [m/s], in the mean over so long [s]."""


def panic(at: Place, people: Sequence[TruePerson]) -> Iterator[Happening]:
    """Yield when many begin to run; it is over when too few of them still run."""
    t_s = people[0].t_s
    inside = np.array([at.holds(person) for person in people])
    runs = [running(person, person.there, at.rule.get("speed_mps", 2.2)) for person in people]
    began_s = np.array([
        _begins_s(person, *one[:2], there)
        for person, one, there in zip(people, runs, inside, strict=True)
    ])  # fmt: skip
    together, since_s, until_s = np.zeros_like(inside), t_s.copy(), t_s.copy()
    for n in range(len(t_s)):
        needed = math.ceil(at.rule.get("share", 0.3) * inside[:, n].sum() - 1e-9)
        needed = max(needed, at.rule.get("people", 3))
        run = [k for k in range(len(people)) if inside[k, n] and np.isfinite(began_s[k, n])]
        most = _most_within([float(began_s[k, n]) for k in run])
        if len(most) >= needed:
            if any(n == 0 or not runs[run[m]][0][n - 1] for m in most):  # else others have gone
                since_s[n] = sorted(began_s[run[m], n] for m in most)[needed - 1]
            together[[run[m] for m in most], n] = True
        elif n > 0 and together[:, n - 1].any():
            were = np.flatnonzero(together[:, n - 1]).tolist()
            stops_s = [runs[k][2][n] if inside[k, n] else t_s[n] for k in were if k not in run]
            until_s[n] = sorted(stops_s)[max(len(were) - needed, 0)] if stops_s else t_s[n]
    yield from of_place(
        at, t_s, together, np.asarray(together.any(axis=0)), since_s=since_s, until_s=until_s
    )


def _begins_s(person: TruePerson, holds: Flags, since_s: Times, inside: Flags) -> Times:
    """Return for each moment since when the person runs [s].

    NaN while the person does not, has run when first seen, or has begun outside the zone.
    """
    out = np.full(len(person.t_s), np.nan)
    for n in np.flatnonzero(holds):
        if n > 0 and holds[n - 1]:
            out[n] = out[n - 1]
            continue
        walked = person.there & (person.t_s < since_s[n] - PAUSE_S - SAME_S)
        if walked.any() and inside[np.searchsorted(person.t_s, since_s[n] - SAME_S)]:
            out[n] = since_s[n]
    return out


def _most_within(began_s: Sequence[float]) -> list[int]:
    """Return which of these begin within `TOGETHER_S` of one of them, of whom these are most.

    Examples
    --------
    >>> _most_within([0.0, 1.9, 2.1, 3.0])
    [1, 2, 3]
    """
    most: list[int] = []
    for first_s in began_s:
        some = [m for m, at_s in enumerate(began_s) if 0.0 <= at_s - first_s <= TOGETHER_S]
        most = max(most, some, key=len)
    return most


def split(at: Place, people: Sequence[TruePerson]) -> Iterator[Happening]:
    """Yield who is far from everybody with whom they had walked for long."""
    t_s, moved = people[0].t_s, [over_the_last(person, STEPS_S) for person in people]
    together_s = np.zeros((len(people), len(people)))
    far = np.zeros((len(people), len(t_s)), bool)
    looked = looks(t_s)
    for n in range(len(t_s)):
        here = [k for k, one in enumerate(moved) if np.isfinite(one.velocity_mps[n, 0])]
        if n > 0 and looked[n] == n:
            for a, b in combinations(here, 2):
                v_a, v_b = moved[a].velocity_mps[n], moved[b].velocity_mps[n]
                walk = min(np.hypot(*v_a), np.hypot(*v_b)) > WALKS_MPS
                alike = math.dist(v_a, v_b) < ALIKE_MPS
                near = math.dist(people[a].floor_m[n], people[b].floor_m[n]) < NEAR_M
                if walk and alike and near:
                    together_s[a, b] += t_s[n] - t_s[looked[n - 1]]
                    together_s[b, a] = together_s[a, b]
        for k in here:
            own = [m for m in here if together_s[k, m] >= at.rule.get("together_s", 10.0) - SAME_S]
            away_m = [math.dist(people[k].floor_m[n], people[m].floor_m[n]) for m in own]
            far[k, n] = bool(away_m) and min(away_m) > at.rule.get("distance_m", 8.0)
    for k, person in enumerate(people):
        for span in spans(t_s, far[k], person.there, at.delays):
            yield Happening((person.number,), span)
