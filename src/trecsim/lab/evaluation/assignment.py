"""Optimal one-to-one assignment of rows to columns, for evaluation; solved by SciPy."""

import numpy as np
from jaxtyping import Float64

from trecsim.extras import needed


def need_scipy() -> None:
    """Raise SetupError with the command that installs SciPy if it is missing."""
    needed("evaluation and studies need SciPy", "evaluate", "scipy.special")


Pairs = tuple[tuple[int, int], ...]


def best_pairs(distance: Float64[np.ndarray, "row column"], gate: float) -> Pairs:
    """Return the assignment with the most pairs within the gate and the least total distance.

    A distance of NaN makes a pair impossible.

    Raises
    ------
    SetupError
        SciPy is not installed.

    Examples
    --------
    >>> best_pairs(np.array([[0.1, 0.2], [0.15, 9.0]]), gate=0.5)
    ((0, 1), (1, 0))
    """
    allowed = distance <= gate
    forbidden = 1.0 + gate * (min(distance.shape) + 1)  # more than all allowed pairs together
    pairs = _assign(np.where(allowed, distance, forbidden))
    return tuple(pair for pair in pairs if allowed[pair])


def heaviest_pairs(weight: Float64[np.ndarray, "row column"]) -> Pairs:
    """Return the assignment with the largest total weight; pairs of weight 0 are left out.

    Raises
    ------
    SetupError
        SciPy is not installed.

    Examples
    --------
    >>> heaviest_pairs(np.array([[0.9, 0.8], [0.7, 0.0]]))
    ((0, 1), (1, 0))
    """
    return tuple(pair for pair in _assign(-weight) if weight[pair] > 0)


def _assign(cost: Float64[np.ndarray, "row column"]) -> list[tuple[int, int]]:
    need_scipy()
    from scipy.optimize import linear_sum_assignment

    rows, columns = linear_sum_assignment(cost)
    return list(zip(rows.tolist(), columns.tolist(), strict=True))
