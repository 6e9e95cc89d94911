"""What is said about a moment: lasting errors of key points, and limbs that hold."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import reference_fusion as reference
from fusion.made import frame_sets, made, path
from fusion.somebody import MODEL, NO_CHAIN, SETTINGS, limbs_of, somebody
from trecsim.fusion import Tracker, kernels
from trecsim.lab.simulation.detector_errors import CLOTHED, PERFECT
from trecsim.lab.simulation.scene import room_scene, simulate
from trecsim.values import FrameSet

NOW_S = 1.1
NO_LIMBS = limbs_of([], n_joint=17)


def state(x, cov, joint_s, limbs=NO_LIMBS, limb_m=None, off_m2=None, quality=None):
    x, cov, velocity_cov = x[None].copy(), cov[None].copy(), np.zeros((1, 17, 3, 3))
    limb_m = np.empty((1, 0)) if limb_m is None else limb_m[None]
    nothing = np.zeros((1, *joint_s.shape))
    sights = kernels.Sights(
        joint_s.max(axis=0), np.full(4, 0.12), joint_s[None],
        nothing if off_m2 is None else off_m2[None],
        nothing + 1.0 if quality is None else quality[None],
    )  # fmt: skip
    kernels.report_all(
        MODEL.cameras, MODEL.noise, limbs,
        kernels.Bodies(limb_m, np.full(limb_m.shape, 1e-6), np.zeros((1, 2))), sights,
        NOW_S, (x, cov, velocity_cov),
    )  # fmt: skip
    return x[0], cov[0], velocity_cov[0]


@given(st.integers(0, 2**32 - 1))
def test_lasting_errors_are_added_as_by_the_reference(seed):
    rng = np.random.default_rng(seed)
    x, cov = somebody(rng)
    joint_s = rng.choice([0.5, 1.05, -np.inf], (17, 4))
    quality = rng.choice([0.0, 0.04, 0.5, 1.0, 1.5], (17, 4))
    said, said_m2, said_m2ps2 = state(x, cov, joint_s, quality=quality)
    np.testing.assert_array_equal(said, x)
    for j in range(17):
        seen = joint_s[j], quality[j]
        lasting = reference.lasting_m2(MODEL, j, x[j], *seen, NOW_S)
        common = MODEL.noise.common_m2[j] * np.eye(3)
        np.testing.assert_allclose(said_m2[j], cov[j] + lasting + common, rtol=1e-9, atol=1e-10)
        wandering = reference.wandering_m2ps2(MODEL, j, x[j], *seen, NOW_S)
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
    common_m = np.sqrt(MODEL.noise.common_m2[0])
    assert common_m < sigma_m[4]
    assert np.hypot(common_m, SETTINGS.joint_sigma_m) < sigma_m[1]
    assert sigma_m[0] <= np.hypot(common_m, 0.11)


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
        assert (smallest[-1] < 0.05) == (seeing == 1)


def test_limbs_hold_joints_by_what_lasting_errors_leave_open():
    """A joint that its trajectory calls sure is moved all the same: its key points may all err."""
    x, cov = np.tile([0.0, 0.0, 1.0], (17, 1)), np.tile(np.eye(3) * 1e-9, (17, 1, 1))
    x[1, 0] += 0.32
    limbs = limbs_of([[0, 1]], n_joint=17)
    said, _, _ = state(x, cov, np.full((17, 4), 1.05), limbs, np.array([0.3]))
    assert 0.3 < np.linalg.norm(said[1] - said[0]) < 0.312


@pytest.mark.parametrize("lag_s", [0.0, 0.2])
@pytest.mark.parametrize("cameras", [2, 4])
def test_stated_uncertainty_is_honest_on_the_errors_of_a_real_detector(cameras, lag_s):
    """Some 90 % of the true joints lie in the 90 % regions, with and without a lag."""
    scene = replace(room_scene(people=3, cameras=cameras, seconds=8.0), detector=CLOTHED)
    room = simulate(scene, 7)
    tracker = Tracker(room.rig, lag_s=lag_s)
    inside = []
    for s in map(tracker.step, frame_sets(room)):
        when = np.argmin(np.abs(room.truth_t_s - s.t_s))
        apart_m = np.linalg.norm(s.xyz_m[:, None] - room.truth_xyz_m[None, :, when], axis=-1)
        for k, mean_m in enumerate(apart_m.mean(axis=-1)):
            if s.t_s > 1.0 and np.isfinite(mean_m).any() and np.nanmin(mean_m) < 0.3:
                inside += (apart_m[k, np.nanargmin(mean_m)] < 2.5 * s.sigma_m[k]).tolist()
    assert 0.8 < np.mean(inside) < 0.97


SEEN = np.tile([NOW_S, NOW_S, NOW_S, NOW_S], (17, 1))


def with_outlier(agreeing, off_m, score=1.0):
    """Return sigma of a joint whose last camera sees it `off_m` away, and so many others here."""
    x, cov = np.tile([0.1, 0.2, 1.0], (17, 1)), np.zeros((17, 3, 3))
    joint_s, off_m2, quality = SEEN.copy(), np.zeros((17, 4)), np.zeros((17, 4))
    quality[:, :agreeing] = 1.0
    joint_s[:, agreeing:] = NOW_S - 0.05
    joint_s[1:, 3] = NOW_S  # so that the camera's image is from now
    quality[0, 3], off_m2[0, 3] = score, off_m**2
    cov_m2 = state(x, cov, joint_s, off_m2=off_m2, quality=quality)[1][0]
    return np.sqrt(np.trace(cov_m2) / 3)


def test_the_fewer_cameras_agree_with_a_joint_the_more_an_outlier_widens_it():
    sigma_m = [with_outlier(n, 0.3) - with_outlier(n, 0.0) for n in (1, 2, 3)]
    assert sigma_m == sorted(sigma_m, reverse=True)
    assert sigma_m[0] > 0.1  # one against one: either may be right
    assert sigma_m[2] < 0.02
    assert with_outlier(1, 0.3, score=0.1) < with_outlier(1, 0.3)
    assert with_outlier(1, 0.6) > with_outlier(1, 0.3)


def test_a_limb_that_one_camera_sees_is_stated_as_uncertain_as_its_two_places_are_apart():
    """Half of their distance along the ray; nothing where the limb is across it."""
    eye_m = MODEL.cameras.position_m[0]
    x, cov = np.tile([0.1, 0.2, 1.0], (17, 1)), np.tile(np.eye(3) * 1e-6, (17, 1, 1))
    ray = (x[0] - eye_m) / np.linalg.norm(x[0] - eye_m)
    across = np.cross(ray, [0.0, 0.0, 1.0])
    across /= np.linalg.norm(across)
    # The first two joints are the ends of a limb of 25 cm, whose length varies so much that it
    # holds neither.
    limbs = limbs_of([(0, 1)], 1e6, n_joint=17, chain=[(0, 1, 0)])
    plain = limbs._replace(chain=NO_CHAIN)
    joint_s = np.full((17, 4), NOW_S - 10.0)
    joint_s[:, 0] = NOW_S

    def along_m(end_m):
        x[1] = end_m
        ray = (x[1] - eye_m) / np.linalg.norm(x[1] - eye_m)
        wide, usual = (
            ray @ state(x, cov, joint_s, some, np.array([0.25]))[1][1] @ ray
            for some in (limbs, plain)
        )
        return np.sqrt(max(wide - usual, 0.0))

    assert along_m(x[0] - 0.25 * ray) == pytest.approx(0.25, abs=1e-6)
    assert along_m(x[0] + 0.25 * across) < 0.03
    assert along_m(x[0] + 0.15 * across) == pytest.approx(0.2, abs=0.01)  # half way between both
    joint_s[1, 1] = NOW_S  # a second camera tells in which place it is
    assert along_m(x[0] - 0.25 * ray) == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("lag_s", [0.0, 0.2])
def test_support_counts_the_cameras_whose_newest_image_shows_the_joint(lag_s):
    """Of four cameras one loses the left hand: three support it at once, and then four again."""
    scene = made([path((0, 0, 0), (2, 0, 0))], detector=PERFECT, seconds=2.0, stagger=False)
    tracker = Tracker(scene.rig, lag_s=lag_s)
    counts = {}
    for s in frame_sets(scene):
        if 1.0 < s.t_s < 1.2:
            view = s.views[0]
            xy_px = view.xy_px.copy()
            xy_px[:, 9] = np.nan
            s = FrameSet(s.t_s, (replace(view, xy_px=xy_px), *s.views[1:]))
        snapshot = tracker.step(s)
        if len(snapshot.id):
            counts[round(snapshot.t_s, 3)] = snapshot.support[0, 9]
    settled = {t_s: n for t_s, n in counts.items() if t_s > 0.5}
    assert all((n == 3) == (1.0 < t_s < 1.2) for t_s, n in settled.items())
    assert set(settled.values()) == {3, 4}
