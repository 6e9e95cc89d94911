"""Optimal assignment, against trying every possible one."""

import sys
from itertools import permutations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trecsim.errors import SetupError
from trecsim.lab.evaluation.assignment import best_pairs, heaviest_pairs


def by_trying_all(distance: np.ndarray, gate: float) -> tuple[int, float]:
    """Return how many pairs are possible, negative, and their smallest sum."""
    if distance.shape[0] > distance.shape[1]:
        distance = distance.T
    rows, columns = distance.shape
    results = []
    for chosen in permutations(range(columns), rows):
        one = [distance[row, column] for row, column in enumerate(chosen)]
        kept = [value for value in one if value <= gate]
        results.append((-len(kept), sum(kept)))
    return min(results)


@given(st.integers(0, 2**32 - 1), st.integers(0, 5), st.integers(0, 5), st.floats(0.0, 0.5))
def test_pairing_is_as_good_as_the_best_of_all_possible_ones(
    seed: int, rows: int, columns: int, unknown: float
) -> None:
    rng = np.random.default_rng(seed)
    distance = rng.uniform(0, 1, (rows, columns))
    distance[rng.uniform(size=distance.shape) < unknown] = np.nan
    pairs = best_pairs(distance, 0.6)
    wanted_pairs, wanted_total = by_trying_all(distance, 0.6)
    assert -len(pairs) == wanted_pairs
    np.testing.assert_allclose(sum(distance[pair] for pair in pairs), wanted_total, atol=1e-12)
    assert len({row for row, _ in pairs}) == len({column for _, column in pairs}) == len(pairs)


def test_two_pairs_are_better_than_one_close_pair() -> None:
    assert best_pairs(np.array([[0.0, 0.4], [0.4, 9.0]]), 0.5) == ((0, 1), (1, 0))


def test_only_pairs_within_a_gate_of_zero_are_made() -> None:
    assert best_pairs(np.array([[np.nan, 0.0], [0.1, np.nan]]), 0.0) == ((0, 1),)


def test_nobody_pairs_with_nobody() -> None:
    assert best_pairs(np.empty((0, 3)), 0.5) == ()
    assert best_pairs(np.full((2, 2), np.nan), 0.5) == ()
    assert heaviest_pairs(np.zeros((2, 3))) == ()


def test_without_scipy_the_message_names_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "scipy.special", None)
    with pytest.raises(SetupError, match=r"pip install .*\[evaluate\]"):
        best_pairs(np.zeros((1, 1)), 0.5)
