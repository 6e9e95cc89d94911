"""Small corrections of the filters' path: companions, and others in the way.

Notes
-----
Each correction is a velocity f [m/s] that turns with the scene, times (c1 T + c2 T^2), with the
horizon T in units of 4.8 s; the two numbers c1, c2 per correction [s] are fitted, see
`trecsim.forecasting.table`. Companions are people nearby of nearly the same velocity: who walks
together goes on together, so their mean velocity tells where the person goes. Others are in the
way when, at constant velocities, they come close soon.
"""

import numpy as np
from jaxtyping import Float64

from trecsim.forecasting.filters import Motion
from trecsim.forecasting.tuning import FULL_AHEAD_S
from trecsim.forecasting.values import Pasts

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
    """Return the velocity of each correction [m/s], in the order of `NAMES`."""
    own = motion.velocity_mps
    towards_m = pasts.xy_m[None, :, -1] - pasts.xy_m[:, None, -1]
    relative = own[None] - own[:, None]
    not_self = ~np.eye(len(own), dtype=bool)
    return np.stack(
        [
            _companions(own, towards_m, relative, not_self),
            _in_the_way(own, towards_m, relative, not_self),
        ],
        axis=1,
    )


def _companions(
    own: np.ndarray, towards_m: np.ndarray, relative: np.ndarray, not_self: np.ndarray
) -> np.ndarray:
    near = (towards_m**2).sum(axis=2) / COMPANION_M**2
    alike = (relative**2).sum(axis=2) / COMPANION_MPS**2
    weight = np.exp(-0.5 * (near + alike)) * not_self
    mean = _summed(weight, relative) / (ALONE + weight.sum(axis=1, keepdims=True))
    return np.where(np.linalg.norm(own, axis=1, keepdims=True) > STANDING_MPS, mean, 0.0)


def _in_the_way(
    own: np.ndarray, towards_m: np.ndarray, relative: np.ndarray, not_self: np.ndarray
) -> np.ndarray:
    speed2 = np.maximum((relative**2).sum(axis=2), 0.01)
    meet_s = np.clip(-(towards_m * relative).sum(axis=2) / speed2, 0.0, FULL_AHEAD_S)
    closest_m = towards_m + meet_s[..., None] * relative
    distance_m = np.linalg.norm(closest_m, axis=2)
    push = np.exp(-distance_m / NEAR_M - meet_s / SOON_S) * (meet_s > 0.0) * not_self
    away = -closest_m / np.maximum(distance_m, 0.1)[..., None]
    return np.asarray(_summed(push, away) * np.linalg.norm(own, axis=1, keepdims=True))


def _summed(weight: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """Return the weighted sum over the others, (person, 2)."""
    total: np.ndarray = (weight[:, None] @ vectors)[:, 0]
    return total
