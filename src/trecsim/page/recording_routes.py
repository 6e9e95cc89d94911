"""`/api/recordings`: what was recorded, and any part of it."""

import asyncio
from collections.abc import AsyncIterator, Iterator
from pathlib import Path

from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import Response, StreamingResponse
from starlette.routing import Route

from trecsim.page.access import Access
from trecsim.page.answers import json_answer
from trecsim.page.live_state import LiveState
from trecsim.page.queries import number_in
from trecsim.page.recordings_shown import recording_folder, shown_recordings, snapshot_lines

LONGEST_S = 3600.0  # of a recording at once
READERS = 2  # at the same time
_END = ""


def recording_routes(access: Access, folder: Path | None, state: LiveState) -> list[Route]:
    """Return the routes of recordings.

    Parameters
    ----------
    access
        Says who may do what.
    folder
        The recordings of the site; None where there are none.
    state
        Has the volumes of the site.
    """
    readers = asyncio.Semaphore(READERS)

    async def listed(request: Request) -> Response:
        if folder is None or not folder.is_dir():
            return json_answer([])
        async with readers:
            return json_answer(await asyncio.to_thread(shown_recordings, folder))

    async def snapshots(request: Request) -> Response:
        from_s, to_s = number_in(request, "from_s"), number_in(request, "to_s")
        if from_s is None or to_s is None or not 0 <= to_s - from_s <= LONGEST_S:
            raise HTTPException(
                400, f"expected from_s and to_s, at most {LONGEST_S:g} s apart and in this order"
            )
        found = folder and recording_folder(folder, request.path_params["id"])
        if not found:
            raise HTTPException(404, "there is no such recording")
        lines = snapshot_lines(found, from_s, to_s, state.site["site"].get("volumes", {}))
        async with readers:
            first = await asyncio.to_thread(next, lines, _END)  # what is wrong shows here
        body = _streamed(first, lines, readers)
        return StreamingResponse(body, media_type="application/x-ndjson")

    return [
        Route("/api/recordings", access.needs("viewer", listed)),
        Route("/api/recordings/{id:str}/snapshots", access.needs("viewer", snapshots)),
    ]


async def _streamed(
    first: str, lines: Iterator[str], readers: asyncio.Semaphore
) -> AsyncIterator[str]:
    block = first
    while block:
        yield block
        async with readers:
            block = await asyncio.to_thread(next, lines, _END)
