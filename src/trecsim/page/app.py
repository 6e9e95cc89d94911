"""The routes of the page."""

import re
from collections.abc import Awaitable, Callable

from starlette.applications import Starlette
from starlette.exceptions import HTTPException
from starlette.middleware import Middleware
from starlette.middleware.body_limit import RequestBodyLimitMiddleware
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocket

from trecsim.page.address import PageAddress
from trecsim.page.bundle import Bundle, answer
from trecsim.page.hosts import names_of
from trecsim.page.live_state import LiveState
from trecsim.page.messages import json_bytes
from trecsim.page.metrics import metrics_text
from trecsim.page.policy import Policy, error
from trecsim.page.schema import stream_schema
from trecsim.page.stream import stream

LARGEST_BODY = 1_000_000  # bytes of a request
PAGES = re.compile(r"/(?:live|review|zones|system|login)(?:/.*)?$")

Answer = Callable[[Request], Awaitable[Response]]


def page_app(state: LiveState, address: PageAddress, bundle: Bundle) -> Starlette:
    """Return the application that answers browsers and programs.

    Parameters
    ----------
    state
        What is known of the site now.
    address
        Where the page listens.
    bundle
        The built page.
    """
    routes = [
        Route("/api/health", _health(state)),
        Route("/api/schema", _schema),
        Route("/api/site", _site(state)),
        Route("/metrics", _metrics(state)),
        WebSocketRoute("/api/stream", _stream(state)),
        Route("/{path:path}", _files(bundle)),
    ]
    return Starlette(
        routes=routes,
        middleware=[
            Middleware(Policy, names=names_of(address)),
            Middleware(RequestBodyLimitMiddleware, max_body_size=LARGEST_BODY),
        ],
        exception_handlers={HTTPException: _refused},
    )


def json_answer(body: object, status: int = 200) -> Response:
    """Return an answer in JSON; numbers that are missing become null."""
    return Response(json_bytes(body), status, media_type="application/json")


def _health(state: LiveState) -> Answer:
    async def health(request: Request) -> Response:
        body = state.health_json()
        return json_answer(body, 200 if body["status"] == "ok" else 503)

    return health


async def _schema(request: Request) -> Response:
    return Response(json_bytes(stream_schema()), media_type="application/schema+json")


def _site(state: LiveState) -> Answer:
    async def site(request: Request) -> Response:
        return json_answer(state.site)

    return site


def _metrics(state: LiveState) -> Answer:
    async def metrics(request: Request) -> Response:
        kind = "text/plain; version=0.0.4; charset=utf-8"
        return Response(metrics_text(state), headers={"Content-Type": kind})

    return metrics


def _stream(state: LiveState) -> Callable[[WebSocket], Awaitable[None]]:
    async def serve(socket: WebSocket) -> None:
        await stream(socket, state.hub)

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
