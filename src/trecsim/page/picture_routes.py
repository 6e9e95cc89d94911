"""`/api/cameras/NAME/picture`: what a camera sees now, where the site file allows it."""

import asyncio
from time import monotonic

from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route

from trecsim.page.access import Access, Identity
from trecsim.page.asking import Ask
from trecsim.page.journal import Journal
from trecsim.page.live_state import LiveState

FRESH_S = 0.5  # a picture that is not older is given again
WAIT_S = 3.0  # so long a picture is waited for
ASK_S = 1.0  # so often the tracking process is told that somebody looks
LOOKS_S = 300.0  # who asks again within this time still looks: it stands once in the audit log
_TICK_S = 0.05


def picture_routes(access: Access, state: LiveState, journal: Journal, ask: Ask) -> list[Route]:
    """Return the route of pictures.

    Parameters
    ----------
    access
        Says who may do what.
    state
        Has the site, and the newest picture of each camera.
    journal
        Gets who begins to look at a camera.
    ask
        Tells the tracking process that somebody looks at a camera.
    """
    desk = _PictureDesk(state, journal, ask)
    return [Route("/api/cameras/{name:str}/picture", access.needs("viewer", desk.show))]


class _PictureDesk:
    def __init__(self, state: LiveState, journal: Journal, ask: Ask) -> None:
        self._state, self._journal, self._ask = state, journal, ask
        self._asked_s: dict[str, float] = {}
        self._looked_s: dict[tuple[str, str], float] = {}

    async def show(self, request: Request) -> Response:
        """Return the newest picture of a camera."""
        identity: Identity = request.state.identity
        name, site = request.path_params["name"], self._state.site["site"]
        if not site.get("pictures"):
            raise HTTPException(404, "this site shows no pictures of its cameras")
        if name not in site.get("cameras", {}):
            raise HTTPException(404, "there is no such camera")
        await self._note(identity.by, name)
        picture = await self._newest(identity.by, name)
        if picture is None:
            raise HTTPException(503, "the camera has sent no picture lately")
        return Response(picture, media_type="image/jpeg", headers={"Cache-Control": "no-store"})

    async def _note(self, by: str, name: str) -> None:
        """Keep in the audit log that somebody begins to look at a camera."""
        now_s = monotonic()
        looking = {who: at_s for who, at_s in self._looked_s.items() if now_s - at_s < LOOKS_S}
        begins = (by, name) not in looking
        self._looked_s = {**looking, (by, name): now_s}
        if begins:
            await self._journal.audit(by, "look at camera", {"camera": name})

    async def _newest(self, by: str, name: str) -> bytes | None:
        """Return a picture that is fresh, waiting for it if need be; None where none comes."""
        end_s = monotonic() + WAIT_S
        while True:
            now_s = monotonic()
            if now_s - self._asked_s.get(name, -ASK_S) >= ASK_S:
                self._asked_s[name] = now_s
                await self._ask("picture", by, {"camera": name})
            newest = self._state.pictures.get(name)
            if newest is not None and now_s - newest.at_s <= FRESH_S:
                return newest.jpeg
            if now_s >= end_s:
                return None
            await asyncio.sleep(_TICK_S)
