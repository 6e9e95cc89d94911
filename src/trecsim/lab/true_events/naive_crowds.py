"""Rules on crowds in a zone, read naively: how many people, how dense, how they push and pass."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.lab.true_events.naive_movement import over_the_last
from trecsim.lab.true_events.naive_places import voronoi_density_pm2
from trecsim.lab.true_events.true_people import TruePerson
from trecsim.lab.true_events.true_places import Happening, Place, of_place
from trecsim.lab.true_events.true_spans import SAME_S, Flags, Times

EVERY_S = 0.4
"""So often crowds are looked at [s]."""
CUT_M = 1.0
"""Nobody takes up floor that is farther away [m]."""
MOVING_MPS = 0.3
"""People who are faster than this in the mean move [m/s]."""
FRUIN_PM2 = {"B": 0.31, "C": 0.43, "D": 0.72, "E": 1.08, "F": 2.15}
"""From which density on each level of service begins [people/m^2]."""
GRAVE_S = 5.0
"""A density that is worse is so in the mean over so long [s]."""
AROUND_M, PACKED_PM2 = 1.0, 4.0
"""Who is about so near makes up the crowd around somebody [m]; pressure counts from such a density
on [people/m^2]."""
STEPS_S, LEAST_S = 1.0, 0.5
"""Velocities are those over so long, and at least so long [s]."""
LATELY_S, USUALLY_S, KNOWN_S = 10.0, 60.0, 30.0
"""The flow lately and the usual one are those over so long; after so long one is known [s]."""


def looks(t_s: Times) -> Int64[np.ndarray, " time"]:
    """Return for each moment the last one at which crowds were looked at.

    Examples
    --------
    >>> looks(np.array([0.0, 0.2, 0.4, 0.6, 0.8]))
    array([0, 0, 2, 2, 4])
    """
    at = np.zeros(len(t_s), np.int64)
    for n in range(1, len(t_s)):
        before = at[n - 1]
        at[n] = n if t_s[n] - t_s[before] >= EVERY_S - SAME_S else before
    return at


def occupancy(at: Place, people: Sequence[TruePerson]) -> Iterator[Happening]:
    """Yield when at least so many people are inside."""
    inside = np.array([at.holds(person) for person in people])
    holds = inside.sum(axis=0) >= at.rule["limit"]
    yield from of_place(at, people[0].t_s, inside, holds)


def density_pm2(at: Place, people: Sequence[TruePerson]) -> dict[int, float]:
    """Return the density in the zone at each look [people/m^2]."""
    looked = np.unique(looks(people[0].t_s)).tolist()
    return {n: voronoi_density_pm2(at.polygon_m, _there_m(people, n), CUT_M) for n in looked}


def _there_m(people: Sequence[TruePerson], n: int) -> Float64[np.ndarray, "person 2"]:
    return np.array([one.floor_m[n] for one in people if one.there[n]]).reshape(-1, 2)


def stays_below(at: Place, people: Sequence[TruePerson], limit_pm2: float) -> bool:
    """Tell whether there are never enough people for a density, were all of them in the zone."""
    corners_m = at.polygon_m
    low_m, high_m = corners_m.min(axis=0) - CUT_M, corners_m.max(axis=0) + CUT_M
    x_m, y_m = corners_m.T
    area_m2 = 0.5 * abs(float(x_m @ np.roll(y_m, -1) - y_m @ np.roll(x_m, -1)))
    near = np.array(
        [((one.floor_m > low_m) & (one.floor_m < high_m)).all(axis=1) for one in people]
    )
    # The grid's area of the zone is a little off.
    return float(near.sum(axis=0).max(initial=0)) < 0.9 * limit_pm2 * area_m2


def density_level(at: Place, people: Sequence[TruePerson]) -> Iterator[Happening]:
    """Yield when the density is at a level of service or above; in F, if people move, at once."""
    t_s, level = people[0].t_s, at.rule.get("level", "E")
    if stays_below(at, people, FRUIN_PM2[level]):
        return
    inside = np.array([at.holds(person) for person in people])
    dense, packed = {}, {}
    speeds_mps = [np.hypot(*person.velocity_mps[:, :2].T) for person in people]
    for n, density in density_pm2(at, people).items():
        dense[n] = density > FRUIN_PM2[level]
        within = [speeds_mps[k][n] for k in np.flatnonzero(inside[:, n])]
        moves = bool(within) and float(np.nanmean(within)) > MOVING_MPS
        packed[n] = density > FRUIN_PM2["F"] and moves and level != "F"
    yield from of_place(at, t_s, inside, _at_all(t_s, dense), _at_all(t_s, packed))


def critical(at: Place, people: Sequence[TruePerson]) -> Iterator[Happening]:
    """Yield when the density is dangerous; at once when it is so in the mean over a while."""
    limit_pm2, grave_pm2 = at.rule.get("density_pm2", 4.0), at.rule.get("grave_pm2", 5.0)
    if stays_below(at, people, min(limit_pm2, grave_pm2)):
        return
    inside = np.array([at.holds(person) for person in people])
    t_s, density = people[0].t_s, density_pm2(at, people)
    dense = {n: one >= limit_pm2 for n, one in density.items()}
    grave = {}
    for n in density:
        lately = [m for m in density if t_s[n] - GRAVE_S - SAME_S <= t_s[m] <= t_s[n]]
        is_known = t_s[n] - t_s[lately[0]] > GRAVE_S - EVERY_S - SAME_S
        mean = float(np.mean([density[m] for m in lately]))
        grave[n] = bool(is_known) and mean >= grave_pm2
    yield from of_place(at, t_s, inside, _at_all(t_s, dense), _at_all(t_s, grave))


def pressure(at: Place, people: Sequence[TruePerson]) -> Iterator[Happening]:
    """Yield when a packed crowd pushes."""
    inside = np.array([at.holds(person) for person in people])
    t_s = people[0].t_s
    moved = [over_the_last(person, STEPS_S) for person in people]
    pushes, grave = {}, {}
    for n in np.unique(looks(t_s)).tolist():
        there = [k for k, one in enumerate(moved) if one.took_s[n] >= LEAST_S - SAME_S]
        xy_m = np.array([people[k].floor_m[n] for k in there]).reshape(-1, 2)
        velocity_mps = np.array([moved[k].velocity_mps[n] for k in there]).reshape(-1, 2)
        found_ps2 = []
        for k, own_m in zip(there, xy_m, strict=True):
            density, variance = _around(own_m, xy_m, velocity_mps)
            if inside[k, n] and density >= PACKED_PM2:
                found_ps2.append(density * variance)
        mean_ps2 = float(np.mean(found_ps2)) if found_ps2 else 0.0
        pushes[n] = mean_ps2 > at.rule.get("pressure_ps2", 0.02)
        grave[n] = mean_ps2 > at.rule.get("grave_ps2", 0.04)
    yield from of_place(at, t_s, inside, _at_all(t_s, pushes), _at_all(t_s, grave))


def _around(
    own_m: Float64[np.ndarray, " 2"],
    xy_m: Float64[np.ndarray, "person 2"],
    velocity_mps: Float64[np.ndarray, "person 2"],
) -> tuple[float, float]:
    """Return density [people/m^2] and variance of the velocities [m^2/s^2] around somebody.

    Everybody counts with the weight exp(-r^2 / R^2) of a bell of R = `AROUND_M`, whose volume is
    pi R^2.
    """
    weights = [math.exp(-(math.dist(own_m, other_m) ** 2) / AROUND_M**2) for other_m in xy_m]
    flow_mps = np.average(velocity_mps, axis=0, weights=weights)
    squares = [math.dist(one, flow_mps) ** 2 for one in velocity_mps]
    variance = float(np.average(squares, weights=weights))
    return sum(weights) / (math.pi * AROUND_M**2), variance


def bottleneck(at: Place, people: Sequence[TruePerson]) -> Iterator[Happening]:
    """Yield when a zone fills while fewer people than usual leave it."""
    least_pm2 = at.rule.get("density_pm2", FRUIN_PM2["D"])
    if stays_below(at, people, least_pm2):
        return
    inside = np.array([at.holds(person) for person in people])
    t_s = people[0].t_s
    looked = np.unique(looks(t_s))
    density = cache(lambda n: voronoi_density_pm2(at.polygon_m, _there_m(people, n), CUT_M))
    left_s = np.array(sorted(one for k, p in enumerate(people) for one in _leaves_s(p, inside[k])))
    clogs = {}
    for n, now in ((n, float(t_s[n])) for n in looked.tolist()):
        known_s = min(now - float(t_s[0]), USUALLY_S)
        lately, usually = (
            int(((left_s > now - one_s - SAME_S) & (left_s <= now)).sum())
            for one_s in (LATELY_S, USUALLY_S)
        )
        slow = lately / LATELY_S < at.rule.get("share", 0.5) * usually / max(known_s, SAME_S)
        clogs[n] = (
            slow
            and known_s >= KNOWN_S - SAME_S
            and _fills(now, t_s[looked], lambda k: density(int(looked[k])), least_pm2)
        )
    yield from of_place(at, t_s, inside, _at_all(t_s, clogs))


def _fills(
    now: float, look_s: Times, density_pm2: Callable[[int], float], least_pm2: float
) -> bool:
    """Tell whether it is dense in the last half of `LATELY_S`, and denser than in the first."""
    is_late = (look_s > now - LATELY_S / 2) & (look_s <= now)
    is_early = (look_s >= now - LATELY_S - SAME_S) & (look_s <= now - LATELY_S / 2)
    late, early = (
        [density_pm2(k) for k in np.flatnonzero(one).tolist()] for one in (is_late, is_early)
    )
    dense = bool(late) and np.mean(late) >= least_pm2
    return bool(dense and early) and bool(np.mean(late) > np.mean(early) + 1e-9)


def _leaves_s(person: TruePerson, inside: Flags) -> Iterator[float]:
    """Yield when somebody leaves the zone [s]; who is not there any more has not left it."""
    last_in_s = -math.inf
    for n in np.flatnonzero(person.there):
        now = float(person.t_s[n])
        if inside[n]:
            last_in_s = now
        elif now - last_in_s <= LATELY_S:
            yield now
            last_in_s = -math.inf


def _at_all(t_s: Times, found: Mapping[int, bool]) -> Flags:
    """Return for all moments what was found at the last look."""
    return np.array([found[n] for n in looks(t_s).tolist()])
