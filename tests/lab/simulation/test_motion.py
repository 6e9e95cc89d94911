"""People who do one thing after the other: laws of anatomy and of the floor."""

from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from often import often
from trecsim.errors import InputError
from trecsim.lab.simulation.actions import (
    Action,
    Bend,
    Crawl,
    Crouch,
    Fall,
    Kneel,
    Lie,
    RaiseArms,
    Run,
    Sit,
    Stand,
    Turn,
    Walk,
)
from trecsim.lab.simulation.body_shape import Body, body
from trecsim.lab.simulation.motion import motion_of
from trecsim.lab.simulation.sampled import Sampled

STEP_S = 0.01
SHORT, TALL = (body(stature, np.random.default_rng(7)) for stature in (1.55, 1.95))
ACTIONS: dict[str, Action] = {
    "walk": Walk(((1.5, 0.0), (1.5, 1.5)), 1.2),
    "run": Run(((6.0, 0.0),), 3.5),
    "crawl": Crawl(((1.2, 0.0), (1.2, 0.8)), 0.4),
    "stand": Stand(0.5),
    "turn": Turn(by_deg=-115.0),
    "arms": RaiseArms(0.5),
    "left arm": RaiseArms(0.5, "left"),
    "bend": Bend(0.5),
    "crouch": Crouch(0.5),
    "kneel": Kneel(0.5),
    "tying a shoe": Kneel(0.5, 50.0),
    "sit": Sit(0.5),
    "lie": Lie(0.3),
    "lie left": Lie(0.3, "left"),
    "lie front": Lie(0.3, "front"),
    "fall": Fall(0.3),
    "fall front": Fall(0.3, "front"),
    "fall left": Fall(0.3, "left"),
    "fall right": Fall(0.3, "right"),
}
LENGTHS = {  # joints at both ends, and what the body says
    "thigh": (((11, 13), (12, 14)), "thigh_m"),
    "shin": (((13, 15), (14, 16)), "shin_m"),
    "upper arm": (((5, 7), (6, 8)), "upper_arm_m"),
    "forearm": (((7, 9), (8, 10)), "forearm_m"),
    "hips": (((11, 12),), "hips_m"),
    "shoulders": (((5, 6),), "shoulders_m"),
}
FASTEST_MPS = 9.0  # the foot of a runner


@cache
def done(name: str, tall: bool = True) -> Sampled:
    """Return an action between two moments of standing."""
    who = TALL if tall else SHORT
    return motion_of(who, (0.0, 0.0), 0.0, [Stand(0.2), ACTIONS[name], Stand(0.2)], style=1.0)


def moments(motion: Sampled) -> np.ndarray:
    """Return all of a motion."""
    return motion(np.arange(motion.enter_s, motion.leave_s, STEP_S))


def apart_m(xyz_m: np.ndarray, first: int, second: int) -> np.ndarray:
    return np.linalg.norm(xyz_m[:, first] - xyz_m[:, second], axis=-1)


def lengths_hold(xyz_m: np.ndarray, who: Body) -> None:
    for name, (pairs, field) in LENGTHS.items():
        for pair in pairs:
            np.testing.assert_allclose(apart_m(xyz_m, *pair), getattr(who, field), atol=1e-3), name
    trunk_m = xyz_m[:, 5:7].mean(axis=1) - xyz_m[:, 11:13].mean(axis=1)
    np.testing.assert_allclose(np.linalg.norm(trunk_m, axis=1), who.trunk_m, atol=1e-3)
    head_m = np.linalg.norm(np.diff(who.head_m, axis=0), axis=1)
    seen_m = np.linalg.norm(np.diff(xyz_m[:, :5], axis=1), axis=2)
    np.testing.assert_allclose(seen_m, np.tile(head_m, (len(seen_m), 1)), atol=1e-3)


@pytest.mark.parametrize("name", ACTIONS)
@pytest.mark.parametrize("tall", [True, False])
def test_limbs_keep_their_lengths_at_any_moment_of_any_action(name: str, tall: bool) -> None:
    motion = done(name, tall)
    t_s = np.random.default_rng(0).uniform(motion.enter_s, motion.leave_s, 600)
    lengths_hold(motion(t_s), TALL if tall else SHORT)


@pytest.mark.parametrize("name", ACTIONS)
@pytest.mark.parametrize("tall", [True, False])
def test_nothing_sinks_into_the_floor(name: str, tall: bool) -> None:
    xyz_m = moments(done(name, tall))
    assert xyz_m[..., 2].min() > 0.015
    assert xyz_m[:, 15:, 2].min() > 0.045


@pytest.mark.parametrize("name", ACTIONS)
def test_nobody_jumps_to_another_place_or_pose(name: str) -> None:
    xyz_m = moments(done(name))
    speed_mps = np.linalg.norm(np.diff(xyz_m, axis=0), axis=-1) / STEP_S
    assert speed_mps.max() < FASTEST_MPS
    assert speed_mps[:, 11:13].max() < (4.0 if name == "run" else 3.0)
    acceleration = np.linalg.norm(np.diff(xyz_m, 2, axis=0), axis=-1) / STEP_S**2
    assert acceleration.max() < (200.0 if name in ("run", "fall front") else 100.0)
    assert acceleration[:, 11:13].max() < 45.0


@pytest.mark.parametrize("name", ACTIONS)
def test_knees_bend_the_way_knees_bend(name: str) -> None:
    xyz_m = moments(done(name))
    left = xyz_m[:, 11] - xyz_m[:, 12]
    left /= np.linalg.norm(left, axis=1, keepdims=True)
    for side in (0, 1):
        thigh_m, shin_m = np.diff(xyz_m[:, 11 + side :: 2], axis=1).transpose(1, 0, 2)
        bend = (np.cross(thigh_m, shin_m) * left).sum(axis=1) / (TALL.thigh_m * TALL.shin_m)
        assert bend.min() > -0.01
        assert bend.max() > 0.1  # and they do bend


@pytest.mark.parametrize("name", ["stand", "arms", "bend", "sit", "walk", "run", "turn"])
def test_elbows_bend_forward(name: str) -> None:
    xyz_m = moments(done(name))
    left = xyz_m[:, 5] - xyz_m[:, 6]
    for side in (0, 1):
        upper_m, fore_m = np.diff(xyz_m[:, 5 + side : 11 : 2], axis=1).transpose(1, 0, 2)
        assert (np.cross(upper_m, fore_m) * left).sum(axis=1).max() < 0.0


@pytest.mark.parametrize("name", ["stand", "arms", "left arm", "bend", "sit"])
def test_feet_stay_while_the_rest_moves(name: str) -> None:
    ankles_m = moments(done(name))[:, 15:]
    assert np.ptp(ankles_m, axis=0).max() < 1e-3


@pytest.mark.parametrize("name", ["walk", "run", "turn"])
def test_a_foot_that_stands_does_not_skate(name: str) -> None:
    ankles_m = moments(done(name))[:, 15:]
    stands = np.abs(ankles_m[..., 2] - TALL.ankle_m) < 2e-5
    speed_mps = np.linalg.norm(np.diff(ankles_m[..., :2], axis=0), axis=-1) / STEP_S
    both = stands[1:] & stands[:-1]
    assert both.mean() > 0.3
    assert speed_mps[both].max() < 0.05


def test_runners_are_fast_and_fly_and_walkers_are_not_and_do_not() -> None:
    walking, running = (
        moments(motion_of(TALL, (0.0, 0.0), 0.0, [go], style=1.0))
        for go in (Walk(((6.0, 0.0),), 1.4), Run(((12.0, 0.0),), 3.5))
    )
    for xyz_m, speed_mps in ((walking, 1.4), (running, 3.5)):
        gone_m = xyz_m[-1, 11:13, 0].mean() - xyz_m[0, 11:13, 0].mean()
        assert gone_m / (len(xyz_m) * STEP_S) == pytest.approx(speed_mps, rel=0.1)
    lower_m = [xyz_m[:, 15:, 2].min(axis=1) - TALL.ankle_m for xyz_m in (walking, running)]
    assert lower_m[0].max() < 0.01
    assert (lower_m[1] > 0.02).mean() > 0.1


def test_the_hips_of_a_runner_do_not_fall_faster_than_things_fall() -> None:
    xyz_m = moments(motion_of(TALL, (0.0, 0.0), 0.0, [Run(((12.0, 0.0),), 3.5)], style=1.0))
    hips_m = xyz_m[:, 11:13, 2].mean(axis=1)
    assert (np.diff(hips_m, 2) / STEP_S**2).min() > -10.0
    assert np.ptp(hips_m) > 0.015  # up and down with each step


@pytest.mark.parametrize("to", ["back", "front", "left", "right"])
@pytest.mark.parametrize("fall_s", [0.7, 1.0])
def test_a_fall_takes_about_a_second_and_is_no_faster_than_a_free_fall(
    to: str, fall_s: float
) -> None:
    motion = motion_of(TALL, (0.0, 0.0), 0.0, [Stand(0.5), Fall(1.0, to, fall_s)], until_s=4.0)
    xyz_m = moments(motion)
    hips_m = xyz_m[:, 11:13, 2].mean(axis=1)
    falling = np.flatnonzero((hips_m < 0.97 * hips_m[0]) & (hips_m > 0.25))
    assert 0.25 * fall_s < len(falling) * STEP_S < fall_s
    middle_m = xyz_m[:, [5, 6, 11, 12], 2].mean(axis=1)
    downwards_mps = -np.diff(middle_m) / STEP_S
    free_mps = np.sqrt(2 * 9.81 * np.maximum(middle_m[0] - middle_m[1:], 1e-3))
    assert (downwards_mps <= 1.1 * free_mps + 0.2).all()
    assert downwards_mps.max() > 1.5
    assert xyz_m[-1, :, 2].max() < 0.55  # and there one lies


@pytest.mark.parametrize(
    ("action", "up"),
    [
        (Lie(1.0, "back"), (1.0, 0.0)),
        (Lie(1.0, "front"), (-1.0, 0.0)),
        (Lie(1.0, "left"), (0.0, -1.0)),
        (Fall(1.0, "back"), (1.0, 0.0)),
        (Fall(1.0, "front"), (-1.0, 0.0)),
        (Fall(1.0, "left"), (0.0, -1.0)),
        (Fall(1.0, "right"), (0.0, 1.0)),
    ],
)
def test_one_lies_on_the_side_that_was_asked_for(action: Action, up: tuple[float, float]) -> None:
    motion = motion_of(TALL, (0.0, 0.0), 0.0, [action], until_s=12.0)
    xyz_m = motion(np.array([11.0]))[0]
    left = (xyz_m[5] - xyz_m[6]) / TALL.shoulders_m
    spine = (xyz_m[5:7].mean(axis=0) - xyz_m[11:13].mean(axis=0)) / TALL.trunk_m
    ahead = np.cross(left, spine)
    assert (ahead[2], left[2]) == pytest.approx(up, abs=0.1)
    assert abs(spine[2]) < 0.2


def test_a_faller_falls_where_he_was_told_to() -> None:
    for to, direction in (
        ("back", (-1, 0)),
        ("front", (1, 0)),
        ("left", (0, 1)),
        ("right", (0, -1)),
    ):
        motion = motion_of(TALL, (2.0, 1.0), 0.0, [Fall(2.0, to)], until_s=2.0)
        head_m = motion(np.array([1.9]))[0, 0, :2] - [2.0, 1.0]
        assert head_m @ direction > 1.0, to


def test_crawlers_go_on_hands_and_knees_that_stay_where_they_rest() -> None:
    motion = done("crawl")
    xyz_m = moments(motion)
    crawls = np.flatnonzero(
        (xyz_m[:, :5, 2].max(axis=1) < 0.85) & (xyz_m[:, 9:11, 2].max(axis=1) < 0.1)
    )
    xyz_m = xyz_m[crawls]
    assert np.ptp(xyz_m[:, 11:13].mean(axis=1)[:, 0]) > 0.7
    assert xyz_m[:, 13:15, 2].max() < 0.12
    assert xyz_m[:, 11:13, 2].min() > 0.8 * TALL.thigh_m
    speed_mps = np.linalg.norm(np.diff(xyz_m[:, 9:11, :2], axis=0), axis=-1) / STEP_S
    rests = xyz_m[:, 9:11, 2] < xyz_m[:, 9:11, 2].min() + 2e-4
    both = rests[1:] & rests[:-1]
    assert both.mean() > 0.5
    assert speed_mps[both].max() < 0.06


def test_one_gets_where_one_wants_and_faces_what_one_wants() -> None:
    actions = [Stand(0.1), Walk(((2.0, 1.0), (3.0, 3.0))), Turn(to_deg=180.0), Stand(0.5)]
    motion = motion_of(TALL, (0.0, 0.0), 0.5, actions)
    last_m = motion(np.array([motion.leave_s]))[0]
    np.testing.assert_allclose(last_m[15:, :2].mean(axis=0), [3.0, 3.0], atol=0.01)
    left = last_m[11] - last_m[12]
    np.testing.assert_allclose(left / TALL.hips_m, [0.0, -1.0, 0.0], atol=0.02)


def test_arms_go_up_as_asked() -> None:
    for arms, raised in (("both", (9, 10)), ("left", (9,)), ("right", (10,))):
        motion = motion_of(TALL, (0.0, 0.0), 0.0, [RaiseArms(2.0, arms)], until_s=2.0)
        xyz_m = motion(np.array([1.5]))[0]
        assert [joint for joint in (9, 10) if xyz_m[joint, 2] > xyz_m[0, 2] + 0.2] == list(raised)


def test_one_sits_on_the_seat_with_bent_knees() -> None:
    for seat_m in (0.35, 0.55):
        xyz_m = motion_of(TALL, (0.0, 0.0), 0.0, [Sit(3.0, seat_m)], until_s=3.0)(np.array([2.5]))[
            0
        ]
        assert seat_m < xyz_m[11, 2] < seat_m + 0.15
        thigh, shin = xyz_m[13] - xyz_m[11], xyz_m[15] - xyz_m[13]
        assert abs(thigh @ shin) < 0.4 * TALL.thigh_m * TALL.shin_m
        assert xyz_m[0, 2] > xyz_m[11, 2] + TALL.trunk_m


def test_who_walks_first_comes_in_at_speed_and_who_walks_last_leaves_at_speed() -> None:
    motion = motion_of(TALL, (0.0, 0.0), 2.0, [Walk(((5.0, 0.0),), 1.3)], enter_s=3.0)
    xyz_m = motion(np.array([2.99, 3.0, 3.02, motion.leave_s - 0.02, motion.leave_s]))
    assert np.isnan(xyz_m[0]).all()
    hips_m = xyz_m[:, 11:13].mean(axis=1)[:, 0]
    assert (hips_m[2] - hips_m[1]) / 0.02 == pytest.approx(1.3, abs=0.25)
    assert (hips_m[4] - hips_m[3]) / 0.02 == pytest.approx(1.3, abs=0.25)
    assert np.isnan(motion(np.array([motion.leave_s + 0.01]))).all()


def test_who_shall_stay_stays_as_the_last_action_ends_and_no_longer() -> None:
    motion = motion_of(TALL, (0.0, 0.0), 0.0, [Walk(((2.0, 0.0),))], until_s=9.0)
    xyz_m = motion(np.array([7.0, 9.0, 9.01]))
    np.testing.assert_allclose(xyz_m[:2, 15:, :2].mean(axis=1), [[2.0, 0.0]] * 2, atol=0.01)
    assert np.isnan(xyz_m[2]).all()
    cut = motion_of(TALL, (0.0, 0.0), 0.0, [Lie(60.0)], until_s=9.0)
    assert cut.leave_s == pytest.approx(9.0)


def test_the_same_people_move_the_same_and_others_do_not() -> None:
    script = [Stand(0.3), Sit(0.5), Walk(((1.0, 1.0),))]
    first, again, other = (
        motion_of(SHORT, (0.0, 0.0), 0.0, script, style=style).xyz_m for style in (1.0, 1.0, 2.0)
    )
    np.testing.assert_array_equal(first, again)
    assert np.abs(first - other).max() > 0.01


def test_a_whole_motion_turns_and_shifts_with_its_start() -> None:
    plain = motion_of(SHORT, (0.0, 0.0), 0.0, [Fall(0.2, "left"), Stand(0.2)]).xyz_m
    turned = motion_of(SHORT, (3.0, -1.0), np.pi / 2, [Fall(0.2, "left"), Stand(0.2)]).xyz_m
    back = np.stack((turned[..., 1] + 1.0, 3.0 - turned[..., 0], turned[..., 2]), axis=-1)
    np.testing.assert_allclose(back, plain, atol=1e-5)


@settings(max_examples=often(8))
@given(names=st.lists(st.sampled_from(sorted(ACTIONS)), min_size=2, max_size=4))
def test_any_order_of_actions_keeps_the_laws(names: list[str]) -> None:
    motion = motion_of(SHORT, (0.0, 0.0), 0.0, [ACTIONS[name] for name in names])
    xyz_m = moments(motion)
    lengths_hold(xyz_m, SHORT)
    assert xyz_m[..., 2].min() > 0.015
    assert (np.linalg.norm(np.diff(xyz_m, axis=0), axis=-1) / STEP_S).max() < FASTEST_MPS


def test_who_does_nothing_is_there_for_a_moment() -> None:
    motion = motion_of(SHORT, (1.0, 2.0), 0.0, [], enter_s=1.0)
    assert np.isfinite(motion(np.array([1.1]))).all()
    assert motion.leave_s > 1.1


def test_nobody_is_busy_for_longer_than_memory_lasts() -> None:
    with pytest.raises(InputError, match="no more than"):
        motion_of(SHORT, (0.0, 0.0), 0.0, [Walk(((9000.0, 0.0), (0.0, 0.0)), 0.2)])
