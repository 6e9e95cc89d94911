"""Files that grow while a program runs and are readable at every moment."""

import errno
import logging
import os
import time
from abc import ABC, abstractmethod
from collections.abc import Callable
from pathlib import Path
from typing import IO, Self

from trecsim.errors import InputError
from trecsim.store.atomic import PRIVATE_FILE, disk_faults, partial_path, sync_directory

try:
    import fcntl
except ImportError:  # not on Windows: there, files are not locked
    _HAS_LOCKS = False
else:
    _HAS_LOCKS = True

logger = logging.getLogger(__name__)

FLUSH_EVERY_S = 2.0


class KeepsPartial(ABC):
    """Something that is closed when its block ends well, and else left under a partial name."""

    @abstractmethod
    def close(self) -> None:
        """Complete it: it takes its final name."""

    @abstractmethod
    def abandon(self) -> None:
        """End early: keep the content under the name of what is not complete."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, *ending: object) -> None:
        if kind is None:
            self.close()
        else:
            self.abandon()


class GrowingFile(KeepsPartial):
    r"""A file that is written under ``NAME.partial`` and takes its name when it is complete.

    The content is flushed to the operating system at least every `flush_s`, so a killed program
    loses no more than that; the partial file then keeps its name. Two programs cannot write the
    same file at the same time. Links are followed; devices and pipes are written to directly.

    Parameters
    ----------
    path
        The file to write. An older file of this name stays until the new one is complete.
    heading
        The first line. A file that holds nothing else is removed after an error.
    flush_s
        Longest time between two flushes [s]; 0 flushes after every write.
    clock
        Returns the time [s].
    resume
        Continue ``NAME.partial`` of an earlier program; an incomplete last line is removed.

    Raises
    ------
    InputError
        When `path` cannot be written to, or another program is writing it.
    SetupError
        When the disk has no room or does not work.

    Examples
    --------
    >>> folder = getfixture("tmp_path")
    >>> with GrowingFile(folder / "list.csv", b"t_s\n", flush_s=0.0) as file:
    ...     file.write(b"1.5\n")
    ...     (folder / "list.csv.partial").read_bytes()
    b't_s\n1.5\n'
    >>> (folder / "list.csv").read_bytes()
    b't_s\n1.5\n'
    """

    def __init__(
        self,
        path: Path,
        heading: bytes,
        *,
        flush_s: float = FLUSH_EVERY_S,
        clock: Callable[[], float] = time.monotonic,
        resume: bool = False,
    ) -> None:
        self._path = path
        self._heading = heading
        self._flush_s = flush_s
        self._clock = clock
        with disk_faults(path):
            self._target = path.resolve()
            if self._target.is_dir():
                raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
            direct = self._target.exists() and not self._target.is_file()
            self._partial = None if direct else partial_path(self._target)
            self._file = self._target.open("wb") if direct else _locked(path, self._target)
        try:
            self._begin(resume)
        except BaseException:
            self.abandon()
            raise

    def _begin(self, resume: bool) -> None:
        self._empty = True
        if self._partial is not None:
            kept = length_of_whole_lines(self._file) if resume else 0
            self._empty = kept <= len(self._heading)
            self._file.truncate(0 if self._empty else kept)
            self._file.seek(0, os.SEEK_END)
        with disk_faults(self._path):
            if self._empty:
                self._file.write(self._heading)
            self._flush()

    @property
    def empty(self) -> bool:
        """Whether the file holds nothing but its heading."""
        return self._empty

    @property
    def closed(self) -> bool:
        """Whether it was completed or abandoned."""
        return self._file.closed

    @property
    def due(self) -> bool:
        """Whether the next write will flush."""
        return self._clock() - self._flushed_s >= self._flush_s

    def write(self, content: bytes) -> None:
        """Append whole lines."""
        with disk_faults(self._path, running=True):
            self._file.write(content)
            self._empty = self._empty and not content
            if self.due:
                self._flush()

    def _flush(self) -> None:
        self._flushed_s = self._clock()
        self._file.flush()
        if self._partial is not None and not self._partial.exists():
            raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT))

    def close(self, name: Path | None = None) -> None:
        """Complete the file: rename it to its final name, or to `name` on the same disk."""
        if self._file.closed:
            return
        target = self._target if name is None else name
        try:
            with disk_faults(self._path, running=True):
                if self._partial is None:
                    self._file.close()
                    return
                self._file.flush()
                os.fsync(self._file.fileno())
                if not _HAS_LOCKS:  # Windows renames no open file
                    self._file.close()
                self._partial.replace(target)  # still locked
                self._file.close()
                sync_directory(target.parent)
        except BaseException:
            self.abandon()
            raise

    def abandon(self) -> None:
        """End early: keep the content in ``NAME.partial``."""
        if self._file.closed:
            return
        try:
            self._file.flush()
        except (OSError, ValueError) as error:  # earlier content is safe
            logger.debug("%s: %s", self._path, error)
        if self._partial is not None and self._empty:
            self._partial.unlink(missing_ok=True)
        try:
            self._file.close()
        except OSError as error:
            logger.debug("%s: %s", self._path, error)


def _locked(path: Path, target: Path) -> IO[bytes]:
    """Open the partial file of `target` for this program alone, without changing it."""
    partial = partial_path(target)
    while True:
        handle = os.open(partial, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, PRIVATE_FILE)
        file = os.fdopen(handle, "r+b")
        if not lock(handle):
            file.close()
            raise InputError(
                f"cannot write {path}: another program is writing it; wait for its end or give "
                "another name"
            )
        if is_file_at(handle, partial):
            partial.chmod(PRIVATE_FILE)  # an older one may have been open to others
            return file
        file.close()  # the other program has just given its file the final name


def lock(handle: int) -> bool:
    """Lock an open file until it is closed; return False if another program holds the lock.

    The operating system releases the lock when its process ends, so no lock is ever stale.
    """
    if not _HAS_LOCKS:
        return True
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


def lock_waiting(handle: int) -> None:
    """Lock an open file until it is closed; wait while another program holds the lock."""
    if _HAS_LOCKS:
        fcntl.flock(handle, fcntl.LOCK_EX)


def is_file_at(handle: int, path: Path) -> bool:
    """Return whether an open file is still the one at `path`."""
    try:
        return os.path.samestat(os.fstat(handle), path.stat())
    except FileNotFoundError:
        return False


def length_of_whole_lines(file: IO[bytes]) -> int:
    """Return how many bytes remain without a last line that was cut off."""
    end = file.seek(0, os.SEEK_END)
    begin = end
    while begin > 0:
        begin = max(0, begin - (1 << 16))
        file.seek(begin)
        newline = file.read(min(end - begin, 1 << 16)).rfind(b"\n")
        if newline >= 0:
            return begin + newline + 1
    return 0


def without_cut_line(content: bytes, path: Path) -> bytes:
    r"""Return the end of a partial file without an incomplete last line.

    In other files a last line without a newline is valid.

    Examples
    --------
    >>> without_cut_line(b"1,2\n3,", Path("list.csv.partial"))
    b'1,2\n'
    >>> without_cut_line(b"1,2\n3,", Path("list.csv"))
    b'1,2\n3,'
    """
    if path.suffix != ".partial" or not content or content.endswith(b"\n"):
        return content
    logger.warning("%s: the last line is cut off and left out", path)
    return content[: content.rfind(b"\n") + 1]
