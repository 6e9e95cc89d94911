"""Keeps the events of a site: first in its ledger, then with those who show them."""

import logging
import time
from collections import deque
from collections.abc import Callable, Iterable, Mapping
from threading import Condition, Thread
from typing import Any, Protocol, Self

from trecsim.cloud_events import numbered
from trecsim.errors import Error, InputError
from trecsim.store.ledger_reading import LedgerEvent

logger = logging.getLogger(__name__)

RETRY_S = 5.0  # so often it is tried again to write what could not be written
MOST_LATE = 2_000  # events that wait for the ledger, about 1 kB each

Event = Mapping[str, Any]


class EventLedger(Protocol):
    """What keeps events; see `trecsim.store.ledger.Ledger`."""

    @property
    def fault(self) -> str | None:
        """Why it cannot keep any; None where that is not known before it is tried."""
        ...

    def append_event(self, event: Event) -> int:
        """Keep an event as it is, once."""
        ...

    def append_next(self, event: Event) -> LedgerEvent:
        """Keep the next event of an episode, and return it with its number."""
        ...


class EventKeeper:
    """Writes each event into the ledger and tells it on, in a thread of its own.

    `put` never waits. An event that cannot be written, as on a full disk, is told at once all the
    same, and written later; until then `fault` says why.

    Parameters
    ----------
    ledger
        Where events are kept. Nobody else writes those that are put here.
    tell
        Is given each event and whether the ledger has it, in order.
    open_events
        Newest event of each episode that the ledger has and that goes on.
    retry_s
        How often it is tried again to write [s].
    """

    def __init__(
        self,
        ledger: EventLedger,
        tell: Callable[[Event, bool], None],
        open_events: Iterable[Event] = (),
        *,
        retry_s: float = RETRY_S,
    ) -> None:
        self._ledger, self._tell, self._retry_s = ledger, tell, retry_s
        self._changed = Condition()
        self._new: deque[Event] = deque()
        self._late: deque[Event] = deque()
        self._seq = {one["data"]["event"]: int(one["data"]["seq"]) for one in open_events}
        self._ending = False
        self._fault: str | None = None
        self._thread = Thread(target=self._run, name="events", daemon=True)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *ending: object) -> None:
        with self._changed:
            self._ending = True
            self._changed.notify()
        self._thread.join()
        if self._late:
            logger.error("%d events could not be kept: %s", len(self._late), self._fault)

    @property
    def fault(self) -> str | None:
        """Why events are not kept, or would not be; None where they are."""
        return self._fault or self._ledger.fault

    def put(self, event: Event) -> None:
        """Take the next event of an episode, without `id` and `seq`."""
        with self._changed:
            self._new.append(event)
            self._changed.notify()

    def acted(self, event: Event) -> None:
        """Take note of what a person did to an episode; the page has kept it."""
        data = event["data"]
        with self._changed:
            if data["event"] in self._seq:
                self._seq[data["event"]] = max(self._seq[data["event"]], int(data["seq"]))

    def _run(self) -> None:
        tried_s = time.monotonic()
        while True:
            with self._changed:
                if not self._new and not self._ending:
                    self._changed.wait(self._retry_s if self._late else None)
                new, ending = list(self._new), self._ending
                self._new.clear()
            if self._late and (ending or time.monotonic() - tried_s >= self._retry_s):
                tried_s = time.monotonic()
                self._write_late()
            for event in new:
                self._keep(event)
            if ending and not self._new:
                return

    def _keep(self, event: Event) -> None:
        """Write an event if that is possible now, and tell it in any case."""
        if self._late:
            self._put_off(event)
            return
        try:
            kept = self._ledger.append_next(event).event
        except InputError:
            logger.exception("an event cannot be kept: a fault of the program")
            return
        except Exception as error:  # the boundary: whatever fails, viewers get the event
            self._failed(error)
            self._put_off(event)
            return
        self._count(kept)
        self._tell(kept, True)

    def _put_off(self, event: Event) -> None:
        """Tell an event that is written later."""
        with self._changed:
            made = numbered(event, 1 + self._seq.get(event["data"]["event"], -1))
        if len(self._late) == MOST_LATE:
            logger.error("an event is not kept: more than %d wait for the ledger", MOST_LATE)
            self._late.popleft()
        self._late.append(made)
        self._count(made)
        self._tell(made, False)

    def _write_late(self) -> None:
        try:
            while self._late:
                self._ledger.append_event(self._late[0])
                self._late.popleft()
        except Exception as error:  # the boundary: it is tried again
            self._failed(error)
            return
        self._fault = None
        logger.warning("all events are kept again")

    def _failed(self, error: Exception) -> None:
        if self._fault is None:
            logger.error(
                "events cannot be kept: %s; they are shown, and it is tried again", error,
                exc_info=not isinstance(error, Error),
            )  # fmt: skip
        self._fault = str(error) or type(error).__name__

    def _count(self, event: Event) -> None:
        data = event["data"]
        with self._changed:
            self._seq[data["event"]] = int(data["seq"])
            if data.get("t_end_s") is not None:
                del self._seq[data["event"]]
