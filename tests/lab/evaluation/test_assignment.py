"""Exact pairing, against SciPy."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import linear_sum_assignment

from trecsim.lab.evaluation.assignment import best_pairs


def reference_cost(distance: np.ndarray, gate: float) -> tuple[int, float]:
    """Return how many pairs are possible and their smallest sum, by SciPy."""
    forbidden = 1000.0
    cost = np.where(distance <= gate, distance, forbidden)
    kept = [(r, c) for r, c in zip(*linear_sum_assignment(cost), strict=True)]
    kept = [(r, c) for r, c in kept if cost[r, c] < forbidden]
    return len(kept), float(sum(distance[r, c] for r, c in kept))


@given(st.integers(0, 2**32 - 1), st.integers(0, 9), st.integers(0, 9), st.floats(0.0, 0.5))
def test_pairing_is_as_good_as_the_reference(
    seed: int, rows: int, columns: int, unknown: float
) -> None:
    rng = np.random.default_rng(seed)
    distance = rng.uniform(0, 1, (rows, columns))
    distance[rng.uniform(size=distance.shape) < unknown] = np.nan
    pairs = best_pairs(distance, 0.6)
    total = sum(distance[pair] for pair in pairs)
    wanted_pairs, wanted_total = reference_cost(np.nan_to_num(distance, nan=9.0), 0.6)
    assert len(pairs) == wanted_pairs
    np.testing.assert_allclose(total, wanted_total, atol=1e-12)
    assert len({row for row, _ in pairs}) == len({column for _, column in pairs}) == len(pairs)


def test_two_pairs_are_better_than_one_close_pair() -> None:
    assert best_pairs(np.array([[0.0, 0.4], [0.4, 9.0]]), 0.5) == ((0, 1), (1, 0))


def test_nobody_pairs_with_nobody() -> None:
    assert best_pairs(np.empty((0, 3)), 0.5) == ()
    assert best_pairs(np.full((2, 2), np.nan), 0.5) == ()
