"""A client of the live page, for programs."""

import logging
import ssl
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from time import sleep
from typing import TYPE_CHECKING, Any
from urllib.parse import quote, urlsplit

import msgspec
import numpy as np

from trecsim.errors import Error, InputError, SetupError
from trecsim.extras import has_extra, install_command
from trecsim.page.address import is_token
from trecsim.redaction import redacted
from trecsim.skeleton import COCO17
from trecsim.values import Snapshot

if TYPE_CHECKING:
    from websockets.exceptions import InvalidStatus
    from websockets.sync.client import ClientConnection

logger = logging.getLogger(__name__)

PAUSES_S = (0.5, 1.0, 2.0, 4.0, 8.0)  # before each try after a break; the last one from then on
SILENT_S = 10.0  # a page that says nothing for so long is gone: it tells its health twice a second
LARGEST_BYTES = 64_000_000
_SCHEMES = {"http": "ws", "https": "wss", "ws": "ws", "wss": "wss"}
_REFUSED = {  # trying again changes nothing
    400: "it does not understand the request",
    401: "sign in first, with a token",
    403: "this token may not read it",
    404: "there is no live page at this address",
    421: "it does not serve this host name",
}
_SIGNED_OUT = 4401
_JOINTS = len(COCO17.joints)

Message = Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class LiveEvent:
    """An event of a live site.

    Attributes
    ----------
    id
        Of this event; `connect` goes on after it.
    kind
        As "zone.enter".
    data
        Everything else: the episode (`event`), its `phase`, `severity`, `people` and so on.
    sent_s
        When the page sent it, Unix time [s].
    """

    id: str
    kind: str
    data: Mapping[str, Any]
    sent_s: float

    def __repr__(self) -> str:
        return f"<LiveEvent {self.kind} {self.data.get('phase', '')}, id={self.id!r}>"


def connect(
    url: str,
    token: str | None = None,
    *,
    last_event_id: str | None = None,
    tls: ssl.SSLContext | None = None,
) -> Iterator[Snapshot | LiveEvent]:
    """Yield what happens at a live site: people and events, for as long as you ask.

    After a break it logs the reason, connects again with growing pauses and goes on after the last
    event; it gives up only where the page refuses the connection. A program that is slow gets the
    newest snapshots and all events.

    Parameters
    ----------
    url
        Address of the page, as the line `page:` of `trecsim run` says.
    token
        The token of programs, if the page asks for one.
    last_event_id
        Go on after this event; None for new events only.
    tls
        What to trust at a page with `https`; None trusts what the system trusts.

    Yields
    ------
    Snapshot | LiveEvent
        The covariance of a snapshot is that of its `sigma_m`, the same in all directions; its
        velocity is not known.

    Raises
    ------
    InputError
        The address or the token is none, nobody answers there at first, the page refuses the
        connection, or what it sends are no messages of a page.
    SetupError
        Optional packages are missing.
    """
    if not has_extra("page"):
        raise SetupError(
            "connect needs packages that are not installed: " + install_command("page")
        )
    link = _Link(_address(url), _checked(token), tls, last_event_id)
    outage = _Outage(redacted(url))
    while True:
        try:
            for message in link.messages():
                outage.end()
                item = _item_of(message)
                if item is not None:
                    yield item
        except _BrokenError as broken:
            if not link.was_open:
                raise InputError(f"nothing answers at {redacted(url)}: {broken}") from None
            sleep(outage.pause_s(str(broken)))


class _Outage:
    """Counts the tries since a connection broke and logs why it cannot be made again.

    Each of the first tries is logged; later ones only when the reason changes.
    """

    def __init__(self, url: str) -> None:
        self._url = url
        self._tries = 0
        self._reason = ""

    def pause_s(self, reason: str) -> float:
        """Return how long to wait before the next try [s]."""
        pause_s = PAUSES_S[min(self._tries, len(PAUSES_S) - 1)]
        self._tries += 1
        if self._tries <= len(PAUSES_S) or reason != self._reason:
            logger.warning(
                "no connection to %s: %s; trying again in %g s", self._url, reason, pause_s
            )
        self._reason = reason
        return pause_s

    def end(self) -> None:
        """Take in that the page sends messages."""
        if self._tries:
            logger.warning("connected to %s again", self._url)
        self._tries, self._reason = 0, ""


class _BrokenError(Error):
    """The connection broke; another try may help."""


@dataclass(slots=True)
class _Link:
    """One connection after the other, and the last event that came over them."""

    address: str
    token: str | None
    tls: ssl.SSLContext | None
    last_event_id: str | None
    was_open: bool = False

    def messages(self) -> Iterator[Message]:
        """Yield the messages of one connection."""
        from websockets.exceptions import InvalidHandshake, InvalidStatus
        from websockets.sync.client import connect

        query = "" if self.last_event_id is None else f"?last_event_id={quote(self.last_event_id)}"
        headers = {} if self.token is None else {"Authorization": f"Bearer {self.token}"}
        try:
            with connect(
                self.address + query, additional_headers=headers, ssl=self.tls, compression=None,
                max_size=LARGEST_BYTES, user_agent_header="trecsim",
            ) as stream:  # fmt: skip
                self.was_open = True
                yield from self._received(stream)
        except InvalidStatus as refused:
            raise _refusal(refused) from None
        except (OSError, InvalidHandshake, TimeoutError) as broken:
            raise _BrokenError(str(broken) or type(broken).__name__) from None

    def _received(self, stream: "ClientConnection") -> Iterator[Message]:
        from websockets.exceptions import ConnectionClosed

        while True:
            try:
                message = _decoded(stream.recv(SILENT_S))
            except TimeoutError:
                raise _BrokenError(f"the page sent nothing for {SILENT_S:g} s") from None
            except ConnectionClosed as closed:
                if closed.rcvd is not None and closed.rcvd.code == _SIGNED_OUT:
                    raise InputError("the page does not take this token any more") from None
                raise _BrokenError(str(closed)) from None
            yield message
            if message["type"] == "event":  # the caller has it
                self.last_event_id = str(message["event"]["id"])


def _decoded(text: str | bytes) -> Message:
    try:
        message = msgspec.json.decode(text)
    except (msgspec.MsgspecError, UnicodeDecodeError) as error:
        raise _no_message(error) from None
    if not isinstance(message, dict) or "type" not in message:
        raise _no_message("no object with a type")
    return message


def _item_of(message: Message) -> Snapshot | LiveEvent | None:
    """Return what a message tells; None where that is neither people nor an event."""
    try:
        if message["type"] == "snapshot":
            return snapshot_of(message)
        return _event_of(message) if message["type"] == "event" else None
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise _no_message(f"{type(error).__name__}: {error}") from None


def _no_message(why: object) -> InputError:
    return InputError(
        "expected messages of a page of trecsim, found something else "
        f"({redacted(str(why))[:100]}); is this its address, and its version the same?"
    )


def snapshot_of(message: Message) -> Snapshot:
    """Return the snapshot that a message of the stream tells.

    Parameters
    ----------
    message
        One of the type "snapshot".
    """
    people = message["people"]
    shape = (len(people), _JOINTS)
    xyz_m = _numbers([person["xyz_m"] for person in people], (*shape, 3))
    sigma_m = _numbers([person["sigma_m"] for person in people], shape)
    return Snapshot(
        t_s=float(message["t_s"]),
        id=np.array([person["person"] for person in people], np.int64),
        xyz_m=xyz_m,
        cov_m2=np.square(sigma_m)[..., None, None] * np.eye(3),
        support=np.array([person["support"] for person in people], np.int64).reshape(shape),
        state=np.array([person["state"] for person in people], dtype="U16"),
    )


def _event_of(message: Message) -> LiveEvent:
    event = message["event"]
    kind = str(event["type"]).removeprefix("trecsim.").removesuffix(".v1")
    return LiveEvent(str(event["id"]), kind, event.get("data", {}), message["sent_s"])


def _numbers(values: list[Any], shape: tuple[int, ...]) -> np.ndarray:
    """Return numbers, NaN in place of None."""
    return np.array(values, dtype=np.float64).reshape(shape)


def _checked(token: str | None) -> str | None:
    """Return a token that can be sent; the message about another one does not show it."""
    if token is not None and not is_token(token):
        raise InputError(
            "the token cannot be one: expected printable ASCII letters without spaces; a line "
            "break at the end comes from reading it from a file: use token.strip()"
        )
    return token


def _address(url: str) -> str:
    try:
        parts = urlsplit(url)
        _ = parts.port
    except ValueError:
        parts = urlsplit("")
    if parts.scheme not in _SCHEMES or not parts.hostname:
        raise InputError(
            f"expected the address of a page, as http://127.0.0.1:8765, found {redacted(url)!r}"
        )
    place = parts.netloc.rpartition("@")[2]
    return f"{_SCHEMES[parts.scheme]}://{place}{parts.path.rstrip('/')}/api/stream"


def _refusal(refused: "InvalidStatus") -> Error:
    response = refused.response
    try:
        said = msgspec.json.decode(response.body or b"{}").get("error", "")
    except (msgspec.MsgspecError, AttributeError):
        said = ""
    text = said or _REFUSED.get(response.status_code, f"it answers {response.status_code}")
    if response.status_code in _REFUSED:
        return InputError(f"the page refuses the connection: {text}")
    return _BrokenError(text)
