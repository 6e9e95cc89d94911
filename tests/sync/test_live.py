"""Frame sets of live cameras: what one camera does delays no other, and time goes on by itself."""

import numpy as np
import pytest

from trecsim.sync import FrameSetBuffer
from trecsim.values import Poses2D

PERIOD_S = 0.04


def image(camera, t_s):
    return Poses2D(camera, t_s, np.empty((0, 17, 2)), np.empty((0, 17)), np.empty(0))


def delivered(seconds, cameras="abc", delay_s=None, stalls=(), clock_s=1.7e9):
    """Return (arrival, image) pairs; a stall (camera, from, to) holds images back until `to`."""
    delay_s = delay_s or {}
    pairs = []
    for c in cameras:
        for n in range(int(seconds / PERIOD_S)):
            taken_s = n * PERIOD_S
            arrived_s = taken_s + delay_s.get(c, 0.01)
            for camera, from_s, to_s in stalls:
                if camera == c and from_s <= taken_s < to_s:
                    arrived_s = to_s
            pairs.append((arrived_s, image(c, clock_s + taken_s)))
    return sorted(pairs, key=lambda pair: pair[0])


def run(pairs, until_s=0.0, tick_s=0.02, **options):
    """Return (time of closing, set) pairs, polling whenever nothing arrives for a tick."""
    buffer = FrameSetBuffer(**{"max_delay_s": 0.1, **options})
    given, now_s = [], 0.0
    for arrived_s, one in pairs:
        while arrived_s - now_s > tick_s:
            now_s += tick_s
            given += [(now_s, s) for s in buffer.poll(now_s)]
        now_s = arrived_s
        given += [(now_s, s) for s in buffer.add(one, arrived_s)]
    while now_s < until_s:
        now_s += tick_s
        given += [(now_s, s) for s in buffer.poll(now_s)]
    return given


def names(frame_set):
    return "".join(sorted(view.camera for view in frame_set.views))


def test_live_cameras_in_step_give_each_set_with_its_last_image():
    given = run(delivered(4.0))
    late = [(at, s) for at, s in given if s.t_s - 1.7e9 > 1.2]
    assert {names(s) for _, s in late} == {"abc"}
    assert max(at - (s.t_s - 1.7e9) for at, s in late) <= 0.011


@pytest.mark.parametrize("stall_s", [1.0, 3.0])
def test_a_stalled_camera_delays_the_others_by_no_more_than_the_delay_allowed(stall_s):
    given = run(delivered(8.0, stalls=[("b", 4.0, 4.0 + stall_s)]))
    others = [(at, s) for at, s in given if "a" in names(s) and s.t_s - 1.7e9 > 1.2]
    assert len(others) == len({round(s.t_s, 3) for _, s in others})
    assert max(at - (s.t_s - 1.7e9) for at, s in others) <= 0.01 + 0.1 + 0.9 * PERIOD_S + 0.021
    waiting_out = [at - (s.t_s - 1.7e9) for at, s in others if 4.5 < s.t_s - 1.7e9 < 3.9 + stall_s]
    assert max(waiting_out) <= 0.011  # once it is silent, nobody waits for it


def test_after_a_stall_the_camera_is_in_the_sets_again():
    given = run(delivered(8.0, stalls=[("b", 4.0, 5.0)]))
    assert {names(s) for _, s in given if 5.2 < s.t_s - 1.7e9 < 7.9} == {"abc"}


def test_when_all_cameras_are_silent_empty_sets_tell_the_time():
    given = run(delivered(4.0), until_s=8.0)
    empty = [s for _, s in given if not s.views]
    assert len(empty) > 30
    for at, s in given:
        if not s.views:
            assert s.t_s - 1.7e9 == pytest.approx(at - 0.01, abs=1e-5)
    times = [s.t_s for _, s in given]
    assert times == sorted(times)


def test_no_empty_set_comes_while_a_camera_delivers():
    given = run(delivered(6.0, stalls=[("b", 2.0, 5.0), ("c", 2.0, 5.0)]), until_s=6.0)
    assert all(s.views for _, s in given)


def test_without_any_image_there_is_no_time_to_tell():
    buffer = FrameSetBuffer(max_delay_s=0.1)
    assert [s for n in range(100) for s in buffer.poll(0.1 * n)] == []


def test_a_camera_that_is_always_late_is_waited_for_within_the_delay_allowed():
    given = run(delivered(6.0, delay_s={"c": 0.08}))
    assert {names(s) for _, s in given if 1.2 < s.t_s - 1.7e9 < 5.8} == {"abc"}


def test_a_clock_that_jumps_while_live_tears_no_set_of_the_others():
    pairs = [
        (at, image("b", one.t_s + 1e6) if one.camera == "b" and at > 3.0 else one)
        for at, one in delivered(6.0)
    ]
    kinds = [names(s) for at, s in run(pairs) if at > 3.3]
    assert set(kinds) == {"ac", "b"}


def test_slow_cameras_are_not_taken_for_silent():
    pairs = sorted(
        [(n + 0.01 * c, image("abc"[c], 5.0 + n + 0.01 * c)) for n in range(20) for c in range(3)],
        key=lambda pair: pair[0],
    )
    given = run(pairs)
    assert all(s.views for _, s in given)
    assert [names(s) for _, s in given][3:] == ["abc"] * (len(given) - 3)


def test_an_image_that_waits_is_given_when_the_stream_ends():
    buffer = FrameSetBuffer()
    assert list(buffer.add(image("a", 1.0), 0.0)) == []
    assert [names(s) for s in buffer.flush()] == ["a"]


def test_a_camera_that_falls_silent_and_comes_back_is_remarked_once_each(caplog):
    run(delivered(8.0, stalls=[("b", 2.0, 6.0)]))  # what waited in the camera comes late: no remark
    assert caplog.messages == [
        "camera 'b' has delivered no image for 1.42 s",
        "camera 'b' delivers images again",
    ]


def test_where_somebody_else_watches_the_cameras_silence_is_not_remarked(caplog):
    run(delivered(8.0, stalls=[("b", 2.0, 6.0)]), silence=False)
    assert caplog.messages == []


def test_a_camera_that_is_late_without_having_been_silent_is_remarked_once():
    remarks = []
    pairs = [
        (at, image("b", one.t_s - 3.0) if one.camera == "b" and at > 2.0 else one)
        for at, one in delivered(6.0)
    ]
    run(pairs, remark=remarks.append)
    (text,) = remarks
    assert text.startswith("camera 'b' delivers 2.96 s late, after the other cameras' images")


def test_short_pauses_are_not_remarked(caplog):
    run(delivered(8.0, stalls=[("b", 2.0, 2.5), ("a", 4.0, 4.9)]))
    assert caplog.messages == []
