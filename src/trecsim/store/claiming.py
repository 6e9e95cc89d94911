"""Exclusive use of a folder by one program."""

import logging
import os
from contextlib import suppress
from pathlib import Path
from typing import Self

from trecsim.errors import InputError
from trecsim.store.atomic import PRIVATE_FILE, PRIVATE_FOLDER, disk_faults
from trecsim.store.growing import is_file_at, lock

logger = logging.getLogger(__name__)

LOCK = ".lock"


class FolderClaim:
    """Reserves a folder for this program until the block ends.

    The operating system locks the file ``.lock`` in the folder, which holds the process number. The
    lock ends with the process, so a file that a crash left behind has no effect. A missing folder
    is created with access for its owner only; a folder that is empty at the end is removed.

    Parameters
    ----------
    folder
        The folder.
    what
        What error messages call the other program, for example "run".
    name
        Name of the file that is locked.

    Raises
    ------
    InputError
        When another program uses the folder, or it cannot be created.
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

    def __init__(self, folder: Path, what: str = "run", *, name: str = LOCK) -> None:
        self.folder = folder
        self._lock = folder / name
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
                os.close(self._handle)  # its last user has just removed it
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
        """The entries of the folder without the lock."""
        with disk_faults(self.folder):
            return sorted(path for path in self.folder.iterdir() if path.name != LOCK)

    def release(self) -> None:
        """End the reservation; remove the folder if it is empty."""
        if self._released:
            return
        self._released = True
        self._lock.unlink(missing_ok=True)
        os.close(self._handle)
        with suppress(OSError):  # it is not empty
            self.folder.rmdir()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *ending: object) -> None:
        self.release()


def is_claimed(folder: Path) -> bool:
    """Return whether a program has reserved a folder."""
    try:
        handle = os.open(folder / LOCK, os.O_RDWR | os.O_CLOEXEC)
    except OSError:
        return False
    try:
        return not lock(handle)
    finally:
        os.close(handle)
