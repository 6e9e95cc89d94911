"""The client for programs, against a real page."""

import os
import signal
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path
from threading import Thread
from time import time

import numpy as np
import pytest
from websockets.sync.server import serve

import trecsim
from made_page import RunningPage, event, running_page, until
from made_tracks import snapshot
from page_processes import linux, process_of
from trecsim.errors import InputError
from trecsim.page.address import PageAddress
from trecsim.page.client import _Outage

TOKEN = "a-token-of-twenty-characters"


def next_snapshot(live: Iterator[object], page: RunningPage, given: trecsim.Snapshot) -> object:
    """Write a snapshot until the client is there to get it."""
    for got in live:
        if isinstance(got, trecsim.Snapshot) and got.t_s == given.t_s:
            return got
    return None


def test_a_program_gets_the_people_as_they_were_written(page: RunningPage) -> None:
    given = snapshot(time(), [4, 6])
    given.xyz_m[1, 3] = np.nan
    page.process.write(given)
    got = next_snapshot(trecsim.connect(page.process.url), page, given)
    assert isinstance(got, trecsim.Snapshot)
    assert got.id.tolist() == [4, 6]
    np.testing.assert_allclose(got.xyz_m, given.xyz_m, atol=0.0005)
    np.testing.assert_allclose(got.sigma_m, given.sigma_m, atol=0.00005)
    assert got.support.tolist() == given.support.tolist()
    assert got.state.tolist() == ["confirmed", "confirmed"]


def test_nobody_is_a_snapshot_too(page: RunningPage) -> None:
    given = snapshot(time(), [])
    page.process.write(given)
    got = next_snapshot(trecsim.connect(page.process.url.rstrip("/")), page, given)
    assert isinstance(got, trecsim.Snapshot)
    assert got.xyz_m.shape == (0, 17, 3)


@linux
def test_after_a_crash_of_the_page_a_program_misses_no_event_and_says_what_it_does(
    caplog: pytest.LogCaptureFixture,
) -> None:
    with running_page() as page:
        page.process.event(event("first"))
        until(lambda: page.client.get("/api/events").json()["events"] != [])
        live = trecsim.connect(page.process.url, last_event_id="")
        got = next(live)
        while not isinstance(got, trecsim.LiveEvent):
            got = next(live)
        assert (got.id, got.kind, got.data["phase"]) == ("first", "zone.enter", "new")
        os.kill(process_of(page), signal.SIGKILL)
        page.process.event(event("second"))
        while isinstance(got, trecsim.Snapshot) or got.id == "first":
            got = next(live)
        assert got.id == "second"
        broken, *_, again = [
            record.getMessage() for record in caplog.records if "conn" in record.getMessage()
        ]
        assert broken.startswith(f"no connection to {page.process.url}: ")
        assert broken.endswith("; trying again in 0.5 s")
        assert again == f"connected to {page.process.url} again"


def test_a_long_outage_is_logged_with_its_pauses_and_then_only_when_the_reason_changes(
    caplog: pytest.LogCaptureFixture,
) -> None:
    outage = _Outage("http://hall")
    pauses_s = [outage.pause_s("refused") for _ in range(50)]
    assert pauses_s == [0.5, 1.0, 2.0, 4.0, *[8.0] * 46]
    assert caplog.messages == [
        f"no connection to http://hall: refused; trying again in {pause_s:g} s"
        for pause_s in (0.5, 1.0, 2.0, 4.0, 8.0)
    ]
    outage.pause_s("no route")
    assert caplog.messages[-1] == "no connection to http://hall: no route; trying again in 8 s"
    outage.end()
    assert caplog.messages[-1] == "connected to http://hall again"
    assert outage.pause_s("refused") == 0.5


@pytest.mark.parametrize(
    ("code", "said"),
    [
        (401, "sign in first, with a token"),
        (403, "this token may not read it"),
        (404, "there is no live page at this address"),
    ],
)
def test_a_refusal_ends_the_tries(code: int, said: str) -> None:
    class Refusing(BaseHTTPRequestHandler):
        protocol_version = "HTTP/1.1"

        def do_GET(self) -> None:
            self.send_error(code)

        def log_message(self, format: str, *args: object) -> None:
            pass

    with HTTPServer(("127.0.0.1", 0), Refusing) as server:
        Thread(target=server.serve_forever, daemon=True).start()
        with pytest.raises(InputError, match=f"the page refuses the connection: {said}"):
            next(trecsim.connect(f"http://127.0.0.1:{server.server_port}"))
        server.shutdown()


def test_a_token_opens_a_page_that_asks_for_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("PAGE_TOKEN", TOKEN)
    with running_page(PageAddress(port=0, token_env="PAGE_TOKEN")) as page:
        given = snapshot(time(), [1])
        page.process.write(given)
        assert next_snapshot(trecsim.connect(page.process.url, TOKEN), page, given)
        for token, said in ((None, "sign in first"), ("wrong", "the token is wrong")):
            with pytest.raises(InputError, match=f"refuses the connection: {said}"):
                next(trecsim.connect(page.process.url, token))


@pytest.mark.parametrize(
    ("url", "said"),
    [
        ("127.0.0.1:8765", "expected the address of a page"),
        ("ftp://127.0.0.1", "expected the address of a page"),
        ("http://", "expected the address of a page"),
        ("http://127.0.0.1:99999", "expected the address of a page"),
        ("http://[::1", "expected the address of a page"),
        ("http://user:secret@127.0.0.1:1", r"nothing answers at http://\*\*\*@127.0.0.1:1"),
    ],
)
def test_an_address_without_a_page_is_told(url: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        next(trecsim.connect(url))


def test_a_token_that_cannot_be_sent_is_refused_and_not_shown(page: RunningPage) -> None:
    with pytest.raises(InputError, match=r"use token\.strip") as told:
        next(trecsim.connect(page.process.url, token=f"{TOKEN}\n"))
    assert TOKEN not in str(told.value)


@pytest.mark.parametrize(
    "sent",
    [
        "no JSON", "[]", "{}", b"\xff", '{"type": "snapshot"}', '{"type": "event", "sent_s": 1}',
        '{"type": "snapshot", "t_s": 1, "people": [{"person": 1, "state": "confirmed", '
        '"xyz_m": [[1, 2]], "sigma_m": [1], "support": [1]}]}',
        '{"type": "snapshot", "t_s": null, "people": []}',
    ],
)  # fmt: skip
def test_what_is_no_message_of_a_page_is_told_in_one_line(sent: str | bytes) -> None:
    with serve(lambda stream: stream.send(sent), "127.0.0.1", 0) as other:
        thread = Thread(target=other.serve_forever)
        thread.start()
        port = other.socket.getsockname()[1]
        try:
            with pytest.raises(InputError, match="expected messages of a page of trecsim"):
                repr(next(trecsim.connect(f"http://127.0.0.1:{port}")))
        finally:
            other.shutdown()
            thread.join()


def test_the_documentation_shows_the_call() -> None:
    text = (Path(__file__).parents[2] / "docs" / "reference" / "page.md").read_text()
    assert 'trecsim.connect("http://127.0.0.1:8765")' in text
