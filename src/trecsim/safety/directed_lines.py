"""Where points are with respect to directed lines and edges on the floor."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from trecsim.safety.kernels import nearest_edges
from trecsim.safety.polygons import plain

Points = Float64[np.ndarray, "point 2"]
_SAMPLE_M, _MOST_SAMPLES = 0.5, 32
_BEYOND_M = 0.05


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

    def beyond_m(self) -> Points:
        """Return points all along it, a little beyond: a wall that stands on it hides them."""
        way_m = np.diff(self.points_m, axis=0)
        long_m = np.hypot(*way_m.T)
        ends_m = np.concatenate([[0.0], long_m.cumsum()])
        step_m = max(_SAMPLE_M, float(ends_m[-1]) / _MOST_SAMPLES)
        at_m = np.arange(0.5 * min(step_m, float(ends_m[-1])), float(ends_m[-1]), step_m)
        side = np.minimum(np.searchsorted(ends_m, at_m, side="right") - 1, len(way_m) - 1)
        along = way_m[side] / long_m[side, None]
        on_m = self.points_m[side] + (at_m - ends_m[side])[:, None] * along
        return np.asarray(on_m + _BEYOND_M * np.stack([-along[:, 1], along[:, 0]], axis=1))

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
        distance_m, direction = np.empty(len(xy_m)), np.empty((len(xy_m), 2))
        nearest_edges(plain(self.points_m), plain(xy_m), distance_m, direction)
        return distance_m, direction
