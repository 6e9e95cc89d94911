"""Feeds of a site while it runs: files that grow, and messages that are posted to the page."""

import logging
import threading
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Self

from trecsim.safety.signals import Signal, with_taken
from trecsim.service.waiting_lines import WaitingLines
from trecsim.sites.feed_files import LONGEST_LINE, signal_of
from trecsim.sites.feed_tables import FeedTable

logger = logging.getLogger(__name__)

LOOK_S = 0.02
"""Time between two looks at the files [s]."""
_MOST_BYTES = 1_000_000  # that are read at one look


class LiveFeeds:
    """Messages that come while the site runs.

    A file that does not exist yet is waited for; one that became shorter is read from its start.

    Parameters
    ----------
    feeds
        The feeds of the site file.
    """

    def __init__(self, feeds: Mapping[str, FeedTable]) -> None:
        self._feeds: dict[str, _Feed] = {}
        self._closing = threading.Event()
        self._thread: threading.Thread | None = None
        self._is_open = False
        self.change(feeds)

    def change(self, feeds: Mapping[str, FeedTable]) -> None:
        """Take other feeds from now on; nothing of a feed that stays is missed or comes twice.

        May be called in any thread.
        """
        before = self._feeds
        self._feeds = {name: _Feed(name, one, before.get(name)) for name, one in feeds.items()}
        self._begin()

    def put(self, feed: str, lines: Sequence[bytes]) -> None:
        """Take messages that were posted to the page; of other feeds they are dropped.

        May be called in any thread.
        """
        one = self._feeds.get(feed)
        if one is not None and one.table.http:
            one.waiting.put(lines)

    def __call__(self, t_s: float) -> list[Signal]:
        """Return the messages that have come since; see `SignalSource`."""
        return [with_taken(one, t_s) for feed in self._feeds.values() for one in feed.taken(t_s)]

    def __enter__(self) -> Self:
        self._is_open = True
        self._begin()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._closing.set()
        if self._thread is not None:
            self._thread.join(timeout=1.0)

    def _begin(self) -> None:
        """Look at the files in a thread, once there are any."""
        has_files = any(feed.tail is not None for feed in self._feeds.values())
        if self._is_open and has_files and self._thread is None:
            self._thread = threading.Thread(target=self._follow, name="feeds", daemon=True)
            self._thread.start()

    def _follow(self) -> None:
        while True:
            for feed in self._feeds.values():
                if feed.tail is not None:
                    feed.tail.look()
            if self._closing.wait(LOOK_S):
                return


class _Feed:
    """One feed: what waits, and the file from which it comes, if it comes from one.

    Parameters
    ----------
    name
        Its name.
    table
        What the site file says.
    before
        The feed of this name as it was: what waits stays, and so does a file that is the same.
    """

    def __init__(self, name: str, table: FeedTable, before: "_Feed | None") -> None:
        self.name, self.table = name, table
        self.waiting: WaitingLines = before.waiting if before else WaitingLines(table.most_per_s)
        self.waiting.limit(table.most_per_s)
        self.tail: _Tail | None = before.tail if before else None
        if table.file is None:
            self.tail = None
        elif self.tail is None or self.tail.path != table.file:
            self.tail = _Tail(name, table.file, self.waiting)

    def taken(self, known_s: float) -> Iterator[Signal]:
        """Yield the messages that have come since."""
        lines, dropped = self.waiting.take()
        if dropped:
            note = f"{dropped} messages were dropped: too many came at once"
            yield Signal(self.name, known_s, "unreadable", note=note)
        for line in lines:
            yield signal_of(self.name, line, known_s)


class _Tail:
    """The end of one file."""

    def __init__(self, feed: str, path: Path, waiting: WaitingLines) -> None:
        self.path = path
        self._feed, self._waiting = feed, waiting
        self._rest = b""
        self._fault: str | None = None
        try:
            self._read_to = path.stat().st_size
        except OSError:
            self._read_to = 0

    def look(self) -> None:
        """Read what was appended; a file that cannot be read is logged, once."""
        try:
            self._read()
            self._fault = None
        except OSError as error:
            if str(error) != self._fault:
                self._fault = str(error)
                logger.warning("feed %s: %s: %s", self._feed, self.path, error.strerror)

    def _read(self) -> None:
        size = self.path.stat().st_size
        if size < self._read_to:
            self._read_to, self._rest = 0, b""
        if size == self._read_to:
            return
        with self.path.open("rb") as file:
            file.seek(self._read_to)
            new = file.read(_MOST_BYTES)
        self._read_to += len(new)
        *lines, rest = (self._rest + new).split(b"\n")
        self._rest = rest[: LONGEST_LINE + 1]  # longer ones are unreadable in any case
        self._waiting.put(lines)
