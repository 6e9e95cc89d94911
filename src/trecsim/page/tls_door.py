"""TLS before HTTP: connections that do not get through their handshake keep nobody out."""

import asyncio
import ssl
from contextlib import suppress
from pathlib import Path
from typing import Any

from trecsim.page.protocols import ImpatientHttp

HANDSHAKE_S = 5.0  # a handshake must be complete within this time, and so must a goodbye
HANDSHAKES = 256  # at the same time; the oldest makes room for one more
_Waiting = dict["TlsDoor", None]  # in the order in which they came


class TlsDoors:
    """Makes the protocol of each new connection.

    The event loop of Python could speak TLS by itself, but it counts nobody before the end of the
    handshake and waits for that for a minute: a thousand connections that say nothing would
    take all file handles.

    Parameters
    ----------
    cert, key
        Certificate and key, PEM.
    """

    def __init__(self, cert: Path, key: Path) -> None:
        self._context = ssl.create_default_context(ssl.Purpose.CLIENT_AUTH)
        self._context.load_cert_chain(cert, key)
        self._waiting: _Waiting = {}

    def __call__(self, **given: Any) -> "TlsDoor":
        """Return a door, with HTTP behind it; uvicorn gives what HTTP takes."""
        return TlsDoor(self._context, self._waiting, ImpatientHttp(**given))


class TlsDoor(asyncio.Protocol):
    """A connection until its handshake is done, which then belongs to HTTP.

    Parameters
    ----------
    context
        How to speak TLS.
    waiting
        All connections that are not through yet.
    http
        What takes over.
    """

    def __init__(self, context: ssl.SSLContext, waiting: _Waiting, http: ImpatientHttp) -> None:
        self._context, self._waiting, self._http = context, waiting, http
        self._early = bytearray()  # what came with the end of the handshake
        self._task: asyncio.Task[None] | None = None
        self._ended = False

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Begin the handshake."""
        assert isinstance(transport, asyncio.Transport)
        self._transport = transport
        self._waiting[self] = None
        if len(self._waiting) > HANDSHAKES:
            oldest = next(iter(self._waiting))
            del self._waiting[oldest]
            oldest._transport.abort()
        self._task = asyncio.get_running_loop().create_task(self._open())

    def data_received(self, data: bytes) -> None:
        """Keep what comes before HTTP can take it."""
        self._early += data

    def connection_lost(self, exc: Exception | None) -> None:
        """Forget a connection that ends before HTTP has it."""
        self._ended = True

    async def _open(self) -> None:
        inner = None
        with suppress(OSError):  # also what is wrong with TLS; a timeout is one, too
            inner = await asyncio.get_running_loop().start_tls(
                self._transport, self, self._context, server_side=True,
                ssl_handshake_timeout=HANDSHAKE_S, ssl_shutdown_timeout=HANDSHAKE_S,
            )  # fmt: skip
        self._waiting.pop(self, None)
        if inner is None or self._ended:
            self._transport.abort()
            return
        inner.set_protocol(self._http)
        self._http.connection_made(inner)
        if self._early:
            self._http.data_received(bytes(self._early))
