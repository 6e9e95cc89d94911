"""Made walks for the tests of forecasts."""

from collections.abc import Iterator

import numpy as np

from trecsim.forecasting import Moment

STEP_S = 0.4


def walks(seed: int, people: int, moments: int, *, noise_m: float = 0.01) -> list[Moment]:
    """Return people who walk, turn a little all the time and are measured with an error."""
    rng = np.random.default_rng(seed)
    at_m, velocity = rng.uniform(0, 12, (people, 2)), rng.normal(0, 0.9, (people, 2))
    person = np.arange(people) + 5
    found: list[Moment] = []
    for i in range(moments):
        velocity = velocity + rng.normal(0, 0.08, velocity.shape)
        at_m = at_m + STEP_S * velocity
        found.append((i * STEP_S, person, at_m + rng.normal(0, noise_m, at_m.shape)))
    return found


def line(speed_mps: float, moments: int, step_s: float = STEP_S) -> Iterator[Moment]:
    """Yield one person who walks along x."""
    for i in range(moments):
        yield i * step_s, np.array([7]), np.array([[speed_mps * i * step_s, 1.0]])
