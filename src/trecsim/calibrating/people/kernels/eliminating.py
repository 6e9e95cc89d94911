"""Bundle adjustment of cameras, clocks and people: normal equations, eliminated from inside out.

Points are eliminated first, then the slowly changing biases of each person and joint along time,
then the height of that joint. What is left are the cameras' unknowns.
"""

import numpy as np

from trecsim.calibrating.people.kernels.looking import certainty, link_of, look, trust
from trecsim.calibrating.people.kernels.small import factor, invert_three, solve_columns
from trecsim.compiler import inner, kernel


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
    high = unknowns.level_m[s] - unknowns.xyz_m[p, 2]
    by_height = trust(high * high / sights.level_m2[s]) / sights.level_m2[s]
    draw = by_height * high * high / (sights.first[p + 1] - sights.first[p])
    out.draw[p] = draw
    for o in range(sights.first[p], sights.first[p + 1]):
        c, cross = sights.cam[o], out.cross[o]
        cross[:] = 0.0
        depth = look(sights, unknowns, o, unknowns.xyz_m[p], n_own, e, by_point, by_own)
        out.depth_m[o] = depth
        if depth < 0.0:
            continue
        own = right[c * n_own : (c + 1) * n_own]
        widen(unknowns.T[c], 1.0 + unknowns.lens[c, 0], depth, by_own, draw, pull, own)
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
    inverse[2, 2] += by_height
    pull[2] += by_height * high
    rise = out.rise[s]
    n_all = right.shape[0]
    rise[n_all] += by_height
    rise[n_all + 1] -= by_height * high
    # the coupling of point and height is -w e_z; it is kept beside the pull
    pull[3] = -by_height
    little = 1e-9 * (inverse[0, 0] + inverse[1, 1] + inverse[2, 2]) + 1e-6
    for i in range(3):
        inverse[i, i] += damping * inverse[i, i] + little
    invert_three(inverse)


@inner
def widen(T, wide, depth, by_own, draw, pull, right):
    """Add the force of a height's draw on the logarithm of a depth over the focal length.

    `by_own` holds the derivatives by the camera's shift: ``-wide u`` and ``-wide v``.
    """
    for i in range(3):
        pull[i] += draw * T[2, i] / depth
    right[0] -= draw * by_own[1, 5] / wide
    right[1] += draw * by_own[0, 5] / wide
    right[5] += draw / depth
    if right.shape[0] > 8:
        right[8] -= draw / wide


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
