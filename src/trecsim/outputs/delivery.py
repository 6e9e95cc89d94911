"""Delivers the events of a ledger to one output, in a thread of its own.

What is not delivered yet is what stands in the ledger after the output's cursor, which the ledger
keeps, too. So nothing is lost when the receiver is away or this process is killed: an event counts
as delivered only once its receiver has taken it. At worst it is sent again, with the same `id`.
"""

import logging
import threading
import time
import traceback
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Protocol, Self

from trecsim.errors import Error
from trecsim.health import OutputHealth
from trecsim.outputs.base import Event, Output
from trecsim.store.ledger_reading import LedgerEvent

logger = logging.getLogger(__name__)

LOOK_S = 0.5
"""So often the ledger is asked for new events, if nobody tells of one [s]."""
FIRST_RETRY_S, LONGEST_RETRY_S = 1.0, 60.0
"""An event that was not taken is tried again after so long, each time after twice as long [s]."""
ENDING_S = 3.0
"""When the site ends, an output has so long to deliver what is left [s]."""
_MOST_AT_ONCE = 100


class Deliveries(Protocol):
    """The part of a ledger that an output needs; see `trecsim.store.ledger.Ledger`."""

    def events(self, after: int = 0, *, limit: int = 1000) -> list[LedgerEvent]:
        """Return events in the order in which they were kept."""
        ...

    def cursor(self, output: str) -> int:
        """Return the number of the last event that an output is done with."""
        ...

    def advance(self, output: str, number: int) -> None:
        """Note that an output is done with all events up to a number."""
        ...

    def waiting(self, output: str) -> int:
        """Return how many events an output is not done with."""
        ...


class Delivery:
    """Delivers events to one output, one after the other, until each was taken.

    Parameters
    ----------
    name, kind
        Of the output.
    make
        Makes the output; called in the thread of the delivery.
    ledger
        Where events and cursors are kept.
    wanted
        Tells which events the output gets.
    clock
        A steady clock [s].
    first_retry_s
        See `FIRST_RETRY_S`.
    """

    def __init__(
        self,
        name: str,
        kind: str,
        make: Callable[[], Output],
        ledger: Deliveries,
        wanted: Callable[[Event], bool] = lambda event: True,
        *,
        clock: Callable[[], float] = time.monotonic,
        first_retry_s: float = FIRST_RETRY_S,
    ) -> None:
        self.name, self.kind = name, kind
        self._make, self._ledger, self._wanted = make, ledger, wanted
        self._clock, self._first_retry_s = clock, first_retry_s
        self._changed = threading.Event()
        self._ending = threading.Event()
        self._fault: str | None = None
        self._since_s: float | None = None
        self._delivered = 0
        self._output: Output | None = None
        self._thread = threading.Thread(target=self._run, name=f"output-{name}", daemon=True)

    def __enter__(self) -> Self:
        self._ledger.cursor(self.name)  # from now on, should this output be new
        self._thread.start()
        return self

    def __exit__(self, *ending: object) -> None:
        self._ending.set()
        self._changed.set()
        self._thread.join(ENDING_S)

    def look(self) -> None:
        """Look for new events now; never waits."""
        self._changed.set()

    def health(self) -> OutputHealth:
        """Return how well the output works."""
        since_s = self._since_s
        return OutputHealth(
            kind=self.kind,
            queue=self._ledger.waiting(self.name),
            waiting_s=None if since_s is None else max(0.0, self._clock() - since_s),
            delivered=self._delivered,
            fault=self._fault,
        )

    def _run(self) -> None:
        wait_s = self._first_retry_s
        while True:
            self._changed.clear()
            try:
                done = self._deliver_what_is_there()
            except Exception as error:  # the boundary: whatever fails, it is tried again
                self._failed(error)
                done = False
            if self._ending.is_set():
                break
            if done:
                wait_s = self._first_retry_s
                self._changed.wait(LOOK_S)
            else:
                self._ending.wait(wait_s)
                wait_s = min(2.0 * wait_s, LONGEST_RETRY_S)
        close = getattr(self._output, "close", None)
        if close is not None:
            with suppress(Exception):
                close()

    def _deliver_what_is_there(self) -> bool:
        """Deliver all events after the cursor; return False once one was not taken."""
        if self._output is None:
            self._output = self._make()
        while found := self._ledger.events(self._ledger.cursor(self.name), limit=_MOST_AT_ONCE):
            for one in found:
                if self._wanted(one.event):
                    self._since_s = self._since_s if self._since_s is not None else self._clock()
                    self._output.deliver(one.event)
                    self._delivered += 1
                self._ledger.advance(self.name, one.number)
                self._worked()
        return True

    def _worked(self) -> None:
        if self._fault is not None:
            logger.warning("output %s delivers again", self.name)
        self._fault = self._since_s = None

    def _failed(self, error: Exception) -> None:
        text = str(error) if isinstance(error, Error) else _unexpected(error)
        if self._fault is None:
            logger.warning("output %s: %s; its events are kept and tried again", self.name, text)
        if self._since_s is None:
            self._since_s = self._clock()
        self._fault = text


def _unexpected(error: Exception) -> str:
    """Say what went wrong and where, without the text of the error, which may hold a secret."""
    where = traceback.extract_tb(error.__traceback__)[-1]
    return f"{type(error).__name__} at {Path(where.filename).name}:{where.lineno}"
