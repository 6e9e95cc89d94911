"""`/api/events`: what happened, and what people do to it."""

import asyncio
from typing import Annotated, Any, Literal

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
from trecsim.page.hub import Hub
from trecsim.page.journal import Journal
from trecsim.page.queries import number_in, text_in
from trecsim.page.why import Reasons

MOST_AT_ONCE = 1000
LONGEST_NOTE = 2000  # characters
TOLD = ("new", "update", "end")  # phases in which a rule tells

_Id = Annotated[str, msgspec.Meta(min_length=1, max_length=200)]


class Act(msgspec.Struct, frozen=True, omit_defaults=True):
    """What somebody does to an event; see the contract of events."""

    phase: Literal["ack", "shelve", "unshelve", "close", "reopen"]
    event: _Id | None = None
    until_s: float | None = None
    reason: Literal["true", "false", "test", "expected"] | None = None
    note: Annotated[str, msgspec.Meta(max_length=LONGEST_NOTE)] | None = None


class Reviewed(msgspec.Struct, frozen=True):
    """Events that the user has looked at, or has not after all."""

    events: Annotated[list[_Id], msgspec.Meta(max_length=MOST_AT_ONCE)]
    reviewed: bool = True


def event_routes(
    access: Access, journal: Journal, hub: Hub, ask: Ask, reasons: Reasons
) -> list[Route]:
    """Return the routes of events.

    Parameters
    ----------
    access
        Says who may do what.
    journal
        Keeps the events.
    hub
        Shows them to viewers.
    ask
        Tells the tracking process.
    reasons
        Finds out why an event fired.
    """
    looking = asyncio.Semaphore(1)

    async def listed(request: Request) -> Response:
        found = await journal.events(
            after=text_in(request, "after"),
            episode=text_in(request, "event"),
            from_s=number_in(request, "from_s"),
            until_s=number_in(request, "until_s"),
            limit=int(number_in(request, "limit", 1, MOST_AT_ONCE) or MOST_AT_ONCE),
        )
        return json_answer({"events": found})

    async def act(request: Request) -> Response:
        identity: Identity = request.state.identity
        given = await body_of(request, Act)
        episode = request.path_params.get("event") or given.event
        if episode is None:
            raise HTTPException(400, "expected the event, found none")
        said: dict[str, Any] = {
            key: value
            for key in ("until_s", "reason", "note")
            if (value := getattr(given, key)) is not None
        }
        try:
            event = await journal.act(episode, given.phase, identity.by, said)
        except InputError as error:
            raise HTTPException(409, str(error)) from None
        hub.wake()
        await ask("event", identity.by, {"event": event})
        return json_answer({"event": event})

    async def why(request: Request) -> Response:
        found = await journal.events(episode=request.path_params["event"])
        told = [one["data"] for one in found if one.get("data", {}).get("phase") in TOLD]
        if not told:
            raise HTTPException(404, "there is no such event")
        async with looking:
            try:
                answer = await asyncio.to_thread(reasons.of, told[-1])
            except (InputError, KeyError, TypeError, ValueError) as error:
                text = str(error) if isinstance(error, InputError) else "no rule has made it"
                raise HTTPException(404, text) from None
        return json_answer(answer)

    async def reviewed(request: Request) -> Response:
        identity: Identity = request.state.identity
        return json_answer({"events": await journal.reviewed(identity.by)})

    async def mark(request: Request) -> Response:
        identity: Identity = request.state.identity
        given = await body_of(request, Reviewed, largest=256_000)
        await journal.mark_reviewed(identity.by, given.events, given.reviewed)
        return json_answer({"events": await journal.reviewed(identity.by)})

    return [
        Route("/api/events", access.needs("viewer", listed), methods=["GET"]),
        Route("/api/events/{event:str}/why", access.needs("viewer", why), methods=["GET"]),
        Route("/api/events", access.needs("operator", act), methods=["POST"]),
        Route("/api/events/{event:str}", access.needs("operator", act), methods=["POST"]),
        Route("/api/users/me/reviewed", access.needs("viewer", reviewed), methods=["GET"]),
        Route("/api/users/me/reviewed", access.needs("viewer", mark), methods=["POST"]),
    ]
