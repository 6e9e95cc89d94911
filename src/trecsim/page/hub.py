"""Viewers of the stream: each gets the newest, all events, and costs nothing when it is slow."""

import asyncio
from collections.abc import Iterator
from time import time

from trecsim.page.event_log import EventLog
from trecsim.page.messages import message

VIEWERS = 64  # at most, all together


class Viewer:
    """What one viewer has not got yet: the newest snapshot and health, and events by number.

    Parameters
    ----------
    next_event
        Number of the first event it gets.
    """

    def __init__(self, next_event: int) -> None:
        self.next_event = next_event
        self.woken = asyncio.Event()
        self._newest: dict[str, str] = {}

    def put(self, kind: str, text: str) -> None:
        """Replace what waits of this kind."""
        self._newest[kind] = text
        self.woken.set()

    def take(self) -> list[str]:
        """Return what waits, health before snapshot."""
        newest, self._newest = self._newest, {}
        return [newest[kind] for kind in ("health", "snapshot") if kind in newest]


class Hub:
    """Hands what comes to all viewers.

    Parameters
    ----------
    events
        The events so far; who appends to it calls `wake`.
    """

    def __init__(self, events: EventLog) -> None:
        self.events = events
        self.viewers: set[Viewer] = set()
        self._newest: dict[str, str] = {}

    @property
    def is_full(self) -> bool:
        """Whether there are as many viewers as are allowed."""
        return len(self.viewers) >= VIEWERS

    def join(self, last_event_id: str | None) -> Viewer:
        """Add a viewer; it first gets the newest health and snapshot.

        Parameters
        ----------
        last_event_id
            The last event it has; see `EventLog.after`.
        """
        viewer = Viewer(self.events.after(last_event_id))
        for kind, text in self._newest.items():
            viewer.put(kind, text)
        viewer.woken.set()
        self.viewers.add(viewer)
        return viewer

    def leave(self, viewer: Viewer) -> None:
        """Remove a viewer."""
        self.viewers.discard(viewer)

    def publish(self, kind: str, text: str) -> None:
        """Hand a message to all viewers in place of the one of its kind that waits."""
        self._newest[kind] = text
        for viewer in self.viewers:
            viewer.put(kind, text)

    def wake(self) -> None:
        """Tell all viewers that there are events."""
        for viewer in self.viewers:
            viewer.woken.set()

    def events_for(self, viewer: Viewer) -> Iterator[str]:
        """Yield the events a viewer has not got; each counts as sent once the next is asked for."""
        for numbered in self.events.since(viewer.next_event):
            yield message("event", time(), {"event": numbered.event})
            viewer.next_event = numbered.number + 1
