"""Somebody whom one camera sees alone, as the benchmark lets them walk."""

import pytest

from one_view import one_view


@pytest.mark.parametrize("seed", [1100, 1103])
def test_whoever_turns_round_close_before_the_only_camera_is_not_lost(seed: int) -> None:
    figures, _ = one_view(("towards and away", "known", seed, {}))
    assert figures["off in depth, p95"] < 60.0
    assert figures["in 90 % regions"] > 85.0
