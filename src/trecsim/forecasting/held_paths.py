"""Walls: no path crosses one.

Notes
-----
Who walks at a wall stops at it or goes on along it. A mode of a forecast that would cross a wall
therefore loses the part of its motion that is square to the wall, as balls that slide. What its
covariance still puts behind a wall beside it is cut off: mean and covariance become those of the
part of the normal distribution on this side. With the distance d to the wall along its normal n, in
standard deviations s = sqrt(n'Cn), and the normal density and distribution at d, their ratio r:

    mean - C n / s * r,    C - C n n' C / s^2 * r (d + r)

(moments of a truncated normal distribution, as in expectation propagation). The stated regions move
with the first mode and keep their size: whoever cannot get beyond a wall is inside all the more.
"""

import math
from dataclasses import replace

import numpy as np
from jaxtyping import Float64

from trecsim.forecasting.forecasts import Forecasts
from trecsim.forecasting.walls import Walls, first_met

NEAR_SIGMAS = 4.0
"""Of a wall farther away, in standard deviations, nothing is cut off."""
GAP_M = 0.01
"""Paths that meet a wall stay so far before it [m]."""
SLIDES = 3
"""So many walls are met within a step at most: a corner has two."""
_ERF = np.vectorize(math.erf, otypes=[np.float64])


def held_by_walls(made: Forecasts, walls: Walls) -> Forecasts:
    """Return forecasts whose modes stay on their side of all walls.

    Parameters
    ----------
    made
        Forecasts that know no walls.
    walls
        The walls.
    """
    if not len(walls):
        return made
    sigma_m = np.sqrt(made.cov_m2[..., 0, 0] + made.cov_m2[..., 1, 1]).max(initial=0.0)
    there_m = np.concatenate([made.xy_m.reshape(-1, 2), made.from_m])
    reach_m = NEAR_SIGMAS * sigma_m + GAP_M
    close = walls.near(there_m.min(axis=0) - reach_m, there_m.max(axis=0) + reach_m)
    if not len(close):
        return replace(made, walls=walls)
    people, modes, steps = made.xy_m.shape[:3]
    from_m = np.repeat(made.from_m, modes, axis=0)
    xy_m = slid(from_m, made.xy_m.reshape(-1, steps, 2), close)
    xy_m, cov_m2 = cut_off(xy_m, made.cov_m2.reshape(-1, steps, 2, 2), close)
    return replace(
        made,
        xy_m=xy_m.reshape(people, modes, steps, 2),
        cov_m2=cov_m2.reshape(people, modes, steps, 2, 2),
        walls=walls,
    )


def slid(
    from_m: Float64[np.ndarray, "path 2"], path_m: Float64[np.ndarray, "path step 2"], walls: Walls
) -> Float64[np.ndarray, "path step 2"]:
    """Return paths that go along the walls that they would cross.

    Parameters
    ----------
    from_m
        Where each begins [m].
    path_m
        Where it would get [m].
    walls
        The walls.
    """
    at_m, before_m, held_m = from_m, from_m, np.empty_like(path_m)
    for step in range(path_m.shape[1]):
        at_m = _moved(at_m, path_m[:, step] - before_m, walls)
        before_m, held_m[:, step] = path_m[:, step], at_m
    return held_m


def _moved(at_m: np.ndarray, by_m: np.ndarray, walls: Walls) -> np.ndarray:
    """Return where people get who would move by `by_m`, both (path, 2)."""
    for _ in range(SLIDES):
        share, wall = first_met(at_m, by_m, walls)
        meets = np.isfinite(share)
        if not meets.any():
            return np.asarray(at_m + by_m)
        along, normal = _axes(walls.ends_m[wall])
        normal = normal * np.sign(_dot(by_m, normal))[:, None]  # the way people go
        until = np.where(meets, share, 1.0)[:, None]
        back_m = np.where(meets, GAP_M, 0.0)[:, None] * normal
        left_m = (1.0 - until) * by_m
        at_m = at_m + until * by_m - back_m
        by_m = np.where(meets[:, None], _dot(left_m, along)[:, None] * along, 0.0)
    return at_m


def cut_off(
    xy_m: Float64[np.ndarray, "path step 2"],
    cov_m2: Float64[np.ndarray, "path step 2 2"],
    walls: Walls,
) -> tuple[Float64[np.ndarray, "path step 2"], Float64[np.ndarray, "path step 2 2"]]:
    """Return means and covariances of what is on this side of the walls beside each point."""
    for ends_m in walls.ends_m:
        along, normal = _axes(ends_m[None])
        off_m = xy_m - ends_m[0]
        place, across_m = off_m @ along[0], off_m @ normal[0]
        beside = (place >= 0.0) & (place <= np.linalg.norm(ends_m[1] - ends_m[0]))
        away = np.where(across_m > 0.0, -1.0, 1.0)[..., None] * normal[0]  # to the wall
        leans_m2 = (cov_m2 @ away[..., None])[..., 0]
        sigma_m = np.sqrt(np.maximum(_dot(away, leans_m2), 1e-12))
        distance = np.abs(across_m) / sigma_m
        near = beside & (distance < NEAR_SIGMAS)
        if not near.any():
            continue
        ratio = np.zeros(distance.shape)
        ratio[near] = _hazard(distance[near])
        shrink = ratio * (distance + ratio) / sigma_m**2
        xy_m = xy_m - (ratio / sigma_m)[..., None] * leans_m2
        cov_m2 = cov_m2 - shrink[..., None, None] * leans_m2[..., :, None] * leans_m2[..., None, :]
    return xy_m, cov_m2


def _hazard(distance: np.ndarray) -> np.ndarray:
    """Return the normal density over the normal distribution at a distance of at least 0."""
    density = np.exp(-0.5 * distance**2) / math.sqrt(2.0 * math.pi)
    return np.asarray(density / (0.5 + 0.5 * _ERF(distance / math.sqrt(2.0))))


def _axes(ends_m: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return unit vectors along walls and square to them, (wall, 2) each."""
    by_m = ends_m[:, 1] - ends_m[:, 0]
    along = by_m / np.maximum(np.linalg.norm(by_m, axis=1, keepdims=True), 1e-12)
    return along, np.stack([-along[:, 1], along[:, 0]], axis=1)


def _dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.asarray((a * b).sum(axis=-1))
