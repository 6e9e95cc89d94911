"""What `follow` is given by mistake is named in one line."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from made_rigs import ring
from trecsim.errors import ConfigError, InputError
from trecsim.fusion import FusionSettings
from trecsim.fusion.arguments import check_arguments
from trecsim.geometry import Rig
from trecsim.skeleton import COCO17
from trecsim.store.rows import rows_of
from trecsim.store.timing_csv import StepTiming
from trecsim.tracking import Tally, _Reach, follow
from trecsim.values import Poses2D, Snapshot

RIG = Rig(tuple(ring(2)))
IMAGE = Poses2D("cam0", 0.0, np.empty((0, 17, 2)), np.empty((0, 17)), np.empty(0))


@pytest.mark.parametrize(
    ("poses", "rig", "told"),
    [
        (RIG, [IMAGE], "rig must be a Rig, .* got a list"),
        ([IMAGE], "rig.toml", "the text 'rig.toml'; read the file first"),
        ([IMAGE], Path("rig.toml"), "the text 'rig.toml'; read the file first"),
        ([IMAGE], None, "got nothing"),
        (RIG, RIG, "poses must be 2D poses one by one, .* got a Rig"),
        ("walk.poses.jsonl", RIG, "read_poses.*the text 'walk.poses.jsonl'"),
        (IMAGE, RIG, "got a Poses2D"),
        (None, RIG, "got nothing"),
    ],
)
def test_poses_and_rig_that_are_something_else_are_refused_at_once(poses, rig, told):
    with pytest.raises(InputError, match=told):
        follow(poses, rig)


def test_something_else_among_the_poses_is_refused():
    with pytest.raises(InputError, match="among them is the number 3"):
        list(follow([IMAGE, 3], RIG))


@pytest.mark.parametrize("lag_s", [-1, -1e-9, float("nan"), float("inf"), 10.5, "0.1", None, True])
def test_a_lag_that_is_no_time_to_wait_is_refused_at_once(lag_s):
    with pytest.raises(ConfigError, match="the lag must "):
        follow([IMAGE], RIG, lag_s=lag_s)


@pytest.mark.parametrize("settings", [0.5, "site.toml", {"knot_s": 0.1}, RIG])
def test_settings_that_are_something_else_are_refused_at_once(settings):
    with pytest.raises(ConfigError, match="settings must be FusionSettings"):
        follow([IMAGE], RIG, settings)


def test_rig_and_settings_exchanged_are_told():
    with pytest.raises(InputError, match="the rig comes before the settings"):
        check_arguments(FusionSettings(), RIG, COCO17, 0.0)


def test_a_skeleton_that_is_a_name_is_refused():
    with pytest.raises(InputError, match="the text 'coco17'"):
        check_arguments(RIG, None, "coco17", 0.0)


def test_more_joints_than_there_are_can_be_asked_of_nobody():
    check_arguments(RIG, FusionSettings(min_joints=17), COCO17, 0.0)
    with pytest.raises(ConfigError, match=r"min_joints = 18 .* has 17 joints"):
        check_arguments(RIG, FusionSettings(min_joints=18), COCO17, 0.0)


def crowd(xyz_m, sigma_m):
    cov_m2 = np.eye(3) * np.array(sigma_m, float)[..., None, None] ** 2
    n = len(xyz_m)
    return Snapshot(1.0, np.arange(n), xyz_m, cov_m2, np.ones((n, 17), np.int64))


def test_people_who_are_nowhere_are_left_out_and_told_once(caplog):
    xyz_m, sigma_m = np.ones((6, 17, 3)), np.full((6, 17), 0.02)
    xyz_m[0, 3, 1], xyz_m[1, 16] = 1e300, np.nan
    xyz_m[2, 0, 2], xyz_m[4, 2, 0] = -np.inf, 9e3
    sigma_m[3, 5] = 1e30
    reach = _Reach(RIG)

    kept = reach.kept(crowd(xyz_m, sigma_m))
    reach.kept(crowd(xyz_m, sigma_m))

    assert kept.id.tolist() == [4, 5]
    np.testing.assert_array_equal(kept.xyz_m, xyz_m[4:])
    assert np.isfinite(rows_of(kept)["xyz_m"]).all()
    assert [record.getMessage() for record in caplog.records] == [
        "at 1.000 s, person 0 had no position within 10 km of the cameras and is left out, "
        "as are all such people later; check the settings of the fusion and the rig"
    ]


def test_people_far_from_the_origin_stay_where_the_cameras_are():
    far_m = np.array([5e5, 5e5, 0.0])
    rig = Rig(tuple(replace(c, T_cam_world=shifted(c.T_cam_world, far_m)) for c in RIG))
    assert len(_Reach(rig).kept(crowd(np.ones((1, 17, 3)) + far_m, np.ones((1, 17)))).id) == 1


def shifted(T_cam_world, by_m):
    moved = T_cam_world.copy()
    moved[:3, 3] -= T_cam_world[:3, :3] @ by_m
    return moved


def test_a_clock_that_drifts_is_put_right_by_the_rig():
    first, second = RIG
    slow = replace(second, time_offset_s=3.0, time_drift_ppm=2000.0, time_ref_s=500.0)
    images = [
        replace(IMAGE, camera=camera.name, t_s=stamp_s)
        for index in range(100)
        for camera, stamp_s in ((first, 0.04 * index), (slow, slow.stamp_s(0.04 * index)))
    ]
    tally = Tally()
    times_s = [snapshot.t_s for snapshot in follow(images, Rig((first, slow)), tally=tally)]
    assert tally.frame_sets == 100  # of two images each: the clocks agree
    np.testing.assert_allclose(times_s, 0.04 * np.arange(100), atol=1e-9)


def test_a_run_of_months_counts_everybody_once_and_does_not_remember_everybody():
    tally, step = Tally(), StepTiming(t_s=0.0, images=2, people=3, fusion_ms=0.1)
    for newest in range(2, 30_000):  # one person stays, the others come and go
        tally.add(step, [0, newest - 1, newest])
    assert tally.people == 30_000
    assert len(tally._recent) == 10_000
