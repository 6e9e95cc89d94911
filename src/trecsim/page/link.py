"""What the tracking process and the page process say to each other, and how.

Both ends speak MessagePack with a length before each message. It holds data only, so that a page
process in wrong hands cannot make the tracking process run anything.
"""

import math
import socket
from collections.abc import Callable
from typing import Any

import msgspec

from trecsim.errors import Error
from trecsim.health import Health
from trecsim.safety.vehicle import PlacedVehicle

LARGEST_BYTES = 4 * 1024 * 1024
"""A longer message of the page process is none: what it was asked is much shorter."""
_HEAD_BYTES = 4


class Setup(msgspec.Struct, frozen=True, tag="setup"):
    """The first thing the page process hears.

    Attributes
    ----------
    address
        Fields of the `PageAddress`.
    url
        Where browsers on this machine find the page.
    data
        Fields of the `PageData`.
    """

    address: dict[str, Any]
    url: str
    data: dict[str, Any]


class SnapshotPart(msgspec.Struct, frozen=True, tag="snapshot"):
    """Where everybody is: arrays as their bytes, in the order of the fields of a `Snapshot`.

    Attributes
    ----------
    t_s
        The moment [s].
    id, support
        int64.
    xyz_m, sigma_m
        float64.
    state, posture
        Per person.
    seen_s
        Per person, how long ago a camera last supported a joint [s].
    vehicles
        Where the vehicles are whose positions come from feeds.
    written_s
        When it was handed over, by `time.monotonic`, which both processes share [s].
    """

    t_s: float
    id: bytes
    xyz_m: bytes
    sigma_m: bytes
    support: bytes
    state: list[str]
    posture: list[str]
    seen_s: list[float]
    vehicles: tuple[PlacedVehicle, ...] = ()
    written_s: float = math.nan


class HealthPart(msgspec.Struct, frozen=True, tag="health"):
    """How well the site works."""

    health: Health


class EventPart(msgspec.Struct, frozen=True, tag="event"):
    """An event, with its running number in this run, and whether the ledger has it."""

    number: int
    event: dict[str, Any]
    kept: bool


class PicturePart(msgspec.Struct, frozen=True, tag="picture"):
    """What a camera sees, for who looks at it now.

    Attributes
    ----------
    camera
        The camera.
    t_s
        When the image was taken [s].
    jpeg
        The image.
    """

    camera: str
    t_s: float
    jpeg: bytes


class SitePart(msgspec.Struct, frozen=True, tag="site"):
    """The site as it is from now on: the body of `/api/site`."""

    body: dict[str, Any]


class PulsePart(msgspec.Struct, frozen=True, tag="pulse"):
    """A sign of life."""


class PageRequest(msgspec.Struct, frozen=True, tag="request"):
    """What somebody at the page asks the tracking process to do.

    Attributes
    ----------
    kind
        What is asked, as "reload".
    by
        Who asks: the name of a user.
    body
        Details.
    """

    kind: str
    by: str
    body: dict[str, Any]


class FeedLines(msgspec.Struct, frozen=True, tag="feed"):
    """Messages of a feed that were posted to the page.

    Attributes
    ----------
    feed
        Name of the feed.
    lines
        The messages, not read yet.
    """

    feed: str
    lines: list[bytes]


ToPage = Setup | SnapshotPart | HealthPart | EventPart | PicturePart | SitePart | PulsePart
FromPage = PulsePart | PageRequest | FeedLines

_ENCODER = msgspec.msgpack.Encoder()
TO_PAGE = msgspec.msgpack.Decoder(ToPage)
FROM_PAGE = msgspec.msgpack.Decoder(FromPage)


def framed(message: ToPage | FromPage) -> bytes:
    """Return a message as it goes over the link."""
    body = _ENCODER.encode(message)
    return len(body).to_bytes(_HEAD_BYTES, "big") + body


def receive_body(link: socket.socket, wait: Callable[[], None] = lambda: None) -> bytes | None:
    """Return the next message, not decoded; None when the other end has gone.

    Parameters
    ----------
    link
        The link.
    wait
        Is called before each look for the next piece; what it raises ends the waiting.

    Raises
    ------
    Error
        What comes is no message.
    """
    head = _exactly(link, _HEAD_BYTES, wait)
    if head is None:
        return None
    size = int.from_bytes(head, "big")
    if size > LARGEST_BYTES:
        raise Error(f"the link to the page: expected at most {LARGEST_BYTES} bytes, found {size}")
    return _exactly(link, size, wait)


def _exactly(link: socket.socket, size: int, wait: Callable[[], None]) -> bytes | None:
    parts = bytearray()
    while len(parts) < size:
        wait()
        try:
            part = link.recv(size - len(parts))
        except ConnectionError:
            return None
        if not part:
            return None
        parts += part
    return bytes(parts)
