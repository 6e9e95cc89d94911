"""People whom one camera alone sees: provisional at once, in a region that holds the truth."""

import numpy as np
import pytest

from fusion.made import frame_sets, made, path, truth_at
from trecsim.fusion import Tracker
from trecsim.fusion.ground_prior import KnownGround
from trecsim.fusion.images import Detections
from trecsim.fusion.initialisation import first_states
from trecsim.fusion.kernels.body_size import ankle_drop, usual_size_m
from trecsim.fusion.model import build
from trecsim.fusion.settings import FusionSettings
from trecsim.fusion.single_views import first_ranges
from trecsim.fusion.spline import KnotGrid
from trecsim.fusion.tuning import MOST_SINGLE_VIEWS
from trecsim.lab.simulation.detector_errors import PERFECT, Detector
from trecsim.lab.simulation.room import corner_rig
from trecsim.skeleton import COCO17
from trecsim.values import CONFIRMED, PROVISIONAL, FrameSet, Poses2D

ACROSS = path((0, -2, 0), (6, 2, 0))
BESIDE = path((0, -2, 1.5), (6, 2, 1.5))
CALM = Detector(missing_person=0.0, false_people=0.0)
TORSO = [5, 6, 11, 12]
IN_90 = 6.251  # of chi squared with three degrees of freedom


def people_only(view, which):
    return Poses2D(
        view.camera, view.t_s, view.xy_px[which], view.score[which], view.person_score[which]
    )


def together(view, other):
    parts = (
        (getattr(v, name) for v in (view, other)) for name in ("xy_px", "score", "person_score")
    )
    return Poses2D(view.camera, view.t_s, *(np.concatenate(list(part)) for part in parts))


def seen_by(scene, keep):
    """Return the frame sets with only the detections that `keep` names by camera and time."""
    cameras = scene.rig.names
    return [
        FrameSet(
            s.t_s,
            tuple(people_only(v, keep(cameras.index(v.camera), v.t_s, v)) for v in s.views),
        )
        for s in frame_sets(scene)
    ]


def first_camera_until(t_s):
    return lambda cam, then_s, view: slice(None) if cam == 0 or then_s >= t_s else slice(0)


def follow(scene, sets, **options):
    tracker = Tracker(scene.rig, provisional=True, **options)
    return [tracker.step(s) for s in sets]


def test_whom_one_camera_sees_is_provisional_within_a_fifth_of_a_second():
    scene = made([ACROSS], cameras=2, detector=CALM, seconds=2.0)
    snapshots = follow(scene, seen_by(scene, first_camera_until(9.0)))
    assert [len(s.id) for s in snapshots if s.t_s >= 0.2] == [1] * sum(
        s.t_s >= 0.2 for s in snapshots
    )
    assert {str(state) for s in snapshots for state in s.state} == {PROVISIONAL}


def test_a_provisional_person_is_confirmed_under_the_same_identity_when_two_cameras_see_it():
    scene = made([ACROSS], cameras=2, detector=CALM, seconds=3.0)
    snapshots = follow(scene, seen_by(scene, first_camera_until(1.5)))
    assert {int(i) for s in snapshots for i in s.id} == {0}
    assert {str(s.state[0]) for s in snapshots if 0.2 < s.t_s < 1.5} == {PROVISIONAL}
    assert {str(s.state[0]) for s in snapshots if s.t_s > 1.9} == {CONFIRMED}


def test_a_lag_leaves_no_gap_while_somebody_becomes_confirmed():
    scene = made([ACROSS], cameras=2, detector=CALM, seconds=3.0)
    snapshots = follow(scene, seen_by(scene, first_camera_until(1.5)), lag_s=0.2)
    assert {len(s.id) for s in snapshots if s.t_s > 0.1} == {1}
    assert {int(i) for s in snapshots for i in s.id} == {0}


def test_a_camera_that_alone_sees_somebody_supports_them_with_a_lag_too():
    scene = made([ACROSS], cameras=2, detector=CALM, seconds=2.0)
    snapshots = follow(scene, seen_by(scene, first_camera_until(9.0)), lag_s=0.2)
    supports = [s.support[0].max() for s in snapshots if len(s.id) and s.t_s > 0.1]
    assert len(supports) > 30
    assert np.mean(supports) > 0.9


@pytest.mark.parametrize("lag_s", [0.6, 1.0])
def test_a_long_lag_hides_nobody_whom_one_camera_sees(lag_s):
    """The window of the trajectories grows with the lag; what is known of a new track does not."""
    scene = made([ACROSS], cameras=2, detector=CALM, seconds=2.0)
    snapshots = follow(scene, seen_by(scene, first_camera_until(9.0)), lag_s=lag_s)
    assert {len(s.id) for s in snapshots if s.t_s > 0.1} == {1}


def test_confirmed_people_are_exactly_the_same_beside_somebody_whom_one_camera_sees():
    alone, other = (
        made([way], cameras=2, detector=PERFECT, seconds=3.0) for way in (ACROSS, BESIDE)
    )
    first = seen_by(alone, lambda cam, t_s, view: slice(None))
    both = [
        FrameSet(s.t_s, tuple(map(together, s.views, more.views)))
        for s, more in zip(
            first,
            seen_by(other, lambda cam, t_s, view: slice(None if cam == 0 else 0)),
            strict=True,
        )
    ]
    pairs = list(zip(follow(alone, first), follow(alone, both), strict=True))
    assert sum(PROVISIONAL in beside.state for _, beside in pairs) > 50
    for one, beside in pairs:
        np.testing.assert_array_equal(one.xyz_m, beside.confirmed().xyz_m)
        np.testing.assert_array_equal(one.cov_m2, beside.confirmed().cov_m2)
        np.testing.assert_array_equal(one.support, beside.confirmed().support)


@pytest.mark.parametrize("images", [3, 10_000], ids=["blinking", "lasting"])
def test_a_false_positive_of_one_camera_is_never_confirmed(images):
    """One that lasts for three images is not even provisional: its key points are weak."""
    scene = made([ACROSS], cameras=2, detector=PERFECT, seconds=4.0)
    rng = np.random.default_rng(0)
    sets = []
    for n, s in enumerate(seen_by(scene, first_camera_until(9.0))):
        seen = n % 12 < images
        views = tuple(
            Poses2D(
                v.camera, v.t_s, v.xy_px[:seen] + rng.normal(0, 2, v.xy_px[:seen].shape),
                np.full(v.score[:seen].shape, 0.4), v.person_score[:seen],
            )
            for v in s.views
        )  # fmt: skip
        sets.append(FrameSet(s.t_s, views))
    states = [str(state) for s in follow(scene, sets) for state in s.state]
    assert set(states) == (set() if images == 3 else {PROVISIONAL})


def test_a_provisional_person_is_gone_half_a_second_after_its_camera_saw_it_last():
    scene = made([ACROSS], cameras=2, detector=CALM, seconds=4.0)
    sets = seen_by(scene, lambda cam, t_s, view: slice(None if cam == 0 and t_s < 2.0 else 0))
    snapshots = follow(scene, sets)
    assert {len(s.id) for s in snapshots if 0.5 < s.t_s < 2.0} == {1}
    assert {len(s.id) for s in snapshots if s.t_s > 2.55} == {0}


def test_the_region_of_who_walks_towards_one_camera_and_away_holds_the_place():
    """For ten seconds and four people of any size: nine of ten moments, and not by being huge."""
    inside, sigma_m = [], []
    for seed in range(4):
        way = path((0, 2.5, 2), (5, -2.0, -1.5), (10, 2.5, 2))
        scene = made([way], cameras=2, detector=CALM, seconds=10.0, seed=seed)
        eye_m = scene.rig.cameras[0].position_m
        for s in follow(scene, seen_by(scene, first_camera_until(99.0)))[10:]:
            assert len(s.id) == 1
            truth_m = truth_at(scene, s.t_s)[0, TORSO].mean(axis=0)
            off_m = s.xyz_m[0, TORSO].mean(axis=0) - truth_m
            cov_m2 = s.cov_m2[0, TORSO].mean(axis=0)
            inside.append(off_m @ np.linalg.solve(cov_m2, off_m) < IN_90)
            ray = (truth_m - eye_m) / np.linalg.norm(truth_m - eye_m)
            sigma_m.append(np.sqrt(ray @ cov_m2 @ ray) / np.linalg.norm(truth_m - eye_m))
    assert np.mean(inside) >= 0.9
    assert np.median(sigma_m) < 0.08


def test_a_body_of_usual_size_in_the_upright_plane_is_at_its_distance():
    """With the joints of the prior's own lengths, and both ankles on the ground."""
    model = build(corner_rig(7.0, 6.0, 2.7, 2), COCO17, FusionSettings())
    eye_m = model.cameras.position_m[0]
    ahead = model.rig.cameras[0].T_cam_world[2, :2]
    ahead = ahead / np.linalg.norm(ahead)
    aside = np.array([-ahead[1], ahead[0]])
    z_m = {"ankle": 0.08, "knee": 0.49, "hip": 0.91, "shoulder": 1.41}
    xyz_m = np.full((17, 3), np.nan)
    for j, name in enumerate(COCO17.joints):
        side, _, part = name.partition("_")
        if part in z_m:
            floor_m = eye_m[:2] + 4.0 * ahead + (0.12 if side == "left" else -0.12) * aside
            xyz_m[j] = *floor_m, z_m[part]
    known = np.isfinite(xyz_m[:, 0])
    xy_px = np.full((1, 17, 2), np.nan)
    homogeneous = xyz_m[known] @ model.cameras.P[0, :, :3].T + model.cameras.P[0, :, 3]
    xy_px[0, known] = homogeneous[:, :2] / homogeneous[:, 2:]
    found = Detections(np.zeros(1, int), np.zeros(1), xy_px, np.ones((1, 17)), -np.ones(1, int))
    _, agrees, at_one_m = first_ranges(found, (0.0, 0.01), model)
    assert agrees.all()
    assert usual_size_m(model.ruler, at_one_m[0]) == pytest.approx(4.0, rel=0.01)
    drop, _, n_ankle = ankle_drop(model.ruler, at_one_m[0], np.ones(17))
    assert n_ankle == 2
    assert (eye_m[2] - 0.08) / drop == pytest.approx(4.0, rel=1e-3)


def test_the_ground_under_newcomers_is_learnt_from_people_before_them():
    model = build(corner_rig(7.0, 6.0, 2.7, 2), COCO17, FusionSettings())
    people = first_states([], 0.0, KnotGrid(0.0, 0.1, 9), model)
    ground = KnownGround()
    assert ground.expected(people) == pytest.approx((0.0, 0.3**2))
    flat, stairs = KnownGround(), KnownGround()
    flat._level_m.extend([-0.5] * 10)
    stairs._level_m.extend([0.0, 1.0] * 5)
    level_m, var_m2 = flat.expected(people)
    assert level_m == pytest.approx(-0.5, abs=0.03)
    assert var_m2 < 0.15**2
    assert stairs.expected(people)[1] > 0.4**2


@pytest.mark.parametrize("posture", ["walks", "stays"])
def test_whom_two_cameras_knew_is_held_in_place_before_one(posture):
    """For ten seconds; the region holds the place, and is narrower than that of somebody new."""
    far = {"walks": ((2, 0, 0), (7, -2.0, -1.5), (12, 2.0, 1.5)), "stays": ((12, 0.1, 0),)}
    scene = made(
        [path((0, -0.2, 0), *far[posture])], cameras=2, detector=CALM, seconds=12.0, seed=3
    )
    sets = seen_by(scene, lambda cam, t_s, view: slice(None if cam == 0 or t_s < 2.0 else 0))
    eye_m = scene.rig.cameras[0].position_m
    inside, off, sigma = [], [], []
    for s in follow(scene, sets)[60:]:
        assert s.id.tolist() == [0]
        truth_m = truth_at(scene, s.t_s)[0, TORSO].mean(axis=0)
        off_m = s.xyz_m[0, TORSO].mean(axis=0) - truth_m
        cov_m2 = s.cov_m2[0, TORSO].mean(axis=0)
        far_m = np.linalg.norm(truth_m - eye_m)
        ray = (truth_m - eye_m) / far_m
        inside.append(off_m @ np.linalg.solve(cov_m2, off_m) < IN_90)
        off.append(abs(off_m @ ray) / far_m)
        sigma.append(np.sqrt(ray @ cov_m2 @ ray) / far_m)
    assert np.mean(inside) >= 0.9
    assert np.median(off) < 0.05
    assert np.median(sigma) < 0.06


def test_a_crowd_of_false_positives_begins_no_more_tracks_than_there_may_be():
    """The same body at 60 places of one image: more than one camera's tracks may be."""
    scene = made([ACROSS], cameras=2, detector=PERFECT, seconds=1.0)
    sets = seen_by(scene, first_camera_until(9.0))
    tracker, most = Tracker(scene.rig, provisional=True), 0
    for one in sets:
        views = []
        for view in one.views:
            if len(view.xy_px):
                xy_px = view.xy_px[0] - view.xy_px[0].mean(axis=0)
                places = np.stack(np.meshgrid(np.linspace(60, 1200, 12), np.linspace(150, 500, 5)))
                xy_px = 0.4 * xy_px + places.reshape(2, -1).T[:, None]
                score = np.tile(view.score[0], (len(xy_px), 1))
                view = Poses2D(view.camera, view.t_s, xy_px, score, np.ones(len(xy_px)))
            views.append(view)
        tracker.step(FrameSet(one.t_s, tuple(views)))
        most = max(most, tracker.held.single_views)
    assert 10 < most <= MOST_SINGLE_VIEWS
