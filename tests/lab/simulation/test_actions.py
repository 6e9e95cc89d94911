"""Actions: values out of range are refused with the reason."""

from collections.abc import Callable
from pathlib import Path

import pytest
from pydantic import ValidationError

from trecsim.lab.simulation.actions import (
    Action,
    Bend,
    Clip,
    Crawl,
    Fall,
    Run,
    Sit,
    Stand,
    Turn,
    Walk,
)

HERE = ((0.0, 0.0),)


@pytest.mark.parametrize(
    ("make", "reason"),
    [
        (lambda: Walk(to_m=()), "to_m\n.* at least 1 item"),
        (lambda: Walk(to_m=((0.0, float("nan")),)), r"to_m\.0\.1\n.* finite number"),
        (lambda: Walk(to_m=(*HERE, (1e9, 0.0))), r"to_m\.1\.0\n.* less than or equal to 10000"),
        (lambda: Walk(HERE, speed_mps=3.0), "speed_mps\n.* less than or equal to 2"),
        (lambda: Run(HERE, speed_mps=1.0), "speed_mps\n.* greater than or equal to 2.2"),
        (lambda: Crawl(HERE, speed_mps=float("inf")), "speed_mps\n.* finite number"),
        (lambda: Stand(seconds=-1.0), "seconds\n.* greater than or equal to 0"),
        (lambda: Stand(seconds=True), "seconds\n.* valid number"),
        (lambda: Turn(), "by_deg or to_deg, got neither"),
        (lambda: Turn(1.0, 2.0), "by_deg or to_deg, got both"),
        (lambda: Turn(1.0, speed_degps=0.0), "speed_degps\n.* greater than or equal to 11"),
        (lambda: Bend(angle_deg=170.0), "angle_deg\n.* less than or equal to 109"),
        (lambda: Sit(seat_m=1.0), "seat_m\n.* less than or equal to 0.6"),
        (lambda: Fall(fall_s=0.1), "fall_s\n.* greater than or equal to 0.6"),
        (lambda: Clip(Path("a.npz"), from_s=2.0, to_s=1.0), "to_s must be at least 0.1 s after"),
        (lambda: Clip(Path("a.npz"), times=0), "times\n.* greater than or equal to 1"),
    ],
)
def test_values_out_of_range_are_refused_with_the_reason(
    make: Callable[[], Action], reason: str
) -> None:
    with pytest.raises(ValidationError, match=reason):
        make()


def test_whole_numbers_are_numbers() -> None:
    assert Walk(((1, 2),), 1).speed_mps == 1
    assert Stand(3).seconds == 3
