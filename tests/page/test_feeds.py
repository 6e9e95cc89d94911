"""Messages of feeds that are posted to the page: what reaches the tracking process."""

import json
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import pytest

from made_page import SITE, RunningPage, running_page, until
from trecsim.page.feed_routes import LARGEST, MOST_LINES
from trecsim.page.site_view import SiteView

GRANT = {"t_s": 1769846400.2, "grant": "gate"}
LINES = {"Content-Type": "application/x-ndjson"}


@pytest.fixture(scope="module")
def page() -> Iterator[RunningPage]:
    with running_page() as page:
        yield page


@contextmanager
def taking(page: RunningPage) -> Iterator[list[tuple[str, list[bytes]]]]:
    """Yield what the tracking process gets."""
    got: list[tuple[str, list[bytes]]] = []

    def take(feed: str, lines: Sequence[bytes]) -> None:
        got.append((feed, list(lines)))

    page.process.feeds_to(take)
    yield got


def test_a_message_and_several_lines_reach_the_tracking_process(page: RunningPage) -> None:
    with taking(page) as got:
        answer = page.client.post("/api/feeds/gate", content=json.dumps(GRANT, indent=1),
                                  headers={"Content-Type": "application/json"})  # fmt: skip
        assert (answer.status_code, answer.json()) == (202, {"taken": 1})
        answer = page.client.post(
            "/api/feeds/gate", content=b'{"t_s": 1}\r\n\n{"t_s": 2}', headers=LINES
        )
        assert (answer.status_code, answer.json()) == (202, {"taken": 2})
        until(lambda: len(got) == 2)
    (first, (one,)), second = got
    assert (first, json.loads(one)) == ("gate", GRANT)
    assert second == ("gate", [b'{"t_s": 1}', b'{"t_s": 2}'])


def test_a_message_that_cannot_be_read_is_told_and_handed_on_as_a_fault_of_the_feed(
    page: RunningPage,
) -> None:
    with taking(page) as got:
        body = b'{"t_s": 1}\n{"t_s": 1, "grnat": "gate"}'
        answer = page.client.post("/api/feeds/gate", content=body, headers=LINES)
        assert (answer.status_code, answer.json()) == (
            422, {"error": "message 2: unknown key 'grnat' in a message", "taken": 2},
        )  # fmt: skip
        until(lambda: got == [("gate", body.split(b"\n"))])
        several = page.client.post("/api/feeds/gate", content=body,
                                   headers={"Content-Type": "application/json"})  # fmt: skip
        until(lambda: len(got) == 2)
    assert "one message a line needs the type application/x-ndjson" in several.json()["error"]


@pytest.mark.parametrize(
    ("path", "content", "status", "said"),
    [
        ("none", b"{}", 404, "no such feed that takes messages by HTTP"),
        ("file", b"{}", 404, "http = true"),
        ("gate", b" \n ", 400, "expected a message, found none"),
        ("gate", b"{}\n" * (MOST_LINES + 1), 413, "at most 1000 messages"),
        ("gate", b"x" * (LARGEST + 1), 413, "at most 65536 bytes"),
    ],
)
def test_what_is_not_taken_is_told(
    page: RunningPage, path: str, content: bytes, status: int, said: str
) -> None:
    with taking(page) as got:
        answer = page.client.post(f"/api/feeds/{path}", content=content, headers=LINES)
        assert answer.status_code == status
        assert said in answer.json()["error"]
        page.client.post("/api/feeds/gate", json=GRANT)
        until(lambda: bool(got))
    assert [len(lines) for _, lines in got] == [1]


def test_a_flood_is_refused_before_it_reaches_the_tracking_process() -> None:
    slow = SiteView("hall", feeds={"gate": {"source": "http", "most_per_s": 1e-3}})
    with running_page(site=slow) as page, taking(page) as got:
        body = b'{"t_s": 1}\n' * 900
        statuses = [
            page.client.post("/api/feeds/gate", content=body, headers=LINES).status_code
            for _ in range(5)
        ]
        assert statuses == [202, 429, 429, 429, 429]
        until(lambda: len(got) == 1)
        refused = page.client.post("/api/feeds/gate", content=body, headers=LINES)
        assert (refused.headers["retry-after"], refused.json()["error"]) == (
            "1", "too many messages: expected at most 0.001 a second",
        )  # fmt: skip


def test_a_feed_takes_messages_as_soon_as_the_site_file_says_so() -> None:
    with running_page(site=SiteView("hall")) as page:
        assert page.client.post("/api/feeds/gate", json=GRANT).status_code == 404
        page.process.site(SITE)
        until(lambda: page.client.post("/api/feeds/gate", json=GRANT).status_code == 202)
