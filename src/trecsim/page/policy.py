"""What holds for every request: who may ask, how much, and what browsers may do with the answer."""

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from trecsim.page.access import SAFE
from trecsim.page.address import PageAddress
from trecsim.page.answers import error
from trecsim.page.caller import caller_of
from trecsim.page.hosts import is_known, is_own_origin, names_of
from trecsim.page.rates import Rates

LONGEST_PATH = 1024  # bytes, and as many in the query
LARGEST_HEADERS = 16_384  # bytes, all together
REQUESTS_PER_S, REQUESTS_AT_ONCE = 100.0, 400.0  # of one address

HEADERS = {
    "Content-Security-Policy": (
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
        "font-src 'self'; connect-src 'self'; worker-src 'self'; manifest-src 'self'; "
        "base-uri 'none'; form-action 'self'; frame-ancestors 'none'"
    ),
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Permissions-Policy": "camera=(), microphone=(), geolocation=(), payment=(), usb=()",
}


class Policy:
    """Refuses what is not meant for this page or is too much; adds the headers to every answer.

    Parameters
    ----------
    app
        Who answers.
    address
        Where the page listens.
    """

    def __init__(self, app: ASGIApp, address: PageAddress) -> None:
        self._app = app
        self._address = address
        self._names = names_of(address)
        self._rates = Rates(REQUESTS_PER_S, REQUESTS_AT_ONCE)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request or WebSocket."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        refusal = self._refusal(scope)
        answer = self._app if refusal is None else refusal
        await answer(scope, receive, send if scope["type"] == "websocket" else _with_headers(send))

    def _refusal(self, scope: Scope) -> ASGIApp | None:
        headers = Headers(scope=scope)
        if len(scope["raw_path"]) > LONGEST_PATH or len(scope["query_string"]) > LONGEST_PATH:
            return error(414, f"expected an address of at most {LONGEST_PATH} bytes")
        if sum(len(name) + len(value) for name, value in scope["headers"]) > LARGEST_HEADERS:
            return error(431, f"expected headers of at most {LARGEST_HEADERS} bytes")
        if not is_known(headers.get("host"), self._names):
            return error(
                421, "this page has another name; add the name to hosts under [page] if it is right"
            )
        changes = scope["type"] == "websocket" or scope["method"] not in SAFE
        if changes and not is_own_origin(headers):
            return error(403, "this request comes from a page of another site")
        if not self._rates.allows(caller_of(scope, self._address).address):
            return error(429, "too many requests; try again in a second", {"Retry-After": "1"})
        return None


def _with_headers(send: Send) -> Send:
    async def wrapped(message: Message) -> None:
        if message["type"] == "http.response.start":
            headers = MutableHeaders(scope=message)
            for name, value in HEADERS.items():
                headers[name] = value
            headers.setdefault("Cache-Control", "no-store")
        await send(message)

    return wrapped
