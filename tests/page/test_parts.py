"""Parts of the page by themselves: what takes too long to wait for, and what ends by a clock."""

import asyncio
import socket
from pathlib import Path
from typing import Any

import httpx
import pytest
from starlette.responses import PlainTextResponse

from made_page import event, next_of, run_apart, running_page
from trecsim.errors import InputError
from trecsim.page import journal as journal_module
from trecsim.page import policy
from trecsim.page import stream as stream_module
from trecsim.page.address import PageAddress, listen
from trecsim.page.caller import caller_of
from trecsim.page.event_log import EVENTS_KEPT, EventLog
from trecsim.page.hub import Hub
from trecsim.page.page_data import PageData
from trecsim.page.rates import KEYS_KEPT, Rates
from trecsim.page.sessions import IDLE_S, KEPT, LONGEST_S, Sessions
from trecsim.store.ledger import NAME, Ledger


class Clock:
    def __init__(self) -> None:
        self.now_s = 0.0

    def __call__(self) -> float:
        return self.now_s


def test_a_session_ends_when_it_is_not_used_and_at_last_in_any_case() -> None:
    clock = Clock()
    sessions = Sessions(clock)
    key, session = sessions.begin("anna", "hash")
    assert sessions.find(key) == session
    assert sessions.find(key + "x") is None
    clock.now_s += IDLE_S + 1
    assert sessions.find(key) is None
    key, _ = sessions.begin("anna", "hash")
    while clock.now_s < LONGEST_S:
        clock.now_s += 0.9 * IDLE_S
        assert sessions.find(key) is not None or clock.now_s > LONGEST_S
    clock.now_s += 2 * IDLE_S
    assert sessions.find(key) is None


def test_no_two_sessions_share_a_key_and_too_many_end_the_oldest() -> None:
    sessions = Sessions(Clock())
    keys = [sessions.begin("anna", "hash")[0] for _ in range(KEPT + 1)]
    assert len(set(keys)) == len(keys)
    assert sessions.find(keys[0]) is None
    assert sessions.find(keys[1]) is not None


def test_what_is_allowed_comes_back_with_time() -> None:
    clock = Clock()
    rates = Rates(0.1, 3.0, clock=clock)
    assert [rates.allows("a") for _ in range(5)] == [True] * 3 + [False] * 2
    assert rates.allows("b")
    clock.now_s = 9.0
    assert not rates.allows("a")
    clock.now_s = 10.1
    assert [rates.allows("a") for _ in range(2)] == [True, False]


def test_rates_forget_who_asked_longest_ago_rather_than_grow() -> None:
    rates = Rates(0.1, 1.0, clock=Clock())
    assert rates.allows("first")
    for number in range(KEYS_KEPT):
        rates.allows(str(number))
    assert rates.allows("first")  # it was forgotten
    assert not rates.allows(str(KEYS_KEPT - 1))


def test_somebody_who_asks_too_often_is_told_to_wait(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(policy, "REQUESTS_AT_ONCE", 3.0)
    monkeypatch.setattr(policy, "REQUESTS_PER_S", 0.0)
    page = policy.Policy(PlainTextResponse("here"), PageAddress())

    async def ask() -> list[httpx.Response]:
        transport = httpx.ASGITransport(page)
        async with httpx.AsyncClient(transport=transport, base_url="http://localhost") as client:
            return [await client.get("/") for _ in range(5)]

    answers = run_apart(ask())
    assert [one.status_code for one in answers] == [200, 200, 200, 429, 429]
    assert answers[-1].headers["Retry-After"] == "1"


def test_the_log_keeps_the_newest_events_each_once() -> None:
    log = EventLog()
    assert log.after("e0") == log.after(None) == 0
    for number in range(EVENTS_KEPT + 5):
        assert log.append(event(f"e{number}"))
        assert not log.append(event(f"e{number}"))
    assert log.since(0)[0].event["id"] == "e5"
    assert not log.knows("e4")
    assert [one.event["id"] for one in log.since(log.after(f"e{EVENTS_KEPT + 2}"))] == [
        f"e{EVENTS_KEPT + 3}", f"e{EVENTS_KEPT + 4}",
    ]  # fmt: skip
    assert log.since(log.after(None)) == []


class Deaf:
    """A WebSocket whose other end reads nothing and says nothing."""

    def __init__(self) -> None:
        self.query_params: dict[str, str] = {}
        self.sent: list[str] = []

    async def accept(self) -> None:
        pass

    async def send_text(self, text: str) -> None:
        self.sent.append(text)
        await asyncio.Event().wait()

    async def receive(self) -> dict[str, Any]:
        await asyncio.Event().wait()
        return {}

    async def close(self, code: int, reason: str) -> None:
        raise AssertionError("the other end would not read that either")


def test_a_user_cannot_fill_the_memory_with_what_was_reviewed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(journal_module, "MOST_REVIEWED", 3)

    async def marked() -> list[str]:
        journal = journal_module.Journal(None, EventLog())
        await journal.mark_reviewed("kim", ["e1", "e2"], True)
        await journal.mark_reviewed("kim", ["e3", "e4"], True)
        return list(await journal.reviewed("kim"))

    assert run_apart(marked()) == ["e2", "e3", "e4"]


def test_a_damaged_ledger_is_used_once_its_owner_has_repaired_it(tmp_path: Path) -> None:
    (tmp_path / NAME).write_bytes(b"no database at all" * 100)
    clock = Clock()
    journal = journal_module.Journal(tmp_path, EventLog(), clock=clock)
    assert not journal.is_kept
    Ledger(tmp_path).close()  # as the tracking process does: puts it aside and begins another
    assert not journal.is_kept
    clock.now_s += journal_module.RETRY_S
    assert journal.is_kept

    run_apart(journal.audit("kim", "login", {}))
    with Ledger(tmp_path, repair=False) as ledger:
        assert [entry.who for entry in ledger.audit()] == ["kim"]


async def nothing(_: str) -> list[dict[str, Any]]:
    return []


def test_a_viewer_that_takes_nothing_is_disconnected(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stream_module, "SLOWEST_S", 0.05)
    deaf: Any = Deaf()

    async def watch() -> None:
        hub = Hub(EventLog())
        hub.publish("snapshot", "1")
        task = asyncio.create_task(stream_module.stream(deaf, hub, nothing, lambda: True))
        await asyncio.sleep(0.02)
        assert len(hub.viewers) == 1
        for number in range(100):
            hub.publish("snapshot", str(number))
        await asyncio.wait_for(task, 20)
        assert hub.viewers == set()

    run_apart(watch())
    assert deaf.sent == ["1"]


class Talking(Deaf):
    """A WebSocket whose other end speaks while something is sent to it.

    Parameters
    ----------
    turns
        Of the event loop until that is sent.
    """

    def __init__(self, turns: int) -> None:
        super().__init__()
        self.turns, self.spoken, self.closed = turns, asyncio.Event(), 0

    async def send_text(self, text: str) -> None:
        self.spoken.set()
        for _ in range(self.turns):
            await asyncio.sleep(0)

    async def receive(self) -> dict[str, Any]:
        await self.spoken.wait()
        return {"type": "websocket.receive", "text": "hello"}

    async def close(self, code: int, reason: str) -> None:
        self.closed = code


@pytest.mark.parametrize("turns", range(9))
def test_a_viewer_that_speaks_while_it_is_sent_something_is_disconnected(turns: int) -> None:
    async def served() -> int:
        talking: Any = Talking(turns)
        hub = Hub(EventLog())
        hub.publish("health", "{}")
        serving = asyncio.create_task(stream_module.stream(talking, hub, nothing, lambda: True))
        await asyncio.wait({serving}, timeout=5.0)
        assert serving.done()
        await serving
        return int(talking.closed)

    assert run_apart(served()) == 1008


def test_a_viewer_that_was_away_for_long_gets_all_it_missed_from_the_ledger(
    tmp_path: Any,
) -> None:
    count = EVENTS_KEPT + 1500
    with Ledger(tmp_path) as ledger:
        for number in range(count):
            ledger.append_event(event(f"e{number}"))
    with (
        running_page(data=PageData(ledger=tmp_path)) as page,
        page.stream("?last_event_id=e10") as stream,
    ):
        got = [next_of(stream, "event")["event"]["id"] for _ in range(11, count)]
        assert got == [f"e{number}" for number in range(11, count)]
        page.process.event(event("new"))
        assert next_of(stream, "event")["event"]["id"] == "new"


@pytest.mark.parametrize("port", [-1, 65_536, 99_999])
def test_a_port_that_cannot_be_is_refused(port: int) -> None:
    with pytest.raises(InputError, match="expected a port from 0 to 65535"):
        listen(PageAddress(port=port))


def test_the_page_listens_on_ipv6_too() -> None:
    try:
        socket.create_server(("::1", 0), family=socket.AF_INET6).close()
    except OSError:
        pytest.skip("this machine has no IPv6")
    with running_page(PageAddress(host="::1", port=0)) as page:
        assert page.process.url.startswith("http://[::1]:")
        assert page.client.get("/").status_code == 200


@pytest.mark.parametrize(
    ("lines", "address"),
    [
        (["10.0.0.7"], "10.0.0.7"),
        (["127.0.0.1, 10.0.0.7"], "10.0.0.7"),  # the proxy added to what the client sent
        (["127.0.0.1", "10.0.0.7"], "10.0.0.7"),  # or added a line of its own
        ([], "10.0.0.2"),
    ],
)
def test_only_what_the_proxy_itself_added_tells_where_a_request_comes_from(
    lines: list[str], address: str
) -> None:
    forwarded = [(b"x-forwarded-for", line.encode()) for line in lines]
    schemes = [(b"x-forwarded-proto", b"https"), (b"x-forwarded-proto", b"http")]
    scope = {"client": ("10.0.0.2", 1), "scheme": "http", "headers": [*forwarded, *schemes]}
    caller = caller_of(scope, PageAddress(trusted_proxy="10.0.0.2"))
    assert (caller.address, caller.is_encrypted, caller.is_private) == (address, False, False)
