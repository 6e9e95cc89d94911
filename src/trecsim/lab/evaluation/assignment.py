"""The best way to pair rows with columns, for evaluation: exact and free of the fusion's code."""

import numpy as np
from jaxtyping import Bool, Float64, Int64

FREE = -1


def best_pairs(
    distance: Float64[np.ndarray, "row column"], gate: float
) -> tuple[tuple[int, int], ...]:
    """Return the pairs, each row and column at most once, that are best altogether.

    As many pairs as possible within the gate come first, then the smallest sum of distances.

    Parameters
    ----------
    distance
        Between each row and column; NaN where a pair cannot be.
    gate
        Pairs further apart than this are not made.

    Notes
    -----
    Hungarian method with shortest augmenting paths, O(n^3), over those whose pair is disputed. A
    pair that is not allowed costs more than all allowed ones together.

    Examples
    --------
    >>> best_pairs(np.array([[0.1, 0.2], [0.15, 9.0]]), gate=0.5)
    ((0, 1), (1, 0))
    """
    allowed = distance <= gate
    lone = allowed & (allowed.sum(axis=1, keepdims=True) == 1) & (allowed.sum(axis=0) == 1)
    sure = [(int(row), int(column)) for row, column in np.argwhere(lone)]
    disputed = allowed & ~lone
    if not disputed.any():
        return tuple(sure)
    rows, columns = np.flatnonzero(disputed.any(axis=1)), np.flatnonzero(disputed.any(axis=0))
    part = np.ix_(rows, columns)
    chosen = _best_complete(distance[part], allowed[part], gate)
    return tuple(sorted(sure + [(int(rows[i]), int(columns[j])) for i, j in chosen]))


def heaviest_pairs(worth: Float64[np.ndarray, "row column"]) -> tuple[tuple[int, int], ...]:
    """Return the pairs, each row and column at most once, that are worth most altogether.

    Parameters
    ----------
    worth
        Of each pair; those worth nothing are not made.

    Examples
    --------
    >>> heaviest_pairs(np.array([[0.9, 0.8], [0.7, 0.0]]))
    ((0, 1), (1, 0))
    """
    rows, columns = worth.shape
    size = max(rows, columns)
    cost = np.full((size, size), worth.max(initial=0.0))
    cost[:rows, :columns] -= worth
    column_of = _assign(cost)[:rows]
    pairs = ((row, int(column)) for row, column in enumerate(column_of) if column < columns)
    return tuple(pair for pair in pairs if worth[pair] > 0)


def _best_complete(
    distance: Float64[np.ndarray, "row column"],
    allowed: Bool[np.ndarray, "row column"],
    gate: float,
) -> list[tuple[int, int]]:
    rows, columns = distance.shape
    size = max(rows, columns)
    cost = np.full((size, size), (size + 1) * gate)
    cost[:rows, :columns] = np.where(allowed, distance, (size + 1) * gate)
    column_of = _assign(cost)[:rows]
    return [(row, int(j)) for row, j in enumerate(column_of) if j < columns and allowed[row, j]]


def _assign(cost: Float64[np.ndarray, "n n"]) -> Int64[np.ndarray, " n"]:
    """Return for each row its column in the cheapest complete assignment."""
    size = len(cost)
    row_price, column_price = np.zeros(size), np.zeros(size)
    row_of = np.full(size, FREE)
    for row in range(size):
        end, came_from = _cheapest_way(cost, row, row_of, row_price, column_price)
        while end != FREE:  # every column on the way takes the row of the column before it
            before = came_from[end]
            row_of[end] = row if before == FREE else row_of[before]
            end = before
    return np.argsort(row_of)


def _cheapest_way(
    cost: Float64[np.ndarray, "n n"],
    row: int,
    row_of: Int64[np.ndarray, " n"],
    row_price: Float64[np.ndarray, " n"],
    column_price: Float64[np.ndarray, " n"],
) -> tuple[int, Int64[np.ndarray, " n"]]:
    """Return the free column that is cheapest to reach from `row`, and the way back; raise prices.

    Prices stay such that no pair costs less than its row and column are worth.
    """
    size = len(cost)
    least, came_from = np.full(size, np.inf), np.full(size, FREE)
    used = np.zeros(size, dtype=bool)
    column, reached = FREE, row
    while True:
        extra = cost[reached] - row_price[reached] - column_price
        better = ~used & (extra < least)
        least[better], came_from[better] = extra[better], column
        column = int(np.argmin(np.where(used, np.inf, least)))
        step = least[column]
        row_price[row] += step
        row_price[row_of[used]] += step
        column_price[used] -= step
        least[~used] -= step
        used[column] = True
        if row_of[column] == FREE:
            return column, came_from
        reached = int(row_of[column])
