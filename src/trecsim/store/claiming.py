"""A folder belongs to one program at a time."""

import logging
import os
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Self

from trecsim.errors import InputError
from trecsim.store.atomic import PRIVATE_FILE, PRIVATE_FOLDER, disk_faults
from trecsim.store.growing import is_file_at, lock

logger = logging.getLogger(__name__)

LOCK = ".lock"


class FolderClaim:
    """Keeps other programs from writing into a folder until the block ends.

    The file ``.lock`` in the folder is locked by the operating system and holds the number of the
    process. The lock ends with the process, however that ends; a file that is left behind does not
    matter. A folder that is missing is made, for its owner alone; one that is empty at the end is
    removed.

    Parameters
    ----------
    folder
        The folder.
    what
        How messages call the other program, as in "run".

    Raises
    ------
    InputError
        When another program holds the folder, or it cannot be made.
    SetupError
        When the disk has no room.

    Examples
    --------
    >>> folder = getfixture("tmp_path") / "recording"
    >>> with FolderClaim(folder):
    ...     FolderClaim(folder)
    Traceback (most recent call last):
    ...
    trecsim.errors.InputError: .../recording is in use: the run with process number ... writes ...
    >>> folder.exists()
    False
    """

    def __init__(self, folder: Path, what: str = "run") -> None:
        self.folder = folder
        self._lock = folder / LOCK
        self._released = False
        if folder.exists() and not folder.is_dir():
            raise InputError(f"cannot write into {folder}: expected a folder, found a file")
        with disk_faults(folder):
            while True:
                folder.mkdir(mode=PRIVATE_FOLDER, parents=True, exist_ok=True)
                self._handle = os.open(
                    self._lock, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, PRIVATE_FILE
                )
                if not lock(self._handle):
                    self._refuse(what)
                if is_file_at(self._handle, self._lock):
                    break
                os.close(self._handle)  # the other program has just ended and removed it
            os.ftruncate(self._handle, 0)
            os.write(self._handle, f"{os.getpid()}\n".encode())

    def _refuse(self, what: str) -> None:
        number = os.read(self._handle, 20).decode("ascii", errors="replace").strip()
        os.close(self._handle)
        raise InputError(
            f"{self.folder} is in use: the {what} with process number {number or 'unknown'} writes "
            "into it; wait for its end or give another place"
        )

    @property
    def content(self) -> list[Path]:
        """What is in the folder beside the lock."""
        with disk_faults(self.folder):
            return sorted(path for path in self.folder.iterdir() if path.name != LOCK)

    def release(self) -> None:
        """Let others write into the folder; remove it if it is empty."""
        if self._released:
            return
        self._released = True
        self._lock.unlink(missing_ok=True)
        os.close(self._handle)
        with suppress(OSError):  # there is something in it, and that is kept
            self.folder.rmdir()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.release()
