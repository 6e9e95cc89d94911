"""Rules on crowds in a zone, read naively: how many people, and how dense."""

from collections.abc import Iterator, Sequence

import numpy as np
from jaxtyping import Int64

from trecsim.lab.true_events.naive_places import voronoi_density_pm2
from trecsim.lab.true_events.true_people import TruePerson
from trecsim.lab.true_events.true_places import Happening, Place, of_place
from trecsim.lab.true_events.true_spans import SAME_S, Times

EVERY_S = 0.4
"""So often crowds are looked at [s]."""
CUT_M = 1.0
"""Nobody takes up floor that is farther away [m]."""
MOVING_MPS = 0.3
"""People who are faster than this in the mean move [m/s]."""
FRUIN_PM2 = {"B": 0.31, "C": 0.43, "D": 0.72, "E": 1.08, "F": 2.15}
"""From which density on each level of service begins [people/m^2]."""


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
    found = {}
    for n in np.unique(looks(people[0].t_s)).tolist():
        xy_m = np.array([person.floor_m[n] for person in people if person.there[n]])
        found[n] = voronoi_density_pm2(at.polygon_m, xy_m, CUT_M)
    return found


def density_level(at: Place, people: Sequence[TruePerson]) -> Iterator[Happening]:
    """Yield when the density is at a level of service or above; in F, if people move, at once."""
    inside = np.array([at.holds(person) for person in people])
    t_s, level = people[0].t_s, at.rule.get("level", "E")
    dense, packed = {}, {}
    speeds_mps = [np.hypot(*person.velocity_mps[:, :2].T) for person in people]
    for n, density in density_pm2(at, people).items():
        dense[n] = density > FRUIN_PM2[level]
        within = [speeds_mps[k][n] for k in np.flatnonzero(inside[:, n])]
        moves = bool(within) and float(np.nanmean(within)) > MOVING_MPS
        packed[n] = density > FRUIN_PM2["F"] and moves and level != "F"
    holds, at_once = (np.array([one[n] for n in looks(t_s).tolist()]) for one in (dense, packed))
    yield from of_place(at, t_s, inside, holds, at_once)
