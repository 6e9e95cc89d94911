"""The routes of the page."""

import re
from collections.abc import Awaitable, Callable
from dataclasses import dataclass

from starlette.applications import Starlette
from starlette.exceptions import HTTPException
from starlette.middleware import Middleware
from starlette.middleware.body_limit import RequestBodyLimitMiddleware
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import BaseRoute, Route, WebSocketRoute
from starlette.websockets import WebSocket

from trecsim.errors import Error
from trecsim.page.access import Access, Answer
from trecsim.page.answers import error, json_answer
from trecsim.page.asking import Ask, HandOn
from trecsim.page.bundle import Bundle, answer
from trecsim.page.event_routes import event_routes
from trecsim.page.feed_routes import feed_routes
from trecsim.page.journal import Journal
from trecsim.page.live_state import LiveState
from trecsim.page.login import login_routes
from trecsim.page.messages import json_bytes
from trecsim.page.metrics import metrics_text
from trecsim.page.mode_routes import mode_routes
from trecsim.page.page_data import PageData
from trecsim.page.picture_routes import picture_routes
from trecsim.page.policy import Policy
from trecsim.page.recording_routes import recording_routes
from trecsim.page.schema import stream_schema
from trecsim.page.site_draft import DraftDesk
from trecsim.page.site_routes import SiteDesk, site_routes
from trecsim.page.stream import stream
from trecsim.page.trial import Trials
from trecsim.page.why import Reasons

LARGEST_BODY = 1_000_000  # bytes of a request
PAGES = re.compile(r"/(?:live|review|zones|system|login)(?:/.*)?$")


@dataclass(frozen=True, slots=True)
class Parts:
    """What the routes need.

    Attributes
    ----------
    state
        What is known of the site now.
    access
        Who may do what.
    journal
        Events and audit.
    bundle
        The built page.
    ask
        Asks the tracking process for something.
    data
        Files that are shown.
    hand_on
        Hands messages of feeds on to the tracking process.
    """

    state: LiveState
    access: Access
    journal: Journal
    bundle: Bundle
    ask: Ask
    data: PageData
    hand_on: HandOn


def page_app(parts: Parts) -> Starlette:
    """Return the application that answers browsers and programs."""
    state, access = parts.state, parts.access
    site = _site_desk(parts)
    reasons = Reasons(parts.data.recordings, site.desk)
    routes: list[BaseRoute] = [
        Route("/api/health", _health(state, access)),
        Route("/api/schema", _schema),
        Route("/metrics", access.needs("viewer", _metrics(state))),
        WebSocketRoute("/api/stream", _stream(parts)),
        *login_routes(access, parts.journal),
        *event_routes(access, parts.journal, state.hub, parts.ask, reasons),
        *recording_routes(access, parts.data.recordings, state),
        *site_routes(access, site),
        *mode_routes(access, state, parts.journal, parts.ask),
        *picture_routes(access, state, parts.journal, parts.ask),
        *feed_routes(access, state, parts.journal, parts.hand_on),
        Route("/{path:path}", _files(parts.bundle)),
    ]
    return Starlette(
        routes=routes,
        middleware=[
            Middleware(Policy, address=access.address),
            Middleware(RequestBodyLimitMiddleware, max_body_size=LARGEST_BODY),
        ],
        exception_handlers={HTTPException: _refused, Error: _impossible},
    )


def _health(state: LiveState, access: Access) -> Answer:
    async def health(request: Request) -> Response:
        body = state.health_json()
        identity = access.identity(request)
        if identity is None or not identity.may("viewer"):  # a watchdog needs no more
            body = {"status": body["status"]}
        return json_answer(body, 200 if body["status"] == "ok" else 503)

    return health


async def _schema(request: Request) -> Response:
    return Response(json_bytes(stream_schema()), media_type="application/schema+json")


def _site_desk(parts: Parts) -> SiteDesk:
    data = parts.data
    desk = None if data.site_file is None else DraftDesk(data.site_file, data.ledger)
    return SiteDesk(parts.state, parts.journal, parts.ask, desk, Trials(data.recordings))


def _metrics(state: LiveState) -> Answer:
    async def metrics(request: Request) -> Response:
        kind = "text/plain; version=0.0.4; charset=utf-8"
        return Response(metrics_text(state), headers={"Content-Type": kind})

    return metrics


def _stream(parts: Parts) -> Callable[[WebSocket], Awaitable[None]]:
    def may_see(socket: WebSocket) -> bool:
        try:
            identity = parts.access.identity(socket)
            return identity is not None and identity.may("viewer")
        except HTTPException:
            return False

    async def serve(socket: WebSocket) -> None:
        try:
            parts.access.checked(socket, "viewer")
        except HTTPException as refused:
            answer = error(refused.status_code, refused.detail)
            await socket.send_denial_response(answer)
            return
        await stream(socket, parts.state.hub, parts.journal.missed, lambda: may_see(socket))

    return serve


def _files(bundle: Bundle) -> Answer:
    async def files(request: Request) -> Response:
        path = request.url.path
        if path == "/" or PAGES.match(path):
            return answer(bundle.index(), request)
        if path in ("/favicon.svg", "/favicon.ico"):
            return answer(bundle.favicon(), request)
        asset = None if path.startswith("/api/") else bundle.asset(path.lstrip("/"))
        if asset is None:
            raise HTTPException(404, "there is nothing here")
        return answer(asset, request)

    return files


async def _refused(request: Request, exception: Exception) -> Response:
    if not isinstance(exception, HTTPException):
        raise exception
    return error(exception.status_code, exception.detail, dict(exception.headers or {}))


async def _impossible(request: Request, exception: Exception) -> Response:
    """Answer what this machine cannot do now, as when its disk is full."""
    return error(503, str(exception))
