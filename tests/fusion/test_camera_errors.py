"""Turned cameras and late clocks are found in the residuals, told apart, and taken out."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import reference_cameras as slow
import reference_fusion as reference
from fusion.made import frame_sets, made, outcome, path
from fusion.somebody import MODEL
from trecsim.fusion import Tracker
from trecsim.fusion.camera_errors import CameraErrors, calibrated, projections, uncorrected
from trecsim.fusion.kernels.camera_error_kernels import eliminate, turned
from trecsim.geometry import Rig
from trecsim.values import FrameSet

SECONDS, SETTLED = 8.0, 125
PATHS = [path((0, -2, 0), (4, 2, 0.5), (8, -2, 0)), path((0, 1, 2), (4, -1, -2), (8, 1, 2))]
SCENE = made(PATHS, seconds=SECONDS, stagger=False)
WHICH = 1


def bent(angle_rad, about):
    """Return the scene's rig with one camera turned about an axis of its own."""
    rotation = np.zeros(3)
    rotation[about] = angle_rad
    c, s = np.cos(angle_rad), np.sin(angle_rad)
    i, k = ((1, 2), (2, 0), (0, 1))[about]
    T = np.eye(4)
    T[i, i] = T[k, k] = c
    T[i, k], T[k, i] = -s, s
    cameras = list(SCENE.rig)
    cameras[WHICH] = replace(cameras[WHICH], T_cam_world=T @ cameras[WHICH].T_cam_world)
    return Rig(tuple(cameras))


def follow(rig, sets):
    tracker = Tracker(rig)
    return tracker, [tracker.step(one) for one in sets]


@given(st.integers(0, 2**32 - 1), st.floats(0.5, 2.0))
def test_errors_of_cameras_are_found_and_taken_out_as_by_the_reference(seed, scale):
    rng = np.random.default_rng(seed)
    errors, n = CameraErrors(MODEL.rig), 4
    A = rng.normal(0, 200, (4 * n, 4 * n))
    errors.info[:] = (A @ A.T).reshape(n, 4, n, 4) * rng.choice([0.1, 1.0, 100.0])
    errors.found[:] = rng.normal(size=(n, 4)) * [0.005, 0.005, 0.005, 0.004]
    errors.vector[:] = np.einsum("cidk,dk->ci", errors.info, errors.found) + rng.normal(size=(n, 4))
    errors.scale = scale
    found, variance, applied, scale, left = slow.corrected(
        errors.info, errors.vector, errors.found, scale
    )
    cameras = errors.corrected()
    expected = projections(calibrated(MODEL.rig), applied[:, :3], left)
    np.testing.assert_allclose(errors.found, found, rtol=1e-7, atol=1e-12)
    np.testing.assert_allclose(errors.variance, variance, rtol=1e-8)
    np.testing.assert_allclose(errors.applied, applied, rtol=1e-7, atol=1e-12)
    assert errors.scale == pytest.approx(scale, rel=1e-8)
    for one, other in zip(cameras, expected, strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-7, atol=1e-9)


@given(st.integers(0, 2**32 - 1))
def test_a_pixel_moves_with_a_turn_as_its_derivatives_say(seed):
    """Central differences over the three angles of the projections that are used."""
    rng = np.random.default_rng(seed)
    rig, c, x = MODEL.rig, int(rng.integers(4)), rng.normal([0, 0, 1], 0.4)
    u, v = reference.project(MODEL.cameras.P[c], x)
    row_u, row_v = np.zeros(4), np.zeros(4)
    camera = rig.cameras[c]
    turned(camera.K[:2, 2], MODEL.cameras.focal_px[c], u, v, row_u, row_v)
    for axis in range(3):
        step = np.zeros((4, 3))
        step[c, axis] = 1e-5
        ahead, back = (
            reference.project(projections(calibrated(rig), sign * step, np.zeros(4)).P[c], x)
            for sign in (1.0, -1.0)
        )
        there = (ahead - back) / 2e-5
        np.testing.assert_allclose([row_u[axis], row_v[axis]], there, rtol=1e-5, atol=1e-3)


def block(rng, n):
    """Return equations of a joint in `n` of four cameras, as `linearise` writes them."""
    cam = rng.permutation(4)[:n]
    return (
        cam, rng.uniform(0.01, 0.1, n), rng.normal(0.0, 5.0, (n, 2)),
        rng.normal(0.0, 200.0, (n, 2, 3)), rng.normal(0.0, 800.0, (n, 2, 4)),
    )  # fmt: skip


def equations(one):
    errors = CameraErrors(SCENE.rig)
    eliminate(len(one[0]), one, errors.known)
    return errors.info.reshape(16, 16), errors.vector.ravel()


@given(st.integers(0, 2**32 - 1), st.integers(2, 4))
def test_the_place_of_a_joint_is_eliminated_as_in_the_whole_system(seed, n):
    """Normal equations of the place and all cameras, solved for the place (Schur)."""
    rng = np.random.default_rng(seed)
    one = block(rng, n)
    A, y, w = np.zeros((2 * n, 19)), one[2].ravel(), np.repeat(one[1], 2)
    A[:, :3] = one[3].reshape(-1, 3)
    for e, c in enumerate(one[0]):
        A[2 * e : 2 * e + 2, 3 + 4 * c : 7 + 4 * c] = one[4][e]
    N, v = (A.T * w) @ A, (A.T * w) @ y
    place = N[:3, :3] + 1e-6 * np.trace(N[:3, :3]) * np.eye(3)
    rest = np.linalg.solve(place, np.column_stack([N[:3, 3:], v[:3]]))
    info, vector = equations(one)
    np.testing.assert_allclose(info, N[3:, 3:] - N[3:, :3] @ rest[:, :-1], rtol=1e-6, atol=1e-2)
    np.testing.assert_allclose(vector, v[3:] - N[3:, :3] @ rest[:, -1], rtol=1e-6, atol=1e-3)


@given(st.integers(0, 2**32 - 1))
def test_what_is_noted_does_not_depend_on_where_the_trajectory_is(seed):
    """The errors have bent it: residuals of another one differ by what the joint has moved."""
    rng = np.random.default_rng(seed)
    one = block(rng, 3)
    moved = (*one[:2], one[2] + one[3] @ rng.normal(0.0, 0.05, 3), *one[3:])
    change = np.abs(equations(moved)[1] - equations(one)[1]).max()
    assert change < 1e-4 * np.abs(equations(one)[1]).max()


@pytest.mark.parametrize("about", [0, 1])
@pytest.mark.parametrize("degrees", [0.5, 2.0])
def test_a_turned_camera_is_found_and_its_error_taken_out(about, degrees):
    """The rig says where it was, so the other way round."""
    rig = bent(np.radians(degrees), about)
    tracker, snapshots = follow(rig, frame_sets(SCENE))
    turn_deg = np.degrees(tracker.camera_errors.applied[:, :3])
    others_deg = np.delete(turn_deg, WHICH, axis=0)
    assert turn_deg[WHICH, about] == pytest.approx(-degrees, abs=0.1)
    assert np.abs(others_deg[:, :2]).max() == 0.0
    _, as_it_was = follow(SCENE.rig, frame_sets(SCENE))
    error_m = [np.nanmean(outcome(SCENE, s).error_m[SETTLED:]) for s in (snapshots, as_it_was)]
    assert error_m[0] < 1.25 * error_m[1]


@pytest.mark.parametrize("late_s", [0.03, -0.03])
def test_a_late_clock_is_found_and_no_camera_is_thought_to_be_turned(late_s):
    sets = [
        FrameSet(
            one.t_s,
            tuple(
                replace(view, t_s=view.t_s + late_s) if n == WHICH else view
                for n, view in enumerate(one.views)
            ),
        )
        for one in frame_sets(SCENE)
    ]
    tracker, _ = follow(SCENE.rig, sets)
    delay_s = tracker.camera_errors.found[:, 3]
    apart_s = delay_s[WHICH] - np.delete(delay_s, WHICH).mean()
    assert apart_s == pytest.approx(late_s, abs=0.01)
    assert np.degrees(np.abs(tracker.camera_errors.found[:, :2])).max() < 0.15


def test_a_rig_that_fits_is_left_alone():
    tracker, _ = follow(SCENE.rig, frame_sets(SCENE))
    assert np.degrees(np.abs(tracker.camera_errors.found[:, :2])).max() < 0.1
    assert np.abs(tracker.camera_errors.found[:, 3]).max() < 0.008
    assert (tracker.cameras.error_px2 < uncorrected(SCENE.rig).error_px2).all()


def test_a_camera_is_learnt_anew_after_time_has_jumped_back():
    """Otherwise all residuals would count for ever until the old time is reached again."""
    back = [
        FrameSet(one.t_s - 3600.0, tuple(replace(v, t_s=v.t_s - 3600.0) for v in one.views))
        for one in frame_sets(SCENE)
    ]
    tracker, _ = follow(SCENE.rig, [*frame_sets(SCENE), *back])
    assert (tracker.camera_errors.learned_s > back[0].t_s).all()
    assert (tracker.camera_errors.learned_s <= back[-1].t_s).all()


@pytest.mark.parametrize("stagger", [True, False])
def test_a_camera_that_does_not_fit_makes_nobody_oscillate(stagger):
    """One camera after the other, one of them 1.5 degrees off: somebody who stands stands still."""
    scene = made([path((0, 0.3, 0), (SECONDS, 0.3, 0.001))], seconds=SECONDS, stagger=stagger)
    cameras = list(scene.rig)
    T = np.eye(4)
    angle = np.radians(1.5)
    T[0, 0] = T[2, 2] = np.cos(angle)
    T[0, 2], T[2, 0] = np.sin(angle), -np.sin(angle)
    cameras[WHICH] = replace(cameras[WHICH], T_cam_world=T @ cameras[WHICH].T_cam_world)
    one_by_one = [FrameSet(view.t_s, (view,)) for view in sorted(scene.poses, key=lambda v: v.t_s)]
    _, snapshots = follow(Rig(tuple(cameras)), one_by_one)
    late = [s for s in snapshots if s.t_s > 3.0 and len(s.id) == 1]
    torso_m = np.array([s.xyz_m[0][MODEL.torso].mean(axis=0) for s in late])
    assert len(late) > 300
    assert np.median(np.linalg.norm(np.diff(torso_m, axis=0), axis=1)) < 0.005
