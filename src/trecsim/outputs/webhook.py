"""Events as signed HTTP requests."""

import hashlib
import hmac
import ssl
from collections.abc import Callable
from http.client import HTTPConnection, HTTPException, HTTPSConnection
from urllib.parse import urlsplit

from trecsim.cloud_events import event_text
from trecsim.outputs.base import Event, UndeliveredError

SIGNATURE = "X-Trecsim-Signature"
TIMEOUT_S = 10.0
TYPE = "application/cloudevents+json"


class Webhook:
    """Posts each event; an answer of 2xx means that it was taken.

    Redirections are not followed: they could lead the event, and its signature, elsewhere.

    Parameters
    ----------
    url
        Where to.
    key
        Signs the body; None sends it unsigned.
    timeout_s
        So long is waited for the connection, and for each part of the answer [s].
    """

    def __init__(self, url: str, key: str | None = None, *, timeout_s: float = TIMEOUT_S) -> None:
        parts = urlsplit(url)
        self._host, self._port = parts.hostname or "", parts.port
        self._target = (parts.path or "/") + (f"?{parts.query}" if parts.query else "")
        self._connect: Callable[..., HTTPConnection] = HTTPConnection
        if parts.scheme.lower() == "https":
            self._connect = _https
        self._key, self._timeout_s = key, timeout_s

    def deliver(self, event: Event, /) -> None:
        """Post an event; see `Output`."""
        body = event_text(event).encode()
        headers = {"Content-Type": TYPE, "User-Agent": "trecsim"}
        if self._key is not None:
            headers[SIGNATURE] = signature(self._key, body)
        status = self._post(body, headers)
        if not 200 <= status < 300:
            raise UndeliveredError(f"{self._host} answers with status {status}, not with 2xx")

    def _post(self, body: bytes, headers: dict[str, str]) -> int:
        connection = self._connect(self._host, self._port, timeout=self._timeout_s)
        try:
            connection.request("POST", self._target, body, headers)
            return connection.getresponse().status
        except TimeoutError:
            raise UndeliveredError(
                f"{self._host} has not answered within {self._timeout_s:g} s"
            ) from None
        except (OSError, HTTPException) as error:  # its text may hold what was sent
            said = error.strerror if isinstance(error, OSError) else None
            raise UndeliveredError(f"{self._host}: {said or type(error).__name__}") from None
        finally:
            connection.close()


def _https(host: str, port: int | None, *, timeout: float) -> HTTPConnection:
    return HTTPSConnection(host, port, timeout=timeout, context=ssl.create_default_context())


def signature(key: str, body: bytes) -> str:
    """Return the value of the header that proves who has sent a body.

    Examples
    --------
    >>> signature("key", b"{}")[:24]
    'sha256=a777724d943eb48dc'
    """
    return f"sha256={hmac.new(key.encode(), body, hashlib.sha256).hexdigest()}"
