"""Floor tracks of two cameras against each other: which motion and offset bring them together."""

import math

import numpy as np

from trecsim.calibrating.people.tuning import EXTENT_M, FLOOR_ERROR_M, FLOOR_GATE_M, TICK_S
from trecsim.compiler import inner, kernel


@kernel(allocates=True)
def scan(first_a, tick_a, xy_a, first_b, tick_b, xy_b, most_lag, fewest, turns, out):
    """Write hypotheses of the motion that takes camera b's floor to camera a's; return how many.

    Parameters
    ----------
    first_a, tick_a, xy_a, first_b, tick_b, xy_b
        `FloorTracks` of the two cameras.
    most_lag
        Largest lag, in ticks.
    fewest
        Least number of positions in common.
    turns
        Whether the two floors may be turned and shifted, or are the same.
    out
        Takes score, lag, angle, x and y of each; the best are kept, changed in place.

    Notes
    -----
    Track b at tick ``i - lag`` is at the same time as track a at tick ``i``. The motion is the
    least-squares one (Procrustes in the plane), by sums over the positions in common.
    """
    made = 0
    for a in range(tick_a.shape[0]):
        n_a = first_a[a + 1] - first_a[a]
        for b in range(tick_b.shape[0]):
            n_b = first_b[b + 1] - first_b[b]
            if min(n_a, n_b) < fewest:
                continue
            gap = tick_a[a] - tick_b[b]  # lag at which both begin together
            before, here = np.zeros(5), np.zeros(5)
            low = max(gap - n_b + fewest, -most_lag)
            high = min(gap + n_a - fewest, most_lag)
            rising = False
            for lag in range(low, high + 1):
                start = max(0, lag - gap)  # position of a
                shift = gap - lag  # b's position is a's plus this
                stop = min(n_a, n_b - shift)
                fit(
                    xy_a[first_a[a] + start : first_a[a] + stop],
                    xy_b[first_b[b] + start + shift : first_b[b] + stop + shift],
                    turns,
                    here,
                )
                here[1] = lag
                if here[0] < before[0] and rising:
                    made = keep(before, out, made)
                rising = here[0] > before[0]
                before[:] = here
            if rising and before[0] > 0.0:
                made = keep(before, out, made)
    return made


@inner
def fit(p, q, turns, out):
    """Write score, (lag), angle, x and y of the motion that takes `q` to `p`."""
    n = p.shape[0]
    px = py = qx = qy = 0.0
    for i in range(n):
        px, py, qx, qy = px + p[i, 0], py + p[i, 1], qx + q[i, 0], qy + q[i, 1]
    px, py, qx, qy = px / n, py / n, qx / n, qy / n
    pp = qq = dot = cross = 0.0
    for i in range(n):
        ax, ay, bx, by = p[i, 0] - px, p[i, 1] - py, q[i, 0] - qx, q[i, 1] - qy
        pp += ax * ax + ay * ay
        qq += bx * bx + by * by
        dot += bx * ax + by * ay
        cross += bx * ay - by * ax
    if turns:
        angle = math.atan2(cross, dot)
        left = max(pp + qq - 2.0 * math.sqrt(dot * dot + cross * cross), 0.0) / n
    else:
        angle = 0.0
        left = max(pp + qq - 2.0 * dot, 0.0) / n + (px - qx) ** 2 + (py - qy) ** 2
    extent = min(pp, qq) / n
    out[0] = 0.0
    if extent > EXTENT_M * EXTENT_M and left < FLOOR_GATE_M * FLOOR_GATE_M:
        out[0] = n * TICK_S * math.log(1.0 + extent / (left + FLOOR_ERROR_M * FLOOR_ERROR_M))
    c, s = math.cos(angle), math.sin(angle)
    out[2] = angle
    out[3] = px - (c * qx - s * qy) if turns else 0.0
    out[4] = py - (s * qx + c * qy) if turns else 0.0


@inner
def keep(found, out, made):
    """Keep a hypothesis among the best, in order; return how many there are."""
    n = out.shape[0]
    if made == n and out[n - 1, 0] >= found[0]:
        return made
    k = min(made, n - 1)
    while k > 0 and out[k - 1, 0] < found[0]:
        for i in range(out.shape[1]):
            out[k, i] = out[k - 1, i]
        k -= 1
    for i in range(out.shape[1]):
        out[k, i] = found[i]
    return min(made + 1, n)


@kernel
def agreement(first_a, tick_a, xy_a, first_b, tick_b, xy_b, motion, matched, common):
    """Write how well each pair of tracks agrees under a motion.

    Parameters
    ----------
    first_a, tick_a, xy_a, first_b, tick_b, xy_b
        `FloorTracks` of the two cameras.
    motion
        Score, lag, angle, x and y.
    matched, common
        Positions that agree, each by how well, and positions in common, (a, b); changed in place.
    """
    lag = round(motion[1])
    c, s = math.cos(motion[2]), math.sin(motion[2])
    for a in range(tick_a.shape[0]):
        n_a = first_a[a + 1] - first_a[a]
        for b in range(tick_b.shape[0]):
            n_b = first_b[b + 1] - first_b[b]
            shift = tick_a[a] - tick_b[b] - lag
            start, stop = max(0, -shift), min(n_a, n_b - shift)
            good = 0.0
            for i in range(start, stop):
                k, m = first_a[a] + i, first_b[b] + i + shift
                x = xy_a[k, 0] - (c * xy_b[m, 0] - s * xy_b[m, 1] + motion[3])
                y = xy_a[k, 1] - (s * xy_b[m, 0] + c * xy_b[m, 1] + motion[4])
                good += max(0.0, 1.0 - (x * x + y * y) / (FLOOR_GATE_M * FLOOR_GATE_M))
            matched[a, b] = good
            common[a, b] = max(stop - start, 0)
