import logging
from collections import Counter

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from trecsim.sync import frame_sets
from trecsim.values import FrameSet, Poses2D


def image(camera: str, t_s: float) -> Poses2D:
    return Poses2D(camera, t_s, np.empty((0, 17, 2)), np.empty((0, 17)), np.empty(0))


def camera_images(camera: str, rate: float, n: int, start_s: float = 0.0) -> list[Poses2D]:
    return [image(camera, start_s + index / rate) for index in range(n)]


def in_order(*cameras: list[Poses2D]) -> list[Poses2D]:
    return sorted((one for camera in cameras for one in camera), key=lambda one: one.t_s)


def seen(frame_set: FrameSet) -> str:
    """Return the cameras of a set, in the order of its views' times."""
    return "".join(view.camera for view in frame_set.views)


@pytest.mark.parametrize("n_cameras", [1, 2, 5, 12])
def test_synchronous_cameras_give_one_set_for_each_instant(n_cameras):
    names = "abcdefghijkl"[:n_cameras]
    sets = list(frame_sets(in_order(*(camera_images(name, 60.0, 100) for name in names))))
    assert [seen(one) for one in sets] == [names] * 100
    np.testing.assert_allclose([one.t_s for one in sets], np.arange(100) / 60.0)


@settings(deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(2, 6), st.sampled_from([0.0, 1.0]))
def test_jitter_of_40_percent_of_the_period_does_not_tear_instants_apart(seed, n, max_delay_s):
    rng = np.random.default_rng(seed)
    jitter = rng.uniform(-0.4, 0.4, (n, 80))
    t_s = (np.arange(80) + jitter) / 60.0
    images = in_order(*([image("abcdef"[c], t) for t in t_s[c]] for c in range(n)))
    sets = list(frame_sets(images, max_delay_s=max_delay_s))
    assert [len(one.views) for one in sets] == [n] * 80


def test_cameras_that_take_turns_within_a_period_share_a_set():
    images = in_order(*(camera_images("abcd"[c], 20.0, 40, 0.005 * c) for c in range(4)))
    sets = list(frame_sets(images))
    assert [seen(one) for one in sets] == ["abcd"] * 40
    np.testing.assert_allclose(np.diff([one.t_s for one in sets]), 0.05)


def test_every_view_keeps_its_own_time_and_the_set_has_the_newest():
    (first, *_) = frame_sets(
        in_order(*(camera_images("ab"[c], 20.0, 9, 0.005 * c) for c in (0, 1)))
    )
    assert [view.t_s for view in first.views] == [0.0, 0.005]
    assert first.t_s == 0.005


@pytest.mark.parametrize("max_delay_s", [0.0, 1.0])
@pytest.mark.parametrize("phase_s", [0.0, 0.004])
def test_a_camera_of_half_the_rate_is_in_every_second_set(phase_s, max_delay_s):
    images = in_order(camera_images("a", 60.0, 120), camera_images("b", 30.0, 60, phase_s))
    sets = list(frame_sets(images, max_delay_s=max_delay_s))
    assert [seen(one) for one in sets] == ["ab", "a"] * 60


def test_a_camera_of_half_the_rate_joins_the_nearer_image():
    images = in_order(camera_images("a", 60.0, 121), camera_images("b", 30.0, 60, 0.012))
    assert [seen(one) for one in frame_sets(images)] == ["a", *["ba", "a"] * 60]


@pytest.mark.parametrize("rate", [7.0, 24.0, 25.0, 29.97, 50.0, 59.0])
def test_sets_come_at_the_pace_of_the_fastest_camera(rate):
    images = in_order(camera_images("a", 60.0, 300), camera_images("b", rate, int(5 * rate)))
    sets = list(frame_sets(images))
    assert sum("a" in seen(one) for one in sets) == 300
    assert sum(seen(one) == "b" for one in sets) <= 1
    assert max(one.views[-1].t_s - one.views[0].t_s for one in sets) <= 0.91 / 60.0


def test_cameras_fall_back_into_step_after_an_image_is_missing():
    a, b = camera_images("a", 20.0, 60), camera_images("b", 20.0, 60, 0.005)
    del a[30], b[40:43]
    sets = list(frame_sets(in_order(a, b)))
    assert Counter(map(seen, sets)) == {"ab": 56, "b": 1, "a": 3}


@pytest.mark.parametrize("missing", [1, 2, 3])
def test_cameras_begin_in_step_when_the_first_to_take_turns_begins_late(missing):
    cameras = [camera_images("abcd"[c], 20.0, 40, 0.005 * c) for c in range(4)]
    for camera in cameras[:missing]:
        del camera[0]
    sets = list(frame_sets(in_order(*cameras)))
    assert [seen(one) for one in sets] == ["abcd"[missing:]] + ["abcd"] * 39


def test_a_camera_that_starts_seconds_later_joins_where_it_is_nearest():
    images = in_order(camera_images("a", 25.0, 200), camera_images("b", 25.0, 50, 3.01))
    sets = list(frame_sets(images))
    both = [one for one in sets if seen(one) == "ab"]
    assert len(both) == 49
    assert all(one.views[1].t_s - one.views[0].t_s < 0.0101 for one in both)


def test_a_recording_that_ends_earlier_does_not_hold_the_others_up():
    images = in_order(camera_images("a", 25.0, 200), camera_images("b", 25.0, 50))
    assert Counter(map(seen, frame_sets(images))) == {"ab": 50, "a": 150}


def test_offsets_bring_clocks_together_whatever_order_the_file_has():
    a, b = camera_images("a", 25.0, 100, 1000.0), camera_images("b", 25.0, 100)
    images = [one for pair in zip(a, b, strict=True) for one in pair]
    sets = list(frame_sets(images, offsets_s={"a": -1000.0}))
    assert [sorted(seen(one)) for one in sets] == [["a", "b"]] * 100
    assert sets[-1].t_s == pytest.approx(99 / 25.0)


def test_recordings_merged_by_time_stamp_are_set_right_by_their_offsets():
    a, b = camera_images("a", 25.0, 200), camera_images("b", 25.0, 200, 3.2)
    sets = list(frame_sets(in_order(a, b), offsets_s={"b": -3.2}))
    assert [sorted(seen(one)) for one in sets] == [["a", "b"]] * 200


def test_images_up_to_a_second_out_of_order_are_put_in_order():
    a, b = camera_images("a", 25.0, 100), camera_images("b", 25.0, 100)
    late = sorted([*((one.t_s, one) for one in a), *((one.t_s + 0.9, one) for one in b)],
                  key=lambda pair: pair[0])  # fmt: skip
    assert {seen(one) for one in frame_sets([one for _, one in late])} == {"ab"}


def test_a_live_set_is_given_with_its_last_image():
    images = in_order(*(camera_images(name, 25.0, 60) for name in "abc"))
    arrived = 0

    def arriving():
        nonlocal arrived
        for one in images:
            arrived += 1
            yield one

    given_after = [(one.t_s, arrived) for one in frame_sets(arriving(), max_delay_s=0.0)]
    after_learning = [(t_s, n) for t_s, n in given_after if t_s > 1.0]
    assert after_learning == [(i / 25.0, 3 * (i + 1)) for i in range(26, 60)]


def test_a_live_set_waits_for_a_silent_camera_no_longer_than_the_window():
    a, b = camera_images("a", 25.0, 100), camera_images("b", 25.0, 100)
    del b[50]
    arrived: list[Poses2D] = []

    def arriving():
        for one in in_order(a, b):
            arrived.append(one)
            yield one

    waited_s = {
        frame_set.t_s: arrived[-1].t_s - frame_set.t_s
        for frame_set in frame_sets(arriving(), max_delay_s=0.0)
    }
    assert waited_s[2.0] == pytest.approx(0.04)


def test_a_window_that_is_given_is_kept():
    images = in_order(camera_images("a", 10.0, 30), camera_images("b", 10.0, 30, 0.03))
    assert {seen(one) for one in frame_sets(images, window_s=0.02)} == {"a", "b"}
    assert {seen(one) for one in frame_sets(images, window_s=0.04)} == {"ab"}


def test_photographs_taken_once_by_each_camera_are_a_set():
    sets = list(frame_sets([image("a", 5.0), image("b", 5.001), image("c", 5.002)]))
    assert [seen(one) for one in sets] == ["abc"]


def test_no_images_give_no_sets():
    assert list(frame_sets([])) == []


def test_cameras_one_after_the_other_in_a_file_are_remarked_once_each(caplog):
    images = camera_images("a", 25.0, 100) + camera_images("b", 25.0, 100)
    with caplog.at_level(logging.WARNING):
        sets = list(frame_sets(images))
    assert sum(len(one.views) for one in sets) == 200
    (message,) = caplog.messages
    assert "'b'" in message
    assert "order of the cameras" in message


def test_a_camera_that_floods_does_not_fill_the_memory():
    waiting = 0
    most = 0

    def flood():
        nonlocal waiting, most
        yield image("b", 0.0)
        waiting += 1
        for index in range(20_000):
            waiting += 1
            most = max(most, waiting)
            yield image("a", index * 1e-9)

    for frame_set in frame_sets(flood()):
        waiting -= len(frame_set.views)
    assert most < 5000


times = st.floats(0.0, 5.0, allow_nan=False).map(lambda t_s: round(t_s, 3))
streams = st.dictionaries(
    st.sampled_from("abcde"), st.lists(times, min_size=1, max_size=40, unique=True), max_size=5
)


@settings(deadline=None)
@given(streams, st.randoms(use_true_random=False), st.sampled_from([0.0, 0.3, 1.0]),
       st.sampled_from([None, 0.0, 0.1]))  # fmt: skip
def test_whatever_comes_no_image_is_lost_doubled_or_overtaken(
    stream, random, max_delay_s, window_s
):
    queues = {name: [image(name, t_s) for t_s in sorted(t)] for name, t in stream.items()}
    images = []
    while any(queues.values()):  # any interleaving that keeps each camera in order
        name = random.choice([name for name, queue in queues.items() if queue])
        images.append(queues[name].pop(0))
    arguments = {"max_delay_s": max_delay_s, "window_s": window_s}
    sets = list(frame_sets(images, **arguments))
    given_views = [view for one in sets for view in one.views]
    assert Counter(map(id, given_views)) == Counter(map(id, images))
    for name in stream:
        own = [view.t_s for view in given_views if view.camera == name]
        assert own == sorted(own)
    assert all(one.t_s >= one.views[-1].t_s for one in sets)
    assert all(len(set(seen(one))) == len(one.views) > 0 for one in sets)
    again = list(frame_sets(images, **arguments))
    assert [seen(one) for one in again] == [seen(one) for one in sets]


@settings(deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 5), st.sampled_from([0.0, 0.3, 1.0]))
def test_times_of_sets_never_go_back_where_cameras_deliver_within_their_delay(seed, n, max_delay_s):
    rng = np.random.default_rng(seed)
    images = []
    for c in range(n):
        t_s = np.sort(rng.uniform(0.0, 4.0, 40))
        arrival_s = t_s + rng.uniform(0.0, max(max_delay_s, 0.3))
        images += [(a, image("abcde"[c], t)) for a, t in zip(arrival_s, t_s, strict=True)]
    stream = [one for _, one in sorted(images, key=lambda pair: pair[0])]
    times = [one.t_s for one in frame_sets(stream, max_delay_s=max_delay_s)]
    assert times == sorted(times)


FAR = [3.0, 1e3, 1e12, -3.0, -1e3, -1e12]


@pytest.mark.parametrize("far_s", FAR)
@pytest.mark.parametrize("max_delay_s", [0.0, 1.0])
@pytest.mark.parametrize("wrong", [0, 50])
def test_one_wrong_time_stamp_tears_no_set_but_its_own(far_s, max_delay_s, wrong):
    cameras = [camera_images(name, 25.0, 100) for name in "abc"]
    images = in_order(*cameras)
    index = images.index(cameras[1][wrong])
    images[index] = image("b", cameras[1][wrong].t_s + far_s)
    sets = Counter(
        "".join(sorted(seen(one))) for one in frame_sets(images, max_delay_s=max_delay_s)
    )
    assert sets["abc"] >= 98
    assert sets["b"] == 1
    assert sets.total() <= 102


@pytest.mark.parametrize("far_s", FAR)
@pytest.mark.parametrize("max_delay_s", [0.0, 1.0])
def test_a_camera_whose_clock_jumps_neither_delays_nor_tears_the_others(far_s, max_delay_s, caplog):
    cameras = [camera_images(name, 25.0, 300) for name in "abc"]
    images = in_order(*cameras)
    jumped = {id(one) for one in cameras[1][100:]}
    arrived = 0

    def arriving():
        nonlocal arrived
        for one in images:
            arrived += 1
            yield image("b", one.t_s + far_s) if id(one) in jumped else one

    waiting, kinds = 0, Counter()
    for given_set in frame_sets(arriving(), max_delay_s=max_delay_s):
        arrived -= len(given_set.views)
        waiting = max(waiting, arrived)
        kinds["".join(sorted(seen(given_set)))] += 1
    assert kinds["abc"] >= 99
    assert kinds["abc"] + kinds["ac"] >= 299
    assert kinds["a"] + kinds["c"] <= 1
    assert waiting < 3 * 25 * 2.1 + 3
    assert sum("'b'" in text for text in caplog.messages) == 1
    assert all("'b'" in text for text in caplog.messages)


@pytest.mark.parametrize("far_s", FAR)
def test_clocks_that_all_jump_together_stay_together(far_s):
    images = [
        image(one.camera, one.t_s + far_s) if index >= 150 else one
        for index, one in enumerate(in_order(*(camera_images(name, 25.0, 100) for name in "abc")))
    ]
    sets = list(frame_sets(images))
    assert [len(one.views) for one in sets] == [3] * 100
    assert all(one.t_s == one.views[-1].t_s for one in sets)


def test_a_camera_that_comes_back_after_minutes_is_put_together_with_the_others_again():
    a, b = camera_images("a", 25.0, 5000), camera_images("b", 25.0, 5000)
    del b[100:4900]
    assert Counter(map(seen, frame_sets(in_order(a, b)))) == {"ab": 199, "a": 4801, "b": 1}


def test_a_fault_in_the_stream_comes_after_everything_before_it():
    from trecsim.errors import InputError

    def stream():
        for n in range(3):
            yield Poses2D("north", 0.04 * n, np.empty((0, 17, 2)), np.empty((0, 17)), np.empty(0))
        raise InputError("line 4 is wrong")

    given = frame_sets(stream())
    assert [next(given).t_s for _ in range(3)] == [0.0, 0.04, 0.08]
    with pytest.raises(InputError, match="line 4"):
        next(given)
