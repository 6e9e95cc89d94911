"""The corrections for companions and people in the way, against a slow twin."""

import numpy as np
import pytest

from trecsim.forecasting import corrections as c
from trecsim.forecasting.constants import FULL_AHEAD_S
from trecsim.forecasting.filters import Motion
from trecsim.forecasting.forecasts import Pasts


def by_hand(at_m: np.ndarray, velocity: np.ndarray, i: int) -> np.ndarray:
    """Return both corrections of one person, one other after the other."""
    mean, weights, away = np.zeros(2), c.ALONE, np.zeros(2)
    for j in range(len(at_m)):
        if j == i:
            continue
        towards, relative = at_m[j] - at_m[i], velocity[j] - velocity[i]
        near, alike = towards @ towards / c.COMPANION_M**2, relative @ relative / c.COMPANION_MPS**2
        weight = np.exp(-(near + alike) / 2)
        mean += weight * relative
        weights += weight
        meet_s = -(towards @ relative) / max(relative @ relative, 0.01)
        if meet_s > 0:
            meet_s = min(meet_s, FULL_AHEAD_S)
            closest = towards + meet_s * relative
            distance = np.linalg.norm(closest)
            push = np.exp(-distance / c.NEAR_M - meet_s / c.SOON_S)
            away -= push * closest / max(distance, 0.1)
    speed = np.linalg.norm(velocity[i])
    companions = mean / weights if speed > c.STANDING_MPS else np.zeros(2)
    return np.stack([companions, away * speed])


@pytest.mark.parametrize("seed", range(4))
def test_corrections_equal_those_by_hand(seed: int) -> None:
    rng = np.random.default_rng(seed)
    at_m, velocity = rng.uniform(0, 5, (7, 2)), rng.normal(0, 0.6, (7, 2))
    velocity[2] = 0.1  # stands
    pasts = Pasts(0.0, np.arange(7), np.repeat(at_m[:, None], 8, axis=1))
    state = np.stack([at_m, velocity, np.zeros((7, 2))], axis=1)
    found = c.velocities(pasts, Motion(state, np.zeros(7)))
    wanted = [by_hand(at_m, velocity, i) for i in range(7)]
    np.testing.assert_allclose(found, wanted, atol=1e-12)


def test_nobody_else_changes_nothing() -> None:
    pasts = Pasts(0.0, np.array([1]), np.zeros((1, 8, 2)))
    motion = Motion(np.ones((1, 3, 2)), np.zeros(1))
    np.testing.assert_array_equal(c.velocities(pasts, motion), 0.0)


def test_who_comes_towards_is_passed_on_the_free_side() -> None:
    at_m = np.array([[0.0, 0.0], [4.0, 0.3]])
    velocity = np.array([[1.2, 0.0], [-1.2, 0.0]])
    pasts = Pasts(0.0, np.array([1, 2]), np.repeat(at_m[:, None], 8, axis=1))
    state = np.stack([at_m, velocity, np.zeros((2, 2))], axis=1)
    away = c.velocities(pasts, Motion(state, np.zeros(2)))[:, 1]
    assert away[0, 1] < -0.01 < 0.01 < away[1, 1]
