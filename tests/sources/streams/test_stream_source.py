"""Live cameras that break: each fault is told, counted and outlived."""

import time
from contextlib import closing
from random import Random

import numpy as np
import pytest

from hostile_camera import HostileCamera, clip, mutated
from made_cameras import JpegCamera, MadeCamera, until
from trecsim.sources.streams import (
    DeviceAddress,
    NetworkAddress,
    StreamSource,
    frozen_image,
    retrying,
)
from trecsim.sources.streams.frozen_image import FrozenImage
from trecsim.sources.streams.live_frame import Developer
from trecsim.sources.streams.stream_address import Opening
from watched_streams import Watched, watched

SIZE_PX = (64, 48)


def test_images_come_dated_now_and_in_order(camera: MadeCamera) -> None:
    with watched(camera.url, SIZE_PX) as north:
        frames = north.images(20)
    assert {(frame.camera, frame.image.shape) for frame in frames} == {("north", (48, 64, 3))}
    assert {frame.size_px for frame in frames} == {None}
    times_s = [frame.t_s for frame in frames]
    assert times_s == sorted(set(times_s))
    assert abs(times_s[-1] - time.time()) < 10.0
    numbers = [frame.index for frame in frames]
    assert numbers == list(range(numbers[0], numbers[0] + len(frames)))
    assert north.counters.clock == "arrival"  # this kind of stream has no clock
    assert north.counters.codec == "h264"


def test_images_come_no_larger_than_the_estimator_looks_at_them(camera: MadeCamera) -> None:
    with watched(camera.url, SIZE_PX, (32, 32)) as north:
        frame = north.images(1)[0]
    assert frame.image.shape == (24, 32, 3)
    assert frame.size_px == SIZE_PX


def test_images_that_nobody_looks_at_are_not_converted(
    camera: MadeCamera, monkeypatch: pytest.MonkeyPatch
) -> None:
    made, make = [], Developer.__call__
    monkeypatch.setattr(Developer, "__call__", lambda *given: made.append(1) or make(*given))
    with watched(camera.url, SIZE_PX) as north:
        frames = north.images(5)
        assert made == []
        first = frames[0].image
        assert frames[0].image is first
        assert made == [1]
    assert first.dtype == np.uint8


@pytest.mark.usefixtures("impatient")
def test_a_camera_that_is_switched_off_and_on_again_comes_back(camera: MadeCamera) -> None:
    with watched(camera.url, SIZE_PX) as north:
        last_s = north.images()[-1].t_s
        camera.switch_off()
        north.fault("nothing answers at 127.0.0.1")
        assert not north.counters.connected
        camera.switch_on()
        assert north.images()[-1].t_s > last_s
        assert north.counters.fault is None
        assert north.counters.reconnects >= 1


@pytest.mark.usefixtures("impatient")
def test_the_end_of_a_live_stream_is_a_fault(camera: MadeCamera) -> None:
    with watched(camera.url, SIZE_PX) as north:
        north.images()
        camera.switch_off()
        assert "tcp://127.0.0.1" in north.fault("ended the")


@pytest.mark.usefixtures("impatient")
def test_a_camera_that_falls_silent_is_given_up_and_comes_back(camera: MadeCamera) -> None:
    with watched(camera.url, SIZE_PX) as north:
        north.images()
        camera.sends.clear()
        north.fault("nothing has come")
        camera.sends.set()
        north.images()
        assert north.counters.fault is None


@pytest.mark.usefixtures("impatient")
def test_garbage_is_told_and_outlived(camera: MadeCamera) -> None:
    with watched(camera.url, SIZE_PX) as north:
        north.images()
        camera.says = bytes(range(256)) * 40
        until(lambda: north.counters.fault, "a fault was told")
        camera.says = b""
        north.images()
        until(lambda: north.counters.fault is None, "the fault was over")


def test_whatever_a_hostile_camera_sends_the_source_goes_on(
    camera: MadeCamera, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(retrying, "FIRST_S", 0.001)
    monkeypatch.setattr(retrying, "SOON_S", 0.001)
    good, random = clip(), Random(4711)
    texts = [mutated(good, random) for _ in range(150)]
    with (
        closing(HostileCamera(texts, camera)) as hostile,
        watched(hostile.url, SIZE_PX) as north,
    ):
        until(lambda: not hostile.left, "all was sent")
        north.images()
        until(lambda: north.counters.fault is None, "the fault was over")


def test_a_device_delivers_raw_images(monkeypatch: pytest.MonkeyPatch) -> None:
    made = Opening("testsrc=size=64x48:rate=20,realtime", "lavfi", {})
    monkeypatch.setattr(DeviceAddress, "opening", lambda self, size_px: made)
    north = Watched(StreamSource("north", DeviceAddress("/dev/video0"), SIZE_PX))
    frames = north.images(5)
    north.source.close()
    assert {frame.image.shape for frame in frames} == {(48, 64, 3)}
    assert frames[0].image.std() > 10.0
    assert north.counters.codec == "wrapped_avframe"


def test_motion_jpeg_over_http_is_read_at_any_rate() -> None:
    with closing(JpegCamera(fps=5)) as camera, watched(camera.url, SIZE_PX) as north:
        frames = north.images(15)  # FFmpeg counts them as 25 images per second
        assert north.counters.codec == "mjpeg"
        assert north.counters.fault is None
        assert north.counters.dropped.get("late", 0) < 5
    times_s = [frame.t_s for frame in frames]
    assert times_s == sorted(times_s)


def test_images_of_another_size_are_left_out_until_the_size_is_back(camera: MadeCamera) -> None:
    with watched(camera.url, SIZE_PX) as north:
        north.images()
        camera.size_px = (96, 64)
        told = north.fault("its images are 96 x 64 px, but it is calibrated for 64 x 48 px")
        assert "Set the stream to that size" in told
        until(lambda: north.counters.dropped.get("size", 0) >= 3, "such images were left out")
        camera.size_px = SIZE_PX
        frames = north.images()
        assert {frame.image.shape for frame in frames} == {(48, 64, 3)}
        until(lambda: north.counters.fault is None, "the fault was over")


def test_an_image_that_lacks_a_few_rows_is_taken(camera: MadeCamera) -> None:
    camera.size_px = (64, 64)
    source = StreamSource("north", NetworkAddress(camera.url), (64, 65))
    one = Watched(source)
    assert one.images(1)[0].image.shape == (64, 64, 3)
    source.close()


def test_a_source_ends_soon_after_it_is_closed_whatever_its_camera_does(
    camera: MadeCamera,
) -> None:
    with watched(camera.url, SIZE_PX) as north:
        north.images(1)
        camera.sends.clear()
        north.source.close()
        north.thread.join(2.0)  # the silence of the camera takes 3 s to be told
        assert not north.thread.is_alive()


def test_the_same_image_for_long_is_told(
    camera: MadeCamera, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(frozen_image, "FROZEN_S", 0.5)
    camera.still = True
    with watched(camera.url, SIZE_PX) as north:
        north.fault("it has shown the same image for")
        camera.still = False
        until(lambda: north.counters.fault is None, "the fault was over")


def test_an_image_that_differs_little_is_another_one() -> None:
    image = np.full((12, 16), 7, np.uint8)
    frozen = FrozenImage()
    assert not frozen.is_frozen(image, 0.0)
    assert not frozen.is_frozen(image, 9.0)
    assert frozen.is_frozen(image, 10.0)
    other = image.copy()
    other[3, 5] += 1
    assert not frozen.is_frozen(other, 10.1)


def test_no_text_of_a_source_shows_its_password() -> None:
    from trecsim.sources.streams.camera_login import Login

    address = NetworkAddress("rtsp://10.0.0.12/1", login=Login("admin", "s3cret"))
    source = StreamSource("north", address, SIZE_PX)
    texts = [repr(source), repr(address), str(address), repr(address.opening(SIZE_PX))]
    assert not any("s3cret" in text or "admin" in text for text in texts)
    assert "admin:s3cret@" in address.opening(SIZE_PX).name


@pytest.mark.parametrize(
    ("url", "opened"),
    [
        ("rtsp://cam/1", "rtsp://a%40b:p%2F%3A%40w@cam/1"),
        ("rtsp://cam/u={user}&p={password}", "rtsp://cam/u=a%40b&p=p%2F%3A%40w"),
    ],
)
def test_user_and_password_are_escaped(url: str, opened: str) -> None:
    from trecsim.sources.streams.camera_login import Login

    address = NetworkAddress(url, login=Login("a@b", "p/:@w"))
    assert address.opening(SIZE_PX).name == opened
