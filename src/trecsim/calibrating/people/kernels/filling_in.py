"""From a step of the cameras to all that was eliminated: places, heights and biases."""

import numpy as np

from trecsim.compiler import inner, kernel


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
