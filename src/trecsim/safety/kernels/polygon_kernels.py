"""Where points on the floor are with respect to a polygon, and how surely they are inside.

Corners go counter-clockwise. See `trecsim.safety.polygons` for the method.
"""

import math

from trecsim.compiler import inner, kernel
from trecsim.safety.kernels.gaussian_kernels import behind_line

LEAST_SIGMA_M = 1e-6
"""Uncertainty of a point that is stated to be exact [m]."""
SURE = 5.5
"""At so many standard deviations from every side the probability is 0 or 1, to 1e-7."""
_SAME_M = 1e-9  # a point so near to a side lies on it


@inner
def known(covariance):
    """Return a covariance, 0 where it is unknown."""
    return covariance if math.isfinite(covariance) else 0.0


@inner
def box(corners):
    """Return the least x and y, and the greatest, of the corners [m]."""
    low_x = high_x = corners[0, 0]
    low_y = high_y = corners[0, 1]
    for n in range(1, corners.shape[0]):
        low_x, high_x = min(low_x, corners[n, 0]), max(high_x, corners[n, 0])
        low_y, high_y = min(low_y, corners[n, 1]), max(high_y, corners[n, 1])
    return low_x, low_y, high_x, high_y


@inner
def to_border(corners, x, y):
    """Return the distance to the border and the direction in which it grows.

    The distance is positive inside, negative outside [m].
    """
    count = corners.shape[0]
    least, nearest = math.inf, 0
    away_x = away_y = 0.0
    holds = False
    for n in range(count):
        after = n + 1 if n + 1 < count else 0
        from_x, from_y = corners[n, 0], corners[n, 1]
        way_x, way_y = corners[after, 0] - from_x, corners[after, 1] - from_y
        to_x, to_y = x - from_x, y - from_y
        share = (to_x * way_x + to_y * way_y) / (way_x * way_x + way_y * way_y)
        share = min(max(share, 0.0), 1.0)
        off_x, off_y = to_x - share * way_x, to_y - share * way_y
        squared = off_x * off_x + off_y * off_y
        if squared < least:
            least, nearest, away_x, away_y = squared, n, off_x, off_y
        if (from_y > y) != (corners[after, 1] > y) and x < from_x + to_y * way_x / way_y:
            holds = not holds  # one more side that a ray to the right leaves through
    if least == math.inf:  # an unknown point
        return math.nan, math.nan, math.nan
    distance = math.sqrt(least)
    if distance <= _SAME_M:
        after = nearest + 1 if nearest + 1 < count else 0
        way_x = corners[after, 0] - corners[nearest, 0]
        way_y = corners[after, 1] - corners[nearest, 1]
        length = math.sqrt(way_x * way_x + way_y * way_y)
        return (distance if holds else -distance), -way_y / length, way_x / length
    if holds:
        return distance, away_x / distance, away_y / distance
    return -distance, -away_x / distance, -away_y / distance


@inner
def exactly_inside(corners, x, y, xx, xy, yy):
    """Return the probability that a point is inside, from all sides; covariances are known."""
    scale_x = math.sqrt(xx)
    shear = xy / scale_x
    scale_y = math.sqrt(max(yy - shear * shear, LEAST_SIGMA_M * LEAST_SIGMA_M))
    last = corners.shape[0] - 1
    from_x = (corners[last, 0] - x) / scale_x
    from_y = (corners[last, 1] - y - shear * from_x) / scale_y
    total = 0.0
    for n in range(last + 1):
        to_x = (corners[n, 0] - x) / scale_x
        to_y = (corners[n, 1] - y - shear * to_x) / scale_y
        way_x, way_y = to_x - from_x, to_y - from_y
        length = math.sqrt(way_x * way_x + way_y * way_y)
        h = (from_x * to_y - to_x * from_y) / length
        start = (from_x * way_x + from_y * way_y) / length
        end = start + length
        far = abs(h)
        angle = math.atan2(end, far) - math.atan2(start, far)
        share = angle / (2.0 * math.pi) - (behind_line(far, end) - behind_line(far, start))
        if h > 0.0:
            total += share
        elif h < 0.0:
            total -= share
        from_x, from_y = to_x, to_y
    return min(max(total, 0.0), 1.0)


@inner
def inside(corners, around, x, y, xx, xy, yy):
    """Return the probability that a point is inside; 0 where it is surely far away.

    Parameters
    ----------
    corners, around
        The polygon, and its `box` [m].
    x, y
        Mean [m].
    xx, xy, yy
        Covariances [m^2]; unknown ones count as none.
    """
    least = LEAST_SIGMA_M * LEAST_SIGMA_M
    xx, xy, yy = known(xx) + least, known(xy), known(yy) + least
    reach = SURE * math.sqrt(xx + yy)  # in the widest direction
    low_x, low_y, high_x, high_y = around
    if not (x + reach > low_x and x - reach < high_x and y + reach > low_y and y - reach < high_y):
        return math.nan if math.isnan(x + y) else 0.0
    distance, _, _ = to_border(corners, x, y)
    if abs(distance) >= reach:
        return 1.0 if distance > 0.0 else 0.0
    return exactly_inside(corners, x, y, xx, xy, yy)


@kernel
def inside_points(corners, xy_m, cov_m2, found):
    """Write the probability that each point is inside to `found`; NaN for unknown points."""
    around = box(corners)
    for n in range(xy_m.shape[0]):
        found[n] = inside(
            corners, around, xy_m[n, 0], xy_m[n, 1],
            cov_m2[n, 0, 0], cov_m2[n, 0, 1], cov_m2[n, 1, 1],
        )  # fmt: skip


@kernel
def nearest_sides(corners, xy_m, distance_m, direction):
    """Write each point's distance to the border [m], and the direction in which it grows."""
    for n in range(xy_m.shape[0]):
        distance_m[n], direction[n, 0], direction[n, 1] = to_border(corners, xy_m[n, 0], xy_m[n, 1])
