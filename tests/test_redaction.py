"""No message shows a password that stands in an address."""

import logging

import pytest

from trecsim.cli import main
from trecsim.errors import CalibrationError, InputError
from trecsim.redaction import redacted


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("rtsp://admin:pw@10.0.0.12:554/s", "rtsp://***@10.0.0.12:554/s"),
        ("rtsp:/admin:pw@10.0.0.12:554/s", "rtsp:/***@10.0.0.12:554/s"),
        ("/home/me/rtsp:/admin:pw@10.0.0.12/s", "/home/me/rtsp:/***@10.0.0.12/s"),
        ("'rtsp://admin:p@ss/w:rd@cam/1'", "'rtsp://***@cam/1'"),
        ("http://cam/1?user=a&password=b&rate=5", "http://cam/1?user=***&password=***&rate=5"),
        ("cam1=rtsp://:pw@cam/1, then", "cam1=rtsp://***@cam/1, then"),
        ("admin:pw@cam/1", "***@cam/1"),
        ("http://cam/1?pw=b&rate=5", "http://cam/1?pw=***&rate=5"),
        ("rtsp://cam/user=a_password=b_channel=1.sdp", "rtsp://cam/user=a_password=***"),
        ("user=a_password=b_channel=1", "user=a_password=***"),
        ("'rtsp://admin:a-long-passw...", "'rtsp://***"),
        ("rtsp://cam:554/1", "rtsp://cam:554/1"),
        ("https://cam:8443: refused", "https://cam:8443: refused"),
        ("site.toml: line 3: name: expected a@b", "site.toml: line 3: name: expected a@b"),
        ("camera 'north': time = 3: wrong", "camera 'north': time = 3: wrong"),
    ],
)
def test_what_opens_a_camera_is_left_out_and_all_else_kept(text, shown):
    assert redacted(text) == shown


@pytest.mark.parametrize("error", [InputError, CalibrationError])
def test_no_error_shows_a_password(error):
    assert str(error("cannot open rtsp://admin:pw@cam/1")) == "cannot open rtsp://***@cam/1"


def test_no_log_message_and_no_argument_fault_on_the_command_line_shows_a_password(capsys):
    with pytest.raises(SystemExit):
        main(["rig", "show", "rtsp://admin:pw@cam/1", "--unit-m", "rtsp://admin:pw@cam/1"])
    logging.getLogger("elsewhere").warning("lost %s", "rtsp://admin:pw@cam/1")
    assert "pw" not in capsys.readouterr().err


@pytest.mark.parametrize(
    "arguments",
    [
        ["estimate", "rtsp://admin:pw@10.0.0.12:554/stream1", "--out", "a.poses.jsonl"],
        ["estimate", "north=rtsp://admin:pw@10.0.0.12:554/stream1", "--out", "a.poses.jsonl"],
        ["estimate", "rtsp://cam/user=admin_password=pw_channel=1", "--out", "a.poses.jsonl"],
        ["estimate", "http://cam/1?password=pw", "--out", "a.poses.jsonl"],
        ["track", "rtsp://admin:pw@cam/rig.toml", "rtsp://admin:pw@cam/poses"],
        ["rig", "show", "http://admin:pw@cam/rig.toml"],
        ["site", "check", "http://admin:pw@cam/site.toml"],
    ],
)
def test_no_command_shows_a_password_that_it_was_given(arguments, capsys):
    with pytest.raises(SystemExit) as caught:
        main(arguments)
    assert caught.value.code == 2
    err = capsys.readouterr().err
    assert "***" in err
    assert "pw" not in err
