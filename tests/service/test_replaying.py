"""Recordings on the page."""

import json

import numpy as np
import pytest

from made_rigs import ring
from trecsim.calibration import write_rig
from trecsim.errors import InputError
from trecsim.page.site_view import cameras_of
from trecsim.service.replaying import paced, recording_at, recording_view, replay
from trecsim.service.rig_repairs import keep_rig
from trecsim.store.names import TRACKS
from trecsim.store.parquet_file import TracksInfo
from trecsim.store.recorder import Recorder
from trecsim.values import Snapshot


def snapshot(t_s):
    ones = np.ones((1, 17), int)
    return Snapshot(t_s, np.array([3]), np.zeros((1, 17, 3)), np.zeros((1, 17, 3, 3)), ones)


def make_recording(folder, times_s=(0.0, 0.5, 1.0)):
    folder.mkdir()
    write_rig(ring(3), folder / "rig.toml")
    recorder = Recorder(folder / TRACKS, TracksInfo())
    for t_s in times_s:
        recorder.write(snapshot(1e9 + t_s))
    recorder.close()
    return folder


class Hand:
    """A clock that only waiting moves."""

    def __init__(self):
        self.now_s = 0.0

    def sleep(self, seconds):
        self.now_s += seconds

    def __call__(self):
        return self.now_s


@pytest.mark.parametrize(("speed", "lasts_s"), [(1.0, 2.5), (2.0, 1.75), (100.0, 1.015)])
def test_snapshots_come_at_their_pace_and_long_pauses_are_cut_to_a_second(speed, lasts_s):
    hand = Hand()
    moments = [snapshot(t_s) for t_s in (0.0, 0.5, 1.0, 1.5, 1001.5)]
    given = list(paced(moments, speed, lambda: False, hand, hand.sleep))
    assert [one.t_s for one in given] == [one.t_s for one in moments]
    assert hand.now_s == pytest.approx(lasts_s, abs=1e-6)


def test_it_ends_within_a_moment_when_it_is_told_to():
    hand = Hand()
    moments = [snapshot(float(n)) for n in range(100)]
    given = list(paced(moments, 1.0, lambda: hand.now_s >= 2.5, hand, hand.sleep))
    assert len(given) == 3
    assert hand.now_s < 2.6


def test_a_recording_shows_its_site_as_it_was(tmp_path):
    folder = make_recording(tmp_path / "one")
    assert recording_view(recording_at(folder)).name == "one"
    zone = {"polygon_m": [[0, 0], [1, 0], [1, 1]], "z_m": [0, 2]}
    site = {"name": "hall", "timezone": "Europe/Zurich", "zones": {"door": zone}}
    (folder / "summary.json").write_text(json.dumps({"configuration": site}))
    view = recording_view(recording_at(folder))
    assert (view.name, view.timezone, view.kind) == ("hall", "Europe/Zurich", "recording")
    assert view.zones == {"door": zone}
    assert sorted(view.cameras) == ["cam0", "cam1", "cam2"]


def test_a_recording_shows_its_cameras_as_repaired_last(tmp_path):
    folder = make_recording(tmp_path / "one")
    there = ring(3, radius_m=7.0)
    keep_rig(there, folder, 1e9 + 0.5)
    assert recording_view(recording_at(folder)).cameras == cameras_of(there)
    assert cameras_of(there) != cameras_of(ring(3))


def test_what_is_no_recording_is_told_and_of_several_one_is_to_be_given(tmp_path):
    for nothing in (tmp_path, tmp_path / "gone"):
        with pytest.raises(InputError, match="expected the folder of a recording"):
            recording_at(nothing)
    make_recording(tmp_path / "one")
    make_recording(tmp_path / "two")
    with pytest.raises(InputError, match="holds 2 recordings; give one of them, as"):
        recording_at(tmp_path)


class Shown:
    """A page that keeps what it is shown."""

    def __init__(self):
        self.events, self.healths, self.vehicles = [], [], []

    def write(self, snapshot, vehicles=()):
        self.vehicles.append([(one.volume, one.vehicle, one.xy_m[0]) for one in vehicles])

    def event(self, event):
        self.events.append(event)

    def health(self, health):
        self.healths.append(health)


def test_a_replay_tells_the_events_of_the_rules_that_the_site_had(tmp_path):
    folder = make_recording(tmp_path / "day", times_s=[0.04 * n for n in range(25)])
    zone = {"polygon_m": [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]}
    site = {
        "format": "trecsim.site/1", "name": "hall", "zones": {"all": zone},
        "rules": [{"id": "in", "kind": "zone.enter", "zone": "all", "on_delay_s": 0.2}],
        "rig": {"file": "somewhere else"}, "sources": {"north": {"video": "gone.mp4"}},
    }  # fmt: skip
    (folder / "summary.json").write_text(json.dumps({"configuration": site}))
    page = Shown()
    recording = recording_at(folder)
    replay(recording, page, speed=1000.0, stop=lambda: len(page.healths) > 1)
    assert [one["data"]["rule"]["id"] for one in page.events] == ["in"]
    assert (page.healths[0].rules.armed, page.healths[0].rules.total) == (1, 1)
    assert recording_view(recording).rules == {"armed": 1, "total": 1}


def test_a_replay_shows_the_vehicles_where_their_feed_told_them(tmp_path):
    folder = make_recording(tmp_path / "day", times_s=(0.0, 0.5, 1.0))
    site = {
        "format": "trecsim.site/1", "name": "hall", "feeds": {"yard": {"file": "gone.jsonl"}},
        "volumes": {"truck": {"size_m": [4.0, 2.0, 2.0], "feed": "yard"}},
    }  # fmt: skip
    (folder / "summary.json").write_text(json.dumps({"configuration": site}))
    told = {"feed": "yard", "taken_s": 1e9 + 0.5, "t_s": 1e9 + 0.5, "volume": "truck", "id": "7"}
    (folder / "signals-0000000000.jsonl").write_text(json.dumps({**told, "xy_m": [3, 1]}) + "\n")
    page = Shown()
    replay(recording_at(folder), page, speed=1000.0, stop=lambda: len(page.healths) > 1)
    assert page.vehicles == [[], [("truck", "7", 3.0)], [("truck", "7", 3.0)]]
