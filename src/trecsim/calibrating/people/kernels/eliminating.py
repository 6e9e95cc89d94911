"""Bundle adjustment of cameras, clocks and people: normal equations, eliminated from inside out.

Points are eliminated first, then the slowly changing biases of each person and joint along time,
then the height of that joint. What is left are the cameras' unknowns.
"""

import math
from typing import NamedTuple

import numpy as np

from trecsim.calibrating.people.kernels.small import factor, invert_three, solve_columns
from trecsim.calibrating.people.tuning import BIAS_S, LEAST_WEIGHT, NOISE_PX, ROBUST
from trecsim.compiler import inner, kernel


class Sights(NamedTuple):
    """What was seen: arrays of observations in the order of series, points and cameras.

    A series is one joint of one person over time; it has points and blocks of time.

    Attributes
    ----------
    point_first, block_first
        Of each series its first point and block; one more entry than series.
    noise_m2, bias_m2, level_m2
        Variances of each series: fast noise, slow bias, change of the joint's height.
    gap_s
        Of each block the time since the one before.
    block, first
        Of each point its block and its first observation (one more entry than points).
    cam, z, speed, ahead_s
        Of each observation the camera, the place in its plane z = 1, its speed there, and the stamp
        since the camera's reference stamp.
    focal_px
        Of each camera.
    """

    point_first: np.ndarray
    block_first: np.ndarray
    noise_m2: np.ndarray
    bias_m2: np.ndarray
    level_m2: np.ndarray
    gap_s: np.ndarray
    block: np.ndarray
    first: np.ndarray
    cam: np.ndarray
    z: np.ndarray
    speed: np.ndarray
    ahead_s: np.ndarray
    focal_px: np.ndarray


class Unknowns(NamedTuple):
    """What is estimated.

    Attributes
    ----------
    T
        Poses of the cameras, from the world.
    clock, lens
        Change of the clocks since the observations were sampled, and of the lenses.
    xyz_m, level_m
        Places of all points, and height of each series.
    bias_m
        Of each block and camera, along the camera's axes.
    """

    T: np.ndarray
    clock: np.ndarray
    lens: np.ndarray
    xyz_m: np.ndarray
    level_m: np.ndarray
    bias_m: np.ndarray


class Eliminated(NamedTuple):
    """What is kept of the elimination, to find the inner unknowns from the cameras'.

    Attributes
    ----------
    inverse, pull
        Of each point the inverse of its normal matrix, and its right-hand side.
    cross
        Of each observation the coupling of its point with bias and camera.
    factor, border, side
        Of each block the Cholesky factor, the coupling with cameras and height, solved, and the
        right-hand side, solved.
    along
        Of each block the coupling with the next one (a number on the diagonal), and solved.
    rise
        Of each series the normal number of its height, the couplings and the right-hand side.
    """

    inverse: np.ndarray
    pull: np.ndarray
    cross: np.ndarray
    factor: np.ndarray
    border: np.ndarray
    side: np.ndarray
    along: np.ndarray
    rise: np.ndarray


@inner
def look(sights, unknowns, o, x, n_own, e, by_point, by_own):
    """Write the residual [m] of an observation and its derivatives; return the depth [m].

    The derivatives are those of the prediction, by the point and by the camera's own unknowns:
    turn, shift, offset, drift and, if `n_own` is 11, focal length and principal point.
    """
    c = sights.cam[o]
    T = unknowns.T[c]
    px = T[0, 0] * x[0] + T[0, 1] * x[1] + T[0, 2] * x[2] + T[0, 3]
    py = T[1, 0] * x[0] + T[1, 1] * x[1] + T[1, 2] * x[2] + T[1, 3]
    pz = T[2, 0] * x[0] + T[2, 1] * x[1] + T[2, 2] * x[2] + T[2, 3]
    if not pz > 0.05:
        return -1.0
    u, v = px / pz, py / pz
    lens = unknowns.lens[c]
    wide = 1.0 + lens[0]
    late = unknowns.clock[c, 0] + unknowns.clock[c, 1] * sights.ahead_s[o]
    e[0] = pz * (sights.z[o, 0] - sights.speed[o, 0] * late - wide * u - lens[1])
    e[1] = pz * (sights.z[o, 1] - sights.speed[o, 1] * late - wide * v - lens[2])
    for a in range(3):
        by_point[0, a] = wide * (T[0, a] - u * T[2, a])
        by_point[1, a] = wide * (T[1, a] - v * T[2, a])
    # turn w: dp = w x p; shift: dp = s
    by_own[0, 0], by_own[0, 1], by_own[0, 2] = -wide * u * py, wide * (pz + u * px), -wide * py
    by_own[1, 0], by_own[1, 1], by_own[1, 2] = -wide * (pz + v * py), wide * v * px, wide * px
    by_own[0, 3], by_own[0, 4], by_own[0, 5] = wide, 0.0, -wide * u
    by_own[1, 3], by_own[1, 4], by_own[1, 5] = 0.0, wide, -wide * v
    for a in range(2):
        by_own[a, 6] = pz * sights.speed[o, a]
        by_own[a, 7] = by_own[a, 6] * sights.ahead_s[o]
    if n_own > 8:
        by_own[0, 8], by_own[0, 9], by_own[0, 10] = pz * u, pz, 0.0
        by_own[1, 8], by_own[1, 9], by_own[1, 10] = pz * v, 0.0, pz
    return pz


@inner
def certainty(sights, s, o, depth_m, scale):
    """Return the inverse variance of an observation [1/m^2]."""
    floor_m = NOISE_PX * depth_m / sights.focal_px[sights.cam[o]]
    return 1.0 / (scale * scale * (sights.noise_m2[s] + floor_m * floor_m))


@inner
def trust(square):
    """Return the weight of a squared residual in standard deviations (Geman and McClure)."""
    s2 = ROBUST * ROBUST
    w = s2 / (s2 + square)
    return max(w * w, LEAST_WEIGHT)


@inner
def cost_of(square):
    """Return the cost that belongs to `trust`."""
    s2 = ROBUST * ROBUST
    return s2 * square / (s2 + square) + LEAST_WEIGHT * square


@kernel(allocates=True)
def total_cost(sights, unknowns, scale):
    """Return the robust cost of all observations, biases and heights."""
    e, by_point, by_own = np.empty(2), np.empty((2, 3)), np.empty((2, 11))
    cost = 0.0
    for s in range(sights.noise_m2.shape[0]):
        for p in range(sights.point_first[s], sights.point_first[s + 1]):
            bias = unknowns.bias_m[sights.block[p]]
            for o in range(sights.first[p], sights.first[p + 1]):
                c = sights.cam[o]
                depth = look(sights, unknowns, o, unknowns.xyz_m[p], 8, e, by_point, by_own)
                if depth < 0.0:
                    cost += ROBUST * ROBUST
                    continue
                x, y = e[0] - bias[c, 0], e[1] - bias[c, 1]
                cost += cost_of((x * x + y * y) * certainty(sights, s, o, depth, scale))
            high = unknowns.xyz_m[p, 2] - unknowns.level_m[s]
            cost += cost_of(high * high / sights.level_m2[s])
        for b in range(sights.block_first[s], sights.block_first[s + 1]):
            kept, info = link_of(sights, s, b)
            for c in range(unknowns.bias_m.shape[1]):
                for a in range(2):
                    step = unknowns.bias_m[b, c, a]
                    if kept > 0.0:
                        step -= kept * unknowns.bias_m[b - 1, c, a]
                    cost += info * step * step
    return cost


@inner
def link_of(sights, s, b):
    """Return how much of the bias of the block before is left, and the step's information."""
    if b == sights.block_first[s]:
        return 0.0, 1.0 / sights.bias_m2[s]
    kept = math.exp(-sights.gap_s[b] / BIAS_S)
    return kept, 1.0 / (sights.bias_m2[s] * (1.0 - kept * kept))


@kernel(allocates=True)
def reduce(sights, unknowns, scale, damping, normal, right, out):
    """Add the reduced normal equations of the cameras, and write what solves the rest.

    Parameters
    ----------
    sights, unknowns
        `Sights` and `Unknowns`.
    scale
        Noise over its usual size.
    damping
        Share by which the points' normal matrices are raised.
    normal, right
        Of the cameras' unknowns, one camera after the other; changed in place.
    out
        `Eliminated`, changed in place.
    """
    n_cam, n_all = unknowns.T.shape[0], right.shape[0]
    n_own = n_all // n_cam
    e, by_point, by_own = np.empty(2), np.empty((2, 3)), np.empty((2, 11))
    for s in range(sights.noise_m2.shape[0]):
        blocks = range(sights.block_first[s], sights.block_first[s + 1])
        for b in blocks:
            out.factor[b] = 0.0
            out.border[b] = 0.0
            out.side[b] = 0.0
            out.along[b] = 0.0
        out.rise[s] = 0.0
        for p in range(sights.point_first[s], sights.point_first[s + 1]):
            observe(
                sights,
                unknowns,
                s,
                p,
                n_own,
                scale,
                damping,
                (e, by_point, by_own),
                normal,
                right,
                out,
            )
            take_point(sights, p, n_own, normal, right, out, s)
        for b in blocks:
            remember(sights, unknowns, s, b, out)
        for b in blocks:
            take_block(b, b + 1 < sights.block_first[s + 1], n_all, normal, right, out, s)
        take_level(s, n_all, normal, right, out)


@inner
def observe(sights, unknowns, s, p, n_own, scale, damping, look_at, normal, right, out):
    """Add a point's observations to the equations, before the point is eliminated."""
    e, by_point, by_own = look_at
    b, inverse, pull = sights.block[p], out.inverse[p], out.pull[p]
    matrix, border, side = out.factor[b], out.border[b], out.side[b]
    inverse[:] = 0.0
    pull[:] = 0.0
    for o in range(sights.first[p], sights.first[p + 1]):
        c, cross = sights.cam[o], out.cross[o]
        cross[:] = 0.0
        depth = look(sights, unknowns, o, unknowns.xyz_m[p], n_own, e, by_point, by_own)
        if depth < 0.0:
            continue
        e[0] -= unknowns.bias_m[b, c, 0]
        e[1] -= unknowns.bias_m[b, c, 1]
        w = certainty(sights, s, o, depth, scale)
        w *= trust((e[0] * e[0] + e[1] * e[1]) * w)
        at = c * n_own
        for a in range(2):
            matrix[2 * c + a, 2 * c + a] += w
            side[2 * c + a] += w * e[a]
            for i in range(3):
                pull[i] += w * by_point[a, i] * e[a]
                cross[i, a] += w * by_point[a, i]
                for j in range(3):
                    inverse[i, j] += w * by_point[a, i] * by_point[a, j]
                for m in range(n_own):
                    cross[i, 2 + m] += w * by_point[a, i] * by_own[a, m]
            for m in range(n_own):
                right[at + m] += w * by_own[a, m] * e[a]
                border[2 * c + a, at + m] += w * by_own[a, m]
                for k in range(n_own):
                    normal[at + m, at + k] += w * by_own[a, m] * by_own[a, k]
    high = unknowns.level_m[s] - unknowns.xyz_m[p, 2]
    w = trust(high * high / sights.level_m2[s]) / sights.level_m2[s]
    inverse[2, 2] += w
    pull[2] += w * high
    rise = out.rise[s]
    n_all = right.shape[0]
    rise[n_all] += w
    rise[n_all + 1] -= w * high
    # the coupling of point and height is -w e_z; it is kept beside the pull
    pull[3] = -w
    little = 1e-9 * (inverse[0, 0] + inverse[1, 1] + inverse[2, 2]) + 1e-6
    for i in range(3):
        inverse[i, i] += damping * inverse[i, i] + little
    invert_three(inverse)


@inner
def take_point(sights, p, n_own, normal, right, out, s):
    """Eliminate a point from the equations of biases, height and cameras."""
    b, inverse, pull = sights.block[p], out.inverse[p], out.pull[p]
    matrix, border, side, rise = out.factor[b], out.border[b], out.side[b], out.rise[s]
    n_all = right.shape[0]
    up = pull[3]
    moved_x = inverse[0, 0] * pull[0] + inverse[0, 1] * pull[1] + inverse[0, 2] * pull[2]
    moved_y = inverse[1, 0] * pull[0] + inverse[1, 1] * pull[1] + inverse[1, 2] * pull[2]
    moved_z = inverse[2, 0] * pull[0] + inverse[2, 1] * pull[1] + inverse[2, 2] * pull[2]
    rise[n_all] -= up * up * inverse[2, 2]
    rise[n_all + 1] -= up * moved_z
    for o in range(sights.first[p], sights.first[p + 1]):
        c, cross = sights.cam[o], out.cross[o]
        at = c * n_own
        for m in range(2 + n_own):
            x = (
                cross[0, m] * inverse[0, 0]
                + cross[1, m] * inverse[1, 0]
                + cross[2, m] * inverse[2, 0]
            )
            y = (
                cross[0, m] * inverse[0, 1]
                + cross[1, m] * inverse[1, 1]
                + cross[2, m] * inverse[2, 1]
            )
            z = (
                cross[0, m] * inverse[0, 2]
                + cross[1, m] * inverse[1, 2]
                + cross[2, m] * inverse[2, 2]
            )
            drawn = cross[0, m] * moved_x + cross[1, m] * moved_y + cross[2, m] * moved_z
            if m < 2:
                side[2 * c + m] -= drawn
                border[2 * c + m, n_all] -= z * up
            else:
                right[at + m - 2] -= drawn
                rise[at + m - 2] -= z * up
            for q in range(sights.first[p], sights.first[p + 1]):
                d, other = sights.cam[q], out.cross[q]
                to = d * n_own
                if m < 2:
                    row, line = matrix[2 * c + m], border[2 * c + m]
                    for k in range(2):
                        row[2 * d + k] -= x * other[0, k] + y * other[1, k] + z * other[2, k]
                    for k in range(n_own):
                        line[to + k] -= (
                            x * other[0, 2 + k] + y * other[1, 2 + k] + z * other[2, 2 + k]
                        )
                else:
                    row = normal[at + m - 2]
                    for k in range(n_own):
                        row[to + k] -= (
                            x * other[0, 2 + k] + y * other[1, 2 + k] + z * other[2, 2 + k]
                        )


@inner
def remember(sights, unknowns, s, b, out):
    """Add to a block's equations that its bias goes on from that of the block before."""
    kept, info = link_of(sights, s, b)
    for i in range(out.side.shape[1]):
        c, a = i // 2, i % 2
        step = unknowns.bias_m[b, c, a]
        if kept > 0.0:
            step -= kept * unknowns.bias_m[b - 1, c, a]
            out.factor[b - 1, i, i] += info * kept * kept
            out.side[b - 1, i] += info * kept * step
            out.along[b - 1] = -info * kept
        out.factor[b, i, i] += info
        out.side[b, i] -= info * step


@inner
def take_block(b, goes_on, n_all, normal, right, out, s):
    """Eliminate the biases of a block from the equations of the next, height and cameras."""
    matrix, border, side, rise = out.factor[b], out.border[b], out.side[b], out.rise[s]
    n = side.shape[0]
    factor(matrix)
    # forward substitution only: L^-1 of border and side; products of these are what is taken off
    solve_columns(matrix, border, side)
    for i in range(n):
        line, e = border[i], side[i]
        for m in range(n_all):
            if line[m] != 0.0:
                w = line[m]
                right[m] -= w * e
                rise[m] -= w * line[n_all]
                row = normal[m]
                for k in range(n_all):
                    row[k] -= w * line[k]
        rise[n_all] -= line[n_all] * line[n_all]
        rise[n_all + 1] -= line[n_all] * e
    if goes_on:
        follow(b, n_all, out)


@inner
def follow(b, n_all, out):
    """Take a block off the next one's equations; they are coupled by a number on the diagonal."""
    matrix, border, side = out.factor[b], out.border[b], out.side[b]
    after, next_border, next_side = out.factor[b + 1], out.border[b + 1], out.side[b + 1]
    n, tie = side.shape[0], out.along[b]
    # L^-1 of tie * identity, column by column: column j has entries from row j on
    for j in range(n):
        for i in range(j, n):
            total = tie if i == j else 0.0
            for k in range(j, i):
                total -= matrix[i, k] * matrix[k, n + j]
            matrix[i, n + j] = total * matrix[i, i]
    for j in range(n):
        for i in range(j, n):
            w = matrix[i, n + j]
            next_side[j] -= w * side[i]
            for m in range(n_all + 1):
                next_border[j, m] -= w * border[i, m]
            for k in range(i + 1):
                after[j, k] -= w * matrix[i, n + k]


@inner
def take_level(s, n_all, normal, right, out):
    """Eliminate the height of a series from the equations of the cameras."""
    rise = out.rise[s]
    if not rise[n_all] > 1e-9:
        rise[n_all] = 0.0
        return
    for m in range(n_all):
        w = rise[m] / rise[n_all]
        if w != 0.0:
            right[m] -= w * rise[n_all + 1]
            row = normal[m]
            for k in range(n_all):
                row[k] -= w * rise[k]


@kernel(allocates=True)
def fill_in(sights, step, out, unknowns, changed):
    """Write all inner unknowns after a step of the cameras.

    Parameters
    ----------
    sights
        `Sights`.
    step
        Of the cameras' unknowns.
    out
        `Eliminated`, as `reduce` left it.
    unknowns, changed
        `Unknowns` before and after; of the second, places, heights and biases are changed.
    """
    n_all = step.shape[0]
    n_own = n_all // unknowns.T.shape[0]
    n = out.side.shape[1]
    moved = np.zeros((unknowns.bias_m.shape[0], n))
    for s in range(sights.noise_m2.shape[0]):
        rise, high = out.rise[s], 0.0
        if rise[n_all] > 0.0:
            high = rise[n_all + 1]
            for m in range(n_all):
                high -= rise[m] * step[m]
            high /= rise[n_all]
        changed.level_m[s] = unknowns.level_m[s] + high
        last = sights.block_first[s + 1] - 1
        for b in range(last, sights.block_first[s] - 1, -1):
            solve_back(b, b < last, step, high, out, moved)
            for i in range(n):
                changed.bias_m[b, i // 2, i % 2] = unknowns.bias_m[b, i // 2, i % 2] + moved[b, i]
        for p in range(sights.point_first[s], sights.point_first[s + 1]):
            pull, inverse, own = out.pull[p], out.inverse[p], moved[sights.block[p]]
            x, y, z = pull[0], pull[1], pull[2] - pull[3] * high
            for o in range(sights.first[p], sights.first[p + 1]):
                c, cross = sights.cam[o], out.cross[o]
                for m in range(2 + n_own):
                    by = own[2 * c + m] if m < 2 else step[c * n_own + m - 2]
                    x -= cross[0, m] * by
                    y -= cross[1, m] * by
                    z -= cross[2, m] * by
            for i in range(3):
                changed.xyz_m[p, i] = unknowns.xyz_m[p, i] + (
                    inverse[i, 0] * x + inverse[i, 1] * y + inverse[i, 2] * z
                )


@inner
def solve_back(b, goes_on, step, high, out, moved):
    """Write the change of a block's biases, once that of the next one is known."""
    matrix, border, side = out.factor[b], out.border[b], out.side[b]
    n, n_all = side.shape[0], step.shape[0]
    for i in range(n):
        total = side[i] - border[i, n_all] * high
        for m in range(n_all):
            total -= border[i, m] * step[m]
        if goes_on:
            for k in range(i + 1):
                total -= matrix[i, n + k] * moved[b + 1, k]
        moved[b, i] = total
    for i in range(n - 1, -1, -1):
        total = moved[b, i]
        for k in range(i + 1, n):
            total -= matrix[k, i] * moved[b, k]
        moved[b, i] = total * matrix[i, i]
