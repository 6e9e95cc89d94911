"""Back up the folder of a site to one file, while the site runs, and restore it."""

import logging
import os
import shutil
import tarfile
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from trecsim.errors import InputError
from trecsim.store.atomic import (
    PRIVATE_FILE,
    PRIVATE_FOLDER,
    atomic_write,
    disk_faults,
    opened_for_reading,
)
from trecsim.store.claiming import LOCK
from trecsim.store.compaction import CHANGING
from trecsim.store.erasing import changing_tracks
from trecsim.store.ledger import Ledger
from trecsim.store.ledger_file import NAME as LEDGER
from trecsim.store.ledger_file import copy_ledger
from trecsim.store.names import REPAIRING, REPAIRS, SITE_HISTORY, TRACKS
from trecsim.store.playback import recording_folders, recordings

logger = logging.getLogger(__name__)

_MARK = ".trecsim-backup"  # the first member, by which a backup is known
_FORMAT = b"trecsim.backup/1\n"


@dataclass(frozen=True, slots=True)
class BackedUp:
    """What a backup holds.

    Attributes
    ----------
    recordings
        Number of recordings.
    events
        Number of events in the ledger.
    files
        Number of files.
    size_bytes
        Room that they take.
    """

    recordings: int
    events: int
    files: int
    size_bytes: int


def backup(folder: Path, out: Path) -> BackedUp:
    """Write everything in the folder of a site to a tar file.

    The site may run meanwhile. The backup holds what was stored when it began: the ledger as of one
    moment, and of each recording the files of one moment. The file is for its owner alone.

    Parameters
    ----------
    folder
        A recording, or the folder with the recordings of a site.
    out
        The file.

    Raises
    ------
    InputError
        When there is nothing to back up, or `out` lies in `folder`.
    SetupError
        When the disk has no room.
    """
    if not recording_folders(folder) and not (folder / LEDGER).exists():
        raise InputError(f"{folder}: expected recordings or a ledger ({LEDGER}), found neither")
    if out.resolve().is_relative_to(folder.resolve()):
        raise InputError(f"{out} lies in {folder}, which it would hold; give another place")
    with (
        tempfile.TemporaryDirectory(prefix="trecsim-") as scratch,
        atomic_write(out, "wb", private=True) as file,
        tarfile.open(fileobj=file, mode="w", format=tarfile.PAX_FORMAT) as tar,
    ):
        target = _Target(tar, folder)
        events = _add_ledger(target, Path(scratch))
        for recording in recording_folders(folder):
            with changing_tracks(recording / TRACKS):
                target.add_all(_files(recording))
        target.add_all(_files(folder / REPAIRS))
        target.add_all(_files(folder / SITE_HISTORY))
        target.add_all(path for path in _files(folder, deep=False))
    return BackedUp(len(recording_folders(folder)), events, target.files, target.size_bytes)


class _Target:
    """A tar file that takes each file once."""

    def __init__(self, tar: tarfile.TarFile, folder: Path) -> None:
        self.tar = tar
        self.folder = folder
        self.size_bytes = 0
        self._names: set[str] = set()

    @property
    def files(self) -> int:
        return len(self._names)

    def add_all(self, paths: Iterable[Path]) -> None:
        for path in paths:
            self.add(path, path.relative_to(self.folder).as_posix())

    def add(self, path: Path, name: str) -> None:
        """Add a file, with the size that it has now; one that is gone meanwhile is left out."""
        if name in self._names:
            return
        with suppress(FileNotFoundError), path.open("rb") as content:
            size_bytes = os.fstat(content.fileno()).st_size
            member = tarfile.TarInfo(name)
            member.size, member.mode = size_bytes, PRIVATE_FILE
            member.mtime = int(path.stat().st_mtime)
            self.tar.addfile(member, content)
            self._names.add(name)
            self.size_bytes += size_bytes


def _add_ledger(target: _Target, scratch: Path) -> int:
    """Add the mark of a backup, and a copy of the ledger; return its number of events."""
    (scratch / _MARK).write_bytes(_FORMAT)
    target.add(scratch / _MARK, _MARK)
    if not (target.folder / LEDGER).exists():
        return 0
    copy_ledger(target.folder / LEDGER, scratch / LEDGER)
    target.add(scratch / LEDGER, LEDGER)
    with Ledger(scratch, repair=False) as ledger:
        return ledger.count_events()


def _files(folder: Path, *, deep: bool = True) -> list[Path]:
    """Return what belongs into a backup: no locks, nothing incomplete, no ledger in use."""
    paths = sorted(folder.rglob("*") if deep else folder.iterdir())
    for path in paths:
        if path.is_symlink() and not path.is_dir():
            logger.warning("%s is a link and not part of the backup; keep what it points to", path)
    return [
        path
        for path in paths
        if path.is_file()
        and not path.is_symlink()
        and path.name not in (LOCK, CHANGING)
        and not path.name.endswith(".tmp")
        and not path.name.startswith(LEDGER)
        and not path.parent.name.startswith(REPAIRING)
    ]


def restore(archive: Path, folder: Path) -> BackedUp:
    """Restore a backup to a folder that is new or empty.

    Parameters
    ----------
    archive
        What `backup` has written.
    folder
        The folder to make.

    Raises
    ------
    InputError
        When the archive is no backup, is damaged, or the folder is not empty.
    SetupError
        When the disk has no room; no folder is left then.
    """
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise InputError(f"{folder} is not empty; nothing is overwritten: give another folder")
    with disk_faults(folder):
        folder.parent.mkdir(parents=True, exist_ok=True)
        scratch = Path(tempfile.mkdtemp(prefix=f".{folder.name}.", dir=folder.parent))
    try:
        with disk_faults(folder):
            files, size_bytes = _unpack(archive, scratch)
        events = 0
        if (scratch / LEDGER).exists():
            with Ledger(scratch, repair=False) as ledger:
                events = ledger.count_events()
        count = len(recordings(scratch))
        with disk_faults(folder):
            if folder.exists():
                folder.rmdir()
            scratch.rename(folder)
    except BaseException:
        shutil.rmtree(scratch, ignore_errors=True)
        raise
    return BackedUp(count, events, files, size_bytes)


def _unpack(archive: Path, folder: Path) -> tuple[int, int]:
    """Write the files of an archive; return their number and size."""
    files = size_bytes = 0
    with (
        opened_for_reading(archive) as stream,
        _tar_faults(archive),
        tarfile.open(fileobj=stream, mode="r:") as tar,
    ):
        for number, member in enumerate(tar):
            content = tar.extractfile(member) if member.isreg() else None
            if content is None or not _is_inside(member.name):
                raise InputError(f"{archive}: {member.name!r} cannot be part of a backup")
            if number == 0:
                _check_mark(archive, member.name, content.read(len(_FORMAT) + 1))
                continue
            _unpack_file(tar, member, folder / member.name)
            files, size_bytes = files + 1, size_bytes + member.size
    if not files:
        raise InputError(f"{archive} holds nothing")
    return files, size_bytes


def _is_inside(name: str) -> bool:
    path = PurePosixPath(name)
    return bool(path.parts) and not path.is_absolute() and ".." not in path.parts


def _check_mark(archive: Path, name: str, content: bytes) -> None:
    if name != _MARK:
        raise InputError(f"{archive} is no backup of trecsim")
    if content != _FORMAT:
        found = content.decode("ascii", errors="replace").strip()
        raise InputError(
            f"{archive}: expected the format {_FORMAT.decode().strip()!r}, found {found!r}: it may "
            "have been made by a newer trecsim"
        )


def _unpack_file(tar: tarfile.TarFile, member: tarfile.TarInfo, path: Path) -> None:
    content = tar.extractfile(member)
    assert content is not None  # it is a file
    path.parent.mkdir(mode=PRIVATE_FOLDER, parents=True, exist_ok=True)
    handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, PRIVATE_FILE)
    with os.fdopen(handle, "wb") as file:
        shutil.copyfileobj(content, file)


@contextmanager
def _tar_faults(archive: Path) -> Iterator[None]:
    try:
        yield
    except (tarfile.TarError, EOFError) as error:
        raise InputError(f"{archive} is no backup of trecsim, or is damaged: {error}") from None
    except (FileExistsError, NotADirectoryError):
        raise InputError(f"{archive} is damaged: it holds two files at the same place") from None
