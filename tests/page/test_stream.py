"""The stream: what viewers get, in which form, and what a slow one costs."""

import json
import os
import socket
from collections.abc import Sequence
from contextlib import ExitStack, suppress
from pathlib import Path
from time import time

import numpy as np
import pytest
from hypothesis import given, settings
from jsonschema import Draft202012Validator
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection
from websockets.typing import Origin

from made_page import RunningPage, event, next_of, running_page, until, well
from made_tracks import recordings, snapshot
from often import often
from page_processes import linux, process_of
from trecsim.page.client import snapshot_of
from trecsim.page.event_log import EVENTS_KEPT
from trecsim.page.hub import VIEWERS
from trecsim.page.last_seen import LastSeen, snapshot_part
from trecsim.page.messages import message, snapshot_body
from trecsim.page.page_data import PageData
from trecsim.page.schema import stream_schema
from trecsim.safety.vehicle import PlacedVehicle
from trecsim.store.ledger import Ledger
from trecsim.values import Snapshot

VALIDATOR = Draft202012Validator(stream_schema())


def told(page: RunningPage, given: Snapshot, vehicles: Sequence[PlacedVehicle] = ()) -> dict:
    with page.stream() as stream:
        page.process.write(given, vehicles)
        while (got := next_of(stream, "snapshot"))["t_s"] != given.t_s:
            pass
        return got


def one_of_each(stream: ClientConnection) -> dict[str, dict]:
    """Return the first message of each kind."""
    found: dict[str, dict] = {}
    while len(found) < 3:
        got = json.loads(stream.recv(20))
        found.setdefault(got["type"], got)
    return found


def test_a_viewer_gets_the_people_that_the_tracking_process_wrote(page: RunningPage) -> None:
    given = snapshot(time(), [3, 8])
    got = told(page, given)
    assert [person["person"] for person in got["people"]] == [3, 8]
    for person, xyz_m, sigma_m in zip(got["people"], given.xyz_m, given.sigma_m, strict=True):
        np.testing.assert_allclose(person["xyz_m"], xyz_m, atol=0.0005)
        np.testing.assert_allclose(person["sigma_m"], sigma_m, atol=0.00005)
        assert person["support"] == [3] * 17
        assert (person["state"], person["seen_s"], person["posture"]) == ("confirmed", 0, "lying")
    assert abs(got["sent_s"] - time()) < 60


def test_vehicles_of_feeds_come_with_the_people_and_fit_the_schema(page: RunningPage) -> None:
    given = snapshot(time(), [1])
    truck = PlacedVehicle("truck", "7", (3.20049, -1.0), np.pi / 2)
    got = told(page, given, [truck])
    VALIDATOR.validate(got)
    assert got["volumes"] == [
        {"volume": "truck", "id": "7", "xy_m": [3.2, -1.0], "heading_deg": 90.0}
    ]
    assert snapshot_of(got).id.tolist() == [1]  # the client for programs reads it, too
    assert "volumes" not in told(page, snapshot(time(), [1]))


def test_what_is_missing_is_null_and_the_rest_has_three_decimals(page: RunningPage) -> None:
    given = snapshot(time(), [1])
    given.xyz_m[0, 5] = np.nan, 1.23456789, -0.0004
    person = told(page, given)["people"][0]
    assert person["xyz_m"][5] == [None, 1.235, 0.0]


def test_the_published_schema_accepts_the_messages_and_nothing_that_differs(
    page: RunningPage,
) -> None:
    published = page.client.get("/api/schema")
    assert published.json() == stream_schema()
    with page.stream("?last_event_id=none") as stream:
        page.process.write(snapshot(time(), [1, 2]))
        page.process.health(well())
        page.process.event(event("for-the-schema"))
        for kind, got in one_of_each(stream).items():
            VALIDATOR.validate(got)
            for key in VALIDATOR.schema["$defs"][kind]["required"]:
                without = {name: value for name, value in got.items() if name != key}
                assert not VALIDATOR.is_valid(without), f"{kind} without {key}"
            assert VALIDATOR.is_valid({**got, "more": 1}) == (kind == "health")


@settings(max_examples=often(20))
@given(recordings())
def test_every_snapshot_fits_the_schema(made: list[Snapshot]) -> None:
    seen = LastSeen()
    for one in made:
        part = snapshot_part(one, seen.ages_s(one))
        VALIDATOR.validate(json.loads(message("snapshot", 1.0, snapshot_body(part))))


def test_seen_s_counts_from_the_last_camera_that_supported_the_person() -> None:
    seen, ages = LastSeen(), []
    for t_s, support in ((0.0, 0), (1.0, 2), (1.5, 0), (2.5, 0), (3.0, 1)):
        one = snapshot(t_s, [4])
        one.support[:] = 0
        one.support[0, 7] = support
        ages += seen.ages_s(one)
    assert ages == [0.0, 0.0, 0.5, 1.5, 0.0]


def test_a_new_viewer_gets_the_newest_snapshot_and_health_at_once(page: RunningPage) -> None:
    given = snapshot(time(), [5])
    told(page, given)
    page.process.health(well())
    with page.stream() as stream:
        assert next_of(stream, "snapshot")["t_s"] == given.t_s
    with page.stream() as stream:
        assert set(next_of(stream, "health")["cameras"]) == {"north", "south"}


def test_the_time_until_viewers_can_have_a_snapshot_is_a_stage(page: RunningPage) -> None:
    page.process.health(well())

    def published() -> dict[str, float]:
        page.process.write(snapshot(time(), [1]))
        return page.client.get("/api/health").json()["stages"].get("publish", {})

    until(lambda: bool(published()))
    stage = published()
    assert 0.0 < stage["median_ms"] <= stage["p95_ms"]
    assert stage["age_ms"] >= 0.0
    assert 'trecsim_stage_age_seconds{stage="publish"}' in page.client.get("/metrics").text


def test_events_come_in_order_and_resume_after_the_last_one() -> None:
    with running_page() as page:
        with page.stream() as stream:
            next_of(stream, "health")
            for number in range(50):
                page.process.event(event(f"e{number}"))
            got = [next_of(stream, "event")["event"]["id"] for _ in range(50)]
            assert got == [f"e{number}" for number in range(50)]
        with page.stream("?last_event_id=e46") as stream:
            got = [next_of(stream, "event")["event"]["id"] for _ in range(3)]
            assert got == ["e47", "e48", "e49"]
        with page.stream("?last_event_id=unknown") as stream:
            assert next_of(stream, "event")["event"]["id"] == "e0"
        with page.stream() as stream:  # wants new events only
            next_of(stream, "health")
            page.process.event(event("e50"))
            assert next_of(stream, "event")["event"]["id"] == "e50"


def test_a_viewer_that_reads_nothing_gets_the_newest_snapshot_and_every_event_later() -> None:
    with running_page() as page, page.stream(max_queue=1) as slow, page.stream() as quick:
        next_of(slow, "health")
        people = list(range(60))
        for number in range(300):  # 25 MB: more than all buffers on the way
            page.process.write(snapshot(float(number), people))
            assert next_of(quick, "snapshot")["t_s"] == number
            if number % 100 == 0:
                page.process.event(event(f"e{number}"))
        got = [json.loads(slow.recv(20)) for _ in range(2)]
        while got[-1].get("t_s") != 299.0:
            got.append(json.loads(slow.recv(20)))
        snapshots = [one for one in got if one["type"] == "snapshot"]
        events = [one["event"]["id"] for one in got if one["type"] == "event"]
        assert len(snapshots) < 200
        assert events == ["e0", "e100", "e200"]


def test_viewers_that_catch_up_count_as_viewers_and_fill_no_log(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    with Ledger(tmp_path) as ledger:
        for number in range(EVENTS_KEPT + 1000):  # the first 1000 are in the ledger only
            ledger.append_event({**event(f"e{number}"), "pad": "x" * 5000})
    with running_page(data=PageData(ledger=tmp_path)) as page, ExitStack() as others:
        for _ in range(VIEWERS):  # none reads more than fits into its buffers
            others.enter_context(page.stream("?last_event_id=e5", max_queue=1))
        until(lambda: f"trecsim_page_viewers {VIEWERS}.0" in page.client.get("/metrics").text)
        with page.stream() as extra, pytest.raises(ConnectionClosed, match="too many viewers"):
            extra.recv(20)
        others.close()
        until(lambda: "trecsim_page_viewers 0.0" in page.client.get("/metrics").text)
        with page.stream("?last_event_id=e5") as stream:
            got = [next_of(stream, "event")["event"]["id"] for _ in range(EVENTS_KEPT + 994)]
        assert got == [f"e{number}" for number in range(6, EVENTS_KEPT + 1000)]
    assert capfd.readouterr().err == ""


def test_a_viewer_that_sends_something_is_disconnected(page: RunningPage) -> None:
    with page.stream() as stream:
        stream.send("hello")
        with pytest.raises(ConnectionClosed) as closed:
            next_of(stream, "none of this kind")
    assert closed.value.rcvd is not None
    assert closed.value.rcvd.code == 1008


def test_what_viewers_do_wrong_and_who_is_refused_fills_no_log(
    capfd: pytest.CaptureFixture[str],
) -> None:
    with running_page() as page:
        for _ in range(5):
            with pytest.raises(InvalidStatus), page.stream(origin=Origin("http://evil.example")):
                pass
            with page.stream() as stream:
                stream.send("hello")
                with pytest.raises(ConnectionClosed):
                    next_of(stream, "none of this kind")
            with page.stream() as stream:
                stream.send(b"\xff\xff", text=True)  # no UTF-8
                with pytest.raises(ConnectionClosed):
                    next_of(stream, "none of this kind")
            with page.stream() as stream:
                page.process.write(snapshot(time(), [1, 2]))
                stream.socket.sendall(b"\xc1\x80\x00\x00\x00\x00")  # compressed: not agreed
                with pytest.raises(ConnectionClosed):
                    next_of(stream, "none of this kind")
    assert capfd.readouterr().err == ""


def test_more_viewers_than_allowed_are_told_so() -> None:
    with running_page() as page, ExitStack() as others:
        for _ in range(63):
            next_of(others.enter_context(page.stream()), "health")
        with page.stream() as last:
            next_of(last, "health")
            with page.stream() as extra, pytest.raises(ConnectionClosed, match="too many viewers"):
                extra.recv(20)
        until(lambda: "trecsim_page_viewers 63.0" in page.client.get("/metrics").text)
        with page.stream() as another:
            next_of(another, "health")


def test_a_connection_that_sends_no_request_is_cut(page: RunningPage) -> None:
    with socket.create_connection(("127.0.0.1", page.port)) as connection:
        connection.sendall(b"GET / HTTP/1.1\r\nHost: local")
        connection.settimeout(20)
        with suppress(ConnectionResetError):
            assert connection.recv(100) == b""


@linux
def test_a_viewer_that_asks_without_reading_fills_no_memory() -> None:
    with running_page() as page:
        page.process.write(snapshot(0.0, list(range(50))))
        page.client.get("/api/health")
        before = memory_of(process_of(page))
        lines = "\r\n".join(f"{name}: {value}" for name, value in UPGRADE.items())
        start = f"GET /api/stream HTTP/1.1\r\nHost: localhost\r\n{lines}\r\n\r\n".encode()
        ping = bytes([0x89, 0x80 + 120, 0, 0, 0, 0]) + bytes(120)
        sent = 0
        with socket.create_connection(("127.0.0.1", page.port), timeout=1) as connection:
            connection.sendall(start)
            with suppress(TimeoutError, ConnectionError):  # it does not read either
                while sent < 200_000_000:
                    connection.sendall(ping * 1000)
                    sent += len(ping) * 1000
            assert sent < 200_000_000
            assert memory_of(process_of(page)) - before < 30_000_000
            assert page.client.get("/api/health").status_code == 503


def memory_of(process: int) -> int:
    """Return the memory that a process uses [bytes]."""
    pages = int(Path(f"/proc/{process}/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE")


UPGRADE = {
    "Upgrade": "websocket", "Connection": "Upgrade", "Sec-WebSocket-Version": "13",
    "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==",
}  # fmt: skip
