"""The events of this run, in memory, in order."""

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

EVENTS_KEPT = 2_000  # about 5 kB each


@dataclass(frozen=True, slots=True)
class NumberedEvent:
    """An event with its running number in this process."""

    number: int
    event: Mapping[str, Any]


class EventLog:
    """Keeps the newest events and finds those after a given one."""

    def __init__(self) -> None:
        self._events: deque[NumberedEvent] = deque(maxlen=EVENTS_KEPT)
        self._number_of: dict[str, int] = {}

    @property
    def next_number(self) -> int:
        """The number the next event gets."""
        return self._events[-1].number + 1 if self._events else 0

    def append(self, event: Mapping[str, Any]) -> bool:
        """Add an event; return False for one that is there already."""
        identity = str(event.get("id", ""))
        if identity in self._number_of:
            return False
        number = self.next_number
        if len(self._events) == EVENTS_KEPT:
            self._number_of.pop(str(self._events[0].event.get("id", "")), None)
        self._events.append(NumberedEvent(number, event))
        self._number_of[identity] = number
        return True

    def knows(self, event_id: str) -> bool:
        """Tell whether an event is kept here."""
        return event_id in self._number_of

    def after(self, event_id: str | None) -> int:
        """Return the number of the first event after one that a viewer has.

        Parameters
        ----------
        event_id
            The last one the viewer has; None for one that wants new events only. One that is not
            known (any more) means that the viewer gets all events that are kept.
        """
        if event_id is None:
            return self.next_number
        known = self._number_of.get(event_id)
        return known + 1 if known is not None else 0

    def since(self, number: int) -> list[NumberedEvent]:
        """Return the events from a number on."""
        if not self._events or number > self._events[-1].number:
            return []
        first = max(number - self._events[0].number, 0)
        return [self._events[index] for index in range(first, len(self._events))]
