"""Walls on the floor: where motions meet them, and what lies behind them."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Bool, Float64, Int64

MOST_WALLS = 500
"""Straight pieces of a site; more would hold up each forecast."""
_ENDS_SHARE = 1e-9
"""Walls are longer by this share at both ends: nobody slips through a corner of two by rounding."""
_BOX_M = 1e-6
"""Boxes that are so far from each other touch [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class Walls:
    """The walls of a site.

    Attributes
    ----------
    ends_m
        Both ends of each straight piece, on the floor [m].
    """

    ends_m: Float64[np.ndarray, "wall 2 2"]

    @classmethod
    def along(cls, lines_m: Sequence[Sequence[Sequence[float]]]) -> "Walls":
        """Return the walls along some lines of points [m].

        Examples
        --------
        >>> Walls.along([[(0.0, 0.0), (4.0, 0.0), (4.0, 3.0)]]).ends_m.tolist()
        [[[0.0, 0.0], [4.0, 0.0]], [[4.0, 0.0], [4.0, 3.0]]]
        """
        pieces = [piece for line in lines_m for piece in pairwise(line)]
        return cls(np.array(pieces, np.float64).reshape(-1, 2, 2))

    def __len__(self) -> int:
        """Return the number of straight pieces."""
        return len(self.ends_m)

    def near(self, low_m: Float64[np.ndarray, " 2"], high_m: Float64[np.ndarray, " 2"]) -> "Walls":
        """Return the pieces that may be met inside a box."""
        return Walls(self.ends_m[self.in_boxes(low_m[None], high_m[None])[0]])

    def in_boxes(
        self, low_m: Float64[np.ndarray, "box 2"], high_m: Float64[np.ndarray, "box 2"]
    ) -> Bool[np.ndarray, "box wall"]:
        """Tell which pieces may be met inside each box."""
        below, above = self.ends_m.min(axis=1) - _BOX_M, self.ends_m.max(axis=1) + _BOX_M
        x, y = (
            (below[:, axis] <= high_m[:, axis, None]) & (above[:, axis] >= low_m[:, axis, None])
            for axis in (0, 1)
        )
        return np.asarray(x & y)


NO_WALLS = Walls(np.empty((0, 2, 2)))


def first_met(
    at_m: Float64[np.ndarray, "path 2"], by_m: Float64[np.ndarray, "path 2"], walls: Walls
) -> tuple[Float64[np.ndarray, " path"], Int64[np.ndarray, " path"]]:
    """Return at which share of a straight motion it first meets a wall, and which wall.

    Parameters
    ----------
    at_m, by_m
        Where each begins, and how far it goes [m].
    walls
        The walls.

    Returns
    -------
    share
        Up to 1, infinity where it meets none. A wall on which a motion begins is not met.
    wall
        The wall; of several that are met at once the first.
    """
    to_m = at_m + by_m
    path, wall = np.nonzero(walls.in_boxes(np.minimum(at_m, to_m), np.maximum(at_m, to_m)))
    shares = _share(at_m.T[:, path], by_m.T[:, path], walls.ends_m[wall])
    share, first = np.full(len(at_m), np.inf), np.zeros(len(at_m), np.int64)
    np.minimum.at(share, path, shares)
    are_first = np.flatnonzero(np.isfinite(shares) & (shares == share[path]))[::-1]
    first[path[are_first]] = wall[are_first]
    return share, first


def _share(at_m: np.ndarray, by_m: np.ndarray, ends_m: np.ndarray) -> np.ndarray:
    """Return at which share of each motion (axis, path) it meets its wall, or the only one."""
    by_x, by_y = by_m
    (to_x, to_y), (wall_x, wall_y) = (ends_m[:, 0].T - at_m), (ends_m[:, 1] - ends_m[:, 0]).T
    cross = by_x * wall_y - by_y * wall_x
    slanted = np.abs(cross) > 1e-12
    safe = np.where(slanted, cross, 1.0)
    share, place = (to_x * wall_y - to_y * wall_x) / safe, (to_x * by_y - to_y * by_x) / safe
    met = slanted & (share > 0.0) & (share <= 1.0)
    met &= (place >= -_ENDS_SHARE) & (place <= 1.0 + _ENDS_SHARE)
    return np.where(met, share, np.inf)


def sees(
    from_m: Float64[np.ndarray, "person point 2"],
    place_m: Float64[np.ndarray, "spot 2"],
    walls: Walls,
) -> Bool[np.ndarray, " person"]:
    """Tell who sees a place: from any point, any point of it, with no wall between.

    Parameters
    ----------
    from_m
        Where each person is, now or later [m].
    place_m
        Points of the place [m].
    walls
        The walls.

    Notes
    -----
    One way of each person is compared with all walls. What hides it hides most others as well, so
    these walls are then compared with all ways that are left. The cost hardly grows with the walls.
    """
    ends_m = np.concatenate([from_m.reshape(-1, 2), place_m])
    walls = walls.near(ends_m.min(axis=0), ends_m.max(axis=0))
    seeing = np.ones(len(from_m), np.bool_)
    if len(walls):
        seeing = _see(from_m[:, :1], place_m, walls)  # of most people that decides
        seeing[~seeing] = _see(from_m[~seeing, 1:], place_m, walls)
    return seeing


def _see(from_m: np.ndarray, place_m: np.ndarray, walls: Walls) -> np.ndarray:
    """Do the work of `sees`."""
    people, points = from_m.shape[:2]
    at_m = np.repeat(from_m.reshape(-1, 2).T, len(place_m), axis=1)
    by_m = np.tile(place_m.T, (1, people * points)) - at_m
    person = np.repeat(np.arange(people), points * len(place_m))
    seeing = np.zeros(people, np.bool_)
    while len(person):
        tried = np.flatnonzero(np.diff(person, prepend=-1))
        share, wall = first_met(at_m[:, tried].T, by_m[:, tried].T, walls)
        is_hidden = np.isfinite(share)
        seeing[person[tried[~is_hidden]]] = True
        left = ~seeing[person]
        left[tried] = False
        rows = np.flatnonzero(left)
        for one in np.unique(wall[is_hidden]):
            ends_m = walls.ends_m[one : one + 1]
            rows = rows[np.isinf(_share(at_m[:, rows], by_m[:, rows], ends_m))]
        at_m, by_m, person = at_m[:, rows], by_m[:, rows], person[rows]
    return seeing
