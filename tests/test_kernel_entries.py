"""Python hands groups of arrays to kernels one array after the other."""

from typing import NamedTuple

import numpy as np
import pytest

from trecsim.compiler import inner, kernel
from trecsim.kernel_entries import Signature


class Pair(NamedTuple):
    """Two arrays."""

    left: np.ndarray
    right: np.ndarray


@inner
def total(pair):
    return pair.left[0] + pair.right[0]


@kernel
def weighed(pair, weights, extra):
    """Use a named group, a group that holds another, and a number."""
    share, (first, second) = weights
    return total(pair) * share + first[0] + second.left[0] + extra


ONES = Pair(np.ones(1), np.ones(1))


def test_groups_reach_the_kernel_as_they_are() -> None:
    pair, held = Pair(np.array([1.0]), np.array([2.0])), Pair(np.array([20.0]), np.zeros(1))
    arguments = pair, (10.0, (np.array([4.0]), held)), 500.0
    assert weighed(*arguments) == weighed.py_func(*arguments) == 554.0


def test_the_entry_takes_every_array_by_itself() -> None:
    weighed(ONES, (1.0, (np.ones(1), ONES)), 1.0)
    (types,) = weighed.entry.signatures
    assert len(types) == 7
    assert not any("Tuple" in str(one) for one in types)


def test_a_kernel_without_groups_has_no_entry_of_its_own() -> None:
    signature = Signature("plain", (np.ones(1), 1.0))
    assert not signature.has_groups


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        ((ONES, 1.0), "return kernel(Pair(_0, _1, ), _2)"),
        (((1, (2, 3)), 4), "return kernel((_0, (_1, _2, ), ), _3)"),
    ],
)
def test_the_entry_groups_its_arguments_again(arguments: tuple, expected: str) -> None:
    assert Signature("one", arguments).entry.splitlines()[1].strip() == expected
