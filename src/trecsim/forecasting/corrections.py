"""Small corrections of the filters' path: companions, and others in the way.

Notes
-----
Each correction is a velocity f [m/s] that turns with the scene, times (c1 T + c2 T^2), with the
horizon T in units of 4.8 s; the two numbers c1, c2 per correction [s] are fitted, see
`trecsim.forecasting.spread_table`. Companions are people nearby of nearly the same velocity: who
walks together goes on together, so their mean velocity tells where the person goes. Others are in
the way when, at constant velocities, they come close soon.
"""

import numpy as np
from jaxtyping import Float64

from trecsim.forecasting.constants import FULL_AHEAD_S
from trecsim.forecasting.filters import Motion
from trecsim.forecasting.forecasts import Pasts

NAMES = ("companions", "in the way")
COMPANION_M, COMPANION_MPS, ALONE = 2.5, 0.35, 0.3
"""How near and how alike companions are, and the weight of the own velocity beside theirs."""
STANDING_MPS = 0.25
"""Slower people have no companions: all who stand have the same velocity."""
NEAR_M, SOON_S = 0.6, 3.2
"""How close and how soon an encounter has to be to matter."""


def corrected(
    path_m: Float64[np.ndarray, "person step 2"],
    pasts: Pasts,
    motion: Motion,
    ahead_s: Float64[np.ndarray, " step"],
    coefficients_s: Float64[np.ndarray, "correction 2"],
) -> Float64[np.ndarray, "person step 2"]:
    """Return the filters' path with all corrections."""
    terms = velocities(pasts, motion)
    return np.asarray(path_m + (growth(ahead_s) @ coefficients_s.T) @ terms)


def growth(ahead_s: Float64[np.ndarray, " step"]) -> Float64[np.ndarray, "step 2"]:
    """Return T and T^2 per horizon."""
    share = ahead_s / FULL_AHEAD_S
    return np.stack([share, share**2], axis=1)


def velocities(pasts: Pasts, motion: Motion) -> Float64[np.ndarray, "person correction 2"]:
    """Return the velocity of each correction [m/s], in the order of `NAMES`.

    Vectors are complex numbers x + iy here, for speed: all pairs of people are looked at.
    """
    own = _complex(motion.velocity_mps)
    at_m = _complex(pasts.xy_m[:, -1])
    towards_m, relative = at_m - at_m[:, None], own - own[:, None]
    found = [_companions(own, towards_m, relative), _in_the_way(own, towards_m, relative)]
    terms = np.stack(found, axis=1)
    return np.stack([terms.real, terms.imag], axis=2)


def _companions(own: np.ndarray, towards_m: np.ndarray, relative: np.ndarray) -> np.ndarray:
    size2 = _size2(towards_m) / COMPANION_M**2 + _size2(relative) / COMPANION_MPS**2
    weight = np.exp(-0.5 * size2)
    np.fill_diagonal(weight, 0.0)
    mean = (weight * relative).sum(axis=1) / (ALONE + weight.sum(axis=1))
    return np.where(np.abs(own) > STANDING_MPS, mean, 0.0)


def _in_the_way(own: np.ndarray, towards_m: np.ndarray, relative: np.ndarray) -> np.ndarray:
    closing = -(towards_m.real * relative.real + towards_m.imag * relative.imag)
    meet_s = np.clip(closing / np.maximum(_size2(relative), 0.01), 0.0, FULL_AHEAD_S)
    closest_m = towards_m + meet_s * relative
    distance_m = np.sqrt(_size2(closest_m))
    push = np.where(meet_s > 0.0, np.exp(-distance_m / NEAR_M - meet_s / SOON_S), 0.0)
    np.fill_diagonal(push, 0.0)
    away = (push / np.maximum(distance_m, 0.1) * closest_m).sum(axis=1)
    return np.asarray(-away * np.abs(own))


def _complex(vectors: np.ndarray) -> np.ndarray:
    return np.asarray(vectors[:, 0] + 1j * vectors[:, 1])


def _size2(vectors: np.ndarray) -> np.ndarray:
    """Return the squared length of complex vectors."""
    return np.asarray(vectors.real**2 + vectors.imag**2)
