"""Where points are with respect to the edge of a drop; see `trecsim.safety.directed_lines.Edge`."""

import math

from trecsim.compiler import inner, kernel
from trecsim.safety.kernels.gaussian_kernels import cdf
from trecsim.safety.kernels.polygon_kernels import LEAST_SIGMA_M, known

_SAME_M = 1e-9  # a point so near to the edge lies on it


@inner
def _rightwards(points, side):
    """Return the direction to the right of a side, of length 1."""
    way_x = points[side + 1, 0] - points[side, 0]
    way_y = points[side + 1, 1] - points[side, 1]
    length = math.sqrt(way_x * way_x + way_y * way_y)
    return way_y / length, -way_x / length


@inner
def _share(points, side, x, y):
    """Return where along a side a point is: 0 at its beginning, 1 at its end."""
    way_x = points[side + 1, 0] - points[side, 0]
    way_y = points[side + 1, 1] - points[side, 1]
    along = (x - points[side, 0]) * way_x + (y - points[side, 1]) * way_y
    return along / (way_x * way_x + way_y * way_y)


@inner
def _facing(points, side, share):
    """Return what is to the right of the nearest place; at a corner, of both its sides."""
    other = side - 1 if share < 0.0 else (side + 1 if share > 1.0 else side)
    other = min(max(other, 0), points.shape[0] - 2)
    right_x, right_y = _rightwards(points, side)
    other_x, other_y = _rightwards(points, other)
    both_x, both_y = right_x + other_x, right_y + other_y
    length = math.sqrt(both_x * both_x + both_y * both_y)
    if length > _SAME_M:
        return both_x / length, both_y / length
    return right_x, right_y


@inner
def from_edge(points, x, y):
    """Return the distance from an edge, and the direction in which it grows.

    The distance is positive on the safe side; NaN before the beginning and behind the end [m].
    """
    sides = points.shape[0] - 1
    least, nearest = math.inf, 0
    away_x = away_y = 0.0
    for side in range(sides):
        share = min(max(_share(points, side, x, y), 0.0), 1.0)
        off_x = x - points[side, 0] - share * (points[side + 1, 0] - points[side, 0])
        off_y = y - points[side, 1] - share * (points[side + 1, 1] - points[side, 1])
        squared = off_x * off_x + off_y * off_y
        if squared < least:
            least, nearest, away_x, away_y = squared, side, off_x, off_y
    share = _share(points, nearest, x, y)
    face_x, face_y = _facing(points, nearest, share)
    apart = math.sqrt(least)
    side_of = 1.0 if away_x * face_x + away_y * face_y >= 0.0 else -1.0
    outside = (nearest == 0 and share < 0.0) or (nearest == sides - 1 and share > 1.0)
    distance = math.nan if outside or least == math.inf else apart
    if apart > _SAME_M:
        return side_of * distance, side_of * away_x / apart, side_of * away_y / apart
    return side_of * distance, face_x, face_y


@inner
def _sigma(normal_x, normal_y, cov_m2):
    """Return the standard deviation in a direction [m]; unknown covariances count as none."""
    xx, xy, yy = known(cov_m2[0, 0]), known(cov_m2[0, 1]), known(cov_m2[1, 1])
    variance = normal_x * normal_x * xx + 2.0 * normal_x * normal_y * xy + normal_y * normal_y * yy
    return math.sqrt(max(variance, 0.0)) + LEAST_SIGMA_M


@kernel
def nearest_edges(points, xy_m, distance_m, direction):
    """Write each point's distance from the edge [m], and the direction in which it grows."""
    for n in range(xy_m.shape[0]):
        distance_m[n], direction[n, 0], direction[n, 1] = from_edge(points, xy_m[n, 0], xy_m[n, 1])


@kernel
def joints_at_edge(points, limits_m, rows, xyz_m, cov_m2, counts, near, beyond, away_m):
    """Write how surely joints are near an edge, and beyond it, and how far away they are.

    Parameters
    ----------
    points
        Of the edge [m].
    limits_m
        What counts as near, and how far beyond is the other side [m].
    rows, xyz_m, cov_m2, counts
        As for `inside_joints`.
    near, beyond
        Probabilities (row, joint); 0 where a joint does not count or is not beside the edge.
    away_m
        Distances (row, joint), infinite for these joints [m].
    """
    for n in range(rows.shape[0]):
        for joint in range(counts.shape[1]):
            near[n, joint] = beyond[n, joint] = 0.0
            away_m[n, joint] = math.inf
            if not counts[n, joint]:
                continue
            at = xyz_m[rows[n], joint]
            distance, normal_x, normal_y = from_edge(points, at[0], at[1])
            if not distance >= -limits_m[1]:
                continue
            sigma = _sigma(normal_x, normal_y, cov_m2[rows[n], joint])
            near[n, joint] = cdf((limits_m[0] - distance) / sigma)
            beyond[n, joint] = cdf(-distance / sigma)
            away_m[n, joint] = distance


@kernel
def reached_edge(points, depth_m, rows, xy_m, cov_m2, joint_m, by_mode):
    """Write the probability that a joint will have been beyond an edge to `by_mode`.

    Parameters
    ----------
    points, depth_m
        Of the edge, and how far beyond is the other side [m].
    rows
        For which people; the others are left as they are.
    xy_m, cov_m2
        Floor points (person, mode, step) [m], and their covariances [m^2].
    joint_m
        Joints seen from the floor point [m]; NaN for those that do not count.
    by_mode
        Per person, mode and step.
    """
    for person in rows:
        for mode in range(xy_m.shape[1]):
            best = 0.0
            for step in range(xy_m.shape[2]):
                at = xy_m[person, mode, step]
                distance, normal_x, normal_y = from_edge(points, at[0], at[1])
                if distance >= -depth_m and best < 1.0:
                    reach = -math.inf
                    for joint in range(joint_m.shape[1]):
                        out = -normal_x * joint_m[person, joint, 0]
                        out -= normal_y * joint_m[person, joint, 1]
                        if out > reach:
                            reach = out
                    sigma = _sigma(normal_x, normal_y, cov_m2[person, mode, step])
                    best = max(best, cdf((reach - distance) / sigma))
                by_mode[person, mode, step] = best
