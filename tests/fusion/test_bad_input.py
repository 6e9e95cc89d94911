"""What cameras and estimators do wrong: nothing diverges, and the others are tracked on."""

from dataclasses import replace

import numpy as np
import pytest

from fusion.made import frame_sets, made, outcome, path
from trecsim import follow
from trecsim.fusion import Tracker
from trecsim.geometry import Rig
from trecsim.values import FrameSet

SCENE = made([path((0, -2, 0), (6, 2, 0)), path((0, -2, 1.5), (6, 2, 1.5))], seconds=3.2)
BAD = SCENE.rig.names[1]
FROM_S = 1.0
SETTLED = 15


@pytest.fixture(scope="module")
def undisturbed():
    return errors(run(frame_sets(SCENE))[0])


def run(sets, rig=SCENE.rig):
    """Follow `sets`; return the snapshots and the most that the tracker held of each kind."""
    tracker, snapshots, most = Tracker(rig), [], {}
    for one in sets:
        snapshots.append(tracker.step(one))
        most = {name: max(most.get(name, 0), n) for name, n in tracker.held._asdict().items()}
    return snapshots, most


def errors(snapshots, scene=SCENE):
    return outcome(scene, snapshots)


def changed(change, from_s=FROM_S, camera=BAD):
    """Return the scene's frame sets with images of one camera, or of all (None), changed."""

    def one(view):
        return change(view) if view.t_s > from_s and camera in (view.camera, None) else view

    sets = (tuple(filter(None, map(one, s.views))) for s in frame_sets(SCENE))
    return [FrameSet(max(v.t_s for v in views), views) for views in sets if views]


def assert_tracked_on(snapshots, most, undisturbed, *, worse=2.0, tracks=6):
    """Everybody has been followed under one identity, and nothing has grown."""
    result = errors(snapshots)
    assert result.switches == 0
    assert np.isnan(result.error_m[SETTLED:]).mean() < 0.01
    assert np.nanmean(result.error_m[SETTLED:]) < worse * np.nanmean(undisturbed.error_m[SETTLED:])
    assert_bounded(snapshots, most, tracks)


def assert_bounded(snapshots, most, tracks, unassigned=20):
    assert all(np.isfinite(s.xyz_m).all() and np.isfinite(s.cov_m2).all() for s in snapshots)
    assert all((np.linalg.eigvalsh(s.cov_m2) > 0.0).all() for s in snapshots)
    assert most["tracks"] <= tracks
    assert most["unassigned"] <= unassigned
    assert most["dead"] <= tracks
    assert most["close_pairs"] <= tracks**2
    assert most["ended"] == 0


class Frozen:
    """A camera that sends the same picture again and again, with new times."""

    def __init__(self):
        self.picture = None

    def __call__(self, view):
        self.picture = self.picture or view
        return replace(self.picture, t_s=view.t_s)


def test_a_camera_that_sends_a_frozen_picture_is_outvoted(undisturbed):
    assert_tracked_on(*run(changed(Frozen())), undisturbed, worse=4.0)


def test_a_camera_that_repeats_one_image_and_its_time_is_as_silent(undisturbed):
    first_s = min(v.t_s for v in SCENE.poses if v.camera == BAD and v.t_s > FROM_S)
    same = run(changed(lambda v: replace(v, t_s=first_s)))
    silent = run(changed(lambda v: v if v.t_s == first_s else None))
    assert_tracked_on(*same, undisturbed, worse=1.7)
    for one, other in zip(same[0], silent[0], strict=True):
        np.testing.assert_allclose(one.xyz_m, other.xyz_m, atol=1e-9)


def test_a_camera_that_goes_silent_and_comes_back_is_used_again(undisturbed):
    gone = run(changed(lambda v: None))
    back = run(changed(lambda v: v if v.t_s > 2.0 else None))
    assert_tracked_on(*back, undisturbed, worse=1.5)
    last = slice(60, None)
    assert np.nanmean(errors(back[0]).error_m[last]) < np.nanmean(errors(gone[0]).error_m[last])


def test_nobody_is_lost_while_all_cameras_are_silent_for_a_moment(undisturbed):
    snapshots, most = run(changed(lambda v: v if v.t_s > 1.4 else None, camera=None))
    result = errors(snapshots)
    assert result.ids == {0, 1}
    assert result.switches == 0
    assert_bounded(snapshots, most, 2)


@pytest.mark.parametrize("shift_s", [0.7, 1.5, 1e12, -0.4, -0.9, -1e12])
def test_a_clock_that_jumps_costs_one_camera_at_most(shift_s, undisturbed):
    snapshots, most = run(changed(lambda v: replace(v, t_s=v.t_s + shift_s)))
    assert_tracked_on(snapshots, most, undisturbed)
    assert abs(snapshots[-1].t_s - 3.2) < 0.1


@pytest.mark.parametrize(("single", "shift_s"), [
    (True, 1.0), (True, 1e12), (True, -1.5), (False, 0.5), (False, 1.0), (False, 1.5),
    (False, 1e12), (False, -0.9), (False, -1e12),
])  # fmt: skip
def test_a_wrong_clock_in_a_stream_costs_one_camera_at_most(single, shift_s, undisturbed):
    wrong = [v for v in SCENE.poses if v.camera == BAD and v.t_s > FROM_S][: 1 if single else None]
    marked = {id(v) for v in wrong}
    stream = [replace(v, t_s=v.t_s + shift_s) if id(v) in marked else v for v in SCENE.poses]
    snapshots = [s for s in follow(stream, SCENE.rig) if s.t_s < 3.1]
    assert len(snapshots) >= 75
    result = errors(snapshots)
    assert result.switches == 0
    assert np.isnan(result.error_m[SETTLED:]).mean() < 0.01
    assert np.nanmean(result.error_m[SETTLED:]) < 2.0 * np.nanmean(undisturbed.error_m[SETTLED:])


@pytest.mark.parametrize("shift_s", [1.0, 1e12, -1.0, -3600.0])
def test_clocks_that_all_jump_together_go_on_in_their_new_time(shift_s):
    stream = [replace(v, t_s=v.t_s + shift_s) if v.t_s > FROM_S else v for v in SCENE.poses]
    *_, last = snapshots = list(follow(stream, SCENE.rig))
    assert last.t_s == pytest.approx(3.2 + shift_s, abs=0.1)
    assert len(last.id) == 2
    assert len({int(i) for s in snapshots for i in s.id}) <= 4
    assert all(np.isfinite(s.xyz_m).all() for s in snapshots)


@pytest.mark.parametrize("late_s", [0.4, 1.0])
def test_images_that_come_late_are_put_in_order_or_left_out(late_s, undisturbed):
    arriving = sorted(SCENE.poses, key=lambda v: v.t_s + (late_s if v.camera == BAD else 0.0))
    in_order = errors(list(follow(arriving, SCENE.rig)))
    assert in_order.ids == {0, 1}
    assert np.nanmean(in_order.error_m[SETTLED:]) < 1.1 * np.nanmean(undisturbed.error_m[SETTLED:])
    as_they_come = run([FrameSet(v.t_s, (v,)) for v in arriving])
    assert_tracked_on(*as_they_come, undisturbed)


def test_images_that_come_in_any_order_within_a_second_do_no_harm(undisturbed):
    rng = np.random.default_rng(0)
    arriving = sorted(SCENE.poses, key=lambda v: v.t_s + rng.uniform(0.0, 1.0))
    snapshots, most = run([FrameSet(v.t_s, (v,)) for v in arriving])
    result = errors(snapshots[120:])
    assert result.ids == {0, 1}
    assert np.nanmedian(result.error_m) < 0.1
    assert_bounded(snapshots, most, 6, unassigned=30)


def turned(rig, axis, degrees):
    """Return the rig with one camera turned, as if it had been pushed."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    T, (i, k) = np.eye(4), [(1, 2), (0, 2), (0, 1)][axis]
    T[i, i] = T[k, k] = c
    T[i, k], T[k, i] = -s, s
    return Rig(
        tuple(
            replace(camera, T_cam_world=T @ camera.T_cam_world) if camera.name == BAD else camera
            for camera in rig
        )
    )


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("degrees", [2.0, -2.0])
def test_a_camera_that_was_pushed_by_two_degrees_loses_nobody(axis, degrees):
    """At 5 m that is 17 cm, too little to tell it from a person: it may make a ghost of its own."""
    snapshots, most = run(frame_sets(SCENE), turned(SCENE.rig, axis, degrees))
    result = errors(snapshots)
    assert len(set.intersection(*(set(s.id.tolist()) for s in snapshots[SETTLED:]))) >= 2
    assert result.switches <= 2
    assert np.isnan(result.error_m[SETTLED:]).mean() < 0.01
    assert np.nanmean(result.error_m[SETTLED:]) < 0.13
    assert result.count.max() <= 3
    assert_bounded(snapshots, most, 4)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_camera_that_looks_quite_elsewhere_is_ignored(axis, undisturbed):
    snapshots, most = run(frame_sets(SCENE), turned(SCENE.rig, axis, 20.0))
    assert_tracked_on(snapshots, most, undisturbed)


def multiplied(times):
    def many(view):
        return replace(
            view,
            xy_px=np.repeat(view.xy_px[:1], times, axis=0),
            score=np.repeat(view.score[:1], times, axis=0),
            person_score=np.ones(times if len(view.xy_px) else 0),
        )

    return many


def test_one_person_fifty_times_in_every_image_is_one_person():
    snapshots, most = run(changed(multiplied(50), from_s=-1.0, camera=None))
    assert errors(snapshots).count.max() <= 3
    assert_bounded(snapshots, most, 4)


def with_false_people(count, rng, like_people):
    def crowded(view):
        if like_people and len(view.xy_px):
            body = view.xy_px[rng.integers(len(view.xy_px), size=count)]
            body = body - np.nanmean(body, axis=1, keepdims=True)
        else:
            body = rng.normal(0, 80, (count, 17, 2))
        false = body + rng.uniform([0, 0], [1920, 1080], (count, 1, 2))
        return replace(
            view,
            xy_px=np.concatenate([view.xy_px, false]),
            score=np.concatenate([view.score, rng.uniform(0.3, 0.9, (count, 17))]),
            person_score=np.ones(len(view.score) + count),
        )

    return crowded


def test_hundreds_of_shapeless_false_people_in_every_image_are_nobody(undisturbed):
    crowd = with_false_people(200, np.random.default_rng(0), like_people=False)
    snapshots, most = run(changed(crowd, camera=None))
    assert errors(snapshots).ids == {0, 1}
    assert_bounded(snapshots, most, 3, unassigned=4 * 202)
    assert np.nanmean(errors(snapshots).error_m[SETTLED:]) < 1.1 * np.nanmean(
        undisturbed.error_m[SETTLED:]
    )


@pytest.mark.parametrize("count", [20, 300])
def test_hundreds_of_false_people_of_human_shape_take_nobodys_place(count, undisturbed):
    crowd = with_false_people(count, np.random.default_rng(0), like_people=True)
    snapshots, most = run(changed(crowd, camera=None)[:45])
    result = errors(snapshots)
    assert result.switches == 0
    assert not np.isnan(result.error_m[SETTLED:]).any()
    assert np.nanmean(result.error_m[SETTLED:]) < 1.2 * np.nanmean(undisturbed.error_m[SETTLED:])
    assert_bounded(snapshots, most, 300, unassigned=4 * (count + 2))


ODD = [np.nan, np.inf, 1e300, -1e154, 1e20, -1e9, 0.0]


@pytest.mark.parametrize("value", ODD)
def test_a_camera_of_impossible_key_points_is_as_good_as_none(value, undisturbed):
    change = changed(lambda v: replace(v, xy_px=np.full_like(v.xy_px, value)))
    assert_tracked_on(*run(change), undisturbed)


@pytest.mark.parametrize("value", ODD[:-1])
def test_a_quarter_of_impossible_key_points_leaves_the_others_usable(value, undisturbed):
    rng = np.random.default_rng(0)

    def some(view):
        xy_px = view.xy_px.copy()
        xy_px[rng.random(xy_px.shape[:2]) < 0.25] = value
        return replace(view, xy_px=xy_px)

    assert_tracked_on(*run(changed(some, camera=None)), undisturbed)


@pytest.mark.parametrize("lens", [("brown", [-0.25, 0.08, 0.001, -0.001, 0.0]),
                                  ("fisheye", [-0.02, 0.005, 0.0, 0.0])])  # fmt: skip
@pytest.mark.parametrize("value", ODD)
def test_impossible_key_points_behind_any_lens_make_nothing_infinite(lens, value):
    model, coefficients = lens
    rig = Rig(
        tuple(
            replace(c, distortion_model=model, distortion=np.array(coefficients)) for c in SCENE.rig
        )
    )
    rng = np.random.default_rng(0)

    def some(view):
        xy_px = view.xy_px.copy()
        xy_px[rng.random(xy_px.shape[:2]) < 0.3] = value
        return replace(view, xy_px=xy_px)

    snapshots, most = run(changed(some, camera=None)[:45], rig)
    assert_bounded(snapshots, most, 40, unassigned=30)


@pytest.mark.parametrize("score", [np.nan, 0.0, -np.inf])
def test_a_camera_that_trusts_nothing_is_as_good_as_none(score, undisturbed):
    change = changed(lambda v: replace(v, score=np.full_like(v.score, score)))
    assert_tracked_on(*run(change), undisturbed)


@pytest.mark.parametrize("score", [5.0, np.inf])
def test_scores_above_one_count_as_one(score):
    best = run(changed(lambda v: replace(v, score=np.ones_like(v.score)), camera=None))[0]
    odd = run(changed(lambda v: replace(v, score=np.full_like(v.score, score)), camera=None))[0]
    for one, other in zip(best, odd, strict=True):
        np.testing.assert_array_equal(one.xyz_m, other.xyz_m)


@pytest.mark.parametrize("joints", [[0], [5, 6, 11, 12]])
def test_of_one_joint_and_of_four_nobody_is_made_and_who_was_there_is_given_up(joints):
    def few(view):
        xy_px = np.full_like(view.xy_px, np.nan)
        xy_px[:, joints] = view.xy_px[:, joints]
        return replace(view, xy_px=xy_px)

    assert errors(run(changed(few, from_s=-1.0, camera=None))[0]).ids == set()
    snapshots, most = run(changed(few, camera=None))
    assert len(snapshots[-1].id) == 0
    assert_bounded(snapshots, most, 2)


def test_images_without_anybody_for_ever_are_quiet():
    def empty(view):
        return replace(
            view, xy_px=view.xy_px[:0], score=view.score[:0], person_score=view.person_score[:0]
        )

    snapshots, most = run(changed(empty, camera=None))
    assert {len(s.id) for s in snapshots if s.t_s > 1.7} == {0}
    assert_bounded(snapshots, most, 2)
