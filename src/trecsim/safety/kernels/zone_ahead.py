"""How probable it is that people will have been in a polygon by each time ahead.

Notes
-----
Within a mode, what counts is the highest probability up to each time. A point that surely adds
nothing to it is not computed exactly: the probability of a convex polygon is at most that of the
half plane behind the side which is nearest to the mean, that of any polygon at most that of the
box around it.
"""

import math

from trecsim.compiler import inner, kernel
from trecsim.safety.kernels.gaussian_kernels import cdf
from trecsim.safety.kernels.polygon_kernels import (
    LEAST_SIGMA_M,
    SURE,
    box,
    exactly_inside,
    to_border,
)

LEAST = 0.01
"""Later times are computed only for people who are at least so probably there in time."""
_LEAST_M2 = LEAST_SIGMA_M * LEAST_SIGMA_M


@inner
def _reach(joints_m, z_m, towards_x, towards_y):
    """Return how far joints between two heights stick out in a direction; -inf without any [m]."""
    reach = -math.inf
    for joint in range(joints_m.shape[0]):
        if z_m[0] <= joints_m[joint, 2] <= z_m[1]:
            reach = max(reach, towards_x * joints_m[joint, 0] + towards_y * joints_m[joint, 1])
    return reach


@inner
def _farthest(joints_m):
    """Return how far from the floor point joints are at most [m]."""
    farthest = 0.0
    for joint in range(joints_m.shape[0]):
        x, y = joints_m[joint, 0], joints_m[joint, 1]
        if x * x + y * y > farthest:
            farthest = x * x + y * y
    return math.sqrt(farthest)


@inner
def _above(corners, around, is_convex, x, y, distance, towards_x, towards_y, xx, xy, yy):
    """Return an upper bound of the probability of a point that is outside; see the module."""
    if is_convex:
        variance = xx * towards_x * towards_x + yy * towards_y * towards_y
        variance += 2.0 * xy * towards_x * towards_y
        return cdf(distance / math.sqrt(max(variance, _LEAST_M2)))
    low_x, low_y, high_x, high_y = around
    away_x, away_y = max(low_x - x, x - high_x), max(low_y - y, y - high_y)
    if away_x <= 0.0 and away_y <= 0.0:  # in a bay of the polygon
        return 1.0
    return cdf(-max(away_x / math.sqrt(xx), away_y / math.sqrt(yy)))


@inner
def _there(
    corners, around, is_convex, z_m, floor_only, joints_m, farthest, xy_m, cov_m2, best, bound
):
    """Return the probability of being there at one time, if it is more than `best`, else `best`.

    With `bound`, an upper bound of it in place of the probability.
    """
    x, y = xy_m[0], xy_m[1]
    xx, xy, yy = cov_m2[0, 0] + _LEAST_M2, cov_m2[0, 1], cov_m2[1, 1] + _LEAST_M2
    reach = SURE * math.sqrt(xx + yy)
    wide = reach + farthest
    low_x, low_y, high_x, high_y = around
    if not (x + wide > low_x and x - wide < high_x and y + wide > low_y and y - wide < high_y):
        return best
    distance, towards_x, towards_y = to_border(corners, x, y)
    if not floor_only:
        out = _reach(joints_m, z_m, towards_x, towards_y)
        if out == -math.inf:
            return best
        moved = min(out, max(-distance, 0.0) + LEAST_SIGMA_M)
        x, y = x + moved * towards_x, y + moved * towards_y
        if distance < 0.0 and -distance > out > 0.0:  # the same side stays the nearest
            distance += moved
        else:
            distance, towards_x, towards_y = to_border(corners, x, y)
    if distance < 0.0:
        if distance <= -reach:
            return best
        above = _above(corners, around, is_convex, x, y, distance, towards_x, towards_y, xx, xy, yy)
        if bound or above <= best:
            return max(above, best)
    elif distance >= reach or bound:
        return 1.0
    return max(best, exactly_inside(corners, x, y, xx, xy, yy))


@kernel
def reached_zone(
    corners, is_convex, z_m, floor_only, rows, weight, xy_m, cov_m2, joint_m, steps, least, by_mode
):
    """Raise `by_mode` to the probability that people will have been in a polygon.

    Parameters
    ----------
    corners, is_convex
        The polygon [m].
    z_m
        Joints between these heights count [m].
    floor_only
        Whether only the floor point counts.
    rows
        For which people; the others are left as they are.
    weight, xy_m, cov_m2
        Of the modes (person, mode, step): weights, floor points [m] and covariances [m^2].
    joint_m
        Joints seen from the floor point [m]; NaN for those that do not count.
    steps
        First step, the step asked for, and the end: the steps after the one asked for are computed
        only for people who are there by then with `LEAST`.
    least
        People may be left out whose probability by the step asked for is surely below this.
    by_mode
        Probabilities so far, per person, mode and step: never less than at the step before.
    """
    around = box(corners)
    first, asked, end = steps[0], steps[1] + 1, steps[2]
    for person in rows:
        farthest = 0.0 if floor_only else _farthest(joint_m[person])
        if least > 0.0 and least > _at_most(
            corners, around, is_convex, z_m, floor_only, joint_m[person], farthest,
            weight[person], xy_m[person], cov_m2[person], first, asked,
        ):  # fmt: skip
            continue
        reached = 0.0
        for mode in range(xy_m.shape[1]):
            reached += weight[person, mode] * _follow(
                corners, around, is_convex, z_m, floor_only, joint_m[person], farthest,
                xy_m[person, mode], cov_m2[person, mode], first, asked, by_mode[person, mode],
            )  # fmt: skip
        for mode in range(xy_m.shape[1]):
            if reached > LEAST:
                _follow(
                    corners, around, is_convex, z_m, floor_only, joint_m[person], farthest,
                    xy_m[person, mode], cov_m2[person, mode], asked, end, by_mode[person, mode],
                )  # fmt: skip
            else:
                for step in range(asked, end):
                    by_mode[person, mode, step] = max(
                        by_mode[person, mode, step], by_mode[person, mode, step - 1]
                    )


@inner
def _at_most(
    corners, around, is_convex, z_m, floor_only, joints_m, farthest, weight, xy_m, cov_m2, first,
    asked,
):  # fmt: skip
    """Return an upper bound of the probability that one person will have been there in time."""
    most = 0.0
    for mode in range(xy_m.shape[0]):
        best = 0.0
        for step in range(first, asked):
            if best < 1.0:
                best = _there(
                    corners, around, is_convex, z_m, floor_only, joints_m, farthest,
                    xy_m[mode, step], cov_m2[mode, step], best, True,
                )  # fmt: skip
        most += weight[mode] * best
    return most


@inner
def _follow(
    corners, around, is_convex, z_m, floor_only, joints_m, farthest, xy_m, cov_m2, first, end, by
):
    """Raise the probabilities of one mode; return the last one."""
    best = by[first - 1] if first > 0 else 0.0
    for step in range(first, end):
        best = max(best, by[step])
        if best < 1.0:
            best = _there(
                corners, around, is_convex, z_m, floor_only, joints_m, farthest, xy_m[step],
                cov_m2[step], best, False,
            )  # fmt: skip
        by[step] = best
    return best
