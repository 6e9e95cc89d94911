"""The event loop of the page process: the link on one side, uvicorn on the other."""

import asyncio
import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import msgspec
import uvicorn
from starlette.applications import Starlette

from trecsim.page.access import Access
from trecsim.page.address import BACKLOG, PageAddress
from trecsim.page.app import Parts, page_app
from trecsim.page.asking import asking_over, handing_on_over
from trecsim.page.bundle import STATIC, Bundle
from trecsim.page.journal import Journal
from trecsim.page.link import TO_PAGE, EventPart, PulsePart, Setup, framed
from trecsim.page.live_state import LiveState
from trecsim.page.page_data import PageData
from trecsim.page.protocols import ImpatientHttp, ImpatientWebSocket
from trecsim.page.tls_door import TlsDoors
from trecsim.page.users_audit import UsersAudit

CONNECTIONS = 512  # at most, all together
HEADER_BYTES = 16_384
MESSAGE_BYTES = 4_096  # of what a viewer sends
PING_S = 20.0
PULSE_S = 1.0
HEALTH_S = 0.5
ENDING_S = 0.6  # viewers are told within this time that the page ends


class _Server(uvicorn.Server):
    @contextmanager
    def capture_signals(self) -> Iterator[None]:
        """Leave signals alone: the tracking process ends this one."""
        yield


def serve(setup: Setup, listening: socket.socket, link: socket.socket) -> None:
    """Serve the page until the link ends.

    Parameters
    ----------
    setup
        What the tracking process said first.
    listening
        Where browsers connect.
    link
        To the tracking process.
    """
    address = msgspec.convert(setup.address, PageAddress, dec_hook=_decoded)
    asyncio.run(_run(setup, address, listening, link))


def _server(app: Starlette, address: PageAddress) -> "_Server":
    config = uvicorn.Config(
        app, http=_http_of(address), ws=ImpatientWebSocket, loop="asyncio", lifespan="off",
        interface="asgi3", log_level="error", access_log=False, server_header=False,
        proxy_headers=False, ws_max_size=MESSAGE_BYTES, ws_per_message_deflate=False,
        ws_ping_interval=PING_S, ws_ping_timeout=PING_S, limit_concurrency=CONNECTIONS,
        h11_max_incomplete_event_size=HEADER_BYTES, timeout_graceful_shutdown=1,
        backlog=BACKLOG,
    )  # fmt: skip
    return _Server(config)


def _http_of(address: PageAddress) -> Any:
    """Return what makes the protocol of a connection."""
    if address.tls_cert is None or address.tls_key is None:
        return ImpatientHttp
    return TlsDoors(address.tls_cert, address.tls_key)


def _parts(setup: Setup, address: PageAddress, port: int, writer: asyncio.StreamWriter) -> Parts:
    data = msgspec.convert(setup.data, PageData, dec_hook=_decoded)
    state = LiveState()
    journal = Journal(data.ledger, state.hub.events)
    access = Access(address, port, UsersAudit(journal))
    bundle = Bundle(data.static or STATIC)
    ask, hand_on = asking_over(writer), handing_on_over(writer)
    return Parts(state, access, journal, bundle, ask, data, hand_on)


async def _run(
    setup: Setup, address: PageAddress, listening: socket.socket, link: socket.socket
) -> None:
    reader, writer = await asyncio.open_connection(sock=link)
    parts = _parts(setup, address, listening.getsockname()[1], writer)
    state, server = parts.state, _server(page_app(parts), address)
    ready = asyncio.Event()
    tasks = [
        asyncio.create_task(_take(reader, parts, server, ready)),
        asyncio.create_task(_tell_health(state)),
        asyncio.create_task(_beat(writer)),
    ]
    await ready.wait()
    await server.serve([listening])
    for task in tasks:
        task.cancel()
    await asyncio.gather(*tasks, return_exceptions=True)


async def _take(
    reader: asyncio.StreamReader, parts: Parts, server: _Server, ready: asyncio.Event
) -> None:
    """Take what the tracking process says; end the server when the link ends."""
    try:
        while True:
            size = int.from_bytes(await reader.readexactly(4), "big")
            part = TO_PAGE.decode(await reader.readexactly(size))
            if isinstance(part, EventPart) and not part.kept:
                parts.journal.waits(part.event)
            parts.state.take(part)
            if isinstance(part, PulsePart):  # it has told everything there was before
                ready.set()
    except (asyncio.IncompleteReadError, ConnectionError):
        server.should_exit = True
        asyncio.get_running_loop().call_later(ENDING_S, os._exit, 0)


async def _tell_health(state: LiveState) -> None:
    """Tell viewers the health while the tracking process does not."""
    while True:
        if state.health_told_s > 2 * HEALTH_S:
            state.tell_health()
        await asyncio.sleep(HEALTH_S)


async def _beat(writer: asyncio.StreamWriter) -> None:
    """Tell the tracking process that this one is alive."""
    while True:
        writer.write(framed(PulsePart()))
        await writer.drain()
        await asyncio.sleep(PULSE_S)


def _decoded(kind: type, value: Any) -> Any:
    return Path(value) if kind is Path else value
