"""Rigs checked and repaired, and clocks brought into step, by the people in a recording."""

import dataclasses

import numpy as np
import pytest

from made_walkers import LATE_S, recording, turns_deg
from trecsim.calibrating.people.agreeing import Dense, displaced_deg, most_that_agree
from trecsim.calibrating.people.checking import check_rig
from trecsim.calibrating.people.repairing import repair_rig
from trecsim.calibrating.people.syncing import sync_clocks
from trecsim.calibration import write_rig
from trecsim.cli import main
from trecsim.errors import CalibrationError
from trecsim.geometry import Rig
from trecsim.lab.simulation.failures import Knock
from trecsim.store.poses_writer import PosesWriter

KNOCK = Knock("cam2", 12.0, turn_deg=(1.0, 1.5, 0.0))


def in_time(rig):
    """Return the rig with the clocks that the recording has."""
    return Rig(
        tuple(
            dataclasses.replace(camera, time_offset_s=-late)
            for camera, late in zip(rig, LATE_S, strict=True)
        )
    )


@pytest.fixture(scope="module")
def knocked():
    return recording(knocks=(KNOCK,))


def test_no_camera_of_a_right_rig_is_named():
    scene = recording()
    found = check_rig(scene.poses, in_time(scene.rig))
    assert found.off == ()
    assert all(np.isnan(one.since_s) and one.rotation_deg < 0.3 for one in found.cameras)


def test_a_knocked_camera_is_named_with_the_time_and_size_of_the_knock(knocked):
    found = check_rig(knocked.poses, in_time(knocked.rig))
    assert found.off == ("cam2",)
    assert found.cameras[1].since_s == pytest.approx(12.0 + LATE_S[1], abs=1.0)
    assert found.cameras[1].rotation_deg == pytest.approx(1.8, abs=0.3)


def test_the_repaired_rig_is_that_after_the_knock(knocked):
    rig = in_time(knocked.rig)
    made = repair_rig(knocked.poses, rig)
    truth = Rig(tuple(KNOCK.moved(one) if one.name == "cam2" else one for one in rig))
    assert turns_deg(rig, truth).max() > 0.9
    assert turns_deg(made.rig, truth).max() < 0.3
    assert made.result.verdict != "wrong"
    assert any("'cam2' was off" in reason for reason in made.result.reasons)


def test_a_clock_that_is_late_is_named_alone_with_what_is_to_be_added():
    scene = recording()
    cameras = list(in_time(scene.rig))
    cameras[2] = dataclasses.replace(cameras[2], time_offset_s=cameras[2].time_offset_s + 0.08)
    found = check_rig(scene.poses, Rig(tuple(cameras)))
    assert found.off == ("cam3",)
    assert found.cameras[2].time_offset_s == pytest.approx(-0.08, abs=0.02)


@pytest.mark.parametrize("begun_s", [1e3, 1e5, 1.7e9])
def test_clocks_are_as_late_whenever_the_recording_began(begun_s):
    scene = recording()
    rig = in_time(scene.rig)
    here, there = (
        check_rig([dataclasses.replace(one, t_s=one.t_s + s) for one in scene.poses], rig)
        for s in (0.0, begun_s)
    )
    late_s = [[camera.time_offset_s for camera in found.cameras] for found in (here, there)]
    np.testing.assert_allclose(late_s[1], late_s[0], atol=0.002)


def test_a_camera_that_sees_nobody_is_neither_right_nor_off():
    scene = recording()
    seen = [one for one in scene.poses if one.camera != "cam3"]
    found = check_rig(seen, in_time(scene.rig))
    assert found.cameras[2].ok is None
    assert any("'cam3'" in remark for remark in found.remarks)


def test_cameras_that_never_see_the_same_people_are_refused():
    scene = recording()
    alone = [one for one in scene.poses if one.camera == "cam1"]
    with pytest.raises(CalibrationError, match="only camera 'cam1' saw anybody"):
        check_rig(alone, scene.rig)


def test_clocks_are_brought_into_step_by_the_people():
    scene = recording()
    found = sync_clocks(scene.poses, scene.rig, longest_s=20.0)
    offsets = [camera.time_offset_s for camera in found.rig]
    np.testing.assert_allclose(offsets, LATE_S[0] - np.array(LATE_S), atol=0.01)
    assert found.result.verdict == "good"


def test_mended_poses_have_the_times_of_the_first_camera():
    scene = recording()
    found = sync_clocks(scene.poses, scene.rig, longest_s=20.0)
    for camera, late in zip(scene.rig.names, LATE_S, strict=True):
        image = next(one for one in scene.poses if one.camera == camera)
        mended = found.mended(image, scene.rig)
        assert mended.t_s == pytest.approx(image.t_s - late + LATE_S[0], abs=0.01)


def seen_by(rig, cameras):
    """Return points before a rig as it is, seen by cameras that may stand elsewhere."""
    rng = np.random.default_rng(2)
    xyz_m = rng.uniform((-2, -2, 0.2), (2, 2, 1.8), (200, 3))
    z = []
    for camera in cameras:
        there = xyz_m @ camera.T_cam_world[:3, :3].T + camera.T_cam_world[:3, 3]
        z.append(there[:, :2] / there[:, 2:])
    return Dense(np.stack(z, axis=1)), np.stack([camera.T_cam_world for camera in rig])


def test_cameras_that_see_points_where_they_are_are_not_displaced():
    rig = recording().rig
    points, T = seen_by(rig, rig)
    assert displaced_deg(points, T, (0, 1, 2)).max() < 1e-7


def test_the_camera_that_was_moved_is_not_among_those_that_agree():
    rig = recording().rig
    moved = [KNOCK.moved(one) if one.name == "cam2" else one for one in rig]
    points, T = seen_by(rig, moved)
    assert most_that_agree(points, T, 0.2) == (0, 2)


def test_a_camera_that_keeps_its_clock_is_printed_as_such(tmp_path, capsys):
    scene = recording()
    write_rig(in_time(scene.rig), tmp_path / "rig.toml", format="trecsim")
    poses = tmp_path / "walk.poses.jsonl"
    with PosesWriter(poses) as writer:
        for image in scene.poses:
            if image.camera != "cam3":
                writer.write(image)
    rig, out = tmp_path / "rig.toml", tmp_path / "in-step.poses.jsonl"
    with pytest.raises(SystemExit, match="0"):
        main(["sync", str(poses), "--rig", str(rig), "--out", str(out)])
    printed = capsys.readouterr().out
    assert "cam3: keeps its clock" in printed
    assert "nan" not in printed
