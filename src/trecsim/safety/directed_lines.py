"""Where points are with respect to directed lines and edges on the floor."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

Points = Float64[np.ndarray, "point 2"]


@dataclass(frozen=True, slots=True, eq=False)
class Line:
    """A directed line on the floor, between two points.

    Attributes
    ----------
    points_m
        The first and the second point [m].
    """

    points_m: Float64[np.ndarray, "2 2"]

    @property
    def normal(self) -> Float64[np.ndarray, " 2"]:
        """The direction to its left, of length 1."""
        way_m = self.points_m[1] - self.points_m[0]
        left: Float64[np.ndarray, " 2"] = np.array([-way_m[1], way_m[0]]) / np.hypot(*way_m)
        return left

    def distance_m(self, xy_m: Points) -> Float64[np.ndarray, " point"]:
        """Return the distance from the line through both points, positive on the left [m].

        Examples
        --------
        >>> Line(np.array([[0.0, 0.0], [2.0, 0.0]])).distance_m(np.array([[5.0, 0.3], [1.0, -2.0]]))
        array([ 0.3, -2. ])
        """
        distance: Float64[np.ndarray, " point"] = (xy_m - self.points_m[0]) @ self.normal
        return distance

    def share(self, xy_m: Points) -> Float64[np.ndarray, " point"]:
        """Return where along the line each point is: 0 at the first point, 1 at the second."""
        way_m = self.points_m[1] - self.points_m[0]
        share: Float64[np.ndarray, " point"] = (xy_m - self.points_m[0]) @ way_m / (way_m @ way_m)
        return share


@dataclass(frozen=True, slots=True, eq=False)
class Edge:
    """The edge of a drop, which lies to the left of the way along its points.

    Attributes
    ----------
    points_m
        Points along the edge [m].
    """

    points_m: Float64[np.ndarray, "corner 2"]

    def nearest(
        self, xy_m: Points
    ) -> tuple[Float64[np.ndarray, " point"], Float64[np.ndarray, "point 2"]]:
        """Return the distance from the edge, and the direction in which it grows.

        Parameters
        ----------
        xy_m
            Points [m].

        Returns
        -------
        distance_m
            Positive on the safe side (right), negative over the drop; NaN for points that are
            before the beginning or behind the end of the edge [m].
        normal
            Of length 1.

        Examples
        --------
        >>> edge = Edge(np.array([[0.0, 0.0], [20.0, 0.0]]))
        >>> edge.nearest(np.array([[3.0, -0.4], [3.0, 0.1], [-1.0, -0.4]]))[0]
        array([ 0.4, -0.1,  nan])
        """
        start, way = self.points_m[:-1], np.diff(self.points_m, axis=0)
        right = np.stack([way[:, 1], -way[:, 0]], axis=1) / np.hypot(*way.T)[:, None]
        to_point = xy_m[:, None, :] - start
        share = (to_point * way).sum(-1) / np.square(way).sum(-1)
        away = to_point - np.clip(share, 0.0, 1.0)[..., None] * way
        each_m = np.sqrt(np.square(away).sum(-1))
        at, row = each_m.argmin(axis=1), np.arange(len(xy_m))
        beyond_start = (at == 0) & (share[:, 0] < 0.0)
        beyond_end = (at == len(way) - 1) & (share[:, -1] > 1.0)
        facing = self._facing(at, share[row, at], right)
        nearest_m, offset = each_m[row, at], away[row, at]
        side = np.where((offset * facing).sum(-1) >= 0.0, 1.0, -1.0)
        distance_m = np.where(beyond_start | beyond_end, np.nan, side * nearest_m)
        apart = nearest_m > 1e-9
        unit = np.divide(offset, nearest_m[:, None], out=facing.copy(), where=apart[:, None])
        return distance_m, np.where(apart[:, None], side[:, None] * unit, facing)

    def _facing(
        self,
        at: np.ndarray,
        share: Float64[np.ndarray, " point"],
        right: Float64[np.ndarray, "side 2"],
    ) -> Float64[np.ndarray, "point 2"]:
        """Return what is to the right of the nearest place; at a corner, of both its sides."""
        other = np.clip(np.where(share < 0.0, at - 1, np.where(share > 1.0, at + 1, at)), 0, None)
        both = right[at] + right[np.minimum(other, len(right) - 1)]
        length = np.hypot(*both.T)[:, None]
        facing: Float64[np.ndarray, "point 2"] = right[at].copy()
        np.divide(both, length, out=facing, where=length > 1e-9)
        return facing
