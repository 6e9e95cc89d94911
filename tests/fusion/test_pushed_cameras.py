"""A camera that is knocked in mid-run: named within seconds, and its turn taken out."""

from dataclasses import replace

import numpy as np
import pytest

from trecsim.fusion.camera_errors import CameraErrors
from trecsim.lab.simulation import room_scene, simulate
from trecsim.lab.simulation.failures import Knock
from trecsim.lab.simulation.room import corner_rig
from trecsim.service.monitor import Monitor
from trecsim.service.site_parts import parts_of
from trecsim.tracking import Follower

KNOCK = Knock("cam2", 10.0, turn_deg=(1.2, 1.6, 0.0))


@pytest.fixture(scope="module")
def knocked():
    """Follow two people before four cameras; one is knocked by two degrees after 10 s."""
    made = simulate(replace(room_scene(people=2, seconds=20.0), knocks=(KNOCK,)), seed=3)
    follower = Follower(made.rig)
    monitor = Monitor(made.rig.names, rig=made.rig)
    told_s = None
    for image in made.poses:
        monitor.take_poses(image)
        for snapshot in follower.add(image):
            monitor.write(snapshot)
        if told_s is None and monitor.health().cameras["cam2"].moved_deg is not None:
            told_s = image.t_s
    return follower, monitor, told_s


def test_a_knocked_camera_is_named_within_ten_seconds(knocked):
    *_, told_s = knocked
    assert told_s is not None
    assert 10.0 < told_s < 20.0


def test_the_tracker_takes_the_turn_out(knocked):
    follower, *_ = knocked
    turn_deg = np.degrees(follower._tracker.camera_errors.applied[1, :2])
    np.testing.assert_allclose(turn_deg, -np.array(KNOCK.turn_deg[:2]), atol=0.4)


def test_the_health_of_the_site_tells_it_of_that_camera_alone(knocked):
    _, monitor, _ = knocked
    cameras = monitor.health().cameras
    assert cameras["cam2"].moved_deg == pytest.approx(2.0, abs=0.3)
    assert [cameras[name].moved_deg for name in ("cam1", "cam3", "cam4")] == [None] * 3
    (part,) = [p for p in parts_of(monitor.health(), 0.0) if p.verdict == "faulty"
               and p.kind == "camera.moved"]  # fmt: skip
    assert part.place == {"camera": "cam2"}
    assert "camera cam2 looks" in part.said


def test_a_push_is_found_at_once():
    errors = CameraErrors(corner_rig(8.0, 6.0, 2.7))
    errors.push(2, np.array([0.02, -0.03]))
    errors.corrected()
    np.testing.assert_allclose(errors.found[2, :2], (0.02, -0.03), rtol=0.2)
    assert np.abs(errors.found[[0, 1, 3]]).max() < 1e-9
