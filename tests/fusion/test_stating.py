"""What is said about a moment: lasting errors of key points, and limbs that hold."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import reference_fusion as reference
from fusion.made import frame_sets
from fusion.somebody import MODEL, SETTINGS, somebody
from trecsim.fusion import Tracker, kernels
from trecsim.lab.simulation.scene import room_scene, simulate

NOW_S = 1.1
NO_LIMBS = kernels.Limbs(np.empty((0, 2), np.int64), np.empty(0), np.zeros(17))


def state(x, cov, joint_s, limbs=NO_LIMBS, limb_m=None):
    x, cov, velocity_cov = x[None].copy(), cov[None].copy(), np.zeros((1, 17, 3, 3))
    limb_m = np.empty((1, 0)) if limb_m is None else limb_m[None]
    kernels.report_all(
        MODEL.cameras, MODEL.noise, limbs,
        kernels.Bodies(limb_m, np.full(limb_m.shape, 1e-6), np.zeros((1, 2))), joint_s[None],
        NOW_S, (x, cov, velocity_cov),
    )  # fmt: skip
    return x[0], cov[0], velocity_cov[0]


@given(st.integers(0, 2**32 - 1))
def test_lasting_errors_are_added_as_by_the_reference(seed):
    rng = np.random.default_rng(seed)
    x, cov = somebody(rng)
    joint_s = rng.choice([0.5, 1.05, -np.inf], (17, 4))
    said, said_m2, said_m2ps2 = state(x, cov, joint_s)
    np.testing.assert_array_equal(said, x)
    for j in range(17):
        lasting = reference.lasting_m2(MODEL, j, x[j], joint_s[j], NOW_S)
        np.testing.assert_allclose(said_m2[j], cov[j] + lasting, rtol=1e-9, atol=1e-10)
        wandering = reference.wandering_m2ps2(MODEL, j, x[j], joint_s[j], NOW_S)
        np.testing.assert_allclose(said_m2ps2[j], wandering, rtol=1e-9, atol=1e-10)


def test_more_cameras_leave_less_of_lasting_errors():
    x, cov = np.tile([0.1, 0.2, 1.0], (17, 1)), np.zeros((17, 3, 3))
    sigma_m = [
        np.sqrt(
            state(x, cov, np.where(np.tile(np.arange(4) < n, (17, 1)), 1.05, 0.95))[1][0].trace()
            / 3
        )
        for n in range(5)
    ]
    assert sigma_m == sorted(sigma_m, reverse=True)
    assert sigma_m[4] < SETTINGS.joint_sigma_m < sigma_m[1] < sigma_m[0] <= 0.11


def test_a_joint_is_the_less_known_the_longer_no_two_cameras_have_seen_it():
    """Along the ray of the camera that sees it, and in all directions where none does."""
    x, cov = np.tile([0.1, 0.2, 1.0], (17, 1)), np.zeros((17, 3, 3))
    for seeing in (0, 1):
        largest, smallest = [], []
        for ago_s in (0.2, 1.0, 3.0, 100.0):
            last_s = np.full((17, 4), NOW_S - ago_s)
            last_s[:, :seeing] = NOW_S
            values = np.linalg.eigvalsh(state(x, cov, last_s)[1][0])
            smallest.append(np.sqrt(values[0]))
            largest.append(np.sqrt(values[2]))
        assert (np.diff(largest) > 0.03).all()
        assert 0.5 < largest[-1] < 0.7
        assert (smallest[-1] < 0.03) == (seeing == 1)


def test_limbs_hold_joints_by_what_lasting_errors_leave_open():
    """A joint that its trajectory calls sure is moved all the same: its key points may all err."""
    x, cov = np.tile([0.0, 0.0, 1.0], (17, 1)), np.tile(np.eye(3) * 1e-9, (17, 1, 1))
    x[1, 0] += 0.32
    limbs = kernels.Limbs(np.array([[0, 1]]), np.zeros(1), np.zeros(2))
    said, _, _ = state(x, cov, np.full((17, 4), 1.05), limbs, np.array([0.3]))
    assert 0.3 < np.linalg.norm(said[1] - said[0]) < 0.312


@pytest.mark.parametrize("lag_s", [0.0, 0.2])
@pytest.mark.parametrize("cameras", [2, 4])
def test_stated_uncertainty_is_honest_on_the_errors_of_a_real_detector(cameras, lag_s):
    """Some 90 % of the true joints lie in the 90 % regions, with and without a lag."""
    made = simulate(room_scene(people=3, cameras=cameras, seconds=8.0), 7)
    tracker = Tracker(made.rig, lag_s=lag_s)
    inside = []
    for s in map(tracker.step, frame_sets(made)):
        when = np.argmin(np.abs(made.truth_t_s - s.t_s))
        apart_m = np.linalg.norm(s.xyz_m[:, None] - made.truth_xyz_m[None, :, when], axis=-1)
        for k, mean_m in enumerate(apart_m.mean(axis=-1)):
            if s.t_s > 1.0 and np.isfinite(mean_m).any() and np.nanmin(mean_m) < 0.3:
                inside += (apart_m[k, np.nanargmin(mean_m)] < 2.5 * s.sigma_m[k]).tolist()
    assert 0.8 < np.mean(inside) < 0.97
