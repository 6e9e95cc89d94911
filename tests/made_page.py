"""A page process on a free port, and what a tracking process would tell it."""

import asyncio
import json
from collections.abc import Callable, Coroutine, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from time import monotonic, sleep, time
from typing import Any, TypeVar

import httpx
from websockets.sync.client import ClientConnection, connect

from trecsim.health import CameraHealth, FusionHealth, Health
from trecsim.page.address import PageAddress
from trecsim.page.page_data import PageData
from trecsim.page.page_process import PageProcess
from trecsim.page.site_view import SiteView

SITE = SiteView(
    "hall", version="a" * 64, cameras={"north": {}, "south": {}},
    feeds={"gate": {"source": "http", "most_per_s": 100.0}, "file": {"source": "file"}},
)  # fmt: skip
WAIT_S = 20.0
Result = TypeVar("Result")


@dataclass(frozen=True)
class RunningPage:
    """A page process and a client of it."""

    process: PageProcess
    client: httpx.Client

    @property
    def port(self) -> int:
        return httpx.URL(self.process.url).port or 0

    def stream(self, query: str = "", **options: Any) -> ClientConnection:
        """Open the stream."""
        url = self.process.url.replace("http", "ws", 1) + f"api/stream{query}"
        return connect(url, open_timeout=WAIT_S, **options)


@contextmanager
def running_page(
    address: PageAddress | None = None, data: PageData | None = None, site: SiteView = SITE
) -> Iterator[RunningPage]:
    """Run a page on a free port."""
    with (
        PageProcess(address or PageAddress(port=0), site, data) as process,
        httpx.Client(base_url=process.url, timeout=WAIT_S) as client,
    ):
        yield RunningPage(process, client)


def well(**cameras: CameraHealth) -> Health:
    """Return the health of a site without faults, but for what the cameras given have."""
    all_cameras = {name: CameraHealth("live", 25.0, 0.02) for name in SITE.cameras}
    fusion = FusionHealth("running", 25.0, 1.0, 0.02, 2)
    return Health(time(), all_cameras | cameras, fusion)


def event(identity: str) -> dict[str, Any]:
    """Return an event as rules make them."""
    return {
        "specversion": "1.0",
        "id": identity,
        "type": "trecsim.zone.enter.v1",
        "source": "site/hall",
        "subject": "rule/strip",
        "data": {"event": identity, "phase": "new", "seq": 0, "severity": "warning"},
    }


def next_of(stream: ClientConnection, kind: str) -> dict[str, Any]:
    """Return the next message of a kind; the test fails when none comes."""
    end_s = monotonic() + WAIT_S
    while monotonic() < end_s:
        message: dict[str, Any] = json.loads(stream.recv(WAIT_S))
        if message["type"] == kind:
            return message
    raise AssertionError(f"no {kind} came")


def until(holds: Callable[[], bool]) -> None:
    """Wait until something holds; the test fails when it never does."""
    end_s = monotonic() + WAIT_S
    while not holds():
        assert monotonic() < end_s, "waited for too long"
        sleep(0.02)


def run_apart(work: Coroutine[Any, Any, Result]) -> Result:
    """Run a coroutine in a thread of its own: browsers of other tests keep a loop in this one."""
    with ThreadPoolExecutor(1) as thread:
        return thread.submit(asyncio.run, work).result()
