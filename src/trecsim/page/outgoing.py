"""What waits to be sent to the page process."""

import socket
from collections import deque
from collections.abc import Iterator
from itertools import islice
from threading import Condition
from time import monotonic
from typing import Any

from trecsim.page.last_seen import snapshot_part
from trecsim.page.link import (
    EventPart,
    HealthPart,
    PicturePart,
    PulsePart,
    Setup,
    SitePart,
    ToPage,
    framed,
)
from trecsim.safety.vehicle import PlacedVehicle
from trecsim.values import Snapshot

EVENTS_KEPT = 2_000  # for a page process that is started again
PULSE_S = 1.0

# How long ago each was seen, where vehicles are, when it was put in.
_Seen = tuple[Snapshot, list[float], tuple[PlacedVehicle, ...], float]


class Outgoing:
    """Holds the newest snapshot, health, site and pictures, and all events, for one process.

    Putting something in never waits for the process.

    Parameters
    ----------
    site
        The site to begin with.
    """

    def __init__(self, site: SitePart) -> None:
        self._changed = Condition()
        self._site: SitePart = site
        self._health: HealthPart | None = None
        self._snapshot: _Seen | None = None
        self._events: deque[EventPart] = deque(maxlen=EVENTS_KEPT)
        self._pictures: dict[str, PicturePart] = {}
        self._fresh: set[str] = set()
        self._next_event = 0  # running number of the next event to send
        self._count = 0  # events so far

    def put_snapshot(
        self, snapshot: Snapshot, seen_s: list[float], vehicles: tuple[PlacedVehicle, ...] = ()
    ) -> None:
        """Replace the snapshot that waits."""
        with self._changed:
            self._snapshot = (snapshot, seen_s, vehicles, monotonic())
            self._fresh.add("snapshot")
            self._changed.notify()

    def put_health(self, health: HealthPart) -> None:
        """Replace the health that waits."""
        with self._changed:
            self._health = health
            self._fresh.add("health")
            self._changed.notify()

    def put_site(self, site: SitePart) -> None:
        """Replace the site that waits."""
        with self._changed:
            self._site = site
            self._fresh.add("site")
            self._changed.notify()

    def put_picture(self, picture: PicturePart) -> None:
        """Replace the picture of its camera that waits."""
        with self._changed:
            self._pictures[picture.camera] = picture
            self._changed.notify()

    def put_event(self, event: dict[str, Any], kept: bool) -> None:
        """Add an event, and whether the ledger has it."""
        with self._changed:
            self._events.append(EventPart(self._count, event, kept))
            self._count += 1
            self._changed.notify()

    def send_to(self, link: socket.socket, setup: Setup) -> None:
        """Send everything to a new process until its link ends.

        A sign of life follows what there is already; the process serves from then on.
        """
        with self._changed:
            self._fresh |= {"site", "health"}
            self._next_event = 0
            messages, snapshot = self._taken()
        try:
            for message in (setup, *messages, *_parts(snapshot), PulsePart()):
                link.sendall(framed(message))
            for message in self._waiting():
                link.sendall(framed(message))
        except OSError:  # the process ended; whoever listens to the link sees it too
            return

    def _waiting(self) -> Iterator[ToPage]:
        while True:
            with self._changed:
                if not self._has_more():
                    self._changed.wait(PULSE_S)
                messages, snapshot = self._taken()
            yield from messages
            yield from _parts(snapshot)
            if not messages and snapshot is None:
                yield PulsePart()

    def _has_more(self) -> bool:
        return bool(self._fresh or self._pictures) or self._next_event < self._count

    def _taken(self) -> tuple[list[ToPage], _Seen | None]:
        fresh, self._fresh = self._fresh, set()
        skipped = max(self._next_event - (self._count - len(self._events)), 0)
        messages: list[ToPage] = [self._site] if "site" in fresh else []
        messages += islice(self._events, skipped, None)
        self._next_event = self._count
        if "health" in fresh and self._health is not None:
            messages.append(self._health)
        messages += self._pictures.values()
        self._pictures = {}
        return messages, self._snapshot if "snapshot" in fresh else None


def _parts(snapshot: _Seen | None) -> list[ToPage]:
    return [] if snapshot is None else [snapshot_part(*snapshot)]
