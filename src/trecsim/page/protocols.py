"""Connections that cannot be held open for nothing.

uvicorn closes a connection in order: only after everything that waits for the other end was sent.
An end that reads nothing would keep it, and memory, for ever.
"""

import asyncio
from typing import Any

import h11
from uvicorn._types import ASGISendEvent
from uvicorn.protocols.http.h11_impl import H11Protocol
from uvicorn.protocols.utils import ClientDisconnected
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol
from websockets.frames import Frame

REQUEST_S = 5.0  # a request must be complete within this time
ANSWER_S = 30.0  # so long an answer may wait for its reader at a time
LEAVING_S = 2.0  # what waits for an end that leaves is thrown away after this time


class ImpatientWebSocket(WebSocketsSansIOProtocol):
    """A WebSocket that does not read while it cannot write, and ends without consent."""

    def pause_writing(self) -> None:
        """Stop reading too: whoever asks without listening must not fill our memory."""
        super().pause_writing()
        self.transport.pause_reading()

    def resume_writing(self) -> None:
        """Read again, unless the application still has a message."""
        super().resume_writing()
        if not self.read_paused:
            self.transport.resume_reading()

    async def send(self, message: ASGISendEvent) -> None:
        """Send a message; one to an end that has left means that it has left, and is no fault."""
        if message["type"] == "websocket.send" and self.close_sent:
            raise ClientDisconnected
        await super().send(message)
        refused = message["type"] == "websocket.http.response.body"
        if refused and not message.get("more_body", False):
            self.handshake_complete = True  # else each refusal would be logged as an error

    def handle_text(self, event: Frame) -> None:
        """Take text as bytes: it is not read, and text that is no UTF-8 would be logged."""
        self.handle_bytes(event)

    def keepalive_timeout(self) -> None:
        """Close a connection whose other end does not answer."""
        super().keepalive_timeout()
        self.loop.call_later(LEAVING_S, self.transport.abort)

    def on_task_complete(self, task: "asyncio.Task[None]") -> None:
        """End the connection once the application is done with it."""
        super().on_task_complete(task)
        self.loop.call_later(LEAVING_S, self.transport.abort)


class ImpatientHttp(H11Protocol):
    """An HTTP connection that is cut when a request or the reading of an answer takes too long.

    Where there are as many connections as may be, the oldest on which nothing happens makes room
    for a new one: idle connections keep nobody out.
    """

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self._request_timer: asyncio.TimerHandle | None = None
        self._answer_timer: asyncio.TimerHandle | None = None
        self._since_s = self.loop.time()
        self._leaves = False

    @property
    def is_idle(self) -> bool:
        """Whether no request is being answered."""
        return not self._leaves and (self.cycle is None or self.cycle.response_complete)

    def _make_room(self) -> None:
        if self.limit_concurrency is None or len(self.connections) < self.limit_concurrency:
            return
        others = [one for one in self.connections if isinstance(one, ImpatientHttp)]
        idle = [one for one in others if one is not self and one.is_idle]
        if idle:
            oldest = min(idle, key=lambda one: one._since_s)
            oldest._leaves = True
            oldest.transport.abort()

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Wait for the first request; the type is that of uvicorn's method."""
        super().connection_made(transport)
        self._request_timer = self.loop.call_later(REQUEST_S, transport.abort)
        self._make_room()

    def data_received(self, data: bytes) -> None:
        """Take a part of a request."""
        super().data_received(data)
        if self.conn.their_state not in (h11.IDLE, h11.SEND_BODY):
            _cancel(self._request_timer)
            self._request_timer = None
        elif self._request_timer is None and self.transport.get_protocol() is self:
            self._request_timer = self.loop.call_later(REQUEST_S, self.transport.abort)

    def handle_websocket_upgrade(self, event: h11.Request) -> None:
        """Leave the connection to the WebSocket."""
        _cancel(self._request_timer)
        self._request_timer = None
        super().handle_websocket_upgrade(event)

    def pause_writing(self) -> None:
        """Give the other end some time to read."""
        super().pause_writing()
        self._answer_timer = self.loop.call_later(ANSWER_S, self.transport.abort)

    def resume_writing(self) -> None:
        """Go on with the answer."""
        _cancel(self._answer_timer)
        self._answer_timer = None
        super().resume_writing()

    def connection_lost(self, exc: Exception | None) -> None:
        """Forget the connection."""
        _cancel(self._request_timer)
        self._request_timer = None
        _cancel(self._answer_timer)
        self._answer_timer = None
        super().connection_lost(exc)


def _cancel(timer: asyncio.TimerHandle | None) -> None:
    if timer is not None:
        timer.cancel()
