"""People and cameras where nobody expects them, garbage of every kind, and a long wait."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from fusion.made import NOISE, frame_sets, made, outcome, path
from often import often
from trecsim.errors import InputError
from trecsim.fusion import Tracker
from trecsim.geometry import Camera, Rig
from trecsim.lab.simulation.detector_errors import PERFECT
from trecsim.lab.simulation.scene import Clock, PathWalkers, Scene, simulate
from trecsim.values import FrameSet, Poses2D

ACROSS, BESIDE = path((0, -2, 0), (4, 2, 0)), path((0, -2, 1.5), (4, 2, 1.5))
CORNERS = made([ACROSS], seconds=0.1).rig


def seen_by(rig, paths=(ACROSS, BESIDE), seconds=3.0, seed=0):
    clocks = tuple(Clock(25.0) for _ in rig)
    return simulate(Scene(rig, PathWalkers(tuple(paths)), seconds, NOISE, clocks), seed)


def follow(scene, rig=None):
    tracker = Tracker(rig or scene.rig)
    return [tracker.step(s) for s in frame_sets(scene)]


def assert_finite(snapshots):
    assert all(np.isfinite(s.xyz_m).all() and np.isfinite(s.cov_m2).all() for s in snapshots)


def at_one_place(count):
    """Return the room's rig with so many of its cameras standing where the first does."""
    first = CORNERS.cameras[0]
    return Rig(
        tuple(
            replace(c, T_cam_world=first.T_cam_world) if n < count else c
            for n, c in enumerate(CORNERS)
        )
    )


def test_cameras_at_the_same_place_make_nobody_of_themselves():
    snapshots = follow(seen_by(at_one_place(4)))
    assert {len(s.id) for s in snapshots} == {0}


def test_two_cameras_at_the_same_place_are_two_of_four():
    scene = seen_by(at_one_place(2))
    snapshots = follow(scene)
    result = outcome(scene, snapshots)
    assert_finite(snapshots)
    assert result.switches == 0
    assert np.nanmean(result.error_m[25:]) < 0.05


def low_camera(name, K):
    """Return a camera at breast height in the middle of the room."""
    R = np.array([[0.0, -1.0, 0.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]])
    T = np.eye(4)
    T[:3, :3] = R
    T[:3, 3] = -R @ [0.0, 0.0, 1.0]
    return Camera(name, (1920, 1080), K, T)


@pytest.mark.parametrize("others", [2, 3])
def test_whoever_walks_through_a_camera_is_followed_by_the_others(others):
    low = low_camera("low", CORNERS.cameras[0].K)
    scene = seen_by(Rig((low, *CORNERS.cameras[:others])))
    snapshots = follow(scene)
    result = outcome(scene, snapshots)
    assert_finite(snapshots)
    assert result.switches == 0
    assert np.isnan(result.error_m[25:]).mean() < 0.02
    assert np.nanmean(result.error_m[25:]) < 0.06


def test_whoever_walks_through_one_of_two_cameras_makes_nothing_infinite():
    low = low_camera("low", CORNERS.cameras[0].K)
    assert_finite(follow(seen_by(Rig((low, CORNERS.cameras[0])))))


def test_a_camera_that_the_rig_has_the_wrong_way_round_is_ignored():
    """For it, everybody it sees is behind it."""
    scene = seen_by(CORNERS)
    back = np.diag([-1.0, 1.0, -1.0, 1.0])
    first, *others = CORNERS.cameras
    rig = Rig((replace(first, T_cam_world=back @ first.T_cam_world), *others))
    result = outcome(scene, follow(scene, rig))
    assert result.ids == {0, 1}
    assert np.nanmean(result.error_m[25:]) < 0.05


@pytest.mark.parametrize("far_m", [1e3, 9e4])
def test_a_world_whose_origin_is_far_away_costs_nothing(far_m):
    scene = seen_by(CORNERS, seconds=2.0)
    T = np.eye(4)
    T[:2, 3] = -far_m
    moved = Rig(tuple(replace(c, T_cam_world=c.T_cam_world @ T) for c in CORNERS))
    for here, there in zip(follow(scene), follow(scene, moved), strict=True):
        np.testing.assert_array_equal(here.id, there.id)
        np.testing.assert_allclose(
            here.xyz_m + np.array([far_m, far_m, 0.0]), there.xyz_m, atol=1e-3
        )


def test_somebody_who_stands_still_for_minutes_stays_the_same_and_as_certain():
    scene = made([path((0, 0.5, 0.3), (12, 0.5, 0.3))], seconds=12.0, fps=10.0, detector=NOISE)
    sets, tracker = frame_sets(scene, 10.0), Tracker(scene.rig)
    snapshots = []
    for turn in range(6):
        for s in sets:
            views = tuple(replace(v, t_s=v.t_s + 12.0 * turn) for v in s.views)
            snapshots.append(tracker.step(FrameSet(s.t_s + 12.0 * turn, views)))
    assert {tuple(s.id.tolist()) for s in snapshots} == {(0,)}
    sigma_m = np.array([s.sigma_m.mean() for s in snapshots]).reshape(6, -1).mean(axis=1)
    error_m = outcome(scene, [replace(s, t_s=s.t_s % 12.0) for s in snapshots]).error_m
    assert sigma_m[-1] == pytest.approx(sigma_m[1], rel=0.02)
    assert error_m[-120:].mean() < 1.05 * error_m[120:240].mean()
    assert max(tracker.held) <= 1


finite_px = st.floats(-1e4, 1e4, allow_nan=False)
any_px = st.one_of(finite_px, st.sampled_from([np.nan, np.inf, -np.inf, 1e300, -1e300, 1e9, 0.0]))
any_score = st.one_of(st.floats(0.0, 1.0), st.sampled_from([np.nan, -1.0, 7.0, np.inf]))


@st.composite
def garbage(draw):
    """Draw an image: any camera, any time, any people."""
    people = draw(st.integers(0, 4))
    return Poses2D(
        draw(st.sampled_from(CORNERS.names)),
        draw(st.one_of(st.floats(-1.0, 3.0), st.sampled_from([-1e12, 1e12, 100.0, 1e300]))),
        draw(hnp.arrays(np.float64, (people, 17, 2), elements=any_px)),
        draw(hnp.arrays(np.float64, (people, 17), elements=any_score)),
        draw(hnp.arrays(np.float64, people, elements=any_score)),
    )


GOOD = frame_sets(made([ACROSS, BESIDE], seconds=3.0, detector=PERFECT))


@settings(max_examples=often(8))
@given(st.data())
def test_no_garbage_between_good_images_raises_or_makes_anybody_infinite(data):
    tracker = Tracker(CORNERS)
    for s in GOOD[:15]:
        tracker.step(s)
    for s in GOOD[15:25]:
        rubbish = tuple(data.draw(st.lists(garbage(), max_size=3)))
        views = (*s.views, *rubbish) if data.draw(st.booleans()) else s.views
        for frame_set in (FrameSet(s.t_s, views), FrameSet(s.t_s, rubbish)):
            assert_finite([tracker.step(frame_set)])
    assert tracker.held.tracks < 20
    assert tracker.held.unassigned < 100


@settings(max_examples=often(30))
@given(st.lists(garbage(), min_size=1, max_size=40), st.sampled_from([0.0, 0.3]))
def test_garbage_alone_raises_nothing_and_makes_nobody_infinite(images, lag_s):
    tracker = Tracker(CORNERS, lag_s=lag_s)
    for image in images:
        assert_finite([tracker.step(FrameSet(image.t_s, (image,)))])


@settings(max_examples=often(20))
@given(st.integers(1, 30).filter(lambda n: n != 17), st.sampled_from([0.0, np.nan, np.inf]))
def test_what_cannot_be_a_pose_is_refused_and_changes_nothing(joints, t_s):
    tracker = Tracker(CORNERS)
    before = tracker.step(GOOD[0])
    empty = Poses2D(CORNERS.names[0], t_s, np.empty((0, joints, 2)), np.empty((0, joints)),
                    np.empty(0))  # fmt: skip
    with pytest.raises(InputError):
        tracker.step(FrameSet(0.0, (GOOD[1].views[0], empty)))
    again = tracker.step(GOOD[0])
    np.testing.assert_array_equal(before.xyz_m, again.xyz_m)
