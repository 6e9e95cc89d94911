"""What a live site tells about itself, at made-up moments."""

from collections import Counter
from dataclasses import dataclass, field

import numpy as np
import pytest

from trecsim.health import StoreHealth
from trecsim.recent import Recent
from trecsim.service.monitor import Monitor
from trecsim.service.timed_estimator import TimedEstimator
from trecsim.store.timing_csv import StepTiming
from trecsim.values import Frame, Poses2D, Snapshot


@dataclass
class Hand:
    """A clock that is moved by hand."""

    now_s: float = 100.0

    def __call__(self):
        return self.now_s


@dataclass
class Stream:
    camera: str
    clock: str = "sender"
    dropped: Counter = field(default_factory=lambda: Counter(late=2))
    fault: str | None = None
    ended: bool = False
    last_image_s: float | None = None
    decoding: Recent = field(default_factory=Recent)


@pytest.fixture
def hand():
    return Hand()


def monitor(hand, *streams):
    return Monitor(("north", "south"), streams, wall_clock=lambda: 1e9 + hand.now_s, clock=hand)


def poses(camera, t_s):
    return Poses2D(camera, t_s, np.empty((0, 17, 2)), np.empty((0, 17)), np.empty(0))


def test_every_camera_is_there_and_down_before_its_first_image(hand):
    health = monitor(hand).health()
    assert {name: (c.state, c.age_s) for name, c in health.cameras.items()} == {
        "north": ("down", None),
        "south": ("down", None),
    }
    assert health.fusion.state == "starting"
    assert not health.is_well


def test_rates_ages_and_times_are_those_of_the_last_seconds(hand):
    north = Stream("north")
    watch = monitor(hand, north)
    for _ in range(200):
        hand.now_s += 0.1
        north.last_image_s = hand.now_s
        watch.take_poses(poses("north", 1e9 + hand.now_s - 0.04))
        watch.take_step(StepTiming(0.0, 1, 1, 2.0))
    hand.now_s += 0.5
    health = watch.health()
    north = health.cameras["north"]
    assert north.fps == pytest.approx(9.0, abs=0.3)  # nothing for half of the last five seconds
    assert north.age_s == pytest.approx(0.5)
    assert (north.state, north.clock, north.dropped) == ("live", "sender", 2)
    assert health.cameras["south"].state == "down"
    assert health.stages["image to poses"].median_ms == pytest.approx(40.0, abs=1e-3)
    assert (health.fusion.state, health.fusion.step_ms) == ("running", 2.0)
    hand.now_s += 4.0
    assert watch.health().cameras["north"].state == "stale"
    assert watch.health().fusion.state == "stalled"
    hand.now_s += 20.0
    assert watch.health().cameras["north"].state == "down"
    assert watch.health().stages == {}


def test_images_that_nobody_took_are_counted_with_those_that_the_stream_left_out(hand):
    watch = monitor(hand, Stream("north"))
    watch.queue_drops = {"north": 5}
    assert watch.health().cameras["north"].dropped_by == {"late": 2, "queue": 5}
    assert watch.health().cameras["south"].dropped == 0


def test_people_of_the_last_snapshot_and_how_old_it_was_are_told(hand):
    watch = monitor(hand)
    people = np.zeros((2, 17, 3))
    cov_m2, support = np.zeros((2, 17, 3, 3)), np.ones((2, 17), int)
    watch.write(Snapshot(1e9 + hand.now_s - 0.2, np.array([1, 4]), people, cov_m2, support))
    assert watch.health().fusion.people == 2
    assert watch.health().stages["image to people"].median_ms == pytest.approx(200.0, abs=1e-3)


def test_a_recording_that_has_ended_is_no_fault(hand):
    watch = monitor(hand)
    watch.ended = True
    assert watch.health().is_well


def test_the_time_of_the_estimator_is_taken_and_nothing_else_changes(hand):
    class Slow:
        skeleton, workers, image_limit_px = "coco17", 3, (320, 320)

        def __call__(self, frame):
            hand.now_s += 0.03
            return poses(frame.camera, frame.t_s)

    watch = monitor(hand)
    timed = TimedEstimator(Slow(), watch.take_estimate, hand)
    assert (timed.skeleton, timed.workers, timed.image_limit_px) == ("coco17", 3, (320, 320))
    assert timed(Frame("north", 0, 0.5, np.zeros((2, 2, 3), np.uint8))).t_s == 0.5
    assert watch.health().stages["estimate"].median_ms == pytest.approx(30.0)


def test_each_stage_tells_how_long_it_takes_and_how_old_the_image_is_then(hand):
    north, south = Stream("north"), Stream("south")
    watch = monitor(hand, north, south)

    class Recorder:
        health, writing = StoreHealth("writing"), Recent()

    watch.take_recorder(Recorder())
    taken_s = 1e9 + hand.now_s
    hand.now_s += 0.02
    north.decoding.add(hand.now_s, 4.0, 20.0)
    south.decoding.add(hand.now_s, 8.0, 24.0)
    hand.now_s += 0.03
    watch.take_estimate(0.03, taken_s)
    watch.take_poses(poses("north", taken_s))
    hand.now_s += 0.05
    watch.take_step(StepTiming(taken_s, 2, 1, 2.0, waited_ms=40.0))
    watch.take_step(StepTiming(taken_s, 0, 1, 2.0))  # no image: nothing waited
    watch.write(Snapshot(taken_s, *nobody()))
    Recorder.writing.add(hand.now_s, 5.0, 900.0)
    stages = watch.health().stages
    assert list(stages) == [
        "decode", "estimate", "image to poses", "sync", "fusion", "image to people", "store",
    ]  # fmt: skip
    found = {name: (one.median_ms, one.age_ms) for name, one in stages.items()}
    assert found == {
        "decode": approx(6.0, 22.0),
        "estimate": approx(30.0, 50.0),
        "image to poses": approx(50.0, 50.0),
        "sync": approx(40.0, 98.0),
        "fusion": approx(2.0, 100.0),
        "image to people": approx(100.0, 100.0),
        "store": approx(5.0, 900.0),
    }


def approx(median_ms, age_ms):
    return pytest.approx((median_ms, age_ms), abs=1e-3)


def nobody():
    return np.empty(0, int), np.empty((0, 17, 3)), np.empty((0, 17, 3, 3)), np.empty((0, 17), int)


def test_a_rate_is_right_when_more_values_come_than_are_kept():
    fast = Recent()
    for n in range(10_000):
        fast.add(0.001 * n)
    assert fast.rate_hz(10.0) == pytest.approx(1000.0, rel=0.01)


def test_a_rate_is_of_the_last_seconds_after_many_values_too():
    camera = Recent()
    for n in range(3000):
        camera.add(0.04 * n)
    assert camera.rate_hz(120.0) == pytest.approx(25.0, rel=0.01)
    assert camera.rate_hz(126.0) == 0.0  # it has stopped


def test_how_late_a_clock_is_comes_from_the_tracking_as_soon_as_that_knows(hand):
    watch = monitor(hand)
    watch.take_step(StepTiming(0.0, 2, 1, 2.0))
    assert watch.health().cameras["north"].clock_late_ms is None
    watch.take_step(StepTiming(1.0, 2, 1, 2.0, late_s={"north": 0.0214}))
    cameras = watch.health().to_json()["cameras"]
    assert cameras["north"]["clock_late_ms"] == 21.4
    assert cameras["south"]["clock_late_ms"] is None
