"""Velocities of joints: the splines' derivative, with a covariance that holds."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import reference_fusion as reference
from fusion.made import NOISE, frame_sets, made, path
from trecsim.fusion import Tracker, kernels
from trecsim.lab.simulation.scene import room_scene, simulate
from trecsim.values import COASTING, CONFIRMED, FrameSet

KNOT_S = 0.1


def velocities(R, c, place):
    velocity_mps, cov_m2ps2 = np.empty((2, 3, 3)), np.empty((2, 3, 3, 3))
    kernels.velocity_all(R, c, place, KNOT_S, velocity_mps, cov_m2ps2)
    return velocity_mps, cov_m2ps2


@given(st.integers(0, 2**32 - 1), st.floats(0.0, 4.999))
def test_velocity_and_covariance_equal_those_of_the_reference(seed, place):
    rng = np.random.default_rng(seed)
    R = np.array([[reference.banded(rng) for _ in range(3)] for _ in range(2)])
    c = rng.normal(size=(2, 3, 24))
    velocity_mps, cov_m2ps2 = velocities(R, c, place)
    for k in range(2):
        for j in range(3):
            expected_mps, expected_m2ps2 = reference.velocity(R[k, j], c[k, j], place, KNOT_S)
            np.testing.assert_allclose(velocity_mps[k, j], expected_mps, rtol=1e-9, atol=1e-9)
            np.testing.assert_allclose(cov_m2ps2[k, j], expected_m2ps2, rtol=1e-7, atol=1e-7)


@given(st.integers(0, 2**32 - 1), st.floats(0.01, 4.99))
def test_velocity_is_the_difference_of_positions_over_a_short_time(seed, place):
    rng = np.random.default_rng(seed)
    c = rng.normal(size=(2, 3, 24))
    around = np.empty((2, 2, 3, 3))
    kernels.evaluate_all(c, np.array([place - 1e-5, place + 1e-5]), around)
    velocity_mps, _ = velocities(np.tile(np.eye(24), (2, 3, 1, 1)), c, place)
    np.testing.assert_allclose(velocity_mps, (around[1] - around[0]) / (2e-5 * KNOT_S), atol=1e-3)


@given(st.integers(0, 2**32 - 1), st.floats(0.0, 4.999))
def test_a_torso_moves_as_its_joints_do_on_average(seed, place):
    rng = np.random.default_rng(seed)
    c, motion, torso = rng.normal(size=(5, 24)), np.empty((2, 3)), np.array([1, 2, 4])
    kernels.torso_motion(c, torso, place, KNOT_S, motion)
    R = reference.banded(rng)
    expected_mps = np.mean([reference.velocity(R, c[j], place, KNOT_S)[0] for j in torso], axis=0)
    points = c[torso].mean(axis=0).reshape(-1, 3)
    np.testing.assert_allclose(motion[0], reference.basis_rows([place], 0, 1, 8)[0] @ points)
    np.testing.assert_allclose(motion[1], expected_mps, rtol=1e-9, atol=1e-9)


def test_who_walks_at_a_known_speed_is_said_to_walk_at_it():
    scene = made([path((0, -2.5, 0), (4, 2.5, 0))], detector=NOISE, seconds=4.0)
    tracker = Tracker(scene.rig)
    hips = [
        snapshot.velocity_mps[0, 11:13].mean(axis=0)
        for snapshot in map(tracker.step, frame_sets(scene))
        if len(snapshot.id) and 1.0 < snapshot.t_s < 3.0
    ]
    np.testing.assert_allclose(np.mean(hips, axis=0), [1.25, 0.0, 0.0], atol=0.05)


@pytest.mark.parametrize("lag_s", [0.0, 0.2])
@pytest.mark.parametrize("cameras", [2, 4])
def test_covariance_of_velocity_is_honest_on_the_errors_of_a_real_detector(cameras, lag_s):
    """Some 90 % of the true velocities lie in the 90 % ellipsoids, with and without a lag."""
    scene = simulate(room_scene(people=3, cameras=cameras, seconds=8.0), 7)
    truth_mps = np.gradient(scene.truth_xyz_m, scene.truth_t_s, axis=1)
    tracker = Tracker(scene.rig, lag_s=lag_s)
    inside = []
    for s in map(tracker.step, frame_sets(scene)):
        when = np.argmin(np.abs(scene.truth_t_s - s.t_s))
        apart_m = np.linalg.norm(s.xyz_m[:, None] - scene.truth_xyz_m[None, :, when], axis=-1)
        for k, mean_m in enumerate(apart_m.mean(axis=-1)):
            if s.t_s > 1.0 and np.isfinite(mean_m).any() and np.nanmin(mean_m) < 0.3:
                off_mps = s.velocity_mps[k] - truth_mps[np.nanargmin(mean_m), when]
                root = np.linalg.inv(np.linalg.cholesky(s.velocity_cov_m2ps2[k]))
                inside += (((root @ off_mps[..., None]) ** 2).sum(axis=(1, 2)) < 6.25).tolist()
    assert 0.83 < np.mean(inside) < 0.97


def test_who_is_seen_is_confirmed_and_who_is_hidden_from_all_cameras_is_coasting():
    scene = made([path((0, -1, 0), (3, 1, 0))], detector=NOISE, seconds=3.0)
    tracker = Tracker(scene.rig)
    states = []
    for frame_set in frame_sets(scene):
        blind = frame_set.t_s > 1.5
        views = tuple(
            type(v)(v.camera, v.t_s, v.xy_px[:0], v.score[:0], v.person_score[:0])
            for v in frame_set.views
        )
        s = tracker.step(FrameSet(frame_set.t_s, views) if blind else frame_set)
        if len(s.id):
            states.append((s.t_s, s.state.tolist()))
    assert {tuple(state) for t_s, state in states if t_s < 1.5} == {(CONFIRMED,)}
    assert {tuple(state) for t_s, state in states if t_s > 1.7} == {(COASTING,)}
