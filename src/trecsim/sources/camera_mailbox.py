"""Live sources side by side: each in a thread of its own, none waits for another.

::

    source ── thread ──┐
    source ── thread ──┼── Mailbox (the newest items of each camera) ──> whoever takes them
    source ── thread ──┘
"""

import time
from collections import Counter, deque
from collections.abc import Callable, Iterator, Sequence
from threading import Condition, Thread
from typing import Generic

from trecsim.errors import Error
from trecsim.sources.base import Arrival, Item, Source

TICK_S = 0.05
Fault = Callable[[Exception], None]


class Mailbox(Generic[Item]):
    """Keeps the newest items of each camera until they are taken; the oldest goes first.

    Nothing waits without bound: where `depth` items of a camera wait already, the oldest of them is
    dropped and counted.

    Parameters
    ----------
    depth
        How many items of a camera may wait.

    Attributes
    ----------
    dropped
        Number of items that were dropped, by camera.
    closed
        Whether nobody takes items any more.
    """

    def __init__(self, depth: int = 2) -> None:
        self.dropped: Counter[str] = Counter()
        self.closed = False
        self._depth = depth
        self._waiting: dict[str, deque[tuple[int, Item]]] = {}
        self._number = 0
        self._senders = 0
        self._changed = Condition()

    def begin(self) -> None:
        """Count one more sender."""
        with self._changed:
            self._senders += 1

    def end(self) -> None:
        """Count one sender less; after the last, `arrivals` ends."""
        with self._changed:
            self._senders -= 1
            self._changed.notify_all()

    def close(self) -> None:
        """Tell senders that nobody takes items any more."""
        with self._changed:
            self.closed = True
            self._waiting.clear()

    def put(self, item: Item) -> None:
        """Add an item; never waits."""
        with self._changed:
            if self.closed:
                return
            queue = self._waiting.setdefault(item.camera, deque())
            if len(queue) >= self._depth:
                queue.popleft()
                self.dropped[item.camera] += 1
            self._number += 1
            queue.append((self._number, item))
            self._changed.notify()

    def take(self, timeout_s: float) -> Item | None:
        """Return the item that waits longest; None where none came within `timeout_s`."""
        with self._changed:
            self._changed.wait_for(lambda: bool(self._next()) or not self._senders, timeout_s)
            queue = self._next()
            return queue.popleft()[1] if queue else None

    @property
    def is_over(self) -> bool:
        """Whether all senders have ended and everything was taken, or it was closed."""
        with self._changed:
            return self.closed or (not self._senders and not self._next())

    def arrivals(
        self, tick_s: float = TICK_S, clock: Callable[[], float] = time.monotonic
    ) -> Iterator[Arrival[Item]]:
        """Yield items as they come; when none has come for a tick, an arrival without an item.

        Parameters
        ----------
        tick_s
            How long to wait for an item [s].
        clock
            A steady clock [s].
        """
        try:
            while not self.is_over:
                yield Arrival(self.take(tick_s), clock())
        finally:
            self.close()

    def _next(self) -> deque[tuple[int, Item]] | None:
        waiting = (queue for queue in self._waiting.values() if queue)
        return min(waiting, key=lambda queue: queue[0][0], default=None)


def as_fault(error: BaseException) -> Exception:
    """Return an error as the fault of a camera that is told.

    A thread that raises SystemExit or KeyboardInterrupt ends without a word, so these are told as
    an `Error` that names them.

    Examples
    --------
    >>> as_fault(SystemExit(3))
    Error('ended with SystemExit: 3')
    """
    if isinstance(error, Exception):
        return error
    fault = Error(f"ended with {type(error).__name__}: {error}".removesuffix(": "))
    fault.__cause__ = error
    return fault


def deliver(sources: Sequence[Source[Item]], box: Mailbox[Item], fault: Fault) -> None:
    """Let each source deliver into `box`, in a thread of its own, until it ends.

    Parameters
    ----------
    sources
        Live sources.
    box
        Where their items wait; once it is closed, each source ends with its next item.
    fault
        Is told, in the source's thread, what ended a source before its time; the others go on.
    """

    def run(source: Source[Item]) -> None:
        try:
            for item in source:
                if box.closed:
                    return
                box.put(item)
        except BaseException as error:  # the boundary of a source: whatever it is, it is told
            fault(as_fault(error))
        finally:
            box.end()

    for number, source in enumerate(sources):
        box.begin()
        # Not waited for at the end: a camera may stall for ever.
        Thread(target=run, args=(source,), name=f"source-{number}", daemon=True).start()
