"""Which points a study tries."""

import numpy as np
import pytest

from trecsim.lab.study.design import Factor, between, grid, levels_of, one_at_a_time, random

A = Factor("a", 1.0, (0.5, 1.0, 2.0))
B = Factor("b", 3, (5, 7), whole=True)
C = Factor("c", 0.1, span=(0.01, 1.0), log=True)


def test_a_grid_has_every_combination_once_and_the_default_for_comparison() -> None:
    design = grid((A, B))
    assert len(set(design.points)) == len(design.points) == 7
    assert design.points[0] == (1.0, 3)
    assert design.own == (False, *[True] * 6)


def test_a_default_that_is_in_the_grid_is_not_tried_twice() -> None:
    design = grid((A,))
    assert design.points == ((1.0,), (0.5,), (2.0,))
    assert all(design.own)


def test_one_at_a_time_changes_one_setting_of_the_default() -> None:
    design = one_at_a_time((A, B))
    changed = [sum(v != d for v, d in zip(p, (1.0, 3), strict=True)) for p in design.points]
    assert changed == [0, 1, 1, 1, 1]
    assert all(design.own)


def test_random_points_cover_each_setting_evenly_and_stay_in_the_range() -> None:
    design = random((A, C), 30)
    columns = list(zip(*design.points[1:], strict=True))
    assert [columns[0].count(value) for value in A.levels] == [10, 10, 10]
    decades = np.log10(columns[1])
    assert ((decades > -2) & (decades < 0)).all()
    assert (np.histogram(decades, bins=10, range=(-2, 0))[0] == 3).all()


def test_the_random_points_are_always_the_same() -> None:
    assert random((A, C), 8).points == random((A, C), 8).points


def test_levels_are_the_values_in_order() -> None:
    design = grid((A, B))
    level, levels = levels_of(design, design.points[1:])
    assert levels == ((0.5, 1.0, 2.0), (5, 7))
    for row, point in zip(level, design.points[1:], strict=True):
        assert (levels[0][row[0]], levels[1][row[1]]) == point


def test_drawn_values_are_put_into_parts_of_equal_count() -> None:
    design = random((C, A), 25)
    level, levels = levels_of(design, design.points[1:])
    assert np.bincount(level[:, 0]).tolist() == [5] * 5
    assert list(levels[0]) == sorted(levels[0])
    for part, mean in enumerate(levels[0]):
        values = [p[0] for p, row in zip(design.points[1:], level, strict=True) if row[0] == part]
        assert min(values) <= mean <= max(values)


@pytest.mark.parametrize("log", [True, False])
def test_a_range_begins_and_ends_where_it_says(log: bool) -> None:
    assert between(0.01, 0.04, 0.0, log=log) == pytest.approx(0.01)
    assert between(0.01, 0.04, 1.0, log=log) == pytest.approx(0.04)
