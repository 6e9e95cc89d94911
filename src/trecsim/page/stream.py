"""`/api/stream`: the WebSocket on which viewers get snapshots, health and events."""

import asyncio
from collections.abc import Awaitable, Callable, Mapping, Sequence
from time import time
from typing import Any

from starlette.websockets import WebSocket, WebSocketDisconnect

from trecsim.page.hub import Hub, Viewer
from trecsim.page.messages import message

SLOWEST_S = 20.0  # a viewer that takes no message for so long is disconnected
SIGNED_IN_S = 2.0  # how often it is looked whether a viewer is still signed in
EVENT_ID_LENGTH = 200
_TRY_LATER, _POLICY, _SIGNED_OUT = 1013, 1008, 4401
_GONE = (WebSocketDisconnect, TimeoutError)  # of a viewer that left or does not read


_Ending = tuple[int, str]  # code and reason
Missed = Callable[[str], Awaitable[Sequence[Mapping[str, Any]]]]


async def stream(socket: WebSocket, hub: Hub, missed: Missed, may_see: Callable[[], bool]) -> None:
    """Serve one viewer until it leaves, sends something, or takes nothing for too long.

    Parameters
    ----------
    socket
        The connection; its query may name the last event the viewer has: `last_event_id`.
    hub
        Where the messages come from.
    missed
        Finds events that follow one which the hub no longer has.
    may_see
        Tells whether the viewer is still signed in.
    """
    last_event_id = socket.query_params.get("last_event_id")
    await socket.accept()
    if hub.is_full:
        await socket.close(_TRY_LATER, "too many viewers; try again later")
        return
    if last_event_id is not None and len(last_event_id) > EVENT_ID_LENGTH:
        await socket.close(_POLICY, f"last_event_id has more than {EVENT_ID_LENGTH} characters")
        return
    viewer = hub.join(last_event_id)
    tasks = [
        asyncio.create_task(_until_it_speaks(socket)),
        asyncio.create_task(_while_it_may_see(may_see)),
        asyncio.create_task(_send(socket, viewer, hub, last_event_id, missed)),
    ]
    try:
        await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    finally:
        hub.leave(viewer)
        for task in tasks:
            task.cancel()
        endings = await asyncio.gather(*tasks, return_exceptions=True)
    for ending in endings:
        if isinstance(ending, Exception) and not isinstance(ending, _GONE):
            raise ending
    for ending in endings:
        if isinstance(ending, tuple):  # only now, as nothing may be sent after it
            await socket.close(*ending)
            return


async def _catch_up(socket: WebSocket, last: str, hub: Hub, missed: Missed) -> str:
    """Send events that the hub no longer has; return the last one the viewer has then."""
    while not hub.events.knows(last):
        events = await missed(last)
        for event in events:
            text = message("event", time(), {"event": event})
            await _put(socket, text)
            last = str(event["id"])
        if not events:
            break
    return last


async def _put(socket: WebSocket, text: str) -> None:
    # wait_for may lose that its task was cancelled (Python 3.11), which then never ends.
    async with asyncio.timeout(SLOWEST_S):
        await socket.send_text(text)


async def _while_it_may_see(may_see: Callable[[], bool]) -> _Ending:
    """Wait until the viewer is signed out; return how to end the stream."""
    while may_see():
        await asyncio.sleep(SIGNED_IN_S)
    return _SIGNED_OUT, "signed out"


async def _until_it_speaks(socket: WebSocket) -> _Ending | None:
    """Wait until the viewer says something; return how to end the stream, None if it left."""
    if (await socket.receive())["type"] == "websocket.disconnect":
        return None
    return _POLICY, "this stream takes no messages"


async def _send(
    socket: WebSocket, viewer: Viewer, hub: Hub, last_event_id: str | None, missed: Missed
) -> None:
    if last_event_id is not None and not hub.events.knows(last_event_id):
        last_event_id = await _catch_up(socket, last_event_id, hub, missed)
        viewer.next_event = hub.events.after(last_event_id)
    while True:
        await viewer.woken.wait()
        viewer.woken.clear()
        for text in hub.events_for(viewer):
            await _put(socket, text)
        for text in viewer.take():
            await _put(socket, text)
