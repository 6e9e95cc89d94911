"""Scenes: what people do, and how well they are followed."""

import numpy as np
import pytest

from fusion.made import NOISE, frame_sets, made, outcome, path
from trecsim.errors import CalibrationError, ConfigError, InputError
from trecsim.fusion import FusionSettings, Tracker
from trecsim.geometry import Camera, Rig
from trecsim.lab.simulation.detector_errors import PERFECT, Detector
from trecsim.skeleton import COCO17
from trecsim.values import FrameSet, Poses2D

ACROSS = path((0, -2, 0), (6, 2, 0))
BESIDE = path((0, -2, 1.5), (6, 2, 1.5))


def follow(simulation, sets=None, **options):
    tracker = Tracker(simulation.rig, **options)
    return [tracker.step(s) for s in (frame_sets(simulation) if sets is None else sets)]


def test_a_perfect_detector_gives_everybody_to_a_centimetre():
    scene = made([ACROSS, BESIDE], detector=PERFECT)
    result = outcome(scene, follow(scene))
    assert np.nanmedian(result.error_m[25:]) < 0.01
    assert result.ids == {0, 1}
    assert result.switches == 0


def test_a_noisy_detector_gives_everybody_to_a_few_centimetres():
    scene = made([ACROSS, BESIDE])
    result = outcome(scene, follow(scene))
    assert np.nanmean(result.error_m[10:]) < 0.05
    assert np.isnan(result.error_m[10:]).mean() < 0.02
    assert result.switches == 0


def test_two_people_crossing_keep_their_ids():
    scene = made([path((0, -2, -0.15), (6, 2, -0.15)), path((0, 2, 0.15), (6, -2, 0.15))])
    result = outcome(scene, follow(scene))
    assert result.switches == 0
    assert len(result.ids) == 2


def test_a_lag_makes_the_result_smoother():
    scene = made([ACROSS, BESIDE])
    now = outcome(scene, follow(scene))
    later = outcome(scene, follow(scene, lag_s=0.2))
    assert np.nanmean(later.error_m[15:]) < 0.95 * np.nanmean(now.error_m[15:])


def test_a_lagged_snapshot_says_which_time_it_is_for():
    scene = made([ACROSS], seconds=2.0)
    sets = frame_sets(scene)
    snapshots = follow(scene, sets, lag_s=0.3)
    for snapshot, frame_set in zip(snapshots, sets, strict=True):
        assert snapshot.t_s == pytest.approx(frame_set.t_s - 0.3)


def test_somebody_whom_three_cameras_see_is_reported_at_once():
    scene = made([ACROSS], detector=PERFECT, stagger=False)
    assert len(follow(scene)[0].id) == 1


def test_two_cameras_that_agree_beyond_doubt_report_somebody_at_once():
    scene = made([ACROSS], cameras=2, detector=PERFECT, stagger=False)
    assert len(follow(scene)[0].id) == 1


def test_two_cameras_that_see_little_must_agree_for_a_while():
    """Of six joints, as many as a body has where its limbs are hidden, two cameras make nobody."""
    scene = made([ACROSS], cameras=2, detector=PERFECT, stagger=False)
    trunk = [5, 6, 7, 8, 11, 12]
    sets = [
        FrameSet(s.t_s, tuple(only_joints(view, trunk) for view in s.views))
        for s in frame_sets(scene)
    ]
    count = [len(snapshot.id) for snapshot in follow(scene, sets)[:8]]
    assert count[0] == 0
    assert count[-1] == 1


def only_joints(view, joints):
    xy = np.full_like(view.xy_px, np.nan)
    xy[:, joints] = view.xy_px[:, joints]
    return Poses2D(view.camera, view.t_s, xy, view.score, view.person_score)


@pytest.mark.parametrize("fps", [25.0, 30.0, 50.0])
def test_nobody_stands_twice_in_a_lagged_snapshot(fps):
    """Whoever is replaced by a better place of the same person is not also kept as gone."""
    scene = made([ACROSS], fps=fps)
    eye = scene.rig.names[0]
    sets = [
        FrameSet(s.t_s, tuple(v for v in s.views if v.camera == eye or int(2 * s.t_s) % 2 == 0))
        for s in frame_sets(scene, fps)
    ]
    for snapshot in follow(scene, [s for s in sets if s.views], lag_s=0.2):
        assert len(set(snapshot.id.tolist())) == len(snapshot.id)


def test_one_camera_alone_makes_nobody():
    scene = made([ACROSS], detector=PERFECT)
    sets = [
        FrameSet(s.t_s, tuple(v for v in s.views if v.camera == scene.rig.names[0]))
        for s in frame_sets(scene)
    ]
    assert all(len(snapshot.id) == 0 for snapshot in follow(scene, [s for s in sets if s.views]))


def test_one_camera_lost_changes_no_identity():
    scene = made([ACROSS, BESIDE])
    sets = [
        FrameSet(s.t_s, tuple(v for v in s.views if s.t_s < 2 or v.camera != scene.rig.names[1]))
        for s in frame_sets(scene)
    ]
    result = outcome(scene, follow(scene, [s for s in sets if s.views]))
    assert result.switches == 0
    assert np.nanmean(result.error_m[60:]) < 0.06


def test_whoever_leaves_is_gone_within_half_a_second_and_no_ghost_stays():
    scene = made([path((0, -2, 0), (3, 0, 0)), BESIDE], detector=PERFECT)
    snapshots = follow(scene)
    there = [len(s.id) for s in snapshots if 1.0 < s.t_s < 2.9]
    after = [len(s.id) for s in snapshots if s.t_s > 3.6]
    assert set(there) == {2}
    assert set(after) == {1}


def test_somebody_new_gets_a_new_identity():
    scene = made([path((0, -2, 0), (2, -1, 0)), path((4.5, 1, 0), (6.5, 2, 0))], seconds=6.5)
    result = outcome(scene, follow(scene))
    assert result.ids == {0, 1}


def test_cameras_of_different_rate_and_phase_are_fused_at_their_own_times():
    """A fast walker: images taken for simultaneous would give many times the error."""
    scene = made([path((0, -2.4, 0), (3, 2.4, 0))], seconds=3.0, detector=PERFECT)
    fast, slow = scene.rig.names[0], scene.rig.names[1]
    sets = []
    for n, s in enumerate(frame_sets(scene)):
        keep = tuple(v for v in s.views if v.camera != slow or n % 3 == 0)
        sets.append(FrameSet(max(v.t_s for v in keep), keep))
    assert any(fast in {v.camera for v in s.views} for s in sets)
    result = outcome(scene, follow(scene, sets))
    assert np.nanmedian(result.error_m[15:]) < 0.015


def test_order_of_cameras_and_of_detections_changes_nothing():
    scene = made([ACROSS, BESIDE], seconds=2.0)
    turned = Rig(tuple(reversed(scene.rig.cameras)))
    forward = follow(scene)
    sets = [FrameSet(s.t_s, tuple(_reversed(v) for v in s.views[::-1])) for s in frame_sets(scene)]
    tracker = Tracker(turned)
    for one, other in zip(forward, [tracker.step(s) for s in sets], strict=True):
        assert len(one.id) == len(other.id)
        a = one.xyz_m[np.lexsort(one.xyz_m[:, 0].T)]
        b = other.xyz_m[np.lexsort(other.xyz_m[:, 0].T)]
        np.testing.assert_allclose(a, b, atol=1e-6)


def _reversed(view):
    return Poses2D(
        view.camera, view.t_s, view.xy_px[::-1], view.score[::-1], view.person_score[::-1]
    )


def test_moving_the_world_moves_the_people():
    scene = made([ACROSS, BESIDE], seconds=2.0)
    angle = 0.7
    T = np.eye(4)
    T[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    T[:3, 3] = 30.0, -12.0, 2.0
    moved = Rig(
        tuple(
            Camera(c.name, c.size_px, c.K, c.T_cam_world @ np.linalg.inv(T), c.distortion_model,
                   c.distortion)
            for c in scene.rig
        )
    )  # fmt: skip
    tracker = Tracker(moved)
    for here, s in zip(follow(scene), frame_sets(scene), strict=True):
        there = tracker.step(s)
        np.testing.assert_array_equal(here.id, there.id)
        np.testing.assert_allclose(here.xyz_m @ T[:3, :3].T + T[:3, 3], there.xyz_m, atol=1e-5)
        np.testing.assert_array_equal(here.support, there.support)


def test_a_shift_of_all_clocks_changes_nothing_but_the_times():
    scene = made([ACROSS], seconds=2.0)
    tracker = Tracker(scene.rig)
    for here, s in zip(follow(scene), frame_sets(scene), strict=True):
        later = FrameSet(
            s.t_s + 1.7e9,
            tuple(
                Poses2D(v.camera, v.t_s + 1.7e9, v.xy_px, v.score, v.person_score) for v in s.views
            ),
        )
        np.testing.assert_allclose(here.xyz_m, tracker.step(later).xyz_m, atol=2e-3)


def test_somebody_read_mirrored_from_the_start_is_turned_round():
    scene = made([ACROSS], detector=PERFECT, seconds=3.0)
    mirror = np.array(COCO17.mirror)
    sets = [
        FrameSet(
            s.t_s,
            tuple(
                Poses2D(v.camera, v.t_s, v.xy_px[:, mirror], v.score[:, mirror], v.person_score)
                if s.t_s < 0.5
                else v
                for v in s.views
            ),
        )
        for s in frame_sets(scene)
    ]
    result = outcome(scene, follow(scene, sets))
    assert np.nanmean(result.error_m[:8]) > 0.1
    assert np.nanmean(result.error_m[-25:]) < 0.02


@pytest.mark.parametrize("rubbish", [np.nan, 1e12, -1e12])
def test_rubbish_from_one_camera_does_not_disturb_the_others(rubbish):
    scene = made([ACROSS, BESIDE], seconds=3.0)
    broken = scene.rig.names[2]
    sets = [
        FrameSet(s.t_s, tuple(_spoilt(v, rubbish) if v.camera == broken else v for v in s.views))
        for s in frame_sets(scene)
    ]
    snapshots = follow(scene, sets)
    result = outcome(scene, snapshots)
    assert result.ids == {0, 1}
    assert np.nanmean(result.error_m[10:]) < 0.06
    assert all(np.isfinite(s.xyz_m).all() and np.isfinite(s.cov_m2).all() for s in snapshots)


def _spoilt(view, value):
    return Poses2D(
        view.camera, view.t_s, np.full_like(view.xy_px, value), view.score, view.person_score
    )


def test_hundreds_of_false_people_make_nobody_and_cost_no_identity():
    scene = made([ACROSS, BESIDE], seconds=2.0)
    rng = np.random.default_rng(0)
    sets = []
    for s in frame_sets(scene):
        views = []
        for v in s.views:
            false = rng.uniform([0, 0], [1920, 1080], (100, 1, 2)) + rng.normal(0, 80, (100, 17, 2))
            views.append(
                Poses2D(
                    v.camera, v.t_s, np.concatenate([v.xy_px, false]),
                    np.concatenate([v.score, rng.uniform(0.2, 0.6, (100, 17))]),
                    np.ones(len(v.score) + 100),
                )
            )  # fmt: skip
        sets.append(FrameSet(s.t_s, tuple(views)))
    result = outcome(scene, follow(scene, sets))
    assert result.switches == 0
    assert result.count.max() <= 3


def test_the_same_image_again_brings_nothing_new():
    scene = made([ACROSS], seconds=1.0)
    once, twice = Tracker(scene.rig), Tracker(scene.rig)
    for s in frame_sets(scene):
        first = once.step(s)
        twice.step(s)
        second = twice.step(s)
        np.testing.assert_allclose(first.xyz_m, second.xyz_m)
        np.testing.assert_allclose(first.cov_m2, second.cov_m2)


def test_a_gap_of_minutes_begins_anew_with_new_identities():
    scene = made([ACROSS], seconds=1.0)
    tracker = Tracker(scene.rig)
    ids = set()
    for start_s in (0.0, 600.0):
        for s in frame_sets(scene):
            views = tuple(
                Poses2D(v.camera, v.t_s + start_s, v.xy_px, v.score, v.person_score)
                for v in s.views
            )
            ids.update(tracker.step(FrameSet(s.t_s + start_s, views)).id.tolist())
    assert ids == {0, 1}


def test_uncertainty_grows_while_nobody_looks_and_support_goes():
    scene = made([ACROSS], detector=PERFECT, seconds=2.0)
    sets = frame_sets(scene)
    tracker = Tracker(scene.rig)
    for s in sets[:30]:
        before = tracker.step(s)
    nothing = np.empty((0, 17, 2)), np.empty((0, 17)), np.empty(0)
    blind = [
        tracker.step(FrameSet(s.t_s, tuple(Poses2D(v.camera, v.t_s, *nothing) for v in s.views)))
        for s in sets[30:36]
    ]
    assert (before.support >= 2).all()
    assert (blind[-1].support == 0).all()
    assert (blind[-1].sigma_m > 1.2 * before.sigma_m).all()


def test_stated_uncertainty_is_not_too_small():
    """Nine in ten joints at least lie within the stated 90 % region."""
    scene = made([ACROSS, BESIDE], detector=NOISE)
    inside = []
    for snapshot in follow(scene)[15:]:
        from fusion.made import truth_at

        truth = truth_at(scene, snapshot.t_s)
        for k in range(len(snapshot.id)):
            off = np.linalg.norm(snapshot.xyz_m[k] - truth, axis=-1).mean(axis=1)
            e = snapshot.xyz_m[k] - truth[int(np.nanargmin(off))]
            d2 = np.einsum("ja,jab,jb->j", e, np.linalg.inv(snapshot.cov_m2[k]), e)
            inside.append(d2 < 6.25)
    assert np.mean(inside) > 0.85


def test_a_camera_the_rig_lacks_is_an_error_that_names_it():
    scene = made([ACROSS], seconds=1.0)
    view = frame_sets(scene)[0].views[0]
    stranger = Poses2D("attic", view.t_s, view.xy_px, view.score, view.person_score)
    with pytest.raises(CalibrationError, match="attic"):
        Tracker(scene.rig).step(FrameSet(view.t_s, (stranger,)))


def test_wrong_settings_are_all_reported_at_once():
    with pytest.raises(ConfigError) as error:
        FusionSettings(knot_s=-1.0, outlier_share=2.0, death_s=float("nan"))
    for name in ("knot_s", "outlier_share", "death_s"):
        assert name in str(error.value)


def test_nobody_is_reported_of_an_empty_room():
    nobody = Detector(false_people=0.0)
    scene = made([path((20, 0, 0), (21, 1, 0))], seconds=1.0, detector=nobody)
    assert all(len(s.id) == 0 for s in follow(scene))


def _shifted(frame_set, shift_s, cameras):
    views = tuple(
        Poses2D(v.camera, v.t_s + shift_s, v.xy_px, v.score, v.person_score)
        if v.camera in cameras
        else v
        for v in frame_set.views
    )
    return FrameSet(max(v.t_s for v in views), views)


@pytest.mark.parametrize("shift_s", [1000.0, -1000.0])
def test_one_camera_whose_clock_jumps_is_left_out_and_the_others_go_on(shift_s):
    scene = made([ACROSS, BESIDE], seconds=4.0)
    wrong = {scene.rig.names[1]}
    sets = [_shifted(s, shift_s, wrong) if s.t_s > 1.5 else s for s in frame_sets(scene)]
    snapshots = follow(scene, sets)
    result = outcome(scene, snapshots)
    assert result.ids == {0, 1}
    assert result.switches == 0
    assert max(s.t_s for s in snapshots) < 5.0
    assert np.nanmean(result.error_m[50:]) < 0.06


def test_all_clocks_set_back_together_begin_anew():
    scene = made([ACROSS], seconds=2.0)
    everybody = set(scene.rig.names)
    sets = [_shifted(s, -3600.0, everybody) if s.t_s > 1 else s for s in frame_sets(scene)]
    snapshots = follow(scene, sets)
    assert {int(i) for s in snapshots for i in s.id} == {0, 1}
    assert snapshots[-1].t_s < 0
    assert len(snapshots[-1].id) == 1


@pytest.mark.parametrize("lag_s", [0.3, 1.5])
def test_a_lag_changes_nobodys_first_and_last_moment(lag_s):
    scene = made([path((0, -2, 0), (2, 0, 0)), BESIDE], detector=PERFECT)

    def extent(snapshots):
        times = [s.t_s for s in snapshots if 0 in s.id]
        return min(times), max(times)

    now, late = extent(follow(scene)), extent(follow(scene, lag_s=lag_s))
    assert late == pytest.approx(now, abs=0.1)


def test_cameras_that_deliver_nothing_do_not_count_as_looking():
    scene = made([ACROSS], detector=PERFECT, seconds=6.0)
    eye = scene.rig.names[0]
    sets = [
        FrameSet(s.t_s, tuple(v for v in s.views if s.t_s < 2 or v.camera == eye))
        for s in frame_sets(scene)
    ]
    snapshots = follow(scene, [s for s in sets if s.views])
    assert {int(i) for s in snapshots for i in s.id} == {0}
    assert len(snapshots[-1].id) == 1


def test_poses_of_another_skeleton_are_an_error_that_says_so():
    scene = made([ACROSS], seconds=1.0)
    name = scene.rig.names[0]
    wrong = Poses2D(name, 0.0, np.zeros((1, 26, 2)), np.ones((1, 26)), np.ones(1))
    with pytest.raises(InputError, match="26 joints"):
        Tracker(scene.rig).step(FrameSet(0.0, (wrong,)))
