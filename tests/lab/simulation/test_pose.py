"""Poses: between joints and turns of limbs, and back."""

import numpy as np
import pytest

from trecsim.lab.simulation.body_shape import body
from trecsim.lab.simulation.paths import through
from trecsim.lab.simulation.pose import blend, joints, pose_of
from trecsim.lab.simulation.rotations import about
from trecsim.lab.simulation.sampled import Sampled, between, sampled
from trecsim.lab.simulation.walkers import walker

ONE = body(1.8, np.random.default_rng(2))


def walking(seed: int = 0) -> np.ndarray:
    ends_m = np.random.default_rng(seed).uniform(-3, 3, (2, 2))
    return walker(ONE, through(np.array([0.0, 3.0]), ends_m))(np.linspace(0.1, 2.9, 50))


@pytest.mark.parametrize("seed", range(3))
def test_a_pose_gives_back_the_joints_it_came_from(seed: int) -> None:
    xyz_m = walking(seed)
    np.testing.assert_allclose(joints(pose_of(xyz_m, ONE.head_m), ONE), xyz_m, atol=5e-3)


def test_between_two_poses_limbs_keep_their_lengths() -> None:
    xyz_m = walking()
    pose = pose_of(xyz_m, ONE.head_m)
    other = pose_of(xyz_m[::-1] @ about("z", 1.0).T, ONE.head_m)
    mixed_m = joints(blend(pose, other, np.linspace(0, 1, 50)), ONE)
    for joint, length_m in ((11, ONE.thigh_m), (13, ONE.shin_m), (6, ONE.upper_arm_m)):
        limb_m = np.linalg.norm(mixed_m[:, joint] - mixed_m[:, joint + 2], axis=1)
        np.testing.assert_allclose(limb_m, length_m, atol=1e-9)
    np.testing.assert_allclose(mixed_m[0], joints(pose, ONE)[0], atol=1e-9)
    np.testing.assert_allclose(mixed_m[-1], joints(other, ONE)[-1], atol=1e-6)


def test_half_way_between_two_turns_is_half_the_turn() -> None:
    xyz_m = walking()[:1]
    turned_m = xyz_m @ about("z", 0.8).T
    half = blend(pose_of(xyz_m, ONE.head_m), pose_of(turned_m, ONE.head_m), np.array([0.5]))
    wanted_m = joints(pose_of(xyz_m @ about("z", 0.4).T, ONE.head_m), ONE)
    np.testing.assert_allclose(half.chest[0], pose_of(wanted_m, ONE.head_m).chest[0], atol=1e-9)


def test_samples_are_met_and_parabolas_are_followed_exactly() -> None:
    steps = np.arange(10.0)
    parabola = (steps**2)[:, None] * np.ones(3)
    entry = np.linspace(1.0, 8.0, 29)
    np.testing.assert_allclose(between(parabola, entry)[:, 0], entry**2, atol=1e-9)
    np.testing.assert_array_equal(between(parabola, steps), parabola)


def test_a_sampled_walk_is_the_walk() -> None:
    person = walker(ONE, through(np.array([0.5, 4.0]), np.array([[0.0, 0.0], [4.0, 1.0]])))
    t_s = np.sort(np.random.default_rng(0).uniform(0.0, 4.5, 300))
    np.testing.assert_allclose(sampled(person)(t_s), person(t_s), atol=5e-4)
    np.testing.assert_allclose(sampled(person)(np.array([4.0])), person(np.array([4.0])), atol=1e-6)


def test_a_sampled_motion_is_there_from_its_first_to_its_last_moment() -> None:
    motion = Sampled(2.0, 0.5, np.ones((3, 17, 3), np.float32), 3.0)
    xyz_m = motion(np.array([1.99, 2.0, 2.7, 3.0, 3.01]))
    assert np.isfinite(xyz_m[1:4]).all()
    assert np.isnan(xyz_m[[0, 4]]).all()
