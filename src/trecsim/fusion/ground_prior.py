"""The ground under people who are new: what those before them have shown."""

from collections import deque

import numpy as np
from jaxtyping import Bool

from trecsim.fusion.population import Population
from trecsim.fusion.tuning import (
    FIRST_LEVEL_SIGMA_M,
    KNOWN_LEVEL_M2,
    LEVELS_REMEMBERED,
    UNKNOWN_LEVEL_WEIGHT,
)


class KnownGround:
    """Remembers the height of the ground under people who have gone."""

    def __init__(self) -> None:
        self._level_m: deque[float] = deque(maxlen=LEVELS_REMEMBERED)

    def note(self, people: Population, gone: Bool[np.ndarray, " track"]) -> None:
        """Remember the ground under those of the people who go."""
        self._level_m.extend(_known_m(people, gone))

    def expected(self, people: Population) -> tuple[float, float]:
        """Return the height of the ground under somebody new, and its variance [m, m^2].

        Parameters
        ----------
        people
            Those who are there.

        Notes
        -----
        Each person whose ground two cameras have measured is a sample. The assumption before any
        of them, ``z = 0`` within `FIRST_LEVEL_SIGMA_M`, counts as part of one more: on a level
        ground the variance falls with the number of people, on stairs it does not.
        """
        level_m = np.array([*self._level_m, *_known_m(people, people.confirmed)])
        total = len(level_m) + UNKNOWN_LEVEL_WEIGHT
        mean_m = float(level_m.sum()) / total
        spread_m2 = float(((level_m - mean_m) ** 2).sum())
        before_m2 = UNKNOWN_LEVEL_WEIGHT * (mean_m**2 + FIRST_LEVEL_SIGMA_M**2)
        return mean_m, (spread_m2 + before_m2) / total


def _known_m(people: Population, which: Bool[np.ndarray, " track"]) -> list[float]:
    """Return the heights of the ground under the people `which` that two cameras measured [m]."""
    level_m, var_m2 = people.ground_level.T
    good = which & people.confirmed & (var_m2 < KNOWN_LEVEL_M2)
    known: list[float] = level_m[good].tolist()
    return known
