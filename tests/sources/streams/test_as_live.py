"""Recordings that are played as if they were live."""

import time
from pathlib import Path
from threading import Thread

import numpy as np
import pytest

from made_videos import numbered, write_video
from trecsim.errors import InputError
from trecsim.sources import VideoFile
from trecsim.sources.streams import Pace, PosesStream, RecordedStream
from trecsim.values import Poses2D


def poses(camera: str, t_s: float) -> Poses2D:
    return Poses2D(camera, t_s, np.empty((0, 17, 2)), np.empty((0, 17)), np.empty(0))


def test_a_video_comes_at_its_own_pace_dated_from_now_on(tmp_path: Path) -> None:
    path = write_video(tmp_path / "north.mp4", numbered(6), fps=10)
    stream = RecordedStream(VideoFile(path, "north", decode_size_px=(32, 32)), Pace(0.0))
    began_s = time.time()
    came_s, frames = zip(*((time.time(), frame) for frame in stream), strict=True)
    assert stream.counters.ended
    assert stream.counters.frames + stream.counters.dropped.get("late", 0) == 6
    np.testing.assert_allclose(np.diff([frame.t_s for frame in frames]), 0.1, atol=1e-3)
    assert began_s - 0.1 <= frames[0].t_s <= came_s[0]
    assert all(frame.t_s <= came + 1e-3 for came, frame in zip(came_s, frames, strict=True))
    assert {frame.size_px for frame in frames} == {(64, 48)}
    assert {frame.image.shape for frame in frames} == {(24, 32, 3)}


def test_recordings_that_began_at_different_times_keep_their_distance() -> None:
    pace = Pace(100.0)
    north, south = (
        PosesStream([poses(name, t_s)], [name], pace)
        for name, t_s in (("north", 100.0), ("south", 100.2))
    )
    (first,), (second,) = list(north), list(south)
    assert second.t_s - first.t_s == pytest.approx(0.2)


def test_poses_of_several_cameras_are_counted_for_each() -> None:
    stream = PosesStream([poses(name, 0.0) for name in ("a", "b", "a")], ["a", "b", "c"])
    taken = list(stream)
    assert abs(taken[0].t_s - time.time()) < 10.0
    assert {one.camera: one.frames for one in stream.readings} == {"a": 2, "b": 1, "c": 0}
    assert all(one.ended and one.fault is None for one in stream.readings)


def test_what_is_wrong_with_a_recording_is_told_of_its_cameras() -> None:
    def broken():
        yield poses("a", 0.0)
        raise InputError("line 2: no JSON")

    stream = PosesStream(broken(), ["a"])
    with pytest.raises(InputError, match="line 2"):
        list(stream)
    (counters,) = stream.readings
    assert counters.ended
    assert counters.fault == "line 2: no JSON"


def test_a_stream_that_waits_for_the_next_image_ends_when_it_is_closed() -> None:
    stream = PosesStream([poses("a", 0.0), poses("a", 1e6)], ["a"])
    taken: list[Poses2D] = []
    thread = Thread(target=lambda: taken.extend(stream), daemon=True)
    thread.start()
    stream.close()
    thread.join(10.0)
    assert not thread.is_alive()
    assert len(taken) <= 1


def test_images_that_are_ready_too_late_are_left_out(tmp_path: Path) -> None:
    path = write_video(tmp_path / "north.mp4", numbered(10), fps=1)
    pace = Pace(5.0)  # as if five seconds had passed before the first image was decoded
    stream = RecordedStream(VideoFile(path, "north"), pace)
    first = next(iter(stream))
    assert stream.counters.dropped["late"] >= 3
    assert abs(first.t_s - time.time()) < 10.0
