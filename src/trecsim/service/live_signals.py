"""Messages of feeds while a site runs: follow their files, and keep what came in the recording."""

import logging
import math
import os
import threading
from collections import deque
from collections.abc import Callable, Collection, Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Self

from trecsim.safety.signals import Signal, SignalSource, with_taken
from trecsim.sites.feed_files import LONGEST_LINE, line_of, name_remarks, signal_of
from trecsim.store.atomic import PRIVATE_FILE
from trecsim.store.names import SIGNALS

logger = logging.getLogger(__name__)

LOOK_S = 0.02
"""Time between two looks at the files [s]."""
MOST_WAITING = 20_000
"""Most messages of a feed that wait for the next frame set; the oldest are dropped."""
MOST_REMARKS = 100
"""Unknown names of places that are logged; a feed that floods must not fill the log."""
PlaceNames = tuple[Collection[str], Collection[str]]
"""Names of lines, and of volumes."""
_MOST_BYTES = 1_000_000  # that are read at one look
_HOUR_S = 3600.0


class Followed:
    """Messages that are appended to files while the site runs.

    A file that does not exist yet is waited for; one that became shorter is read from its start.

    Parameters
    ----------
    files
        The file of each feed, by its name.
    """

    def __init__(self, files: Mapping[str, Path]) -> None:
        self._tails: tuple[_Tail, ...] = ()
        self._closing = threading.Event()
        self._thread: threading.Thread | None = None
        self._is_open = False
        self.change(files)

    def change(self, files: Mapping[str, Path]) -> None:
        """Follow other files from now on; nothing of a file that stays is missed or comes twice.

        May be called in any thread.
        """
        before = {(tail.feed, tail.path): tail for tail in self._tails}
        self._tails = tuple(before.get(one) or _Tail(*one) for one in files.items())
        self._begin()

    def __call__(self, t_s: float) -> list[Signal]:
        """Return the messages that have come since; see `SignalSource`."""
        return [
            with_taken(signal_of(tail.feed, line, t_s), t_s)
            for tail in self._tails
            for line in tail.taken()
        ]

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
        if self._is_open and self._tails and self._thread is None:
            self._thread = threading.Thread(target=self._follow, name="feeds", daemon=True)
            self._thread.start()

    def _follow(self) -> None:
        while True:
            for tail in self._tails:
                tail.look()
            if self._closing.wait(LOOK_S):
                return


class _Tail:
    """The end of one file."""

    def __init__(self, feed: str, path: Path) -> None:
        self.feed, self.path = feed, path
        self._waiting: deque[bytes] = deque(maxlen=MOST_WAITING)
        self._rest = b""
        self._fault: str | None = None
        try:
            self._read_to = path.stat().st_size
        except OSError:
            self._read_to = 0

    def taken(self) -> list[bytes]:
        """Return the lines that have come since."""
        lines: list[bytes] = []
        while self._waiting:
            lines.append(self._waiting.popleft())
        return lines

    def look(self) -> None:
        """Read what was appended; a file that cannot be read is logged, once."""
        try:
            self._read()
            self._fault = None
        except OSError as error:
            if str(error) != self._fault:
                self._fault = str(error)
                logger.warning("feed %s: %s: %s", self.feed, self.path, error.strerror)

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
        self._waiting.extend(line[: LONGEST_LINE + 1] for line in lines if line.strip())


class KeptSignals:
    """A source of messages that also writes each of them to the recording.

    Parameters
    ----------
    source
        Where the messages come from.
    places
        Returns the names of the lines and of the volumes of the site; None to check no names.
    """

    def __init__(
        self, source: SignalSource | Followed, places: Callable[[], PlaceNames] | None = None
    ) -> None:
        self._source, self._places = source, places
        self._remarked: set[str] = set()
        self._folder: Path | None = None
        self._failed = False

    @property
    def follows_files(self) -> bool:
        """Whether the messages are those that are appended to files while the site runs."""
        return isinstance(self._source, Followed)

    def follow(self, files: Mapping[str, Path]) -> None:
        """Follow other files from now on, if it follows any; may be called in any thread."""
        if isinstance(self._source, Followed):
            self._source.change(files)

    def keep_in(self, folder: Path) -> None:
        """Keep the messages in the folder of a recording from now on."""
        self._folder = folder

    def __call__(self, t_s: float) -> Sequence[Signal]:
        """Return the messages that have come since; see `SignalSource`."""
        signals = self._source(t_s)
        self._check_names(signals)
        if signals and self._folder is not None:
            self._keep(self._folder, t_s, signals)
        return signals

    def __enter__(self) -> Self:
        if isinstance(self._source, Followed):
            self._source.__enter__()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if isinstance(self._source, Followed):
            self._source.__exit__(kind, error, trace)

    def _check_names(self, signals: Sequence[Signal]) -> None:
        """Log which places messages name that the site does not have: each once."""
        if not signals or self._places is None or len(self._remarked) >= MOST_REMARKS:
            return
        for remark in name_remarks(signals, *self._places()):
            if remark not in self._remarked:
                self._remarked.add(remark)
                logger.warning("%s", remark)

    def _keep(self, folder: Path, t_s: float, signals: Sequence[Signal]) -> None:
        path = folder / SIGNALS.format(f"{math.floor(t_s / _HOUR_S):010d}")
        try:
            handle = os.open(
                path, os.O_WRONLY | os.O_APPEND | os.O_CREAT | os.O_CLOEXEC, PRIVATE_FILE
            )
            with os.fdopen(handle, "a", encoding="utf-8") as file:
                file.writelines(f"{line_of(one)}\n" for one in signals)
            self._failed = False
        except OSError as error:
            if not self._failed:
                logger.warning(
                    "%s: messages of feeds cannot be kept: %s; the rules get them all the same",
                    path, error.strerror,
                )  # fmt: skip
            self._failed = True
