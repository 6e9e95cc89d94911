"""Rules on bodies over the movements of the simulator, exact 3D: falls, and what is like them."""

from typing import Any

import numpy as np
import pytest

from made_paths import events_of, moments, times, told
from trecsim.lab.simulation.actions import Bend, Crawl, Fall, Lie, RaiseArms, Run, Sit, Stand, Walk
from trecsim.lab.simulation.body_shape import body
from trecsim.lab.simulation.motion import motion_of

RULES = "".join(
    f'[[rules]]\nid = "{name}"\nkind = "{kind}"\n'
    for name, kind in (("fall", "body.fall"), ("down", "body.down"), ("run", "speed.running"))
)


def events(actions: list[Any], *, fps: float = 25.0, stature_m: float = 1.75) -> Any:
    t_s = times(18.0, fps)
    motion = motion_of(body(stature_m), (0.0, 0.0), 0.3, actions, until_s=18.0, style=0.7)
    return events_of(RULES, moments([np.asarray(motion(t_s), np.float64)], t_s))


@pytest.mark.parametrize("fps", [25.0, 8.0])
@pytest.mark.parametrize("to", ["back", "front", "left", "right"])
@pytest.mark.parametrize("fall_s", [0.6, 0.9, 1.2])
def test_a_fall_is_told_once_a_second_after_the_person_lies(
    to: Any, fall_s: float, fps: float
) -> None:
    ((rule, phase, start_s, detect_s),) = told(
        events([Stand(3.0), Fall(seconds=20.0, to=to, fall_s=fall_s)], fps=fps),
        "rule", "phase", "t_start_s", "t_detect_s",
    )  # fmt: skip
    assert (rule["kind"], phase) == ("body.fall", "new")
    assert 3.0 + 0.5 * fall_s < start_s <= 3.0 + fall_s + 0.13
    assert detect_s - start_s == pytest.approx(1.0, abs=1.0 / fps + 1e-6)


def test_who_slides_down_slowly_is_told_as_down_ten_seconds_later() -> None:
    found = events([Stand(3.0), Fall(seconds=20.0, fall_s=2.0)])
    assert [rule["kind"] for (rule,) in told(found, "rule")] == ["body.down"]


@pytest.mark.parametrize("stature_m", [1.5, 2.0])
def test_small_and_tall_people_fall_too(stature_m: float) -> None:
    found = events([Stand(3.0), Fall(seconds=20.0)], stature_m=stature_m)
    assert [rule["kind"] for (rule,) in told(found, "rule")] == ["body.fall"]


@pytest.mark.parametrize("fps", [25.0, 8.0])
@pytest.mark.parametrize("on", ["back", "front", "left", "right"])
def test_lying_down_with_care_is_no_fall_and_who_stays_is_down(on: Any, fps: float) -> None:
    found = events([Stand(2.0), Lie(seconds=20.0, on=on)], fps=fps)
    assert [rule["kind"] for (rule,) in told(found, "rule")] == ["body.down"]


@pytest.mark.parametrize("fps", [25.0, 8.0])
@pytest.mark.parametrize(
    "actions",
    [
        [Stand(1.0), Sit(seconds=12.0, seat_m=0.45)],
        [Stand(1.0), Sit(seconds=12.0, seat_m=0.3)],
        [Stand(1.0), Bend(seconds=12.0, angle_deg=105)],
        [Crawl(to_m=((5.0, 0.0),))],
        [Walk(to_m=((6.0, 0.0), (0.0, 0.0)), speed_mps=2.0)],
        [RaiseArms(seconds=10.0)],
    ],
    ids=lambda actions: actions[-1].do,
)
def test_everyday_movements_are_told_as_nothing(actions: list[Any], fps: float) -> None:
    assert events(actions, fps=fps) == []


def test_somebody_who_runs_is_told_and_the_start_is_when_the_speed_is_reached() -> None:
    t_s = times(18.0)
    actions = [Stand(2.0), Run(to_m=((15.0, 0.0),), speed_mps=3.0)]
    motion = motion_of(body(1.75), (0.0, 0.0), 0.0, actions, until_s=18.0)
    hips_m = np.asarray(motion(t_s), np.float64)[:, 11:13, :2].mean(axis=1)
    speed_mps = np.hypot(*(hips_m[2:] - hips_m[:-2]).T) / 0.08
    fast = t_s[1:-1][speed_mps > 2.2]
    found = events_of(RULES, moments([np.asarray(motion(t_s), np.float64)], t_s))
    assert [phase for (phase,) in told(found, "phase")] == ["new", "end"]
    start_s, end_s = told(found, "t_start_s", "t_end_s")[1]
    assert start_s == pytest.approx(fast[0], abs=0.041)
    assert end_s == pytest.approx(fast[-1] + 0.04, abs=0.041)
