"""Where points are with respect to zones, lines and edges: plain geometry, a loop over the sides.

All points are given as (..., 2) [m].
"""

from functools import lru_cache
from itertools import pairwise

import numpy as np
from jaxtyping import Bool, Float64

Floor = Float64[np.ndarray, "*points 2"]
Distances = Float64[np.ndarray, "*points"]
Corners = Float64[np.ndarray, "corner 2"]


def is_inside(corners_m: Corners, xy_m: Floor) -> Bool[np.ndarray, "*points"]:
    """Tell which points are in a polygon: those around which its corners go once.

    Examples
    --------
    >>> square = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [0.0, 2.0]])
    >>> is_inside(square, np.array([[1.0, 0.5], [-3.0, -4.0]]))
    array([ True, False])
    """
    turned = np.zeros(xy_m.shape[:-1])
    for a, b in pairwise([*corners_m, corners_m[0]]):
        to_a, to_b = a - xy_m, b - xy_m
        turned += np.arctan2(_cross(to_a, to_b), (to_a * to_b).sum(-1))
    return np.asarray(np.abs(turned) > np.pi)


def inside_m(corners_m: Corners, xy_m: Floor) -> Distances:
    """Return the distances of points from the border of a polygon, negative outside [m]."""
    sides = list(pairwise([*corners_m, corners_m[0]]))
    nearest_m = np.min([_from_side_m(a, b, xy_m) for a, b in sides], axis=0)
    return np.asarray(np.where(is_inside(corners_m, xy_m), nearest_m, -nearest_m))


def left_of_m(line_m: Corners, xy_m: Floor) -> Distances:
    """Return how far to the left of a line from its first to its second point points are [m].

    Examples
    --------
    >>> left_of_m(np.array([[0.0, 0.0], [2.0, 0.0]]), np.array([[5.0, 0.3], [1.0, -2.0]]))
    array([ 0.3, -2. ])
    """
    way_m = line_m[1] - line_m[0]
    return np.asarray(_cross(way_m, xy_m - line_m[0]) / np.hypot(*way_m))


def along(line_m: Corners, xy_m: Floor) -> Distances:
    """Return where along a line points are: 0 at its first point, 1 at its second."""
    way_m = line_m[1] - line_m[0]
    return np.asarray(((xy_m - line_m[0]) * way_m).sum(-1) / (way_m**2).sum())


def from_edge_m(edge_m: Corners, xy_m: Floor) -> Distances:
    """Return how far from an edge points are, negative over the drop on its left [m].

    NaN beside its ends. At a corner the side with the nearer middle decides on which side a point
    is.
    """
    sides = list(pairwise(edge_m))
    each_m = np.array([_from_side_m(a, b, xy_m) for a, b in sides])
    middles_m = np.array([np.hypot(*np.moveaxis(xy_m - (a + b) / 2, -1, 0)) for a, b in sides])
    at = np.argmin(each_m + 1e-9 * middles_m, axis=0)
    left_m = np.array([left_of_m(np.array(side), xy_m) for side in sides])
    nearest_m = np.take_along_axis(each_m, at[None], 0)[0]
    is_left = np.take_along_axis(left_m, at[None], 0)[0] > 0.0
    before = (at == 0) & (along(edge_m[:2], xy_m) < 0.0)
    behind = (at == len(sides) - 1) & (along(edge_m[-2:], xy_m) > 1.0)
    signed_m = np.where(is_left, -nearest_m, nearest_m)
    return np.asarray(np.where(before | behind, np.nan, signed_m))


def voronoi_density_pm2(
    corners_m: Corners, xy_m: Float64[np.ndarray, "person 2"], cut_m: float, cell_m: float = 0.04
) -> float:
    """Return the Voronoi density in a polygon, counted on a grid [people/m^2].

    Each cell of the grid belongs to the nearest person, if that is at most `cut_m` away. The
    density is the sum of the shares of everybody's cells in the polygon, over its area.
    """
    low_m, high_m = corners_m.min(axis=0) - 2.0 * cut_m, corners_m.max(axis=0) + 2.0 * cut_m
    # Who is farther away owns no cell of the grid.
    xy_m = xy_m[((xy_m > low_m - cut_m) & (xy_m < high_m + cut_m)).all(axis=1)]
    if not len(xy_m):
        return 0.0
    cells_m, within = _grid(tuple(map(tuple, corners_m.tolist())), 2.0 * cut_m, cell_m)
    away_m = np.array([np.hypot(*(cells_m - one).T) for one in xy_m])
    owner = np.where(away_m.min(axis=0) <= cut_m, away_m.argmin(axis=0), -1)
    shares = 0.0
    for person in range(len(xy_m)):
        own = owner == person
        if own.any():
            shares += float((own & within).sum() / own.sum())
    return shares / (float(within.sum()) * cell_m**2)


@lru_cache(maxsize=8)
def _grid(
    corners_m: tuple[tuple[float, float], ...], around_m: float, cell_m: float
) -> tuple[Float64[np.ndarray, "cell 2"], Bool[np.ndarray, " cell"]]:
    """Return the middles of the cells on and around a polygon [m], and which are in it."""
    polygon_m = np.array(corners_m)
    low_m, high_m = polygon_m.min(axis=0) - around_m, polygon_m.max(axis=0) + around_m
    axes = [np.arange(low_m[k], high_m[k], cell_m) + cell_m / 2 for k in (0, 1)]
    cells_m = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)
    return cells_m, is_inside(polygon_m, cells_m)


def _from_side_m(
    a: Float64[np.ndarray, " 2"], b: Float64[np.ndarray, " 2"], xy_m: Floor
) -> Distances:
    share = np.clip(along(np.array([a, b]), xy_m), 0.0, 1.0)[..., None]
    return np.asarray(np.hypot(*np.moveaxis(xy_m - (a + share * (b - a)), -1, 0)))


def _cross(
    a: Float64[np.ndarray, "... 2"], b: Float64[np.ndarray, "... 2"]
) -> Float64[np.ndarray, "..."]:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
