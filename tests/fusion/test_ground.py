"""The ground under people: learnt, and what it says of a body that one camera sees."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fusion.made import frame_sets, made, outcome, path
from fusion.somebody import MODEL
from trecsim.fusion import FusionSettings, Tracker
from trecsim.fusion.body import contact_height_m
from trecsim.fusion.kernels.ground import ground_contact, learn_level, lowest, raise_to_ground
from trecsim.skeleton import COCO17
from trecsim.values import FrameSet

REST_M = contact_height_m(COCO17)
SURE = np.tile(np.eye(3) * 0.01**2, (17, 1, 1))
STEP_S = 0.04


def standing(level_m):
    x = np.tile([0.3, -0.2, 1.2], (17, 1))
    x[COCO17.index("left_ankle"), 2] = level_m + 0.08
    x[COCO17.index("right_ankle"), 2] = level_m + 0.20  # in the air
    return x


def learnt(level, heights, n_seen=2):
    level = np.array(level)
    for height in heights:
        learn_level(standing(height), SURE, np.full(17, n_seen), REST_M, level, STEP_S)
    return level


def test_the_kernels_know_how_high_joints_are_that_rest():
    assert MODEL.limbs.contact_height_m.tolist() == REST_M.tolist()


def test_a_body_rests_on_its_lowest_joint():
    assert lowest(standing(0.0), REST_M) == COCO17.index("left_ankle")
    lying = np.tile([0.0, 0.0, 0.3], (17, 1))
    lying[COCO17.index("right_hip"), 2] = 0.10
    assert lowest(lying, REST_M) == COCO17.index("right_hip")


def test_the_ground_is_learnt_where_two_cameras_look():
    level = learnt([0.0, 0.3**2], [0.35] * 50)
    assert abs(level[0] - 0.35) < 0.02
    assert level[1] < 0.03**2


def test_where_one_camera_looks_the_ground_only_gets_less_known():
    level = learnt([0.1, 0.02**2], [0.35] * 50, n_seen=1)
    assert level[0] == 0.1
    assert level[1] > 0.02**2


def test_the_ground_rises_with_somebody_on_stairs_and_not_with_somebody_who_jumps():
    known = [0.0, 0.02**2]
    stairs = learnt(known, 0.3 * STEP_S * np.arange(100))
    assert abs(stairs[0] - 0.3 * STEP_S * 99) < 0.2
    jump = learnt(known, [0.4] * 10)
    assert abs(jump[0]) < 0.01


def test_somebody_who_floats_is_brought_down_and_somebody_who_jumps_is_not():
    level = np.array([0.0, 0.02**2])
    loose = SURE * 30.0**2
    joint, rise_m, variance_m2 = ground_contact(standing(0.3), loose, REST_M, level)
    assert joint == COCO17.index("left_ankle")
    assert rise_m == pytest.approx(-0.3)
    assert 0.0 < variance_m2 < 0.05**2
    assert ground_contact(standing(0.3), SURE, REST_M, level)[0] == -1


def test_one_camera_keeps_the_distance_of_somebody_who_walks_for_four_seconds():
    scene = made([path((0, -2, 0), (8, 2, 0))], seconds=7.5)
    eye = scene.rig.names[0]
    sets = [
        s if s.t_s < 3 else FrameSet(s.t_s, tuple(v for v in s.views if v.camera == eye))
        for s in frame_sets(scene)
    ]
    tracker = Tracker(scene.rig, FusionSettings(single_view_death_s=60.0))
    result = outcome(scene, [tracker.step(s) for s in sets if s.views])
    assert result.ids == {0}
    assert np.nanmax(result.error_m[50:]) < 0.45
    assert not np.isnan(result.error_m[50:]).any()


def raised(height_m, cov_m2, level=(0.1, 0.01**2)):
    x = np.tile([0.3, -0.2, height_m], (17, 1))
    raise_to_ground(np.array(level), x, np.tile(cov_m2, (17, 1, 1)))
    return x[0]


def test_a_joint_below_the_ground_comes_up_to_it_and_others_stay():
    loose = np.diag([0.05, 0.05, 0.2]) ** 2
    assert raised(-0.1, loose)[2] == pytest.approx(0.1, abs=0.01)
    assert raised(0.101, loose).tolist() == [0.3, -0.2, 0.101]


def test_a_joint_comes_up_along_the_ray_on_which_it_is_uncertain():
    ray = np.array([0.6, 0.0, 0.8])
    x = raised(-0.05, 0.5**2 * np.outer(ray, ray) + 1e-6 * np.eye(3))
    np.testing.assert_allclose((x[:2] - [0.3, -0.2]) / (x[2] + 0.05), [0.75, 0.0], atol=1e-3)


def test_a_joint_that_is_surely_lower_shows_that_there_are_stairs():
    assert raised(-0.3, 0.02**2 * np.eye(3))[2] == -0.3


@given(st.floats(-0.5, 0.5), st.floats(0.005, 1.0), st.floats(0.0, 0.3))
def test_no_joint_passes_the_ground_on_its_way_up(height_m, sigma_m, ground_sigma_m):
    z = raised(height_m, sigma_m**2 * np.eye(3), (0.1, ground_sigma_m**2))[2]
    assert min(height_m, 0.1) <= z <= max(height_m, 0.1)
