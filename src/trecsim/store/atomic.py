"""Files that appear complete or not at all."""

import errno
import os
import secrets
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import IO, Any, Literal, cast, overload

from trecsim.errors import Error, InputError, SetupError

PRIVATE_FILE, PRIVATE_FOLDER = 0o600, 0o700
"""Permissions of what holds personal data: its owner may read and write it, nobody else."""

_NO_ROOM = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG}
_GONE = {errno.ENOENT, errno.ENOTDIR, errno.ESTALE}
_NOT_THERE = {errno.ENOENT, errno.ENOTDIR, errno.ENAMETOOLONG, errno.ELOOP}
_FORBIDDEN = {errno.EACCES, errno.EPERM, errno.EROFS}


@overload
def atomic_write(
    path: Path, mode: Literal["w"] = "w", *, private: bool = False
) -> AbstractContextManager[IO[str]]: ...
@overload
def atomic_write(
    path: Path, mode: Literal["wb"], *, private: bool = False
) -> AbstractContextManager[IO[bytes]]: ...
def atomic_write(
    path: Path, mode: Literal["w", "wb"] = "w", *, private: bool = False
) -> AbstractContextManager[IO[str]] | AbstractContextManager[IO[bytes]]:
    """Open a file that gets its name only when it is complete.

    The content goes to a hidden file in the same directory, which replaces `path` when the block
    ends without an error. After an error, Ctrl-C, a full disk or a power failure `path` is as it
    was before.

    Parameters
    ----------
    path
        The file to write. A link is followed; a device or pipe is written to directly.
    mode
        Text (UTF-8, lines end with a newline character) or bytes.
    private
        Whether the file holds personal data: only its owner may then read it.

    Raises
    ------
    InputError
        When `path` cannot be a file: its directory is missing, it is a directory itself, or
        writing there is not allowed.
    SetupError
        When the disk has no room or does not work.

    Examples
    --------
    >>> folder = getfixture("tmp_path")
    >>> with atomic_write(folder / "answer.txt") as file:
    ...     _ = file.write("42")
    ...     (folder / "answer.txt").exists()
    False
    >>> (folder / "answer.txt").read_text()
    '42'
    """
    return cast(AbstractContextManager[IO[str]], _atomic_write(path, mode, private))


@contextmanager
def _atomic_write(path: Path, mode: str, private: bool) -> Iterator[IO[Any]]:
    with disk_faults(path):
        target = path.resolve()
        if target.is_dir():
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
        if target.exists() and not target.is_file():  # /dev/stdout, a named pipe
            with _open(target, mode) as file:
                yield file
            return
        temporary = target.with_name(f".{target.name[:80]}.{secrets.token_hex(4)}.tmp")
        try:
            with _open(temporary, mode.replace("w", "x"), private) as file:
                yield file
                file.flush()
                os.fsync(file.fileno())
            temporary.replace(target)
            sync_directory(target.parent)
        finally:
            temporary.unlink(missing_ok=True)


def refuse_unwritable(path: Path) -> None:
    """Refuse a place where no file can be written, before the work whose result it is.

    Raises
    ------
    InputError
        The directory does not exist or may not be written to, or a directory has this name.
    """
    with disk_faults(path):
        target = path.resolve()
        if target.is_dir():
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
        if target.exists() and not target.is_file():
            return
        if not target.parent.is_dir():
            raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT))
        if not os.access(target.parent, os.W_OK):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))


def sync_directory(folder: Path) -> None:
    """Wait until the names in a folder are on the disk."""
    if hasattr(os, "O_DIRECTORY"):  # elsewhere directories cannot be opened
        handle = os.open(folder, os.O_DIRECTORY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def partial_path(path: Path) -> Path:
    """Return where the content of `path` is until it is complete."""
    return path.with_name(path.name + ".partial")


@contextmanager
def opened_for_reading(path: Path) -> Iterator[IO[bytes]]:
    """Open a file the user named.

    Raises
    ------
    InputError
        When it cannot be read.
    """
    try:
        file = path.open("rb")
    except (OSError, ValueError) as error:  # ValueError: a name with a null character
        reason = error.strerror if isinstance(error, OSError) else error
        raise InputError(f"cannot read {path}: {reason}") from None
    with file:
        yield file


def _open(path: Path, mode: str, private: bool = False) -> IO[Any]:
    def opener(name: str, flags: int) -> int:
        return os.open(name, flags, PRIVATE_FILE if private else 0o666)

    if "b" in mode:
        return open(path, mode, opener=opener)
    return open(path, mode, encoding="utf-8", newline="\n", opener=opener)


@contextmanager
def disk_faults(path: Path, *, running: bool = False) -> Iterator[None]:
    """Turn errors of the operating system while writing `path` into our own with advice.

    Parameters
    ----------
    path
        The file or folder that is written.
    running
        Whether writing has begun, so that a place that is missing now was removed meanwhile.

    Raises
    ------
    InputError
        When the place itself is wrong.
    SetupError
        When the disk has no room or does not work, or the place was removed meanwhile.
    """
    try:
        yield
    except OSError as error:
        told = _removed(path) if running and error.errno in _GONE else _explain(path, error)
        if told is None:  # not an error of the file system
            raise
        raise told from error


def _removed(path: Path) -> Error:
    return SetupError(
        f"cannot write {path}: it, or the folder {path.parent}, was removed or renamed while it "
        "was written; run again and leave the folder alone until the end"
    )


def _explain(path: Path, error: OSError) -> Error | None:
    if error.errno in _NO_ROOM:
        return SetupError(
            f"cannot write {path}: the disk is full or the size of files is limited "
            f"({error.strerror}); free some space or write to another disk"
        )
    if error.errno == errno.EIO:
        return SetupError(f"cannot write {path}: the disk reports an error ({error.strerror})")
    if error.errno == errno.EISDIR:
        return InputError(f"cannot write {path}: it is a directory; give the name of a file")
    if error.errno in _NOT_THERE:
        return InputError(
            f"cannot write {path}: the directory {path.parent} does not exist or the name is "
            f"not valid ({error.strerror}); make the directory first"
        )
    if error.errno in _FORBIDDEN:
        return InputError(f"cannot write {path}: {error.strerror}; choose another place")
    return None
