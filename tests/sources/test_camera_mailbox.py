"""Live sources side by side."""

from threading import Event

import numpy as np
import pytest

from trecsim.errors import InputError
from trecsim.sources.camera_mailbox import Mailbox, deliver
from trecsim.values import Poses2D


def image(camera, t_s):
    return Poses2D(camera, t_s, np.empty((0, 17, 2)), np.empty((0, 17)), np.empty(0))


def no_fault(error):
    raise AssertionError(error)


def test_what_waits_longest_is_taken_first_whatever_the_camera():
    box = Mailbox(depth=3)
    box.begin()
    for camera in "aab":
        box.put(image(camera, 0.0))
    assert [box.take(0.0).camera for _ in range(3)] == ["a", "a", "b"]
    assert box.take(0.0) is None


def test_a_camera_that_floods_loses_its_own_oldest_images_and_no_others():
    box = Mailbox(depth=2)
    box.begin()
    box.put(image("b", 7.0))
    for n in range(100):
        box.put(image("a", float(n)))
    taken = [box.take(0.0) for _ in range(3)]
    assert [(one.camera, one.t_s) for one in taken] == [("b", 7.0), ("a", 98.0), ("a", 99.0)]
    assert box.dropped == {"a": 98}


def test_a_source_that_stalls_delays_no_other():
    stalled, may_end = Event(), Event()

    def stalling():
        yield image("a", 0.0)
        stalled.set()
        may_end.wait()

    def steady():
        stalled.wait()
        for n in range(5):
            yield image("b", float(n))

    box = Mailbox(depth=10)
    deliver([stalling(), steady()], box, no_fault)
    taken = []
    for arrival in box.arrivals(tick_s=0.001):
        taken += [arrival.item] if arrival.item else []
        if len(taken) == 6:
            may_end.set()
    assert sorted(one.camera for one in taken) == ["a", *"bbbbb"]
    assert [one.t_s for one in taken if one.camera == "b"] == [0.0, 1.0, 2.0, 3.0, 4.0]


def test_ticks_come_while_nothing_does():
    may_end = Event()

    def silent():
        may_end.wait()
        yield image("a", 0.0)

    now = iter(range(1000))
    box = Mailbox()
    deliver([silent()], box, no_fault)
    arrivals = []
    for arrival in box.arrivals(tick_s=0.001, clock=lambda: float(next(now))):
        arrivals.append(arrival)
        if len(arrivals) == 3:
            may_end.set()
    assert [one.item for one in arrivals[:3]] == [None] * 3
    assert [one.arrived_s for one in arrivals] == [float(n) for n in range(len(arrivals))]
    assert [one.item.t_s for one in arrivals if one.item] == [0.0]


def test_a_source_that_fails_is_told_and_the_others_go_on():
    def failing():
        yield image("a", 0.0)
        raise InputError("the cable is out")

    faults = []
    box = Mailbox(depth=9)
    deliver([failing(), [image("b", float(n)) for n in range(3)]], box, faults.append)
    taken = [one.item for one in box.arrivals(tick_s=0.001) if one.item]
    assert sorted(one.camera for one in taken) == ["a", "b", "b", "b"]
    assert [str(one) for one in faults] == ["the cable is out"]


@pytest.mark.parametrize(
    ("error", "text"),
    [
        (SystemExit(3), "ended with SystemExit: 3"),
        (KeyboardInterrupt(), "ended with KeyboardInterrupt"),
    ],
)
def test_a_source_that_ends_its_thread_is_told_and_the_others_go_on(error, text):
    def ending():
        yield image("a", 0.0)
        raise error

    faults = []
    box = Mailbox(depth=9)
    deliver([ending(), [image("b", float(n)) for n in range(3)]], box, faults.append)
    taken = [one.item for one in box.arrivals(tick_s=0.001) if one.item]
    assert sorted(one.camera for one in taken) == ["a", "b", "b", "b"]
    assert [str(one) for one in faults] == [text]
    assert faults[0].__cause__ is error


def test_a_closed_mailbox_ends_its_sources():
    ended = Event()

    def endless():
        try:
            while True:
                yield image("a", 0.0)
        finally:
            ended.set()

    source = endless()
    box = Mailbox()
    deliver([source], box, no_fault)
    arrivals = box.arrivals()
    next(arrivals)
    arrivals.close()
    del source
    assert ended.wait(10.0)
    assert box.is_over
