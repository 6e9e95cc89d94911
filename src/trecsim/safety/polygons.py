"""Where a point on the floor is with respect to a zone, and how surely it is inside.

Notes
-----
The probability that a normally distributed point lies in a polygon is computed exactly, also near
corners and in zones that are smaller than the uncertainty. The transform that makes the
distribution round keeps the polygon a polygon. Its probability is the signed sum over its sides of
the triangles that they form with the mean; that of such a triangle is the share of its angle in the
full circle, minus what lies behind the side (Owen's T function at its two ends).
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float64

from trecsim.safety.gaussian import behind_line_within_angle, normal_cdf

LEAST_SIGMA_M = 1e-6
"""Uncertainty of a point that is stated to be exact [m]."""
_LEAST_M2 = {n: LEAST_SIGMA_M**2 * np.eye(n) for n in (2, 3)}
SURE = 5.5
"""At so many standard deviations from every side the probability is 0 or 1, to 1e-7."""
_SLICES, _SLICE_WEIGHTS = np.polynomial.legendre.leggauss(16)

Points = Float64[np.ndarray, "point 2"]


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
        if area_m2(self.corners_m) < 0.0:
            object.__setattr__(self, "corners_m", self.corners_m[::-1].copy())

    def distance_m(self, xy_m: Points) -> Float64[np.ndarray, " point"]:
        """Return the distance to the border: positive inside, negative outside [m].

        Examples
        --------
        >>> square = Polygon(np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [0.0, 2.0]]))
        >>> square.distance_m(np.array([[1.0, 0.5], [-3.0, -4.0]]))
        array([ 0.5, -5. ])
        """
        away_x, away_y = self._away_m(xy_m)
        nearest_m = np.sqrt((np.square(away_x) + np.square(away_y)).min(axis=1))
        distance_m: Float64[np.ndarray, " point"] = np.where(
            self._holds(xy_m), nearest_m, -nearest_m
        )
        return distance_m

    def normals(self, xy_m: Points) -> Float64[np.ndarray, "point 2"]:
        """Return the direction in which the distance of each point grows, of length 1."""
        return self.nearest(xy_m)[1]

    def nearest(
        self, xy_m: Points
    ) -> tuple[Float64[np.ndarray, " point"], Float64[np.ndarray, "point 2"]]:
        """Return the distance to the border, and the direction in which it grows, of length 1.

        See `distance_m`; both at once cost little more than one.
        """
        away_x, away_y = self._away_m(xy_m)
        squared_m2 = np.square(away_x) + np.square(away_y)
        side, row = squared_m2.argmin(axis=1), np.arange(len(xy_m))
        offset_m = np.stack([away_x[row, side], away_y[row, side]], axis=1)
        length_m = np.sqrt(squared_m2[row, side])[:, None]
        way = self._ways_m
        inwards = np.stack([-way[:, 1], way[:, 0]], axis=1) / np.hypot(*way.T)[:, None]
        apart = length_m > 1e-9
        unit = np.divide(offset_m, length_m, out=inwards[side], where=apart)
        holds = self._holds(xy_m)
        outside = ~holds[:, None] & apart
        distance_m = np.where(holds, length_m[:, 0], -length_m[:, 0])
        return distance_m, np.where(outside, -unit, unit)

    @cached_property
    def _ways_m(self) -> Float64[np.ndarray, "corner 2"]:
        """The way from each corner to the next."""
        way: Float64[np.ndarray, "corner 2"] = _next(self.corners_m) - self.corners_m
        return way

    @cached_property
    def box_m(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """The least and the greatest x and y of its corners [m]."""
        (low_x, low_y), (high_x, high_y) = (
            self.corners_m.min(axis=0).tolist(), self.corners_m.max(axis=0).tolist(),
        )  # fmt: skip
        return (low_x, low_y), (high_x, high_y)

    def _away_m(
        self, xy_m: Points
    ) -> tuple[Float64[np.ndarray, "point corner"], Float64[np.ndarray, "point corner"]]:
        """Return the way from the nearest place on each side to each point, x and y."""
        (way_x, way_y), (start_x, start_y) = self._ways_m.T, self.corners_m.T
        to_x, to_y = xy_m[:, :1] - start_x, xy_m[:, 1:] - start_y
        share = (to_x * way_x + to_y * way_y) / (np.square(way_x) + np.square(way_y))
        share = np.minimum(np.maximum(share, 0.0), 1.0)
        return to_x - share * way_x, to_y - share * way_y

    def _holds(self, xy_m: Points) -> Bool[np.ndarray, " point"]:
        """Tell which points a ray to the right leaves through an odd number of sides."""
        (x, y), a, way = xy_m.T[..., None], self.corners_m, self._ways_m
        above = a[:, 1] > y
        spans = above != np.concatenate([above[:, 1:], above[:, :1]], axis=1)
        rise = np.where(way[:, 1] == 0.0, 1.0, way[:, 1])
        left_of = x < a[:, 0] + (y - a[:, 1]) * way[:, 0] / rise
        holds: Bool[np.ndarray, " point"] = np.logical_xor.reduce(spans & left_of, axis=1)
        return holds

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
        cov_m2 = _known(cov_m2)
        reach_m = SURE * np.sqrt(cov_m2[:, 0, 0] + cov_m2[:, 1, 1])  # in the widest direction
        (low_x, low_y), (high_x, high_y) = self.box_m
        x, y = xy_m.T
        near = (x + reach_m > low_x) & (x - reach_m < high_x)
        near &= (y + reach_m > low_y) & (y - reach_m < high_y)
        inside = np.where(np.isnan(x + y), np.nan, 0.0)
        rows = near.nonzero()[0]
        if len(rows):
            inside[rows] = self._probability_near(xy_m[rows], cov_m2[rows], reach_m[rows])
        return inside

    def _probability_near(
        self,
        xy_m: Points,
        cov_m2: Float64[np.ndarray, "point 2 2"],
        reach_m: Float64[np.ndarray, " point"],
    ) -> Float64[np.ndarray, " point"]:
        """Return the probability of points that are known and not far away."""
        distance_m = self.distance_m(xy_m)
        inside = (distance_m > 0.0).astype(np.float64)
        unsure = np.abs(distance_m) < reach_m
        if unsure.any():
            inside[unsure] = _exact(self.corners_m, xy_m[unsure], cov_m2[unsure])
        return inside


@dataclass(frozen=True, slots=True, eq=False)
class Prism:
    """An upright prism over a polygon.

    Attributes
    ----------
    polygon
        Its base.
    z_m
        Where it begins and ends above the floor [m].
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

        Notes
        -----
        Height and place are correlated. A point that is near a side and near the floor or ceiling
        of the prism is judged in slices of constant height, in which the distribution over the
        floor is known.
        """
        over = self.polygon.probability(xyz_m[:, :2], cov_m2[:, :2, :2])
        there = np.flatnonzero(~(over <= 0.0))  # elsewhere the height does not matter
        over[there] = self._with_height(xyz_m[there], cov_m2[there], over[there])
        return over

    def _with_height(
        self,
        xyz_m: Float64[np.ndarray, "point 3"],
        cov_m2: Float64[np.ndarray, "point 3 3"],
        over: Float64[np.ndarray, " point"],
    ) -> Float64[np.ndarray, " point"]:
        """Return the probability of points that may be over the polygon; see `probability`."""
        cov_m2 = _known(cov_m2)
        sigma_z = np.sqrt(cov_m2[:, 2, 2])
        low, high = ((limit - xyz_m[:, 2]) / sigma_z for limit in self.z_m)
        in_height = normal_cdf(high) - normal_cdf(low)
        inside: Float64[np.ndarray, " point"] = over * in_height
        cut = _is_open(in_height) & _is_open(over) & (cov_m2[:, 2, :2] != 0.0).any(axis=1)
        if cut.any():
            inside[cut] = in_height[cut] * self._in_slices(
                xyz_m[cut], cov_m2[cut], low[cut], high[cut]
            )
        return inside

    def _in_slices(
        self,
        xyz_m: Float64[np.ndarray, "point 3"],
        cov_m2: Float64[np.ndarray, "point 3 3"],
        low: Float64[np.ndarray, " point"],
        high: Float64[np.ndarray, " point"],
    ) -> Float64[np.ndarray, " point"]:
        """Return the probability over the polygon, given that the height is within the prism.

        Parameters
        ----------
        xyz_m, cov_m2
            See `probability`.
        low, high
            Floor and ceiling, as standard deviations from the mean height.
        """
        low, high = np.maximum(low, -SURE)[:, None], np.minimum(high, SURE)[:, None]
        heights = 0.5 * (low + high) + 0.5 * (high - low) * _SLICES  # (point, slice)
        weights = _SLICE_WEIGHTS * np.exp(-0.5 * np.square(heights))
        shift_m = cov_m2[:, :2, 2] / np.sqrt(cov_m2[:, 2, 2])[:, None]
        rest_m2 = cov_m2[:, :2, :2] - shift_m[:, :, None] * shift_m[:, None, :]
        xy_m = xyz_m[:, None, :2] + heights[..., None] * shift_m[:, None, :]
        each_m2 = np.broadcast_to(rest_m2[:, None], (*heights.shape, 2, 2))
        over = self.polygon.probability(xy_m.reshape(-1, 2), each_m2.reshape(-1, 2, 2))
        total = (weights * over.reshape(heights.shape)).sum(axis=1)
        share: Float64[np.ndarray, " point"] = total / weights.sum(axis=1)
        return share


def _is_open(probability: Float64[np.ndarray, " point"]) -> Bool[np.ndarray, " point"]:
    """Tell which probabilities are neither 0 nor 1."""
    is_open: Bool[np.ndarray, " point"] = (probability > 1e-6) & (probability < 1.0 - 1e-6)
    return is_open


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


def _known(cov_m2: Float64[np.ndarray, "point n n"]) -> Float64[np.ndarray, "point n n"]:
    """Return covariances that are positive definite, also where they are unknown or zero."""
    return np.where(np.isfinite(cov_m2), cov_m2, 0.0) + _LEAST_M2[cov_m2.shape[-1]]


def _exact(
    corners_m: Float64[np.ndarray, "corner 2"],
    xy_m: Points,
    cov_m2: Float64[np.ndarray, "point 2 2"],
) -> Float64[np.ndarray, " point"]:
    """Return the probability of a polygon; see the notes of the module."""
    scale_x = np.sqrt(cov_m2[:, 0, 0])
    shear = cov_m2[:, 0, 1] / scale_x
    scale_y = np.sqrt(np.maximum(cov_m2[:, 1, 1] - np.square(shear), LEAST_SIGMA_M**2))
    x, y = np.moveaxis(corners_m - xy_m[:, None, :], -1, 0)  # (point, corner) each
    x = x / scale_x[:, None]
    y = (y - shear[:, None] * x) / scale_y[:, None]
    next_x, next_y = _next(x.T).T, _next(y.T).T
    way_x, way_y = next_x - x, next_y - y
    length = np.sqrt(np.square(way_x) + np.square(way_y))
    h = (x * next_y - next_x * y) / length
    from_foot = (x * way_x + y * way_y) / length
    side, h = np.sign(h), np.abs(h)
    angle = np.arctan2(from_foot + length, h) - np.arctan2(from_foot, h)
    ends = np.stack([from_foot + length, from_foot])
    to_end, to_start = behind_line_within_angle(np.stack([h, h]), ends)
    behind = to_end - to_start
    share = side * (angle / (2.0 * math.pi) - behind)
    inside: Float64[np.ndarray, " point"] = np.clip(share.sum(axis=1), 0.0, 1.0)
    return inside
