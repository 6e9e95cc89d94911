"""Addresses of cameras: what is taken, and what is said about the rest without a password."""

import pytest

from trecsim.errors import InputError
from trecsim.sources.streams.stream_address import (
    DeviceAddress,
    NetworkAddress,
    check_device,
    check_url,
)


@pytest.mark.parametrize(
    "url",
    [
        "rtsp://cam-north.local:554/stream1",
        "rtsps://10.0.0.12/Streaming/Channels/102",
        "rtsp://[fe80::1]:554/1",
        "http://10.0.0.12/video.mjpg?size=1",
        "udp://239.0.0.1:1234",
        "rtsp://10.0.0.12/user={user}&password={password}&channel=1",
    ],
)
def test_addresses_of_cameras_are_taken(url: str) -> None:
    assert check_url(url) == url


@pytest.mark.parametrize(
    ("url", "told"),
    [
        ("cam-north/stream1", "begins with one of rtsp://, rtsps://, http://"),
        ("file:///etc/passwd", "begins with one of"),
        ("concat:a|b", "begins with one of"),
        ("rtsp://", "with the address of the camera"),
        ("rtsp://:554/1", "with the address of the camera"),
        ("rtsp://cam:port/1", "expected a URL like"),
        ("rtsp://[::1/1", "expected a URL like"),
        ("rtsp://cam/a b", "without spaces"),
        ("rtsp://cam/" + "x" * 2000, "at most 1000 letters"),
    ],
)
def test_other_addresses_are_told(url: str, told: str) -> None:
    with pytest.raises(InputError) as caught:
        check_url(url)
    assert told in str(caught.value)


@pytest.mark.parametrize(
    "url",
    [
        "rtsp://admin:s3cret@10.0.0.12/1",
        "rtsp://admin@10.0.0.12/1",
        "rtsp://10.0.0.12/user=admin_password=s3cret_channel=1",
        "http://10.0.0.12/cam?usr=admin&pwd=s3cret",
    ],
)
def test_a_password_in_the_address_is_refused_without_being_shown(url: str) -> None:
    with pytest.raises(InputError) as caught:
        check_url(url)
    assert "TRECSIM_CREDENTIALS_NAME" in str(caught.value)
    assert "s3cret" not in str(caught.value)
    assert "admin" not in str(caught.value)


def test_devices_are_paths_or_numbers() -> None:
    assert check_device(0) == check_device("0") == check_device("/dev/video0") == "/dev/video0"
    assert check_device("/dev/v4l/by-id/usb-cam-1") == "/dev/v4l/by-id/usb-cam-1"
    for wrong in ("video0", "/etc/passwd", "/dev/../etc/passwd", "", -1):
        with pytest.raises(InputError, match="expected a device like"):
            check_device(wrong)


def test_rtsp_is_opened_without_delay_and_by_the_transport_asked_for() -> None:
    opening = NetworkAddress("rtsp://cam/1", "udp").opening((640, 360))
    assert opening.options["rtsp_transport"] == "udp"
    assert opening.options["fflags"] == "nobuffer"
    assert "file" not in opening.options["protocol_whitelist"]


def test_a_webcam_is_asked_for_the_calibrated_size() -> None:
    opening = DeviceAddress("/dev/video0").opening((640, 360))
    assert (opening.name, opening.format) == ("/dev/video0", "video4linux2")
    assert opening.options["video_size"] == "640x360"
