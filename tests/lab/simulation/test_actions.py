"""Actions: what nobody can do is refused with a reason."""

from collections.abc import Callable
from pathlib import Path

import pytest

from trecsim.errors import InputError
from trecsim.lab.simulation.actions import (
    Action,
    Bend,
    Clip,
    Crawl,
    Fall,
    Lie,
    RaiseArms,
    Run,
    Sit,
    Stand,
    Turn,
    Walk,
)

HERE = ((0.0, 0.0),)


def untyped(kind: type, **values: object) -> Action:
    """Return an action as untyped code would make it; the checker of types looks away."""
    action = object.__new__(kind)
    for name, value in values.items():
        object.__setattr__(action, name, value)
    action.__post_init__()
    return action


@pytest.mark.parametrize(
    ("make", "reason"),
    [
        (lambda: Walk(()), "walk: needs a way point"),
        (lambda: Walk(((0.0, float("nan")),)), "walk: way point 1 must be a number"),
        (lambda: Walk((*HERE, (1e9, 0.0))), "walk: way point 2 .* got 1000000000.0"),
        (
            lambda: untyped(Walk, to_m=((1.0, 2.0, 3.0),)),
            r"walk: way point 1 must be \(x, y\)",
        ),
        (lambda: Walk(HERE, 3.0), "walk: speed_mps must be a number from 0.2 to 2 m/s, got 3.0"),
        (lambda: Run(HERE, 1.0), "run: speed_mps must be a number from 2.2 to 6 m/s"),
        (lambda: Crawl(HERE, float("inf")), "crawl: speed_mps"),
        (lambda: Stand(-1.0), "stand: seconds must be a number from 0 to 86400 s, got -1.0"),
        (lambda: untyped(Stand, seconds="2"), "stand: seconds must be a number .* got '2'"),
        (lambda: Stand(True), "stand: seconds must be a number"),
        (lambda: Turn(), "turn: .* got neither"),
        (lambda: Turn(1.0, 2.0), "turn: .* got both"),
        (lambda: Turn(1.0, speed_radps=0.0), "turn: speed_radps"),
        (
            lambda: untyped(RaiseArms, seconds=1.0, arms="none"),
            "raise arms: arms must be one of both, left, right",
        ),
        (lambda: Bend(angle_rad=3.0), "bend: angle_rad"),
        (lambda: Sit(seat_m=1.0), "sit: seat_m must be a number from 0.3 to 0.6 m, got 1.0"),
        (
            lambda: untyped(Lie, seconds=1.0, on="head"),
            "lie: on must be one of back, front, left, right, got 'head'",
        ),
        (lambda: untyped(Fall, seconds=1.0, to="up"), "fall: to must be one of"),
        (lambda: Fall(fall_s=0.1), "fall: fall_s"),
        (lambda: Clip(Path("a.npz"), from_s=2.0, to_s=1.0), "clip: to_s"),
        (lambda: Clip(Path("a.npz"), times=0), "clip: times"),
    ],
)
def test_what_nobody_can_do_is_refused_with_a_reason(
    make: Callable[[], Action], reason: str
) -> None:
    with pytest.raises(InputError, match=reason):
        make()


def test_whole_numbers_are_numbers() -> None:
    assert Walk(((1, 2),), 1).speed_mps == 1
    assert Stand(3).seconds == 3
