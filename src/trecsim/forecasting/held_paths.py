"""Walls: no path crosses one.

Notes
-----
Who walks at a wall stops at it or goes on along it. A mode of a forecast that would cross a wall
therefore loses the part of its motion that is square to the wall, as balls that slide. What its
covariance still puts behind a wall beside it is cut off: mean and covariance become those of the
part of the normal distribution on this side. With the distance d to the wall along its normal n, in
standard deviations s = sqrt(n'Cn), and the normal density and distribution at d, their ratio r:

    mean - C n / s * r,    C - C n n' C / s^2 * r (d + r)

(moments of a truncated normal distribution, as in expectation propagation). One wall after the
other cuts; where the next one has moved the mean behind a wall, as between the walls of a narrow
corridor, that wall cuts again. A mean that is still behind one stays before it. The stated regions
move with the first mode and keep their size: whoever cannot get beyond a wall is inside all the
more.
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
SWEEPS = 3
"""So often walls cut at most."""
_FARTHEST_SIGMAS = 20.0
_DISTANCES = np.arange(-_FARTHEST_SIGMAS, NEAR_SIGMAS, 0.002)
_HAZARDS = np.array(
    [
        math.sqrt(2.0 / math.pi) * math.exp(-0.5 * d * d) / math.erfc(-d / math.sqrt(2.0))
        for d in _DISTANCES.tolist()
    ]
)
"""The normal density over the normal distribution at these distances."""


def held_by_walls(made: Forecasts, walls: Walls) -> Forecasts:
    """Return forecasts whose modes stay on their side of all walls.

    Parameters
    ----------
    made
        Forecasts that know no walls.
    walls
        The walls.
    """
    if not len(walls) or not len(made.person):
        return replace(made, walls=walls)
    people, modes, steps = made.xy_m.shape[:3]
    from_m = np.repeat(made.from_m, modes, axis=0)
    path_m = made.xy_m.reshape(-1, steps, 2)
    sigma_m = np.sqrt(made.cov_m2[..., 0, 0] + made.cov_m2[..., 1, 1]).max(initial=0.0)
    reach_m = _longest_m(from_m, path_m) + NEAR_SIGMAS * sigma_m + GAP_M
    close = walls.near(from_m.min(axis=0) - reach_m, from_m.max(axis=0) + reach_m)
    if not len(close):
        return replace(made, walls=walls)
    xy_m = slid(from_m, path_m, close)
    xy_m, cov_m2 = cut_off(xy_m, made.cov_m2.reshape(-1, steps, 2, 2), close)
    return replace(
        made,
        xy_m=xy_m.reshape(people, modes, steps, 2),
        cov_m2=cov_m2.reshape(people, modes, steps, 2, 2),
        walls=walls,
    )


def _longest_m(from_m: np.ndarray, path_m: np.ndarray) -> float:
    """Return the length of the longest path [m]: along walls it gets no farther."""
    ways_m = np.diff(np.concatenate([from_m[:, None], path_m], axis=1), axis=1)
    return float(np.hypot(ways_m[..., 0], ways_m[..., 1]).sum(axis=1).max())


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
    """Return where people get who would move by `by_m`, both (path, 2).

    They keep away from a wall by stopping earlier on their own way, which is free: a step back
    square to the wall could cross another one, as in a narrow corner.
    """
    at_m, moving = at_m.copy(), np.arange(len(at_m))
    for _ in range(SLIDES):
        share, wall = first_met(at_m[moving], by_m, walls)
        meets = np.isfinite(share)
        at_m[moving[~meets]] += by_m[~meets]
        moving, by_m = moving[meets], by_m[meets]
        if not len(moving):
            break
        along, normal = _axes(walls.ends_m[wall[meets]])
        until = np.maximum(share[meets] - GAP_M / np.abs(_dot(by_m, normal)), 0.0)[:, None]
        at_m[moving] += until * by_m
        by_m = _dot((1.0 - until) * by_m, along)[:, None] * along
    return at_m


def cut_off(
    xy_m: Float64[np.ndarray, "path step 2"],
    cov_m2: Float64[np.ndarray, "path step 2 2"],
    walls: Walls,
) -> tuple[Float64[np.ndarray, "path step 2"], Float64[np.ndarray, "path step 2 2"]]:
    """Return means and covariances of what is on this side of the walls beside each point."""
    at_m, left_m2 = xy_m.reshape(-1, 2), cov_m2.reshape(-1, 2, 2).copy()
    point, away, ends_m = _beside(at_m, left_m2, walls)
    if not len(point):
        return xy_m, cov_m2
    mean_m = at_m.copy()
    turn = np.arange(len(point)) - np.searchsorted(point, point)  # the first wall of each, ...
    for most in (NEAR_SIGMAS, *[0.0] * (SWEEPS - 1)):  # again only where the mean is behind
        for n in range(turn.max() + 1):
            now = turn == n
            _cut(mean_m, left_m2, point[now], away[now], ends_m[now], most)
    return _before_walls(at_m, mean_m, walls).reshape(xy_m.shape), left_m2.reshape(cov_m2.shape)


def _beside(
    at_m: np.ndarray, cov_m2: np.ndarray, walls: Walls
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return which points have which walls beside them: points in order, ways there, an end."""
    reach_m = NEAR_SIGMAS * np.sqrt(_widest_m2(cov_m2))[:, None]
    point, wall = np.nonzero(walls.in_boxes(at_m - reach_m, at_m + reach_m))
    along, normal = _axes(walls.ends_m)
    ends_m, long_m = walls.ends_m[:, 0], _dot(walls.ends_m[:, 1] - walls.ends_m[:, 0], along)
    off_m = at_m[point] - ends_m[wall]
    place_m, across_m = _dot(off_m, along[wall]), _dot(off_m, normal[wall])
    away = np.where(across_m > 0.0, -1.0, 1.0)[:, None] * normal[wall]
    variance_m2 = _dot(away, _leaning(cov_m2[point], away))
    beside = (place_m >= 0.0) & (place_m <= long_m[wall])
    beside &= across_m**2 < NEAR_SIGMAS**2 * variance_m2
    return point[beside], away[beside], ends_m[wall[beside]]


def _widest_m2(cov_m2: np.ndarray) -> np.ndarray:
    """Return the largest variance in any direction."""
    xx, yy = cov_m2[:, 0, 0], cov_m2[:, 1, 1]
    return np.asarray(0.5 * (xx + yy + np.hypot(xx - yy, 2.0 * cov_m2[:, 0, 1])))


def _cut(
    mean_m: np.ndarray,
    cov_m2: np.ndarray,
    point: np.ndarray,
    away: np.ndarray,
    end_m: np.ndarray,
    most: float,
) -> None:
    """Cut off what is behind one wall for each of some points.

    Parameters
    ----------
    mean_m, cov_m2
        Means and covariances of all points, which are changed.
    point, away, end_m
        Which points, the way to the wall of each, and an end of the wall.
    most
        A wall that is farther away cuts nothing [standard deviations].
    """
    leans_m2 = _leaning(cov_m2[point], away)
    sigma_m = np.sqrt(np.maximum(_dot(away, leans_m2), 1e-12))
    distance = _dot(end_m - mean_m[point], away) / sigma_m
    near = distance < most
    point, leans_m2, sigma_m = point[near], leans_m2[near], sigma_m[near]
    distance = np.maximum(distance[near], -_FARTHEST_SIGMAS)
    ratio = np.interp(distance, _DISTANCES, _HAZARDS)
    shrink = ratio * (distance + ratio) / sigma_m**2
    mean_m[point] -= (ratio / sigma_m)[:, None] * leans_m2
    cov_m2[point] -= shrink[:, None, None] * leans_m2[:, :, None] * leans_m2[:, None, :]


def _leaning(cov_m2: np.ndarray, away: np.ndarray) -> np.ndarray:
    """Return covariances times directions, (n, 2)."""
    return np.asarray(cov_m2[:, :, 0] * away[:, :1] + cov_m2[:, :, 1] * away[:, 1:])


def _before_walls(at_m: np.ndarray, mean_m: np.ndarray, walls: Walls) -> np.ndarray:
    """Return means, those behind a wall half-way from where the path is to the wall."""
    moved = np.flatnonzero((mean_m != at_m).any(axis=1))
    by_m = mean_m[moved] - at_m[moved]
    share, _ = first_met(at_m[moved], by_m, walls)
    behind = np.isfinite(share)
    held_m = mean_m.copy()
    held_m[moved[behind]] = at_m[moved[behind]] + 0.5 * share[behind, None] * by_m[behind]
    return held_m


def _axes(ends_m: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return unit vectors along walls and square to them, (wall, 2) each."""
    by_m = ends_m[:, 1] - ends_m[:, 0]
    along = by_m / np.maximum(np.linalg.norm(by_m, axis=1, keepdims=True), 1e-12)
    return along, np.stack([-along[:, 1], along[:, 0]], axis=1)


def _dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.asarray(a[:, 0] * b[:, 0] + a[:, 1] * b[:, 1])
