"""Tracklets of one camera: detections of the same person in consecutive images."""

import math

import numpy as np

from trecsim.calibrating.people.kernels.small import insert
from trecsim.calibrating.people.tuning import (
    LINK_GATE,
    LINK_GATE_PER_S,
    LINK_MARGIN,
    LINK_SURE,
    LONGEST_GAP_S,
    MOST_OPEN,
)
from trecsim.compiler import inner, kernel


@kernel(allocates=True)
def link(t_s, first, xy, size, tracklet):
    """Write the number of each detection's tracklet; return how many there are.

    Parameters
    ----------
    t_s, first, xy, size
        As in `CameraRecord`.
    tracklet
        Of each detection; changed in place, -1 where it has none.
    """
    last = np.full(MOST_OPEN, -1)  # newest detection of each open tracklet
    number, since_s = np.zeros(MOST_OPEN, np.int64), np.zeros(MOST_OPEN)
    speed, steps = np.zeros((MOST_OPEN, 2)), np.empty(xy.shape[1])
    cost = np.empty((MOST_OPEN, MOST_OPEN))
    partner = np.empty(MOST_OPEN, np.int64)
    made = 0
    for i in range(t_s.shape[0]):
        begin, n = first[i], min(first[i + 1] - first[i], MOST_OPEN)
        for o in range(MOST_OPEN):
            if last[o] >= 0 and t_s[i] - since_s[o] > LONGEST_GAP_S:
                last[o] = -1
            for d in range(n):
                cost[o, d] = math.inf
                if last[o] >= 0:
                    ahead_s = t_s[i] - since_s[o]
                    gate = LINK_GATE + LINK_GATE_PER_S * ahead_s
                    step = median_step(xy, size, last[o], begin + d, speed[o], ahead_s, steps)
                    if step < gate * LINK_MARGIN:
                        cost[o, d] = step
        choose(cost, n, last, partner)
        for d in range(n):
            o = partner[d]
            gate = LINK_GATE + LINK_GATE_PER_S * (t_s[i] - since_s[o]) if o >= 0 else 0.0
            if o < 0 or cost[o, d] > gate:
                o = free_place(last)
                if o < 0:
                    tracklet[begin + d] = -1
                    continue
                number[o] = made
                speed[o] = 0.0
                made += 1
            else:
                follow_speed(xy, last[o], begin + d, t_s[i] - since_s[o], speed[o])
            tracklet[begin + d] = number[o]
            last[o] = begin + d
            since_s[o] = t_s[i]
    return made


@inner
def free_place(last):
    """Return a place without an open tracklet, or -1."""
    for o in range(last.shape[0]):
        if last[o] < 0:
            return o
    return -1


@inner
def choose(cost, n, last, partner):
    """Write the open tracklet of each detection, -1 where none is clear; end doubtful ones."""
    for d in range(n):
        partner[d] = best_of(cost, n, d)
    for d in range(n):
        if partner[d] < -1:
            doubtful = -2 - partner[d]
            for other in range(n):
                if partner[other] == doubtful:
                    partner[other] = -1
            last[doubtful] = -1
            partner[d] = -1


@inner
def best_of(cost, n, d):
    """Return the open tracklet of a detection; -2 minus its number where it is in doubt."""
    best, second, chosen = math.inf, math.inf, -1
    for o in range(cost.shape[0]):
        if cost[o, d] < best:
            best, second, chosen = cost[o, d], best, o
        elif cost[o, d] < second:
            second = cost[o, d]
    if chosen < 0:
        return -1
    for other in range(n):
        if other != d:
            second = min(second, cost[chosen, other])
    clear = max(LINK_MARGIN * best, best + LINK_SURE)
    return chosen if second > clear else -2 - chosen


@inner
def median_step(xy, size, a, b, speed, ahead_s, steps):
    """Return the median distance of the joints two detections share, over the body's size."""
    n = 0
    for j in range(xy.shape[1]):
        x = xy[b, j, 0] - xy[a, j, 0] - speed[0] * ahead_s
        y = xy[b, j, 1] - xy[a, j, 1] - speed[1] * ahead_s
        d = math.sqrt(x * x + y * y)
        if d >= 0.0:  # not NaN
            insert(d, n, steps)
            n += 1
    scale = max(size[a], size[b])
    if n < 4 or not scale > 0.0:
        return math.inf
    return steps[n // 2] / scale


@inner
def follow_speed(xy, a, b, ahead_s, speed):
    """Update the speed of a tracklet by the mean step of the joints, in place."""
    x = y = 0.0
    n = 0
    for j in range(xy.shape[1]):
        dx, dy = xy[b, j, 0] - xy[a, j, 0], xy[b, j, 1] - xy[a, j, 1]
        if dx * dx + dy * dy >= 0.0:
            x, y, n = x + dx, y + dy, n + 1
    if n > 0 and ahead_s > 0.0:
        speed[0] += 0.3 * (x / n / ahead_s - speed[0])
        speed[1] += 0.3 * (y / n / ahead_s - speed[1])
