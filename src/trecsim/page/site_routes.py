"""`/api/site`: what the site is, what it shall become, and its mode."""

import asyncio
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Annotated, Any, TypeVar

import msgspec
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route

from trecsim.errors import InputError
from trecsim.page.access import Access, Identity
from trecsim.page.answers import json_answer
from trecsim.page.asking import Ask
from trecsim.page.bodies import body_of
from trecsim.page.journal import Journal
from trecsim.page.live_state import LiveState
from trecsim.page.site_draft import ConflictError, Draft, DraftDesk

LARGEST_DRAFT = 500_000  # bytes
NO_RULES = (
    "this version of trecsim cannot try rules from the page, and has no modes; try them with "
    "trecsim assess RECORDING SITE.toml"
)

Result = TypeVar("Result")
_Version = Annotated[str, msgspec.Meta(max_length=100)]
_Tables = dict[str, dict[str, Any]]


class DraftBody(msgspec.Struct, frozen=True):
    """A draft, based on a version of the site and a revision of the draft."""

    based_on: _Version
    revision: int = 0
    zones: _Tables = {}
    lines: _Tables = {}
    edges: _Tables = {}


class LiveBody(msgspec.Struct, frozen=True):
    """Which draft to make live."""

    based_on: _Version
    revision: int


def site_routes(access: Access, site: "SiteDesk") -> list[Route]:
    """Return the routes of the site.

    Parameters
    ----------
    access
        Says who may do what.
    site
        Answers.
    """
    return [
        Route("/api/site", access.needs("viewer", site.show), methods=["GET"]),
        Route("/api/site/draft", access.needs("viewer", site.draft), methods=["GET"]),
        Route("/api/site/draft", access.needs("admin", site.put), methods=["PUT"]),
        Route("/api/site/draft", access.needs("admin", site.discard), methods=["DELETE"]),
        Route("/api/site/draft/try", access.needs("admin", site.needs_rules), methods=["POST"]),
        Route("/api/site/draft/live", access.needs("admin", site.make_live), methods=["POST"]),
        Route("/api/site/reload", access.needs("admin", site.reload), methods=["POST"]),
        Route("/api/mode", access.needs("viewer", site.mode), methods=["GET"]),
        Route("/api/mode", access.needs("operator", site.needs_rules), methods=["POST", "PUT"]),
    ]


@dataclass(frozen=True, slots=True)
class SiteDesk:
    """Shows and changes the site.

    Attributes
    ----------
    state
        Has the live site.
    journal
        Gets what is changed.
    ask
        Asks the tracking process to read the site file again.
    desk
        Keeps the draft; None for a site without a file.
    """

    state: LiveState
    journal: Journal
    ask: Ask
    desk: DraftDesk | None

    async def show(self, request: Request) -> Response:
        """Return the live site and its version."""
        return json_answer(self.state.site)

    async def draft(self, request: Request) -> Response:
        """Return the draft; null where there is none."""
        return json_answer(self._desk().draft)

    async def put(self, request: Request) -> Response:
        """Replace the draft."""
        given = await body_of(request, DraftBody, LARGEST_DRAFT)
        wanted = Draft(
            given.based_on, given.revision, _by(request), given.zones, given.lines, given.edges
        )
        return json_answer(await _done(partial(self._desk().put, wanted)))

    async def discard(self, request: Request) -> Response:
        """Remove the draft."""
        await _done(self._desk().discard)
        return Response(status_code=204)

    async def make_live(self, request: Request) -> Response:
        """Write the draft into the site file, and have it read."""
        by = _by(request)
        given = await body_of(request, LiveBody)
        work = partial(self._desk().make_live, given.based_on, given.revision)
        made, version = await _done(work)
        change = {"from": made.based_on, "to": version, "draft_by": made.by}
        await self.journal.audit(by, "site changed", change)
        await self.ask("reload", by, {})
        return json_answer({"version": version})

    async def reload(self, request: Request) -> Response:
        """Have the site file read again."""
        by = _by(request)
        await self.journal.audit(by, "reload", {})
        await self.ask("reload", by, {})
        return Response(status_code=202)

    async def mode(self, request: Request) -> Response:
        """Return the mode in force, and those there are."""
        return json_answer({"mode": self.state.site["site"].get("mode"), "modes": []})

    async def needs_rules(self, request: Request) -> Response:
        """Refuse what only rules make possible."""
        raise HTTPException(409, NO_RULES)

    def _desk(self) -> DraftDesk:
        if self.desk is None:
            raise HTTPException(409, "this site has no site file, so that it cannot be changed")
        return self.desk


def _by(request: Request) -> str:
    identity: Identity = request.state.identity
    return identity.by


async def _done(work: Callable[[], Result]) -> Result:
    """Do something in a thread; what is wrong with it becomes an answer."""
    try:
        return await asyncio.to_thread(work)
    except ConflictError as error:
        raise HTTPException(409, str(error)) from None
    except InputError as error:
        raise HTTPException(422, str(error)) from None
