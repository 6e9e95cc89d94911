"""Events as JSON Lines in a file."""

import json
import os
from pathlib import Path

from trecsim.cloud_events import event_text
from trecsim.outputs.base import Event, UndeliveredError
from trecsim.store.atomic import PRIVATE_FILE

_TAIL_BYTES = 1 << 16  # holds what one kill can leave unconfirmed: it is a single line


class JsonLines:
    """Appends events to a file, one a line; an event that is its last line is not added again.

    The file may be moved away at any time, as programs that rotate logs do.

    Parameters
    ----------
    path
        The file; made if it is missing.
    """

    def __init__(self, path: Path) -> None:
        self._path = path

    def deliver(self, event: Event, /) -> None:
        """Append an event; see `Output`."""
        try:
            self._append(event)
        except OSError as error:
            raise UndeliveredError(f"cannot write {self._path}: {error.strerror}") from None

    def _append(self, event: Event) -> None:
        flags = os.O_RDWR | os.O_CREAT | os.O_CLOEXEC
        with os.fdopen(os.open(self._path, flags, PRIVATE_FILE), "r+b") as file:
            end = file.seek(0, os.SEEK_END)
            file.seek(max(0, end - _TAIL_BYTES))
            whole, newline, torn = file.read().rpartition(b"\n")
            if torn:  # the end of a line that a kill or a full disk has cut
                file.truncate(end - len(torn))
            if newline and _id_of(whole.rpartition(b"\n")[2]) == event["id"]:
                return
            file.seek(0, os.SEEK_END)
            file.write(f"{event_text(event)}\n".encode())


def _id_of(line: bytes) -> str | None:
    try:
        read = json.loads(line)
    except ValueError:
        return None
    return read.get("id") if isinstance(read, dict) else None
