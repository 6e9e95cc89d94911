"""No message shows a password that stands in an address."""

import logging

import pytest
from hypothesis import given
from hypothesis import strategies as st

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
        ("'rtsp://admin:a long/passw...", "'rtsp://***"),
        ("rtsp://admin:my pw@cam/1: refused", "rtsp://***@cam/1: refused"),
        ("'rtsp://admin:one@two/thr...: expected a file", "'rtsp://***: expected a file"),
        ("C:/rig.toml: line 3: name: expected a@b", "C:/rig.toml: line 3: name: expected a@b"),
        (
            "found rtsp://a:pw@cam/1; write url = 'rtsp://...'",
            "found rtsp://***@cam/1; write url = 'rtsp://...'",
        ),
        ("http://cam/1?password=my pw&rate=5", "http://cam/1?password=***&rate=5"),
        ("'http://cam/1?user=me&pwd=it's mine': no", "'http://cam/1?user=***&pwd=***': no"),
        ("http://cam/1?password=my pw: refused", "http://cam/1?password=***: refused"),
        ("cam/1?usr=me&pwd=my pw", "cam/1?usr=***&pwd=***"),
        ("cam/1?loginuse=me&loginpas=pw, then", "cam/1?loginuse=***&loginpas=***, then"),
        ("admin:my pw@cam/1: refused", "***@cam/1: refused"),
        ("north=admin:p@s/s w:d@cam:554/1", "north=***@cam:554/1"),
        ("at 12:30 the camera\nfailed: a@b", "at 12:30 the camera\nfailed: a@b"),
        ("rtsp://cam:554/1", "rtsp://cam:554/1"),
        ("https://cam:8443: refused", "https://cam:8443: refused"),
        ("site.toml: line 3: name: expected a@b", "site.toml: line 3: name: expected a@b"),
        ("camera 'north': time = 3: wrong", "camera 'north': time = 3: wrong"),
    ],
)
def test_what_opens_a_camera_is_left_out_and_all_else_kept(text, shown):
    assert redacted(text) == shown


# Each word of these passwords is found in no message; between the words stands anything but a line
# break.
WORDS = ("qxz", "zqj", "jzx")
ODD = st.text(
    st.one_of(
        st.sampled_from(" '\"@/?#:<>&=%.,;()[]{}\\\t"),
        st.characters(exclude_categories=("L", "N", "Cs", "Zl", "Zp", "Cc")),
    ),
    max_size=4,
)
PASSWORDS = st.builds(
    lambda odd, end: (
        "".join(f"{between}{word}" for word, between in zip(WORDS, odd, strict=True)) + end
    ),
    st.tuples(ODD, ODD, ODD),
    st.sampled_from(["", "%20", "%40zqj", "@", "/", "?"]),
)
MESSAGES = [
    "{}",
    "cannot read {}: the server refused it; look at the user and the password",
    "camera 'north': expected a file, found {!r}; give a recording",
    "north={}, then",
]


@given(password=PASSWORDS, message=st.sampled_from(MESSAGES), rest=st.sampled_from(["", ":554/1"]))
def test_no_part_of_a_password_is_shown_whatever_it_holds(password, message, rest):
    shown = redacted(message.format(f"rtsp://admin:{password}@cam{rest}"))
    assert "admin" not in shown
    assert not any(word in shown for word in WORDS), shown
    assert f"***@cam{rest}" in shown


@given(password=PASSWORDS, message=st.sampled_from(MESSAGES), rest=st.sampled_from(["", ":554/1"]))
def test_no_part_of_a_password_is_shown_in_an_address_without_a_scheme(password, message, rest):
    shown = redacted(message.format(f"admin:x{password}@cam{rest}"))
    assert not any(word in shown for word in WORDS), shown
    assert f"***@cam{rest}" in shown


@given(
    words=st.tuples(
        *[st.sampled_from([" ", "  ", "'s ", "/", "@", "%20", "?", "#", "=", ".", "!"])] * 2
    ),
    key=st.sampled_from(["password", "pwd", "pass", "auth_token", "loginpas"]),
    end=st.sampled_from(["", "&rate=5", ": refused", ", then", "'; give a file"]),
)
def test_no_part_of_a_password_in_a_query_is_shown(words, key, end):
    password = "qxz{}zqj{}jzx".format(*words)
    for scheme in ("http://", "rtsp://", ""):
        shown = redacted(f"north={scheme}cam/1?rate=5&{key}={password}{end}")
        assert not any(word in shown for word in WORDS), shown
        assert shown.endswith(f"{key}=***{end}")


@given(password=PASSWORDS, kept=st.integers(0, 30))
def test_no_part_of_a_password_is_shown_where_a_message_cuts_it(password, kept):
    shown = redacted(f"found 'rtsp://admin:{password}"[: 20 + kept] + "...")
    assert not any(word[:2] in shown for word in WORDS), shown


@pytest.mark.parametrize("error", [InputError, CalibrationError])
def test_no_error_shows_a_password(error):
    assert str(error("cannot open rtsp://admin:pw@cam/1")) == "cannot open rtsp://***@cam/1"


def test_no_log_message_and_no_argument_fault_on_the_command_line_shows_a_password(capsys):
    with pytest.raises(SystemExit):
        main(["rig", "show", "rtsp://admin:pw@cam/1", "--unit-m", "rtsp://admin:pw@cam/1"])
    logging.getLogger("elsewhere").warning("lost %s", "rtsp://admin:pw@cam/1")
    assert "pw" not in capsys.readouterr().err


@pytest.mark.parametrize("password", ["qxz zqj", "%20@qxz='zqj/jzx?"])
@pytest.mark.parametrize(
    "arguments",
    [
        ["estimate", "{}", "{}", "--out", "a.poses.jsonl"],
        ["estimate", "north={}", "--out", "a.poses.jsonl"],
        ["track", "{}", "{}"],
        ["rig", "show", "{}"],
        ["site", "check", "{}"],
        ["evaluate", "{}"],
    ],
)
def test_no_command_shows_a_part_of_an_odd_password(arguments, password, capsys):
    address = f"rtsp://admin:{password}@cam"
    with pytest.raises(SystemExit):
        main([one.format(address) for one in arguments])
    told = capsys.readouterr()
    assert not any(word in told.out + told.err for word in WORDS), told.err


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
