"""`/api/stream`: the WebSocket on which viewers get snapshots, health and events."""

import asyncio

from starlette.websockets import WebSocket, WebSocketDisconnect

from trecsim.page.hub import Hub, Viewer

SLOWEST_S = 20.0  # a viewer that takes no message for so long is disconnected
EVENT_ID_LENGTH = 200
_TRY_LATER, _POLICY = 1013, 1008
_GONE = (WebSocketDisconnect, TimeoutError)  # of a viewer that left or does not read


async def stream(socket: WebSocket, hub: Hub) -> None:
    """Serve one viewer until it leaves, sends something, or takes nothing for too long.

    Parameters
    ----------
    socket
        The connection; its query may name the last event the viewer has: `last_event_id`.
    hub
        Where the messages come from.
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
    leaving = asyncio.create_task(_until_it_speaks(socket))
    sending = asyncio.create_task(_send(socket, viewer, hub))
    try:
        await asyncio.wait({leaving, sending}, return_when=asyncio.FIRST_COMPLETED)
    finally:
        hub.leave(viewer)
        leaving.cancel()
        sending.cancel()
        for ended in await asyncio.gather(leaving, sending, return_exceptions=True):
            if isinstance(ended, Exception) and not isinstance(ended, _GONE):
                raise ended


async def _until_it_speaks(socket: WebSocket) -> None:
    if (await socket.receive())["type"] != "websocket.disconnect":
        await socket.close(_POLICY, "this stream takes no messages")


async def _send(socket: WebSocket, viewer: Viewer, hub: Hub) -> None:
    while True:
        await viewer.woken.wait()
        viewer.woken.clear()
        for text in hub.events_for(viewer):
            await asyncio.wait_for(socket.send_text(text), SLOWEST_S)
        for text in viewer.take():
            await asyncio.wait_for(socket.send_text(text), SLOWEST_S)
