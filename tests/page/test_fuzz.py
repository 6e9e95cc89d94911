"""Whatever comes over the network, the page neither fails nor keeps anything of it."""

import json
import os
import socket
from collections.abc import Iterator
from contextlib import suppress
from itertools import count
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from made_page import RunningPage, event, next_of, running_page, until
from often import often
from page_processes import linux, process_of
from trecsim.page.address import PageAddress
from trecsim.page.page_data import PageData

EXAMPLES = 150
ROUTES = (
    "GET /", "GET /api/health", "GET /api/site", "GET /api/site/draft", "PUT /api/site/draft",
    "DELETE /api/site/draft", "POST /api/site/draft/live", "POST /api/site/draft/try",
    "POST /api/site/reload", "GET /api/events", "POST /api/events", "POST /api/events/one",
    "POST /api/login", "POST /api/logout", "GET /api/me", "GET /api/mode", "POST /api/mode",
    "GET /api/recordings", "GET /api/recordings/x/snapshots", "GET /api/stream",
    "GET /api/users/me/reviewed", "POST /api/users/me/reviewed", "GET /api/cameras/north/picture",
    "POST /api/feeds/gate", "POST /api/feeds/none", "GET /metrics", "GET /assets/x", "HEAD /",
    "OPTIONS /api/site", "PATCH /api/site", "X /",
)  # fmt: skip
QUERIES = ("", "?after=one", "?limit=1", "?limit=1e99", "?from_s=0&to_s=1", "?until_s=nan", "?%ff")
KEYS = (
    "phase", "event", "events", "until_s", "reason", "note", "user", "password", "based_on",
    "revision", "zones", "lines", "edges", "polygon_m", "points_m", "mode", "reviewed",
    "bypass", "rule", "t_s", "grant", "closed", "volume", "xy_m",
)  # fmt: skip

texts = st.text(max_size=20)
plain = st.none() | st.booleans() | st.integers() | st.floats() | texts | st.sampled_from(KEYS)
values = st.recursive(
    plain,
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(st.sampled_from(KEYS) | texts, inner, max_size=6)
    ),
    max_leaves=12,
)
bodies = st.one_of(
    values.map(lambda value: json.dumps(value).encode()),
    st.binary(max_size=200),
    st.sampled_from([b"[" * 15_000, b'{"a":' * 3_000, b'"' + b"\\ud800" * 2_000 + b'"', b"-"]),
)
tails = st.sampled_from(QUERIES) | st.text(st.characters(codec="latin-1"), max_size=20)
headers = st.dictionaries(
    st.sampled_from(
        ["Authorization", "Cookie", "Origin", "Content-Type", "X-Forwarded-Proto", "Upgrade",
         "Connection", "Transfer-Encoding", "Sec-WebSocket-Key", "Accept-Encoding", "Range"]
    ),
    st.sampled_from(
        ["websocket", "Upgrade", "application/json", "application/x-ndjson", "chunked",
         "Bearer x", "gzip", "null", "a=b", "bytes=0-", "dGhlIHNhbXBsZSBub25jZQ==", "\xff\xfe"]
    ),
    max_size=4,
)  # fmt: skip
addresses = count(1)


@pytest.fixture(scope="module")
def fuzzed(
    tmp_path_factory: pytest.TempPathFactory, request: pytest.FixtureRequest
) -> Iterator[tuple[RunningPage, Path]]:
    """Run a page in which every route leads somewhere; return it and what it wrote to stderr."""
    folder = tmp_path_factory.mktemp("fuzzed")
    (folder / "site.toml").write_text('format = "trecsim.site/1"\nname = "hall"\n')
    (folder / "recordings").mkdir()
    data = PageData(folder / "recordings", folder / "ledger", folder / "site.toml")
    log, before = folder / "stderr", os.dup(2)
    with log.open("wb") as file:
        os.dup2(file.fileno(), 2)  # what the page process inherits
    try:
        with running_page(PageAddress(port=0, trusted_proxy="127.0.0.1"), data) as page:
            page.process.event(event("one"))
            process_of(page)
            os.dup2(before, 2)
            yield page, log
    finally:
        os.dup2(before, 2)
        os.close(before)


def sent(page: RunningPage, content: bytes, patience_s: float = 0.3) -> bytes:
    """Send bytes and nothing after them; return what comes until nothing comes any more."""
    answer = b""
    connection = socket.create_connection(("127.0.0.1", page.port), timeout=20)
    with connection, suppress(ConnectionError):
        connection.sendall(content)
        connection.settimeout(patience_s)
        with suppress(TimeoutError):  # it waits for more, or has more to say
            while part := connection.recv(65536):
                answer += part
            return answer
        connection.shutdown(socket.SHUT_WR)
        connection.settimeout(20)
        while connection.recv(65536):
            pass
    return answer


def request_of(route: str, more: dict[str, str], body: bytes) -> bytes:
    lines = [
        f"{route} HTTP/1.1", "Host: localhost", f"Content-Length: {len(body)}",
        f"X-Forwarded-For: 10.9.{next(addresses) % 250}.1", "Connection: close",
        *(f"{name}: {value}" for name, value in more.items()),
    ]  # fmt: skip
    return "\r\n".join([*lines, "", ""]).encode("utf-8", "surrogateescape") + body


def check_alive(page: RunningPage, log: Path, answer: bytes) -> None:
    """Check that an answer tells of no fault, and that the page goes on."""
    status = answer.split(b" ", 2)[1] if answer.startswith(b"HTTP/1.1 ") else b"none"
    assert not status.startswith(b"5") or status == b"503", answer[:500]
    assert page.process.restarts == 0
    assert log.read_text() == ""


@linux
@settings(max_examples=often(EXAMPLES))
@given(route=st.sampled_from(ROUTES), tail=tails, more=headers, body=st.just(b"") | bodies)
def test_no_request_makes_the_page_fail(
    fuzzed: tuple[RunningPage, Path], route: str, tail: str, more: dict[str, str], body: bytes
) -> None:
    page, log = fuzzed
    check_alive(page, log, sent(page, request_of(route + tail, more, body)))


@linux
@settings(max_examples=often(EXAMPLES))
@given(route=st.sampled_from([one for one in ROUTES if one[0] == "P"]), body=values)
def test_no_json_makes_the_page_fail(
    fuzzed: tuple[RunningPage, Path], route: str, body: object
) -> None:
    page, log = fuzzed
    kind = {"Content-Type": "application/json"}
    content = request_of(route, kind, json.dumps(body).encode())
    check_alive(page, log, sent(page, content))


@linux
@pytest.mark.parametrize("tail", QUERIES)
@pytest.mark.parametrize("route", ROUTES)
def test_no_plain_request_makes_the_page_fail(
    fuzzed: tuple[RunningPage, Path], route: str, tail: str
) -> None:
    page, log = fuzzed
    answer = sent(page, request_of(route + tail, {}, b""), patience_s=20.0)
    assert answer.startswith(b"HTTP/1.1 ")
    check_alive(page, log, answer)


@linux
@settings(max_examples=often(EXAMPLES))
@given(
    st.binary(max_size=300)
    | st.tuples(st.sampled_from([b"GET / HTTP/1.1\r\n", b"POST /api/login "]), st.binary()).map(
        b"".join
    )
)
def test_no_bytes_make_the_page_fail(fuzzed: tuple[RunningPage, Path], content: bytes) -> None:
    page, log = fuzzed
    check_alive(page, log, sent(page, content, patience_s=0.02))


@linux
def test_who_hangs_up_within_a_body_fills_no_log(fuzzed: tuple[RunningPage, Path]) -> None:
    page, log = fuzzed
    for route in (one for one in ROUTES if one[0] == "P"):
        whole = request_of(route, {"Content-Type": "application/json"}, b'{"user": "anna"}')
        check_alive(page, log, sent(page, whole[:-1], patience_s=0.05))
    page.client.get("/api/health")  # by then all of it was taken in
    assert log.read_text() == ""


UPGRADE = {
    "Upgrade": "websocket", "Connection": "Upgrade", "Sec-WebSocket-Version": "13",
    "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==",
}  # fmt: skip


@linux
@settings(max_examples=often(EXAMPLES))
@given(
    query=st.sampled_from(["", "?last_event_id=", "?last_event_id=%00%ff", "?last_event_id=one"]),
    frames=st.lists(
        st.tuples(
            st.sampled_from([0x80, 0x81, 0x82, 0x88, 0x89, 0x8A, 0x01, 0xF1]),
            st.sampled_from([0x00, 0x05, 0x80, 0x85, 0xFE, 0xFF, 0x7F]),
            st.binary(max_size=150),
        ).map(lambda parts: bytes(parts[:2]) + parts[2]),
        max_size=5,
    ),
)
def test_no_frames_make_the_stream_fail(
    fuzzed: tuple[RunningPage, Path], query: str, frames: list[bytes]
) -> None:
    page, log = fuzzed
    lines = "\r\n".join(f"{name}: {value}" for name, value in UPGRADE.items())
    start = f"GET /api/stream{query} HTTP/1.1\r\nHost: localhost\r\n{lines}\r\n\r\n".encode()
    check_alive(page, log, sent(page, start + b"".join(frames), patience_s=0.02))


@linux
def test_after_all_that_the_page_keeps_no_connection_and_no_viewer(
    fuzzed: tuple[RunningPage, Path],
) -> None:
    page, _ = fuzzed
    handles = Path(f"/proc/{process_of(page)}/fd")
    until(lambda: "trecsim_page_viewers 0.0" in page.client.get("/metrics").text)
    page.client.close()
    until(lambda: sum("socket" in target for target in targets(handles)) <= 4)
    with page.stream() as stream:
        next_of(stream, "health")


def targets(folder: Path) -> list[str]:
    found = []
    for handle in folder.iterdir():
        try:
            found.append(os.readlink(handle))
        except FileNotFoundError:
            continue
    return found
