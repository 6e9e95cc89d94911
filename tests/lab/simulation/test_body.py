"""Bodies: anatomy within what one meets."""

import numpy as np

from trecsim.lab.simulation.body_shape import SHORTEST_M, TALLEST_M, bodies, body


def test_nobody_is_as_tall_as_another_and_all_are_of_usual_height() -> None:
    statures_m = sorted(one.stature_m for one in bodies(20, np.random.default_rng(0)))
    assert SHORTEST_M <= statures_m[0] < statures_m[-1] <= TALLEST_M
    assert min(np.diff(statures_m)) > 0
    assert statures_m[-1] - statures_m[0] > 0.8 * (TALLEST_M - SHORTEST_M)


def test_people_of_the_same_stature_have_limbs_of_their_own() -> None:
    rng = np.random.default_rng(0)
    thighs_m = [body(1.75, rng).thigh_m for _ in range(50)]
    assert 0.005 < np.std(thighs_m) < 0.02
    assert abs(np.mean(thighs_m) - body(1.75).thigh_m) < 0.01


def test_the_parts_add_up_to_the_stature() -> None:
    one = body(1.8)
    to_shoulders_m = one.ankle_m + one.leg_m + one.trunk_m
    assert 0.80 * 1.8 < to_shoulders_m < 0.84 * 1.8
    assert to_shoulders_m + one.head_m[:, 2].max() < 1.8
