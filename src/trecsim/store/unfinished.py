"""The folder of parts in which a recording of tracks lies until it is complete."""

import errno
import os
from pathlib import Path

from trecsim.errors import InputError, SetupError
from trecsim.store.atomic import disk_faults
from trecsim.store.claiming import FolderClaim
from trecsim.store.parquet_file import COMPACT_FORMAT
from trecsim.store.parquet_reading import parts_of, read_info
from trecsim.store.segments import SUFFIX, files_in, segment_name


def claim_parts(path: Path, *, resume: bool) -> FolderClaim:
    """Reserve the folder of parts of a recording; with `resume` what is recorded goes there.

    Raises
    ------
    InputError
        When `path` cannot be written to, is in use, or has parts of an unfinished recording.
    SetupError
        When the disk has no room.
    """
    parts = parts_of(path)
    with disk_faults(path):
        if path.is_dir() and not resume:
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
        if not path.parent.is_dir():
            raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT))
        if parts.is_dir() and files_in(parts) and path.exists() and resume:
            raise InputError(
                f"{path} and {parts} are both there; move one of them away, then resume again"
            )
        if path.is_dir():
            path.rename(parts)
    claim = FolderClaim(parts, "recording")
    try:
        with disk_faults(path):
            _prepare(path, parts, resume)
    except BaseException:
        claim.release()
        raise
    return claim


def _prepare(path: Path, parts: Path, resume: bool) -> None:
    if files_in(parts) and not resume:
        raise InputError(
            f"{parts} holds a recording that has not ended: keep it with "
            f"`trecsim export {parts} OUT.parquet`, then delete the directory"
        )
    for temporary in parts.rglob(".*.tmp"):  # incomplete files of a crash
        temporary.unlink()
    if resume and path.is_file():
        path.replace(parts / f"{segment_name(1)}{SUFFIX}")


def check_continued(parts: Path) -> None:
    """Refuse to continue a recording that is not of the present format.

    Raises
    ------
    InputError
        When it has another one.
    """
    if files_in(parts) and (found := read_info(parts).format) != COMPACT_FORMAT:
        raise InputError(
            f"{parts} holds tracks of the format {found}, which can be read, not continued; "
            f"expected {COMPACT_FORMAT}: give another folder or file"
        )


def with_kept(error: SetupError, parts: Path) -> SetupError:
    """Return an error that also says where earlier content is kept."""
    if not parts.is_dir() or not files_in(parts):
        return error
    return SetupError(f"{error}; what was recorded is kept in {parts}")
