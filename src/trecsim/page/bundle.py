"""The built page: files by path, compressed once, cached by browsers where their name says so."""

import gzip
import re
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from starlette.requests import Request
from starlette.responses import Response

STATIC = Path(__file__).parent / "static"
KINDS = {
    ".html": "text/html; charset=utf-8", ".js": "text/javascript; charset=utf-8",
    ".css": "text/css; charset=utf-8", ".svg": "image/svg+xml", ".png": "image/png",
    ".ico": "image/x-icon", ".woff2": "font/woff2", ".json": "application/json",
    ".webmanifest": "application/manifest+json", ".txt": "text/plain; charset=utf-8",
    ".wasm": "application/wasm", ".mp3": "audio/mpeg", ".ogg": "audio/ogg",
}  # fmt: skip
_COMPRESSED = (".html", ".js", ".css", ".svg", ".json", ".txt", ".wasm", ".webmanifest")
_HASHED = re.compile(r"[-.][A-Za-z0-9_-]{8,}\.\w+$")
_FOR_EVER, _ASK_AGAIN = "public, max-age=31536000, immutable", "no-cache"

PLAIN_PAGE = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<title>trecsim</title>
<meta name="viewport" content="width=device-width, initial-scale=1">
<link rel="icon" href="/favicon.svg">
</head>
<body>
<h1>trecsim runs</h1>
<p>The operator page is not built in this installation. People are tracked all the same, and
programs can read everything:</p>
<ul>
<li><a href="/api/health">/api/health</a>: how well cameras and stages work</li>
<li>/api/stream: people, events and health, as a WebSocket (<a href="/api/schema">schema</a>)</li>
<li><a href="/api/site">/api/site</a>: cameras and zones</li>
<li><a href="/metrics">/metrics</a>: figures for Prometheus</li>
</ul>
<p>To build the page in a clone of the repository: <code>make page</code>. To install it elsewhere:
<code>pip install --force-reinstall ".[page]"</code> in a clone.</p>
</body>
</html>
"""
FAVICON = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 32 32">
<rect width="32" height="32" rx="7" fill="#1d2730"/>
<g fill="none" stroke="#e8eef2" stroke-width="2.6" stroke-linecap="round">
<circle cx="16" cy="8" r="3"/><path d="M16 12v7M10 15l6-2 6 2M16 19l-4 7M16 19l4 7"/></g>
</svg>
"""


@dataclass(frozen=True, slots=True)
class Asset:
    """One file: as it is, and compressed where that is worth it."""

    body: bytes
    compressed: bytes | None
    kind: str
    caching: str


class Bundle:
    """Finds files of the built page.

    Parameters
    ----------
    folder
        Where it is; it need not exist.
    """

    def __init__(self, folder: Path = STATIC) -> None:
        self._folder = folder.resolve()

    @property
    def is_built(self) -> bool:
        """Whether there is a page."""
        return (self._folder / "index.html").is_file()

    def asset(self, path: str) -> Asset | None:
        """Return a file by its path below the folder; None where there is no such file."""
        file = (self._folder / path).resolve() if "\0" not in path else self._folder
        if not file.is_relative_to(self._folder) or file.suffix not in KINDS:
            return None
        try:
            changed = file.stat().st_mtime_ns
            return _read(file, changed) if file.is_file() else None
        except OSError:
            return None

    def index(self) -> Asset:
        """Return the page itself, or one that says how to build it."""
        return self.asset("index.html") or _asset(PLAIN_PAGE.encode(), "index.html")

    def favicon(self) -> Asset:
        """Return the picture of the page's tab."""
        return self.asset("favicon.svg") or _asset(FAVICON.encode(), "favicon.svg")


@lru_cache(maxsize=256)
def _read(file: Path, changed: int) -> Asset:
    return _asset(file.read_bytes(), file.name)


def _asset(body: bytes, name: str) -> Asset:
    suffix = Path(name).suffix
    worth_it = suffix in _COMPRESSED and len(body) > 500
    return Asset(
        body,
        gzip.compress(body, mtime=0) if worth_it else None,
        KINDS[suffix],
        _FOR_EVER if _HASHED.search(name) and suffix != ".html" else _ASK_AGAIN,
    )


def answer(asset: Asset, request: Request) -> Response:
    """Return a file as the answer to a request."""
    headers = {"Cache-Control": asset.caching, "Content-Type": asset.kind}
    body = asset.body
    if asset.compressed is not None:
        headers["Vary"] = "Accept-Encoding"
        if "gzip" in request.headers.get("accept-encoding", ""):
            headers["Content-Encoding"] = "gzip"
            body = asset.compressed
    return Response(body, headers=headers)
