"""Several files that get their names only when all of them are complete."""

import errno
import os
import secrets
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from trecsim.store.atomic import PRIVATE_FILE, disk_faults, partial_path, sync_directory


@contextmanager
def placed(paths: Sequence[Path]) -> Iterator[list[Path]]:
    """Give a hidden path to write to for each path; rename them all when the block ends well.

    After an error, Ctrl-C or a full disk nothing is left, and older files are as they were. The
    hidden names keep the endings, by which some libraries choose the format. A device or pipe is
    written to directly. Only the owner can read the files: tracks are personal data.

    Raises
    ------
    InputError
        When a path cannot be a file.
    SetupError
        When the disk has no room.
    """
    with disk_faults(paths[0]):
        targets = [path.resolve() for path in paths]
        hidden = [_hidden(target, number) for number, target in enumerate(targets)]
        _check_folder(targets[0].parent)
        try:
            yield hidden
            for place in hidden:
                _make_durable(place)
            for place, target in zip(hidden, targets, strict=True):
                if place != target:
                    place.replace(target)
            sync_directory(targets[0].parent)
        finally:
            for place, target in zip(hidden, targets, strict=True):
                if place != target:
                    place.unlink(missing_ok=True)
                    partial_path(place).unlink(missing_ok=True)


def _hidden(target: Path, number: int) -> Path:
    if target.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
    if target.exists() and not target.is_file():  # a device or pipe
        return target
    code = f"{secrets.token_hex(4)}.{number}"
    return target.with_name(f".{target.stem[:80]}.{code}{target.suffix}")


def _check_folder(folder: Path) -> None:
    """Fail before any work is done where nothing can be written."""
    if not folder.is_dir():
        raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT))
    if not os.access(folder, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))


def _make_durable(place: Path) -> None:
    if not place.is_file():
        return
    place.chmod(PRIVATE_FILE)
    with place.open("rb+") as file:
        os.fsync(file.fileno())
