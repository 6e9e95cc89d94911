"""Walls on the floor: where motions meet them, and what lies behind them."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Bool, Float64


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
    def along(cls, lines_m: Sequence[Sequence[tuple[float, float]]]) -> "Walls":
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
        below, above = self.ends_m.min(axis=1), self.ends_m.max(axis=1)
        return Walls(self.ends_m[((below <= high_m) & (above >= low_m)).all(axis=1)])


NO_WALLS = Walls(np.empty((0, 2, 2)))


def first_met(
    at_m: Float64[np.ndarray, "path 2"], by_m: Float64[np.ndarray, "path 2"], walls: Walls
) -> tuple[Float64[np.ndarray, " path"], np.ndarray]:
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
        From 0 to 1, infinity where it meets none.
    wall
        The wall.
    """
    a, b = walls.ends_m[:, 0], walls.ends_m[:, 1]
    to_m, wall_m = a - at_m[:, None], b - a
    cross = _cross(by_m[:, None], wall_m)
    slanted = np.abs(cross) > 1e-12
    safe = np.where(slanted, cross, 1.0)
    share, place = _cross(to_m, wall_m) / safe, _cross(to_m, by_m[:, None]) / safe
    met = slanted & (share >= 0.0) & (share <= 1.0) & (place >= 0.0) & (place <= 1.0)
    share = np.where(met, share, np.inf)
    wall = share.argmin(axis=1)
    return share[np.arange(len(share)), wall], wall


def hidden(
    seen_from_m: Float64[np.ndarray, "path 2"],
    place_m: Float64[np.ndarray, "corner 2"],
    walls: Walls,
) -> Bool[np.ndarray, "path corner"]:
    """Tell which corners of a place lie behind a wall, seen from somewhere."""
    by_m = place_m - seen_from_m[:, None]
    at_m = np.broadcast_to(seen_from_m[:, None], by_m.shape)
    share, _ = first_met(at_m.reshape(-1, 2), by_m.reshape(-1, 2), walls)
    return np.asarray(np.isfinite(share).reshape(by_m.shape[:2]))


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
