"""Feeds of a site while it runs: files that grow, messages that are posted or published."""

import logging
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from time import monotonic
from types import TracebackType
from typing import Self

from trecsim.errors import Error
from trecsim.safety.signals import Signal, with_taken
from trecsim.service.subscription import Subscription
from trecsim.service.waiting_lines import WaitingLines
from trecsim.sites.feed_brokers import broker_of
from trecsim.sites.feed_files import LONGEST_LINE, signal_of
from trecsim.sites.feed_tables import FeedTable
from trecsim.sites.site_file import Site

logger = logging.getLogger(__name__)

Subscribe = Callable[[str, FeedTable, WaitingLines], Subscription]
LOOK_S = 0.02
"""Time between two looks at the files [s]."""
ENDING_S = 1.5
"""So long all brokers together have to take leave [s]."""
_MOST_BYTES = 1_000_000  # that are read at one look


class LiveFeeds:
    """Messages that come while the site runs.

    A file that does not exist yet is waited for; one that became shorter is read from its start.

    Parameters
    ----------
    feeds
        The feeds of the site file.
    subscribe
        Subscribes to the topic of a feed by MQTT, given its name, its table, and who takes the
        messages.
    """

    def __init__(self, feeds: Mapping[str, FeedTable], subscribe: Subscribe | None = None) -> None:
        self._subscribe = subscribe
        self._feeds: dict[str, _Feed] = {}
        self._closing = threading.Event()
        self._thread: threading.Thread | None = None
        self._lock = threading.Lock()  # the site file is read again in a thread of its own
        self._is_open = False
        self.change(feeds)

    def change(self, feeds: Mapping[str, FeedTable]) -> None:
        """Take other feeds from now on; nothing of a feed that stays is missed or comes twice.

        May be called in any thread.
        """
        with self._lock:
            before = self._feeds
            self._feeds = {name: _Feed(name, one, before.get(name)) for name, one in feeds.items()}
            kept = {id(feed.subscription) for feed in self._feeds.values()}
            for feed in before.values():
                if feed.subscription is not None and id(feed.subscription) not in kept:
                    feed.subscription.close()
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
        with self._lock:
            self._is_open = True
            self._begin()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        with self._lock:  # what changes from now on is followed no more
            self._is_open = False
            self._closing.set()
        open_now = [feed.subscription for feed in self._feeds.values() if feed.subscription]
        end_s = monotonic() + ENDING_S
        for leaving in [one.close() for one in open_now]:
            leaving.join(timeout=max(end_s - monotonic(), 0.0))
        if self._thread is not None:
            self._thread.join(timeout=1.0)

    def _begin(self) -> None:
        """Look at the files in a thread, once there are any, and subscribe to topics."""
        if self._is_open and self._subscribe is not None:
            for feed in self._feeds.values():
                if feed.table.mqtt is not None and feed.subscription is None:
                    feed.subscription = _subscribed(self._subscribe, feed)
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


def subscription_of(site: Site, name: str, table: FeedTable, waiting: WaitingLines) -> Subscription:
    """Return the subscription of a feed by MQTT; see `LiveFeeds`.

    Raises
    ------
    ConfigError
        When its broker is not known, or its credentials cannot be found.
    SetupError
        When the package that speaks MQTT is not installed.
    OSError
        When the certificates cannot be read.
    """
    broker = broker_of(table, site.outputs)
    return Subscription(
        name, table.mqtt or "", broker, broker.login(site.secrets), waiting,
        client_id=f"trecsim-{site.name}-feed-{name}",
    )  # fmt: skip


def _subscribed(subscribe: Subscribe, feed: "_Feed") -> Subscription | None:
    """Return a new subscription; None, and a line in the log, where it cannot be made."""
    try:
        return subscribe(feed.name, feed.table, feed.waiting)
    except (Error, OSError) as error:
        logger.warning("feed %s: %s; none of its messages comes", feed.name, error)
        return None


class _Feed:
    """One feed: what waits, and its file or subscription.

    Parameters
    ----------
    name
        Its name.
    table
        What the site file says.
    before
        The feed of this name as it was: what waits stays, and so does a file or a topic that is
        the same.
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
        same = before is not None and _topic_of(before.table) == _topic_of(table)
        self.subscription: Subscription | None = before.subscription if before and same else None

    def taken(self, known_s: float) -> Iterator[Signal]:
        """Yield the messages that have come since."""
        lines, dropped = self.waiting.take()
        if dropped:
            note = f"{dropped} messages were dropped: too many came at once"
            yield Signal(self.name, known_s, "unreadable", note=note)
        for line in lines:
            yield signal_of(self.name, line, known_s)


def _topic_of(table: FeedTable) -> tuple[object, ...]:
    return table.mqtt, table.broker, table.credentials, table.ca


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
