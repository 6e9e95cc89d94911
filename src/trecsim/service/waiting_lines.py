"""Messages of a feed that wait for the next frame set, not read yet."""

from collections import deque
from collections.abc import Callable, Iterable
from threading import Lock
from time import monotonic

from trecsim.sites.feed_files import LONGEST_LINE

LEAST_LINES = 1000
"""Room for messages, also of a feed that may send few a second."""
FLOOD_FACTOR = 2.0
"""Of so many times what a feed may send in a second no more is taken: it is a flood long since."""
MOST_BYTES = 4_000_000
"""Room for all messages of a feed together [bytes]."""


class WaitingLines:
    """A queue with limits, in memory and in time; what goes beyond them is dropped and counted.

    A feed that sends at most what it may loses nothing. Of one that floods, no more is taken than
    memory, the rules and the recording bear. Where the tracking hangs, the oldest are dropped. Any
    thread may put something in, and one takes it out.

    Parameters
    ----------
    most_per_s
        How many messages the feed may send in a second.
    clock
        A steady clock [s].

    Examples
    --------
    >>> waiting = WaitingLines(100.0)
    >>> waiting.put([b"one", b" ", b"two"])
    0
    >>> waiting.take(), waiting.take()
    (([b'one', b'two'], 0), ([], 0))
    """

    def __init__(self, most_per_s: float, clock: Callable[[], float] = monotonic) -> None:
        self._lock, self._clock = Lock(), clock
        self._lines: deque[bytes] = deque()
        self._bytes = self._dropped = 0
        self.limit(most_per_s)
        self._room, self._room_at_s = float(self._most), clock()

    def limit(self, most_per_s: float) -> None:
        """Take another limit from now on."""
        self._rate_per_s = FLOOD_FACTOR * most_per_s
        self._most = max(LEAST_LINES, int(self._rate_per_s))

    def put(self, lines: Iterable[bytes]) -> int:
        """Add messages, of one that is too long the beginning; return how many had no room."""
        with self._lock:
            before = self._dropped
            now_s = self._clock()
            grown = self._room + (now_s - self._room_at_s) * self._rate_per_s
            self._room, self._room_at_s = min(grown, float(self._most)), now_s
            for line in lines:
                if line.strip():
                    self._add(line[: LONGEST_LINE + 1])
            return self._dropped - before

    def _add(self, line: bytes) -> None:
        if self._room < 1.0:
            self._dropped += 1
            return
        self._room -= 1.0
        self._lines.append(line)
        self._bytes += len(line)
        while len(self._lines) > self._most or self._bytes > MOST_BYTES:
            self._bytes -= len(self._lines.popleft())
            self._dropped += 1

    def take(self) -> tuple[list[bytes], int]:
        """Return the messages since the last call, and how many were dropped meanwhile."""
        with self._lock:
            lines, dropped = list(self._lines), self._dropped
            self._lines.clear()
            self._bytes = self._dropped = 0
        return lines, dropped
