"""How probable it is that people will have been in a zone by each time ahead.

Notes
-----
Within a mode, the error of a path grows steadily and hardly changes its direction: the path is
``x(t) = m(t) + A(t) z`` with ``A A' = C(t)``, and one z for the whole path, normally distributed in
two dimensions. For some values of the second component, each as probable as the others, the first
ones with which the path is inside at a time are an interval, as a zone is made of convex parts. In
between two times the interval moves from one to the next. The probability is that of the union of
all intervals so far, in the mean over the second component.

The body reaches farther than its floor point: each side of a zone is moved outwards by as much as
the joints stick out inwards.
"""

import math
from statistics import NormalDist

import numpy as np

from trecsim.compiler import inner, kernel
from trecsim.safety.kernels.polygon_kernels import LEAST_SIGMA_M

LEAST = 0.01
"""Later times are computed only for people who are at least so probably there in time."""
PATHS = 16
"""Values of the second component."""
_LEAST_M2 = LEAST_SIGMA_M * LEAST_SIGMA_M
_ACROSS = np.array([NormalDist().inv_cdf((n + 0.5) / PATHS) for n in range(PATHS)])
_FARTHEST, _PER_UNIT = 6.0, 32
_BELOW = np.array(
    [NormalDist().cdf(n / _PER_UNIT - _FARTHEST) for n in range(2 * int(_FARTHEST) * _PER_UNIT + 1)]
)
_SURE = 4.5  # standard deviations from a zone: nobody gets there
_LEVEL = 1e-12  # a side that is so nearly parallel to the way bounds nothing along it
MOST = 6
"""Separate intervals that are kept."""


@inner
def _below(z):
    """Return the probability that a standard normal variable is below z, to 3e-5."""
    if z <= -_FARTHEST:
        return 0.0
    if z >= _FARTHEST:
        return 1.0
    place = (z + _FARTHEST) * _PER_UNIT
    n = min(int(place), _BELOW.shape[0] - 2)
    share = place - n
    return (1.0 - share) * _BELOW[n] + share * _BELOW[n + 1]


@inner
def _reach(joints_m, z_m, towards_x, towards_y):
    """Return how far joints between two heights stick out in a direction; -inf without any [m]."""
    reach = -math.inf
    for joint in range(joints_m.shape[0]):
        if z_m[0] <= joints_m[joint, 2] <= z_m[1]:
            reach = max(reach, towards_x * joints_m[joint, 0] + towards_y * joints_m[joint, 1])
    return reach


@inner
def _prepare(planes, reach_m, xy_m, cov_m2, end, lines):
    """Write what bounds z at each time: ``a z1 + b z2 >= c`` for each side of each part.

    Return the first and the last step at which anybody may be there; reversed if there is none.

    Parameters
    ----------
    planes
        Sides (time or 1, part, side, 3): inward normal, and how far along it the side is [m].
    reach_m
        How far the body sticks out inwards of each of them [m].
    xy_m, cov_m2, end
        Of one mode (step), up to a step.
    lines
        Is written (step, part, side, 3).
    """
    first, last = end, -1
    for step in range(end):
        at = step if planes.shape[0] > 1 else 0
        scale_x = math.sqrt(cov_m2[step, 0, 0] + _LEAST_M2)
        shear = cov_m2[step, 0, 1] / scale_x
        scale_y = math.sqrt(max(cov_m2[step, 1, 1] + _LEAST_M2 - shear * shear, _LEAST_M2))
        for part in range(planes.shape[1]):
            may = True
            for side in range(planes.shape[2]):
                normal_x, normal_y = planes[at, part, side, 0], planes[at, part, side, 1]
                lines[step, part, side, 0] = normal_x * scale_x + normal_y * shear
                lines[step, part, side, 1] = normal_y * scale_y
                lines[step, part, side, 2] = (
                    planes[at, part, side, 2] - reach_m[at, part, side]
                    - normal_x * xy_m[step, 0] - normal_y * xy_m[step, 1]
                )  # fmt: skip
                a, b = lines[step, part, side, 0], lines[step, part, side, 1]
                c = lines[step, part, side, 2]
                may = may and (c <= 0.0 or c * c <= _SURE * _SURE * (a * a + b * b))
            if may:
                first, last = min(first, step), step
    return first, last


@inner
def _interval(lines, across):
    """Return from which first component to which one part holds the path; empty if reversed."""
    low, high = -math.inf, math.inf
    for side in range(lines.shape[0]):
        slope, least = lines[side, 0], lines[side, 2] - across * lines[side, 1]
        if slope > _LEVEL:
            low = max(low, least / slope)
        elif slope < -_LEVEL:
            high = min(high, least / slope)
        elif least > 0.0:
            return math.inf, -math.inf
    return low, high


@inner
def _add(intervals, count, low, high):
    """Unite an interval with `count` separate ones; return how many there are then."""
    n = 0
    while n < count:
        if intervals[n, 0] <= high and low <= intervals[n, 1]:
            low, high = min(low, intervals[n, 0]), max(high, intervals[n, 1])
            count -= 1
            intervals[n, 0], intervals[n, 1] = intervals[count, 0], intervals[count, 1]
            n = 0  # the longer one may reach others
        else:
            n += 1
    if count < intervals.shape[0]:
        intervals[count, 0], intervals[count, 1] = low, high
        count += 1
    return count


@inner
def _follow(lines, first, last, end, before, intervals, by):
    """Write the probability of having been there by each step to `by`.

    Only the steps from just before the first one to just after the last one can change it.
    """
    for step in range(end):
        by[step] = 0.0
    if first > last:
        return
    first, last = max(first - 1, 0), min(last + 1, end - 1)
    for k in range(PATHS):
        _follow_paths(lines, first, last, _ACROSS[k], before, intervals, by)
    for step in range(last + 1, end):
        by[step] = by[last]


@inner
def _follow_paths(lines, first, last, across, before, intervals, by):
    """Add the share of the paths with one second component to `by`, from step to step."""
    count = 0
    for part in range(lines.shape[1]):
        before[part, 0], before[part, 1] = math.inf, -math.inf
    inside = 0.0
    for step in range(first, last + 1):
        has_grown = False
        for part in range(lines.shape[1]):
            low, high = _interval(lines[step, part], across)
            if low < high:
                count = _add(
                    intervals, count, min(low, before[part, 0]), max(high, before[part, 1])
                )
                has_grown = True
            else:
                low, high = math.inf, -math.inf
            before[part, 0], before[part, 1] = low, high
        if has_grown:
            inside = 0.0
            for n in range(count):
                inside += _below(intervals[n, 1]) - _below(intervals[n, 0])
        by[step] += inside / PATHS


@inner
def _has_reach(planes, z_m, floor_only, joints_m, reach_m):
    """Write how far the body reaches across each side; return whether a joint is between them."""
    for at in range(planes.shape[0]):
        for part in range(planes.shape[1]):
            for side in range(planes.shape[2]):
                reach_m[at, part, side] = 0.0
                if not floor_only:
                    reach = _reach(
                        joints_m, z_m, planes[at, part, side, 0], planes[at, part, side, 1]
                    )
                    if reach == -math.inf:
                        return False
                    reach_m[at, part, side] = reach
    return True


@kernel
def reached_zone(
    planes, z_m, floor_only, rows, weight, xy_m, cov_m2, joint_m, asked, reach_m, lines, before,
    intervals, by_mode,
):  # fmt: skip
    """Write the probability that people will have been in a zone to `by_mode`.

    Parameters
    ----------
    planes
        Its sides, see `_prepare`: of one time, or of each step where it moves.
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
    asked
        Later steps than this are computed only for people who are there by then with `LEAST`.
    reach_m, lines, before, intervals
        Room to work in: (time, part, side), (step, part, side, 3), (part, 2), (MOST, 2).
    by_mode
        Probabilities per person, mode and step.
    """
    steps = xy_m.shape[2]
    for person in rows:
        if not _has_reach(planes, z_m, floor_only, joint_m[person], reach_m):
            continue
        reached = 0.0
        for mode in range(xy_m.shape[1]):
            by = by_mode[person, mode]
            first, last = _prepare(
                planes, reach_m, xy_m[person, mode], cov_m2[person, mode], asked + 1, lines
            )
            _follow(lines, first, last, asked + 1, before, intervals, by)
            reached += weight[person, mode] * by[asked]
        for mode in range(xy_m.shape[1]):
            by = by_mode[person, mode]
            if reached > LEAST and asked + 1 < steps:
                first, last = _prepare(
                    planes, reach_m, xy_m[person, mode], cov_m2[person, mode], steps, lines
                )
                _follow(lines, first, last, steps, before, intervals, by)
            else:
                for step in range(asked + 1, steps):
                    by[step] = by[asked]
