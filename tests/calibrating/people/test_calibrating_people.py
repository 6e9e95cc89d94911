"""Cameras calibrated from people who walk: the whole way, on a simulated recording."""

import dataclasses
import re

import numpy as np
import pytest

from made_walkers import LATE_S, recording, turns_deg
from trecsim.calibrating.people.calibrate import calibrate_people
from trecsim.errors import CalibrationError
from trecsim.geometry import Rig
from trecsim.values import Poses2D


@pytest.fixture(scope="module")
def made():
    scene = recording()
    apart_m = float(np.linalg.norm(scene.rig["cam1"].position_m - scene.rig["cam3"].position_m))
    return calibrate_people(
        scene.poses, without_poses(scene.rig), distance=("cam1", "cam3", apart_m)
    )


def without_poses(rig):
    return Rig(tuple(dataclasses.replace(one, T_cam_world=np.eye(4)) for one in rig))


def test_cameras_are_found_within_half_a_degree(made):
    assert turns_deg(made.rig, recording().rig).max() < 0.5


def test_the_given_distance_makes_the_scale(made):
    scene = recording()
    for a, b in (("cam1", "cam2"), ("cam2", "cam3")):
        true_m, found_m = (
            np.linalg.norm(rig[a].position_m - rig[b].position_m) for rig in (scene.rig, made.rig)
        )
        assert found_m == pytest.approx(true_m, rel=0.01)


def test_z_points_up_and_the_floor_is_at_0(made):
    for camera in recording().rig:
        down = made.rig[camera.name].T_cam_world[:3, 2]
        assert np.degrees(np.arccos(down @ camera.T_cam_world[:3, 2])) < 0.7
        assert made.rig[camera.name].position_m[2] == pytest.approx(camera.position_m[2], abs=0.06)


def test_clocks_are_told_by_the_first_camera(made):
    offsets = np.array([camera.time_offset_s for camera in made.rig])
    np.testing.assert_allclose(offsets, LATE_S[0] - np.array(LATE_S), atol=5e-3)
    assert [camera.time_ref_s for camera in made.rig] == [made.result.time_ref_s] * 3


def test_the_covariance_holds_the_truth(made):
    error = turns_deg(made.rig, recording().rig)
    sd = np.array([camera.rotation_sd_deg for camera in made.result.cameras])
    assert (error < 4.0 * sd).all()
    assert (sd < 0.3).all()


def test_the_stature_makes_the_scale_where_no_distance_is_given():
    scene = recording()
    tall = calibrate_people(scene.poses, without_poses(scene.rig), stature_m=1.8)
    short = calibrate_people(scene.poses, without_poses(scene.rig), stature_m=1.6)
    apart = [
        np.linalg.norm(one.rig["cam1"].position_m - one.rig["cam2"].position_m)
        for one in (tall, short)
    ]
    assert apart[0] / apart[1] == pytest.approx(1.8 / 1.6, rel=1e-6)


def test_a_distance_in_other_units_is_refused_with_what_the_people_say():
    scene = recording()
    apart_m = float(np.linalg.norm(scene.rig["cam1"].position_m - scene.rig["cam3"].position_m))
    with pytest.raises(CalibrationError, match="in metres, and between these") as caught:
        calibrate_people(scene.poses, scene.rig, distance=("cam1", "cam3", 100 * apart_m))
    told_m = float(re.search(r"about ([\d.]+) m apart", str(caught.value))[1])
    assert told_m == pytest.approx(apart_m, rel=0.15)


def test_without_distance_and_stature_the_verdict_says_that_the_scale_is_a_guess():
    scene = recording()
    made = calibrate_people(scene.poses, without_poses(scene.rig))
    assert made.result.verdict != "good"
    assert any("--distance" in reason for reason in made.result.reasons)


@pytest.mark.parametrize(("jump_s", "verdicts"), [(0.3, {"wrong"}), (0.0, {"good", "usable"})])
def test_a_clock_that_jumps_while_recording_is_named(jump_s, verdicts):
    scene = recording(seconds=40.0)
    jumped = [
        dataclasses.replace(one, t_s=one.t_s + jump_s)
        if one.camera == "cam2" and one.t_s > LATE_S[1] + 20.0
        else one
        for one in scene.poses
    ]
    apart_m = float(np.linalg.norm(scene.rig["cam1"].position_m - scene.rig["cam3"].position_m))
    made = calibrate_people(jumped, without_poses(scene.rig), distance=("cam1", "cam3", apart_m))
    assert made.result.verdict in verdicts
    told = [reason for reason in made.result.reasons if "the clock of 'cam2' differs" in reason]
    assert len(told) == (jump_s > 0.0)


def test_a_recording_without_people_is_refused_with_how_to_record():
    scene = recording()
    nobody = [
        Poses2D(one.camera, one.t_s, one.xy_px[:0], one.score[:0], np.zeros(0))
        for one in scene.poses[:200]
    ]
    with pytest.raises(CalibrationError, match="no camera saw anybody; let one to three people"):
        calibrate_people(nobody, scene.rig)


def test_a_camera_that_sees_nobody_is_left_out_and_named():
    scene = recording()
    seen = [one for one in scene.poses if one.camera != "cam2"]
    made = calibrate_people(seen, scene.rig)
    assert made.rig.names == ("cam1", "cam3")
    assert np.isnan(made.result.cameras[1].rotation_sd_deg)
    assert any("'cam2'" in reason for reason in made.result.reasons)
