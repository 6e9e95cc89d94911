"""Where a point on the floor is with respect to a zone, and how surely it is inside.

Notes
-----
The probability that a normally distributed point lies in a polygon is computed exactly, also near
corners and in zones that are smaller than the uncertainty. The transform that makes the
distribution round keeps the polygon a polygon. Its probability is the signed sum over its sides of
the triangles that they form with the mean; that of such a triangle is the share of its angle in the
full circle, minus what lies behind the side (Owen's T function at its two ends).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from jaxtyping import Bool, Float64, Int64

from trecsim.safety.kernels import (
    LEAST_SIGMA_M,
    SURE,
    inside_joints,
    inside_points,
    nearest_sides,
)

Points = Float64[np.ndarray, "point 2"]
_SAMPLE_M, _MOST_SAMPLES = 0.5, 16
"""Points within a polygon are so far from each other along its border, and hardly more [m]."""
_INNER = 0.9
"""They are nearer to the middle by this factor than the border is."""


def plain(values: Float64[np.ndarray, "*n"]) -> Float64[np.ndarray, "*n"]:
    """Return values as kernels take them; a copy only where they are not so already."""
    flags = values.flags
    if values.dtype == np.float64 and flags.c_contiguous and flags.writeable:
        return values  # `np.require` costs as much as a small kernel
    return np.require(values, np.float64, ["C", "W"])


@dataclass(frozen=True, eq=False)
class Polygon:
    """A simple polygon on the floor.

    Attributes
    ----------
    corners_m
        Its corners in counter-clockwise order [m].
    """

    corners_m: Float64[np.ndarray, "corner 2"]

    def __post_init__(self) -> None:
        around = self.corners_m if area_m2(self.corners_m) >= 0.0 else self.corners_m[::-1]
        object.__setattr__(self, "corners_m", plain(around))

    def distance_m(self, xy_m: Points) -> Float64[np.ndarray, " point"]:
        """Return the distance to the border: positive inside, negative outside [m].

        Examples
        --------
        >>> square = Polygon(np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [0.0, 2.0]]))
        >>> square.distance_m(np.array([[1.0, 0.5], [-3.0, -4.0]]))
        array([ 0.5, -5. ])
        """
        return self.nearest(xy_m)[0]

    def normals(self, xy_m: Points) -> Float64[np.ndarray, "point 2"]:
        """Return the direction in which the distance of each point grows, of length 1."""
        return self.nearest(xy_m)[1]

    def nearest(
        self, xy_m: Points
    ) -> tuple[Float64[np.ndarray, " point"], Float64[np.ndarray, "point 2"]]:
        """Return the distance to the border, and the direction in which it grows, of length 1.

        Both are NaN for unknown points; see `distance_m`.
        """
        distance_m, direction = np.empty(len(xy_m)), np.empty((len(xy_m), 2))
        nearest_sides(self.corners_m, plain(xy_m), distance_m, direction)
        return distance_m, direction

    @cached_property
    def box_m(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """The least and the greatest x and y of its corners [m]."""
        (low_x, low_y), (high_x, high_y) = (
            self.corners_m.min(axis=0).tolist(), self.corners_m.max(axis=0).tolist(),
        )  # fmt: skip
        return (low_x, low_y), (high_x, high_y)

    @cached_property
    def is_convex(self) -> bool:
        """Whether no corner points inwards."""
        way_m = _next(self.corners_m) - self.corners_m
        turn = way_m[:, 0] * _next(way_m)[:, 1] - way_m[:, 1] * _next(way_m)[:, 0]
        return bool((turn >= 0.0).all())

    @cached_property
    def parts(self) -> tuple[Float64[np.ndarray, "corner 2"], ...]:
        """Convex parts that make it up: itself, or else triangles."""
        if self.is_convex:
            return (self.corners_m,)
        left, parts = list(range(len(self.corners_m))), []
        while len(left) > 3:
            ear = next((n for n in range(len(left)) if self._is_ear(left, n)), 0)
            parts.append(self.corners_m[[left[ear - 1], left[ear], left[(ear + 1) % len(left)]]])
            del left[ear]
        return (*parts, self.corners_m[left])

    @cached_property
    def inner_m(self) -> Points:
        """Points all over it: the middles of its convex parts, and some within its borders.

        None is at a border, where a wall may stand that hides nothing of what is before it.
        """
        around_m = sum(float(np.hypot(*(_next(part) - part).T).sum()) for part in self.parts)
        step_m = max(_SAMPLE_M, around_m / _MOST_SAMPLES)
        found = []
        for part in self.parts:
            ring_m = np.concatenate([part, part[:1]])
            along_m = np.concatenate([[0.0], np.hypot(*np.diff(ring_m, axis=0).T).cumsum()])
            at_m = np.arange(0.0, along_m[-1], step_m)
            border_m = np.stack([np.interp(at_m, along_m, axis_m) for axis_m in ring_m.T], axis=1)
            middle_m = part.mean(axis=0)
            found += [middle_m[None], middle_m + _INNER * (border_m - middle_m)]
        points_m = np.concatenate(found)
        if len(points_m) > 2 * _MOST_SAMPLES:
            points_m = points_m[:: -(-len(points_m) // _MOST_SAMPLES)]
        return points_m

    @cached_property
    def sides(self) -> Float64[np.ndarray, "1 part side 3"]:
        """Its sides as kernels take them, see `sides_of`."""
        return sides_of([[self]])

    def _is_ear(self, left: list[int], n: int) -> bool:
        """Tell whether a corner and those beside it make a triangle that holds no other corner."""
        triangle = [left[n - 1], left[n], left[(n + 1) % len(left)]]
        a, b, c = self.corners_m[triangle]
        if _cross(b - a, c - b) <= 0.0:
            return False
        others = self.corners_m[[one for one in left if one not in triangle]]
        turns = [_cross(q - p, others - p) for p, q in ((a, b), (b, c), (c, a))]
        return not (np.min(turns, axis=0) > 0.0).any()

    def probability(
        self, xy_m: Points, cov_m2: Float64[np.ndarray, "point 2 2"]
    ) -> Float64[np.ndarray, " point"]:
        """Return the probability that each point is inside; NaN where its mean is unknown.

        Parameters
        ----------
        xy_m
            Means [m].
        cov_m2
            Covariances [m^2]; an unknown one (NaN) counts as none.

        Examples
        --------
        >>> square = Polygon(np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [0.0, 2.0]]))
        >>> on_a_side, on_a_corner = np.array([[2.0, 0.0], [0.0, 0.0]])
        >>> means, cov_m2 = np.array([on_a_side, on_a_corner]), np.full((2, 2, 2), 0.01 * np.eye(2))
        >>> square.probability(means, cov_m2)
        array([0.5 , 0.25])
        """
        found = np.empty(len(xy_m))
        inside_points(self.corners_m, plain(xy_m), plain(cov_m2), found)
        return found


@dataclass(frozen=True, slots=True, eq=False)
class Prism:
    """An upright prism over a polygon.

    Attributes
    ----------
    polygon
        Its base.
    z_m
        Where it begins and ends above the floor [m].

    Notes
    -----
    Height and place are correlated. A point that is near a side and near the floor or ceiling of
    the prism is judged in slices of constant height, in which the distribution over the floor is
    known.
    """

    polygon: Polygon
    z_m: tuple[float, float]

    def probability(
        self, xyz_m: Float64[np.ndarray, "point 3"], cov_m2: Float64[np.ndarray, "point 3 3"]
    ) -> Float64[np.ndarray, " point"]:
        """Return the probability that each point is inside; NaN where its mean is unknown.

        Parameters
        ----------
        xyz_m, cov_m2
            Means [m] and covariances [m^2]; an unknown covariance (NaN) counts as none.
        """
        rows, counts = np.arange(len(xyz_m)), np.ones((len(xyz_m), 1), bool)
        found: Float64[np.ndarray, " point"]
        found = self.of_joints(rows, xyz_m[:, None], cov_m2[:, None], counts)[:, 0]
        return found

    def of_joints(
        self,
        rows: Int64[np.ndarray, " row"],
        xyz_m: Float64[np.ndarray, "person joint 3"],
        cov_m2: Float64[np.ndarray, "person joint 3 3"],
        counts: Bool[np.ndarray, "row joint"],
    ) -> Float64[np.ndarray, "row joint"]:
        """Return the probability that joints are inside; 0 for those that do not count.

        Parameters
        ----------
        rows
            Of which people.
        xyz_m, cov_m2
            Of all people: means [m] and covariances [m^2]; an unknown one (NaN) counts as none.
        counts
            Which joints of these people count.
        """
        found = np.empty(counts.shape)
        if len(rows):
            low_m, high_m = self.z_m
            inside_joints(
                self.polygon.corners_m, (float(low_m), float(high_m)), rows, plain(xyz_m),
                plain(cov_m2), np.ascontiguousarray(counts), found,
            )  # fmt: skip
        return found


def all_over(polygons: Sequence[Sequence[Polygon]]) -> Points:
    """Return points all over the polygons of some times, see `Polygon.inner_m`."""
    return np.concatenate([np.empty((0, 2)), *[one.inner_m for these in polygons for one in these]])


def sides_of(polygons: Sequence[Sequence[Polygon]]) -> Float64[np.ndarray, "time part side 3"]:
    """Return the sides of polygons as kernels take them: inward normal, and how far along it.

    Parameters
    ----------
    polygons
        At each time; what is missing at a time holds nothing.
    """
    parts = [[_sides(part) for one in these for part in one.parts] for these in polygons]
    most = max((len(some) for some in parts), default=0)
    sides = max((len(part) for some in parts for part in some), default=0)
    found = np.zeros((len(parts), most, sides, 3))
    found[..., 2] = np.inf
    for at, some in enumerate(parts):
        for n, part in enumerate(some):
            found[at, n] = part[-1]  # the last side again in place of those that it has not
            found[at, n, : len(part)] = part
    return found


def _sides(corners_m: Float64[np.ndarray, "corner 2"]) -> Float64[np.ndarray, "corner 3"]:
    way_m = _next(corners_m) - corners_m
    inwards = np.stack([-way_m[:, 1], way_m[:, 0]], axis=1) / np.hypot(*way_m.T)[:, None]
    along: Float64[np.ndarray, " corner"] = (inwards * corners_m).sum(axis=1)
    return np.concatenate([inwards, along[:, None]], axis=1)


def _cross(a: np.ndarray, b: np.ndarray) -> Any:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def area_m2(corners_m: Float64[np.ndarray, "corner 2"]) -> float:
    """Return the area of a polygon [m^2], positive if its corners go counter-clockwise.

    Examples
    --------
    >>> area_m2(np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [0.0, 2.0]]))
    8.0
    """
    (x, y), (next_x, next_y) = corners_m.T, _next(corners_m).T
    return 0.5 * float((x * next_y - next_x * y).sum())


def _next(corners: Float64[np.ndarray, "corner *n"]) -> Float64[np.ndarray, "corner *n"]:
    """Return the corner after each corner."""
    return np.concatenate([corners[1:], corners[:1]])


__all__ = ["LEAST_SIGMA_M", "SURE", "Points", "Polygon", "Prism", "area_m2", "plain", "sides_of"]
