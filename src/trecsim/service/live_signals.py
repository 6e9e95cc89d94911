"""Messages of feeds while a site runs: what came is kept in the recording."""

import logging
import math
import os
from collections.abc import Callable, Collection, Sequence
from pathlib import Path
from typing import BinaryIO

from trecsim.safety.signals import Signal, SignalSource
from trecsim.sites.feed_files import LONGEST_LINE, line_of
from trecsim.sites.feed_remarks import name_remarks
from trecsim.store.atomic import PRIVATE_FILE
from trecsim.store.names import SIGNALS, SIGNALS_S

logger = logging.getLogger(__name__)

MOST_REMARKS = 100
"""Unknown names of places that are logged; a feed that floods must not fill the log."""
PlaceNames = tuple[Collection[str], Collection[str]]
"""Names of lines, and of volumes."""
_LAST_BYTES = 4 * LONGEST_LINE  # of a file; a line of it is a message, with its feed and a time


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
        self, source: SignalSource, places: Callable[[], PlaceNames] | None = None
    ) -> None:
        self._source, self._places = source, places
        self._remarked: set[str] = set()
        self._folder: Path | None = None
        self._failed = False

    def keep_in(self, folder: Path, begins_s: float | None = None) -> None:
        """Keep the messages in the folder of a recording from now on.

        Parameters
        ----------
        folder
            The folder.
        begins_s
            The Unix time, for a site with feeds: the recording then tells that there were any, also
            where no message comes, and that those of their files are none of it [s].
        """
        self._folder = folder
        if begins_s is not None:
            self._keep(folder, begins_s, ())

    def __call__(self, t_s: float) -> Sequence[Signal]:
        """Return the messages that have come since; see `SignalSource`."""
        signals = self._source(t_s)
        self._check_names(signals)
        if signals and self._folder is not None:
            self._keep(self._folder, t_s, signals)
        return signals

    def _check_names(self, signals: Sequence[Signal]) -> None:
        """Log which places messages name that the site does not have: each once."""
        if not signals or self._places is None or len(self._remarked) >= MOST_REMARKS:
            return
        for remark in name_remarks(signals, *self._places()):
            if remark not in self._remarked:
                self._remarked.add(remark)
                logger.warning("%s", remark)

    def _keep(self, folder: Path, t_s: float, signals: Sequence[Signal]) -> None:
        path = folder / SIGNALS.format(f"{math.floor(t_s / SIGNALS_S):010d}")
        try:
            handle = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, PRIVATE_FILE)
            with os.fdopen(handle, "rb+") as file:
                file.seek(_whole_bytes(file))
                file.truncate()  # what a crash or a full disk has left of a line
                file.writelines(f"{line_of(one)}\n".encode() for one in signals)
            self._failed = False
        except OSError as error:
            if not self._failed:
                logger.warning(
                    "%s: messages of feeds cannot be kept: %s; the rules get them all the same",
                    path, error.strerror,
                )  # fmt: skip
            self._failed = True


def _whole_bytes(file: BinaryIO) -> int:
    """Return up to where a file has whole lines [bytes]."""
    size = file.seek(0, os.SEEK_END)
    start = max(size - _LAST_BYTES, 0)
    file.seek(start)
    last = file.read()
    return size if last.endswith(b"\n") else start + last.rfind(b"\n") + 1
