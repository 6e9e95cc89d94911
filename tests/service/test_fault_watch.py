"""Faults of a site as events: when they begin, get worse and end, at made-up moments."""

from dataclasses import dataclass

import pytest

from trecsim.health import CameraHealth, FusionHealth, Health, StoreHealth
from trecsim.service.fault_watch import OFF_MOST_S, OFF_S, FaultEvents, FaultWatch
from trecsim.service.site_parts import parts_of

UNIX_S = 1.8e9
LIVE = CameraHealth("live", 25.0, 0.05)
RUNNING = FusionHealth("running", 25.0, 1.0, 0.05, 2)
WRITING = StoreHealth("writing")


@dataclass
class Site:
    """A site whose health is set by hand; its clocks are moved by hand too."""

    open_events: tuple = ()
    now_s: float = 0.0

    def __post_init__(self):
        self.events = []
        watch = FaultWatch(
            "hall", self.open_events, people=lambda: [{"person": 7}], clock=lambda: self.now_s
        )
        self.read = True
        self.tell = FaultEvents(watch, self.events.append, lambda: self.read)

    def goes(self, seconds, north=LIVE, fusion=RUNNING, store=WRITING, **more):
        """Let time pass in which the site works like this; return what events came."""
        before = len(self.events)
        for _ in range(round(2 * seconds)):
            self.now_s += 0.5
            cameras = {"north": north, "south": LIVE, **more}
            self.tell(Health(UNIX_S + self.now_s, cameras, fusion, store))
        return self.events[before:]

    def phases(self):
        return [(one["data"]["phase"], one["data"].get("camera")) for one in self.events]


def silent(age_s):
    return CameraHealth("stale" if age_s <= 10.0 else "down", 0.0, age_s, fault="nothing answers")


def test_a_camera_that_falls_silent_and_comes_back_is_one_episode_with_its_times():
    site = Site()
    assert site.goes(5) == []
    (began,) = site.goes(0.5, silent(2.5))
    (worse,) = site.goes(8, silent(11.0))
    (over,) = site.goes(30)
    assert [one["data"]["phase"] for one in (began, worse, over)] == ["new", "update", "end"]
    assert len({one["data"]["event"] for one in (began, worse, over)}) == 1
    data = began["data"]
    assert began["type"] == "trecsim.camera.health.v1"
    assert (began["source"], began["subject"]) == ("site/hall", "rule/camera-health")
    assert began["time"] == "2027-01-15T08:00:05.500Z"
    assert (data["rule"]["id"], data["rule"]["kind"]) == ("camera-health", "camera.health")
    assert len(data["rule"]["config"]) == 64
    assert data["people"] == over["data"]["people"] == [{"person": 7}]
    assert (data["severity"], data["camera"], data["state"]) == ("warning", "north", "stale")
    assert data["fault"] == "camera north is stale: nothing answers"
    assert (data["t_start_s"], data["t_detect_s"], data["t_end_s"]) == (
        UNIX_S + 3.0, UNIX_S + 5.5, None,
    )  # fmt: skip
    assert (worse["data"]["state"], worse["data"]["t_start_s"]) == ("down", UNIX_S + 3.0)
    assert worse["data"]["measures"] == {"age_s": 11.0}
    assert over["data"]["t_end_s"] == UNIX_S + 14.0  # the first moment at which it worked again
    assert over["data"]["t_detect_s"] == UNIX_S + 14.0 + OFF_S


def test_each_camera_has_its_own_episode_and_each_fault_another_one():
    site = Site()
    site.goes(3, silent(3.0), south=silent(4.0))
    site.goes(20)
    site.goes(1, silent(2.5))
    assert site.phases() == [
        ("new", "north"), ("new", "south"), ("end", "north"), ("end", "south"), ("new", "north"),
    ]  # fmt: skip
    begun = [one["data"]["event"] for one in site.events if one["data"]["phase"] == "new"]
    assert len(set(begun)) == 3


def test_a_camera_that_flaps_makes_few_episodes_and_never_two_at_once():
    site = Site()
    for _ in range(3600 // 15):  # an hour in which it works for 12 s of every 15 s
        site.goes(3, silent(2.5))
        site.goes(12)
    assert site.phases()[:3] == [("new", "north"), ("end", "north"), ("new", "north")]
    assert len([one for one in site.phases() if one[0] == "new"]) == 3
    open_at_once = 0
    for phase, _ in site.phases():
        open_at_once += {"new": 1, "end": -1}.get(phase, 0)
        assert open_at_once <= 1
    site.goes(2 * OFF_MOST_S)
    assert site.phases()[-1] == ("end", "north")


def test_a_short_recovery_does_not_end_a_fault():
    site = Site()
    site.goes(3, silent(3.0))
    site.goes(OFF_S - 1)
    site.goes(3, silent(3.0))
    assert site.phases() == [("new", "north")]


def test_a_fusion_that_stalls_is_an_alarm_and_a_disk_that_fails_a_warning():
    site = Site()
    site.goes(2, fusion=FusionHealth("stalled", age_s=3.5))
    site.goes(2, store=StoreHealth("failing", "no space left"))
    stalled, failing = site.events
    assert (stalled["type"], stalled["data"]["severity"]) == ("trecsim.fusion.health.v1", "alarm")
    assert stalled["data"]["t_start_s"] == UNIX_S + 0.5 - 3.5
    assert stalled["data"]["fault"] == "the fusion has stopped"
    assert (failing["type"], failing["data"]["severity"]) == ("trecsim.store.health.v1", "warning")
    assert failing["data"]["fault"] == "storage fails: no space left"
    assert "camera" not in failing["data"]


def test_a_camera_that_never_came_is_told_once_it_had_time_to():
    site = Site()
    never = CameraHealth("down", fault="connection refused")
    assert site.goes(10, never, fusion=FusionHealth("starting")) == []
    (began,) = site.goes(10, never, fusion=FusionHealth("starting"))
    assert began["data"]["t_start_s"] == UNIX_S + 0.5
    assert began["data"]["measures"] == {"age_s": None}


def test_nothing_is_judged_while_the_cameras_are_not_read():
    site = Site()
    site.read = False
    assert site.goes(30, silent(20.0)) == []
    site.read = True
    assert len(site.goes(1, silent(20.0))) == 1
    site.read = False
    assert site.goes(30) == []


@pytest.mark.parametrize("still", [True, False])
def test_an_episode_that_was_open_goes_on_after_a_restart_or_ends(still):
    before = Site()
    before.goes(3, silent(11.0))
    acked = {**before.events[0]["data"], "phase": "ack", "by": "kim", "seq": 1}
    after = Site(open_events=({**before.events[0], "data": acked},))
    after.goes(20, silent(30.0) if still else LIVE)
    if still:
        assert after.events == []
        after.goes(20)
    (over,) = after.events
    assert over["data"]["event"] == before.events[0]["data"]["event"]
    assert over["data"]["phase"] == "end"
    assert "by" not in over["data"]


def test_after_a_restart_a_camera_that_has_not_come_yet_neither_ends_nor_doubles_its_episode():
    before = Site()
    before.goes(3, silent(11.0))
    after = Site(open_events=tuple(before.events))
    assert after.goes(9, CameraHealth("down"), fusion=FusionHealth("starting")) == []
    assert after.goes(60, CameraHealth("down")) == []


def test_episodes_of_a_camera_that_is_gone_and_of_a_second_one_left_open_end_at_once():
    one, other = Site(), Site(now_s=1.0)
    one.goes(1, silent(3.0), west=silent(3.0))
    other.goes(1, silent(3.0))
    north, west = one.events
    after = Site(open_events=(north, west, *other.events))
    ended = after.goes(1, silent(20.0))
    assert {(e["data"]["phase"], e["data"]["event"]) for e in ended} == {
        ("end", north["data"]["event"]),
        ("end", west["data"]["event"]),
        ("update", other.events[0]["data"]["event"]),
    }


def test_times_that_are_no_unix_times_have_no_date():
    parts = parts_of(Health(50.0, {"north": silent(3.0)}, RUNNING), 0.0)
    (event,) = FaultWatch("hall").step(parts, 50.0)
    assert "time" not in event
    assert event["data"]["t_start_s"] == 47.0
