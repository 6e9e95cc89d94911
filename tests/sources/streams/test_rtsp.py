"""RTSP cameras of a real server: their clock, and what they and the network do to us."""

import logging
import time
from collections.abc import Iterator
from contextlib import closing

import numpy as np
import pytest

from made_cameras import until
from rtsp_servers import FPS, SIZE_PX, Network, RtspCamera, painted_s, rtsp_camera
from trecsim.sources.streams.camera_login import Login
from watched_streams import Watched, watched


@pytest.fixture(scope="module")
def camera() -> Iterator[RtspCamera]:
    """Return a camera that stays on."""
    with rtsp_camera() as made:
        yield made


@pytest.fixture
def network(camera: RtspCamera) -> Iterator[Network]:
    """Return a network between that camera and us."""
    with closing(Network(camera.port)) as made:
        yield made


def sender(north: Watched) -> None:
    until(lambda: north.counters.clock == "sender", "the camera told its clock")


@pytest.mark.parametrize("transport", ["tcp", "udp"])
def test_images_are_dated_by_the_clock_of_the_camera(camera: RtspCamera, transport: str) -> None:
    with watched(camera.url(), SIZE_PX, transport=transport) as north:
        sender(north)
        frames = north.images(2 * FPS)
    wrong_s = [frame.t_s - painted_s(frame.image) for frame in frames[FPS:]]
    assert abs(float(np.median(wrong_s))) < 0.2
    assert north.counters.delay_s is not None
    assert north.counters.fault is None


@pytest.mark.usefixtures("impatient")
def test_a_camera_that_is_killed_and_comes_back_delivers_again() -> None:
    with rtsp_camera() as camera, watched(camera.url(), SIZE_PX) as north:
        last_s = north.images()[-1].t_s
        camera.switch_off()
        north.fault("nothing answers at 127.0.0.1")
        camera.switch_on()
        assert north.images()[-1].t_s > last_s
        sender(north)
        assert north.counters.fault is None


@pytest.mark.usefixtures("impatient")
def test_a_camera_that_freezes_is_given_up_and_delivers_again() -> None:
    with rtsp_camera() as camera, watched(camera.url(), SIZE_PX) as north:
        north.images()
        camera.freeze()
        north.fault("nothing has come from rtsp://127.0.0.1")
        camera.thaw()
        north.images()
        assert north.counters.fault is None


def test_a_wrong_password_is_told_without_being_shown(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.DEBUG)
    with rtsp_camera(login="admin:s3cret/:@%") as camera:
        with watched(camera.url(), SIZE_PX, login=Login("admin", "wr0ng")) as north:
            told = north.fault("refuses user or password; check the credentials 'gate'")
            assert "TRECSIM_CREDENTIALS_GATE" in told
        with watched(camera.url(), SIZE_PX) as north:
            assert 'write credentials = "NAME"' in north.fault("asks for user and password")
        with watched(camera.url(), SIZE_PX, login=Login("admin", "s3cret/:@%")) as north:
            north.images()
    assert not any(word in caplog.text for word in ("wr0ng", "s3cret"))


def test_a_stream_that_the_camera_does_not_have_is_told(camera: RtspCamera) -> None:
    with watched(camera.url("/nothing"), SIZE_PX) as north:
        assert "knows no such stream: rtsp://" in north.fault("/nothing")


def test_a_stream_without_video_is_told(camera: RtspCamera) -> None:
    with watched(camera.url("/sound"), SIZE_PX) as north:
        north.fault("does not play rtsp://")
        assert "there may be no video in it" in str(north.counters.fault)


def test_a_gap_in_the_network_is_outlived_and_old_images_are_left_out(
    camera: RtspCamera, network: Network
) -> None:
    with watched(camera.url(port=network.port), SIZE_PX) as north:
        sender(north)
        north.images()
        network.passes.clear()
        until(lambda: time.monotonic() - (north.counters.last_image_s or 0.0) > 2.0, "2 s passed")
        network.passes.set()
        until(lambda: north.counters.dropped.get("late", 0) > 0, "late images were left out")
        frame = north.images(FPS)[-1]
        assert frame.t_s - painted_s(frame.image) < 0.5
        times_s = [one.t_s for one in north.frames]
        assert times_s == sorted(times_s)


@pytest.mark.usefixtures("impatient")
def test_a_long_gap_in_the_network_is_told(camera: RtspCamera, network: Network) -> None:
    with watched(camera.url(port=network.port), SIZE_PX) as north:
        north.images()
        network.passes.clear()
        north.fault("nothing has come")
        network.passes.set()
        north.images()
        assert north.counters.fault is None
        assert north.counters.reconnects >= 1


@pytest.mark.usefixtures("impatient")
def test_a_network_that_is_too_slow_for_the_images_is_told(
    camera: RtspCamera, network: Network
) -> None:
    with watched(camera.url(port=network.port), SIZE_PX) as north:
        sender(north)
        network.slow_s = 4.0 / FPS
        assert "set a lower bit rate" in north.fault("late all the time")
        network.slow_s = 0.0
        frame = north.images(FPS)[-1]
        assert frame.t_s - painted_s(frame.image) < 0.5


@pytest.mark.parametrize("step_s", [3600.0, -3600.0, 2.0])
def test_a_step_of_the_cameras_clock_moves_no_image(
    camera: RtspCamera, network: Network, step_s: float
) -> None:
    with watched(camera.url(port=network.port), SIZE_PX) as north:
        sender(north)
        before = north.images()[-1]
        network.step_s = step_s
        north.fault("its clock was set while it sent")
        assert north.counters.clock == "arrival"
        after = north.images()[-1]
    error_s = [frame.t_s - painted_s(frame.image) for frame in (before, after)]
    assert abs(error_s[1] - error_s[0]) < 0.5
    times_s = [one.t_s for one in north.frames]
    assert times_s == sorted(times_s)


def test_a_camera_whose_clock_is_wrong_is_dated_by_arrival(
    camera: RtspCamera, network: Network
) -> None:
    network.step_s = -86400.0 * 300
    with watched(camera.url(port=network.port), SIZE_PX) as north:
        assert "set the time of both by NTP" in north.fault("300 days behind")
        frame = north.images()[-1]
    assert abs(frame.t_s - painted_s(frame.image)) < 1.0


@pytest.mark.usefixtures("impatient")
def test_garbage_between_the_packets_is_outlived(camera: RtspCamera, network: Network) -> None:
    with watched(camera.url(port=network.port), SIZE_PX) as north:
        north.images()
        for garbage in (bytes(range(256)) * 300, b"$\0\xff\xff" + b"x" * 3000):
            network.garbage = garbage
            north.images(FPS)


def test_another_size_in_mid_stream_is_left_out_until_the_first_is_back() -> None:
    with rtsp_camera() as camera, watched(camera.url(), SIZE_PX) as north:
        north.images()
        camera.say("size 256 64")
        north.fault("its images are 256 x 64 px, but it is calibrated for 320 x 96 px")
        camera.say("size 320 96")
        assert {frame.image.shape for frame in north.images()} == {(96, 320, 3)}
        until(lambda: north.counters.fault is None, "the fault was over")
