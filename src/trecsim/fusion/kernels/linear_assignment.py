"""Assignment of rows to columns with the largest sum of gains."""

import math

import numpy as np

from trecsim.compiler import inner

_NEVER = 1e9


@inner
def cost_of(gain, row, column):
    """Return the cost of a pair; columns past the last are each row's private empty one."""
    n_column = gain.shape[1]
    if column < n_column:
        return -gain[row, column] if gain[row, column] > 0.0 else _NEVER
    return 0.0 if column - n_column == row else _NEVER


@inner
def relax(gain, row, u, v, used, low, way):
    """Update the shortest ways to the unused columns; return the nearest and its distance.

    ``way[0]`` is the column from which the search goes on.
    """
    delta, nearest = math.inf, -1
    for j in range(1, v.shape[0]):
        if used[j]:
            continue
        reduced = cost_of(gain, row - 1, j - 1) - u[row] - v[j]
        if reduced < low[j]:
            low[j] = reduced
            way[j] = way[0]
        if low[j] < delta:
            delta, nearest = low[j], j
    return nearest, delta


@inner(allocates=True)
def assign(gain, best):
    """Assign rows to columns so that the sum of gains is largest; write column or -1 to `best`.

    Only positive gains count: a row may stay without a column.

    Notes
    -----
    Shortest augmenting paths with potentials (Jonker and Volgenant 1987); index 0 of the
    potentials stands for "not yet assigned".
    """
    n_row, n_column = gain.shape
    m = n_column + n_row
    u, v, low = np.empty(m + 1), np.empty(m + 1), np.empty(m + 1)
    owner, way = np.empty(m + 1, np.int64), np.empty(m + 1, np.int64)
    used = np.empty(m + 1, np.int64)
    for j in range(m + 1):  # `np.zeros` would be compiled for each type by itself
        u[j] = v[j] = 0.0
        owner[j] = 0
    for i in range(1, n_row + 1):
        best[i - 1] = -1
        owner[0] = i
        column = 0
        for j in range(m + 1):
            low[j] = math.inf
            used[j] = 0
        while owner[column] != 0:
            used[column] = 1
            way[0] = column
            nearest, delta = relax(gain, owner[column], u, v, used, low, way)
            for j in range(m + 1):
                if used[j]:
                    u[owner[j]] += delta
                    v[j] -= delta
                else:
                    low[j] -= delta
            column = nearest
        while column:
            owner[column] = owner[way[column]]
            column = way[column]
    for j in range(1, n_column + 1):
        if owner[j] > 0 and gain[owner[j] - 1, j - 1] > 0.0:
            best[owner[j] - 1] = j - 1
