"""`/api/feeds/NAME`: messages of other systems, such as ticket readers and vehicles."""

import asyncio
from collections.abc import Mapping, Sequence

from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route

from trecsim.page.access import Access, Identity
from trecsim.page.answers import json_answer
from trecsim.page.asking import HandOn
from trecsim.page.bodies import JSON, content_of, type_of
from trecsim.page.caller import caller_of
from trecsim.page.journal import Journal
from trecsim.page.live_state import LiveState
from trecsim.page.rates import Rates

LINES = "application/x-ndjson"  # a message a line
LARGEST = 65_536  # bytes
MOST_LINES = 1000  # at once
RATE_FACTOR = 2.0  # more than so many times `most_per_s` of a feed are refused in the long run


def feed_routes(access: Access, state: LiveState, journal: Journal, hand_on: HandOn) -> list[Route]:
    """Return the route of messages of feeds.

    Parameters
    ----------
    access
        Says who may do what.
    state
        Has the site with its feeds.
    journal
        Gets who begins to post messages.
    hand_on
        Hands messages on to the tracking process, whose rules get them.
    """
    desk = _FeedDesk(access, state, journal, hand_on)
    return [Route("/api/feeds/{feed:str}", access.needs("feeds", desk.take), methods=["POST"])]


class _FeedDesk:
    """Takes messages of the feeds of which the site file says that they are posted."""

    def __init__(self, access: Access, state: LiveState, journal: Journal, hand_on: HandOn) -> None:
        self._access, self._state = access, state
        self._journal, self._hand_on = journal, hand_on
        self._rates: dict[tuple[str, float], Rates] = {}
        self._noted: set[tuple[str, str]] = set()

    async def take(self, request: Request) -> Response:
        """Hand messages on, those that cannot be read too: the feed is faulty then."""
        identity: Identity = request.state.identity
        name = request.path_params["feed"]
        most_per_s = self._most_per_s(name)
        content = await content_of(request, (JSON, LINES), LARGEST)
        lines = _lines_of(content, one=type_of(request) == JSON)
        if not self._rate_of(name, most_per_s).allows("", len(lines)):
            raise HTTPException(
                429, f"too many messages: expected at most {most_per_s:g} a second",
                {"Retry-After": "1"},
            )  # fmt: skip
        await self._hand_on(name, lines)
        await self._note(identity.by, name, request)
        wrong = await asyncio.to_thread(_first_wrong, name, lines)
        if wrong is not None:
            return json_answer({"error": wrong, "taken": len(lines)}, 422)
        return json_answer({"taken": len(lines)}, 202)

    def _most_per_s(self, name: str) -> float:
        """Return the limit of a feed that messages may be posted to."""
        feeds: Mapping[str, Mapping[str, object]] = self._state.site["site"].get("feeds", {})
        feed = feeds.get(name, {})
        most_per_s = feed.get("most_per_s")
        if feed.get("source") != "http" or not isinstance(most_per_s, int | float):
            raise HTTPException(
                404, "there is no such feed that takes messages by HTTP; the site file says which "
                "do: http = true under [feeds.NAME]",
            )  # fmt: skip
        return float(most_per_s)

    def _rate_of(self, name: str, most_per_s: float) -> Rates:
        """Return what counts the messages of a feed, anew where its limit has changed."""
        key = name, most_per_s
        if key not in self._rates:
            others = {one: rates for one, rates in self._rates.items() if one[0] != name}
            per_s = RATE_FACTOR * most_per_s
            self._rates = {**others, key: Rates(per_s, max(per_s, float(MOST_LINES)))}
        return self._rates[key]

    async def _note(self, by: str, name: str, request: Request) -> None:
        """Keep in the audit log who posts to a feed: once, as messages come all day."""
        if (by, name) in self._noted:
            return
        self._noted.add((by, name))
        address = caller_of(request.scope, self._access.address).address
        await self._journal.audit(by, "post to feed", {"feed": name, "address": address})


def _lines_of(content: bytes, *, one: bool) -> list[bytes]:
    """Return the messages of a body: one, which may have several lines, or one a line."""
    if one:  # the text of a message in JSON has no line breaks but between its parts
        content = content.replace(b"\n", b" ")
    lines = [line.strip() for line in content.split(b"\n") if line.strip()]
    if not lines:
        raise HTTPException(400, "expected a message, found none")
    if len(lines) > MOST_LINES:
        raise HTTPException(413, f"expected at most {MOST_LINES} messages at once")
    return lines


def _first_wrong(feed: str, lines: Sequence[bytes]) -> str | None:
    """Return what is wrong with the first message that cannot be read."""
    from trecsim.sites.feed_files import signal_of

    for number, line in enumerate(lines, 1):
        read = signal_of(feed, line)
        if read.what == "unreadable":
            hint = f"; one message a line needs the type {LINES}" if len(lines) == 1 else ""
            return f"message {number}: {read.note}{hint}"
    return None
