"""Cameras that were moved while a site runs are named by the people who are tracked."""

import dataclasses

import numpy as np
import pytest

from trecsim.consistency.view_watch import ViewWatch
from trecsim.lab.simulation.failures import Knock
from trecsim.lab.simulation.room import corner_rig
from trecsim.values import Poses2D, Snapshot

RIG = corner_rig(8.0, 6.0, 2.7)
BODY_M = np.array([[0.0, 0.1 * (j % 3), 0.1 * j] for j in range(17)])


def walked(watch, seconds, moved=None, cameras=RIG.names, people=1):
    """Let people walk in circles before cameras, one of which was moved; return what is told."""
    told = []
    for t_s in np.arange(0.0, seconds, 0.25):
        xyz_m = np.stack(
            [
                BODY_M + np.array([np.cos(t_s / 2 + k), np.sin(t_s / 2 + k), 0.0])
                for k in range(people)
            ]
        )
        cov = np.full((people, 17, 3, 3), 1e-4)
        snapshot = Snapshot(t_s, np.arange(people), xyz_m, cov, np.full((people, 17), 3))
        views = []
        for name in cameras:
            camera = moved if moved is not None and moved.name == name else RIG[name]
            xy_px = camera.project(xyz_m)
            views.append(Poses2D(name, t_s, xy_px, np.ones(xy_px.shape[:2]), np.ones(people)))
        told += watch.observe(views, snapshot)
    return told


def test_nobody_is_named_where_all_cameras_look_where_the_rig_says():
    watch = ViewWatch(RIG)
    assert walked(watch, 12.0) == []
    assert watch.off == {}


@pytest.mark.parametrize("people", [1, 2])
def test_a_camera_that_was_turned_is_named_with_the_turn(people):
    watch = ViewWatch(RIG)
    moved = Knock("cam2", 0.0, turn_deg=(0.0, 2.0, 0.0)).moved(RIG["cam2"])
    (first, *_) = walked(watch, 12.0, moved, people=people)
    assert first.camera == "cam2"
    assert watch.off["cam2"].turn_deg == pytest.approx(2.0, abs=0.25)
    assert watch.off["cam2"].right_deg < 0.0  # it looks to the right: people appear to the left
    assert list(watch.off) == ["cam2"]


def test_it_is_named_within_seconds():
    watch = ViewWatch(RIG)
    moved = Knock("cam3", 0.0, turn_deg=(2.0, 0.0, 0.0)).moved(RIG["cam3"])
    assert walked(watch, 4.0, moved) != []


def test_a_camera_that_was_put_back_is_right_again():
    watch = ViewWatch(RIG)
    walked(watch, 10.0, Knock("cam2", 0.0, turn_deg=(0.0, 2.0, 0.0)).moved(RIG["cam2"]))
    assert "cam2" in watch.off
    for t_s in np.arange(10.0, 20.0, 0.25):
        xyz_m = BODY_M[None] + np.array([np.cos(t_s / 2), np.sin(t_s / 2), 0.0])
        snapshot = Snapshot(
            t_s, np.zeros(1, np.int64), xyz_m, np.full((1, 17, 3, 3), 1e-4), np.full((1, 17), 3)
        )
        views = [Poses2D(c.name, t_s, c.project(xyz_m), np.ones((1, 17)), np.ones(1)) for c in RIG]
        watch.observe(views, snapshot)
    assert watch.off == {}


def test_of_two_cameras_nobody_can_say_which_was_moved():
    watch = ViewWatch(RIG)
    moved = Knock("cam2", 0.0, turn_deg=(0.0, 2.0, 0.0)).moved(RIG["cam2"])
    assert walked(watch, 12.0, moved, cameras=("cam1", "cam2")) == []


def test_people_whom_one_camera_alone_follows_tell_nothing():
    watch = ViewWatch(RIG)
    moved = Knock("cam2", 0.0, turn_deg=(0.0, 2.0, 0.0)).moved(RIG["cam2"])
    snapshot = Snapshot(
        0.0, np.zeros(1, np.int64), BODY_M[None], np.full((1, 17, 3, 3), 1e-4),
        np.ones((1, 17), np.int64),
    )  # fmt: skip
    for t_s in np.arange(0.0, 12.0, 0.5):
        now = dataclasses.replace(snapshot, t_s=float(t_s))
        view = Poses2D("cam2", t_s, moved.project(BODY_M[None]), np.ones((1, 17)), np.ones(1))
        assert watch.observe([view], now) == []
