"""Automatic repairs of a rig: what is taken, what is refused, and how it is taken back."""

import json
from dataclasses import replace

import numpy as np
import pytest

from made_rigs import ring
from trecsim.errors import SetupError
from trecsim.geometry import Rig
from trecsim.geometry.rigid import rotation_matrix
from trecsim.health import CameraHealth, Health
from trecsim.service.repair_job import Repaired
from trecsim.service.rig_keeper import AGAIN_S, NEEDED_S, RigKeeper, turned_deg
from trecsim.service.rig_repairs import RigRepairs
from trecsim.values import Poses2D

MOVED = Health(0.0, {"cam0": CameraHealth("live", moved_deg=2.1, moved_since_s=10.0),
                     "cam1": CameraHealth("live"), "cam2": CameraHealth("live")})  # fmt: skip
WELL = Health(0.0, {name: CameraHealth("live") for name in ("cam0", "cam1", "cam2")})


def turned(rig, **turn_deg):
    """Return a rig with cameras turned about their x axis."""
    cameras = []
    for camera in rig:
        T = camera.T_cam_world.copy()
        T[:3] = rotation_matrix(np.radians([turn_deg.get(camera.name, 0.0), 0.0, 0.0])) @ T[:3]
        cameras.append(replace(camera, T_cam_world=T))
    return Rig(tuple(cameras))


class Job:
    """A repair that ends at once."""

    def __init__(self, result):
        self.made, self.closed = result, False

    def result(self):
        return self.made

    def close(self):
        self.closed = True


class Site:
    """A keeper, a clock, and what the repairs that it begins will find."""

    def __init__(self, folder, result=None, automatic=True):
        self.rig, self.now_s, self.begun, self.job = ring(3), 0.0, [], None
        self.result = result or Repaired(turned(self.rig, cam0=2.0, cam1=0.1), "good", (),
                                         {"cam0": 2.0})  # fmt: skip
        self.repairs = RigRepairs(folder)
        self.keeper = RigKeeper(
            self.rig, self.repairs, automatic=automatic, revoke_by="revoke it",
            clock=lambda: self.now_s, launch=self.launch,
        )  # fmt: skip

    def launch(self, rig, poses, folder):
        self.begun.append([one.t_s for one in poses])
        if isinstance(self.result, Exception):
            raise self.result
        return self.job or Job(self.result)

    def people(self, to_s, cameras=("cam0", "cam1")):
        for t_s in np.arange(0.0, to_s, 0.1):
            for camera in cameras:
                self.keeper.write(Poses2D(camera, t_s, np.ones((1, 17, 2)), np.ones((1, 17)),
                                          np.ones(1)))  # fmt: skip

    def pulses(self, health=MOVED, count=2):
        self.now_s += AGAIN_S
        for _ in range(count):
            self.keeper(health)

    def log(self):
        lines = (self.repairs.folder / "log.jsonl").read_text().splitlines()
        return [json.loads(line)["action"] for line in lines]


def test_a_repair_waits_for_people_who_were_seen_since_the_knock(tmp_path):
    site = Site(tmp_path)
    site.people(10.0 + NEEDED_S)
    site.pulses()
    assert not site.begun
    site.people(14.0 + NEEDED_S)
    site.pulses()
    (used,) = site.begun
    assert min(used) == pytest.approx(13.0, abs=0.06)


def test_a_repair_needs_another_camera(tmp_path):
    site = Site(tmp_path)
    site.people(40.0, cameras=("cam0",))
    site.pulses()
    assert not site.begun


def test_only_the_camera_that_was_named_is_turned(tmp_path):
    site = Site(tmp_path)
    site.people(40.0)
    site.pulses()
    rig = site.keeper.new_rig()
    assert turned_deg(site.rig, rig) == {"cam0": 2.0}
    assert site.keeper.new_rig() is None
    judged = site.keeper.judged(WELL)
    assert judged.cameras["cam0"].repaired_deg == 2.0
    assert judged.cameras["cam1"].repaired_deg is None
    assert site.log() == ["repaired"]


@pytest.mark.parametrize(
    ("verdict", "off", "why"),
    [
        ("wrong", {"cam0": 2.0}, "halves differ"),
        ("good", {}, "does not find 'cam0' off"),
        ("good", {"cam0": 2.0, "cam1": 0.9}, "would turn other cameras"),
    ],
)
def test_a_doubtful_repair_is_refused_and_logged(tmp_path, caplog, verdict, off, why):
    made = Repaired(turned(ring(3), cam0=2.0), verdict, ("halves differ",), off)
    site = Site(tmp_path, made)
    site.people(40.0)
    site.pulses()
    assert site.keeper.new_rig() is None
    assert site.log() == ["refused"]
    assert why in caplog.text


def test_a_repair_is_taken_back_and_not_made_again(tmp_path):
    site = Site(tmp_path)
    site.people(40.0)
    site.pulses()
    site.keeper.new_rig()
    assert RigRepairs(tmp_path).revoke().turn_deg == {"cam0": 2.0}
    site.pulses(count=4)
    assert turned_deg(site.rig, site.keeper.new_rig()) == {}
    assert len(site.begun) == 1
    assert site.log() == ["repaired", "revoked"]
    assert RigRepairs(tmp_path).revoke() is None


def test_a_repair_holds_at_the_next_start_unless_the_rig_has_changed(tmp_path):
    site = Site(tmp_path)
    site.people(40.0)
    site.pulses()
    assert turned_deg(site.rig, Site(tmp_path).keeper.new_rig()) == {"cam0": 2.0}
    other = turned(site.rig, cam2=5.0)
    assert RigRepairs(tmp_path).rig(other) is other
    assert Site(tmp_path, automatic=False).keeper.new_rig() is None


def test_without_the_table_nothing_is_repaired(tmp_path):
    site = Site(tmp_path, automatic=False)
    site.people(40.0)
    site.pulses()
    assert not site.begun


def test_a_damaged_file_of_a_repair_is_no_repair(tmp_path):
    folder = tmp_path / "repairs"
    folder.mkdir()
    for text in ("", "{", "[]", '{"time": 1}'):
        (folder / "current.json").write_text(text)
        assert RigRepairs(tmp_path).current() is None


def test_a_repair_that_runs_when_another_is_taken_back_is_ended(tmp_path):
    site = Site(tmp_path)
    site.people(40.0)
    site.pulses()
    site.keeper.new_rig()
    site.job = running = Job(None)
    site.pulses()  # knocked again
    RigRepairs(tmp_path).revoke()
    running.made = site.result
    site.pulses()
    assert running.closed
    assert turned_deg(site.rig, site.keeper.new_rig()) == {}
    assert RigRepairs(tmp_path).current() is None


def test_a_repair_that_cannot_be_read_for_a_moment_is_not_taken_back(tmp_path, monkeypatch):
    site = Site(tmp_path)
    site.people(40.0)
    site.pulses()
    site.keeper.new_rig()
    monkeypatch.setattr(RigRepairs, "current", lambda repairs: None)  # too many open files
    site.pulses(WELL)
    assert site.keeper.new_rig() is None
    assert site.keeper.repaired_deg == {"cam0": 2.0}


@pytest.mark.parametrize(
    "content",
    ["[" * 100_000, '{"time": 1, "rig": "a", "of_sha256": "b", "reasons": [], "turn_deg": {"c": 1'
     + 400 * "0" + "}}", "\udcff", "[]"],
)  # fmt: skip
def test_a_damaged_repair_is_as_none_and_can_be_taken_back(tmp_path, content):
    repairs = RigRepairs(tmp_path)
    repairs.folder.mkdir()
    (repairs.folder / "current.json").write_bytes(content.encode(errors="surrogateescape"))
    site = Site(tmp_path)
    site.pulses()
    assert site.keeper.new_rig() is None
    assert repairs.revoke().turn_deg == {}
    assert repairs.revoke() is None


def test_a_log_that_cannot_be_written_undoes_no_repair(tmp_path, caplog):
    site = Site(tmp_path)
    (site.repairs.folder / "log.jsonl").mkdir(parents=True)
    site.people(40.0)
    site.pulses()
    assert turned_deg(site.rig, site.keeper.new_rig()) == {"cam0": 2.0}
    assert "log.jsonl cannot be written" in caplog.text
    assert site.repairs.revoke().turn_deg == {"cam0": 2.0}


def test_a_line_cut_by_a_crash_does_not_spoil_the_next(tmp_path):
    repairs = RigRepairs(tmp_path)
    repairs.note("refused")
    with (repairs.folder / "log.jsonl").open("a") as file:
        file.write('{"time": "2026-')
    repairs.note("revoked")
    last = (repairs.folder / "log.jsonl").read_text().splitlines()[-1]
    assert json.loads(last)["action"] == "revoked"


def test_a_repair_that_cannot_begin_or_be_kept_is_refused(tmp_path, caplog):
    site = Site(tmp_path, SetupError("the disk is full"))
    site.people(40.0)
    site.pulses()
    assert "not repaired: the disk is full" in caplog.text
    site = Site(tmp_path / "file")
    (tmp_path / "file").write_text("")
    site.people(40.0)
    site.pulses()
    assert len(site.begun) == 1
    assert site.keeper.new_rig() is None


def test_repairs_that_fail_become_rare(tmp_path):
    site = Site(tmp_path, Repaired(None, "wrong", ("too few people",)))
    site.people(40.0)
    for _ in range(100):
        site.pulses()
    assert len(site.begun) == pytest.approx(7, abs=1)  # within 50 minutes


def test_one_wrong_clock_keeps_no_other_camera_from_being_repaired(tmp_path):
    site = Site(tmp_path)
    for t_s in np.arange(0.0, 40.0, 0.1):
        for camera, late_s in (("cam0", 0.0), ("cam1", 0.0), ("cam2", 1e6)):
            site.keeper.write(Poses2D(camera, t_s + late_s, np.ones((1, 17, 2)), np.ones((1, 17)),
                                      np.ones(1)))  # fmt: skip
    site.pulses()
    assert site.begun


def test_poses_left_by_a_site_that_was_killed_are_deleted_at_the_next_start(tmp_path):
    left = RigRepairs(tmp_path).folder / ".repair-abc"
    left.mkdir(parents=True)
    (left / "poses.jsonl").write_text("{}")
    Site(tmp_path)
    assert not left.exists()
