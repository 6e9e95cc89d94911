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
from trecsim.page.recordings_shown import recording_folder
from trecsim.page.site_check import FaultsError
from trecsim.page.site_draft import ConflictError, Draft, DraftDesk
from trecsim.page.site_text import PLACES, parts_of
from trecsim.page.trial import Trials

LARGEST_DRAFT = 500_000  # bytes

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
    rules: list[dict[str, Any]] | None = None
    exclusions: _Tables | None = None
    portals: _Tables | None = None


class TryBody(msgspec.Struct, frozen=True):
    """On what to try the draft: a recording, or a part of it [s]."""

    based_on: _Version
    revision: int | None = None
    recording: Annotated[str, msgspec.Meta(max_length=200)] | None = None
    from_s: float = -1e12
    to_s: float = 1e12


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
        Route("/api/site/draft/try", access.needs("admin", site.try_draft), methods=["POST"]),
        Route("/api/site/draft/live", access.needs("admin", site.make_live), methods=["POST"]),
        Route("/api/site/parts", access.needs("viewer", site.parts), methods=["GET"]),
        Route("/api/site/kinds", access.needs("viewer", site.kinds), methods=["GET"]),
        Route("/api/site/history", access.needs("viewer", site.history), methods=["GET"]),
        Route(
            "/api/site/history/{version:str}", access.needs("viewer", site.version), methods=["GET"]
        ),
        Route("/api/site/reload", access.needs("admin", site.reload), methods=["POST"]),
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
    trials
        Tries drafts on recordings.
    """

    state: LiveState
    journal: Journal
    ask: Ask
    desk: DraftDesk | None
    trials: Trials

    async def show(self, request: Request) -> Response:
        """Return the live site and its version."""
        return json_answer(self.state.site)

    async def draft(self, request: Request) -> Response:
        """Return the draft, and what is doubtful about it; null where there is none."""
        if self.desk is None or self.desk.draft is None:
            return json_answer(None)
        return await self._shown(self.desk.draft)

    async def parts(self, request: Request) -> Response:
        """Return what the page can change of the site file, and what is doubtful about it."""
        desk = self.desk
        if desk is None:  # as a recording that is replayed
            site = self.state.site["site"]
            shown = {kind: site.get(kind, {}) for kind in PLACES}
            version = self.state.site["version"]
            return json_answer(
                {"version": version, **shown, "rules": [], "remarks": [], "has_file": False}
            )
        parts = await _done(desk.parts)
        remarks = await _done(desk.remarks) if desk.draft is None else []
        return json_answer({**parts, "remarks": remarks, "has_file": True})

    async def kinds(self, request: Request) -> Response:
        """Return the kinds of rules there are, as forms need them."""
        return json_answer({"kinds": await asyncio.to_thread(_rule_kinds)})

    async def history(self, request: Request) -> Response:
        """Return which earlier versions of the site file are kept."""
        history = self._desk().history
        kept = [] if history is None else await asyncio.to_thread(history.versions)
        return json_answer({"versions": kept})

    async def version(self, request: Request) -> Response:
        """Return places and rules of an earlier version."""
        history, version = self._desk().history, request.path_params["version"]
        text = None if history is None else await asyncio.to_thread(history.text, version)
        if text is None:
            raise HTTPException(404, "there is no such version")
        return json_answer({"version": version, **parts_of(text)})

    async def put(self, request: Request) -> Response:
        """Replace the draft."""
        given = await body_of(request, DraftBody, LARGEST_DRAFT)
        wanted = Draft(
            given.based_on,
            given.revision,
            _by(request),
            given.zones,
            given.lines,
            given.edges,
            given.rules,
            given.exclusions,
            given.portals,
        )
        try:
            kept = await _done(partial(self._desk().put, wanted))
        except FaultsError as wrong:
            return json_answer({"error": str(wrong), "faults": wrong.faults}, 422)
        return await self._shown(kept)

    async def try_draft(self, request: Request) -> Response:
        """Judge the draft on a recording, beside the rules that are live."""
        given, desk = await body_of(request, TryBody), self._desk()
        if given.based_on != await _done(desk.version):
            raise HTTPException(409, "the site file has changed meanwhile; load the site again")
        if given.revision not in (None, 0 if desk.draft is None else desk.draft.revision):
            raise HTTPException(409, "there is no such draft; load it again")
        folder, name = self.trials.recordings, given.recording
        found = None
        if folder is not None and name is not None:
            found = await asyncio.to_thread(recording_folder, folder, name)
        if found is None:
            raise HTTPException(404, "expected the id of a recording that /api/recordings lists")
        texts = await _done(desk.trial_texts)
        part = (given.from_s, given.to_s)
        answer = await self.trials.run(desk.site_file, texts, found, part)
        return json_answer({"recording": name, **answer})

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

    async def _shown(self, draft: Draft) -> Response:
        shown = {**msgspec.to_builtins(draft), "remarks": await _done(self._desk().remarks)}
        return json_answer(shown)

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
    except FaultsError:
        raise
    except InputError as error:
        raise HTTPException(422, str(error)) from None


def _rule_kinds() -> list[dict[str, Any]]:
    from trecsim.sites.rule_kinds import rule_kinds

    return rule_kinds()
