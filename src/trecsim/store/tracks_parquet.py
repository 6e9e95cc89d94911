"""Tracks as Parquet: the rows of the CSV file, compact, and safe against a crash at any moment.

A Parquet file without its footer is unreadable, and the footer is written last. So while a
recording runs, every two seconds a complete small file, a part, goes into a folder beside it; once
an hour the parts become a segment::

    tracks.parquet.parts/00000001.parquet           a segment: the first hour
    tracks.parquet.parts/00000002/000001.parquet    a part of the second hour

A segment is written along with its parts and takes its name when its hour is over; then the parts
are removed. At the end a recording of one segment becomes the file ``tracks.parquet``, and one of
several the folder ``tracks.parquet``. After a crash, even by SIGKILL or loss of power, segments and
parts are there, every one of them whole, and :func:`read_parquet` reads them in place of what is
missing; lost are the seconds since the last part. A recording that ends with an error keeps its
parts, so that an unfinished recording never looks like a finished one.

The columns are those of the CSV file, which pandas, R, DuckDB and others open as they are, and
behind them everybody's state and each joint's velocity and covariance. Numbers are float32, stored
byte by byte (BYTE_STREAM_SPLIT) and compressed with Zstandard. See ``docs/decisions/``.
"""

import errno
import math
import os
import shutil
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Self

import numpy as np
import pyarrow as pa

from trecsim.errors import InputError, SetupError
from trecsim.skeleton import Skeleton
from trecsim.store.atomic import PRIVATE_FILE, PRIVATE_FOLDER, disk_faults, sync_directory
from trecsim.store.claiming import FolderClaim
from trecsim.store.parquet_file import (
    ROWS_OF_A_GROUP,
    Contents,
    TracksInfo,
    file_rows,
    joined,
    parquet_file,
    read_file_info,
    write_file,
    write_group,
)
from trecsim.store.rows import ROW, Rows, rows_of, snapshots_of, table_of
from trecsim.store.segments import (
    CATALOGUE,
    SUFFIX,
    Segment,
    files_in,
    part_folders,
    segment_files,
    segment_name,
    segment_of,
    segments_in,
    write_catalogue,
)
from trecsim.values import Snapshot

HOUR_S = 3600.0

_PART_S = 2.0
_ROWS_OF_A_PART = 1 << 18
_BATCH_ROWS = 1 << 16


class ParquetTracksWriter:
    """Records tracks; however the program ends, what is older than `part_s` is on the disk.

    Parameters
    ----------
    path
        The file that will hold the whole recording, or the folder, if there is more than one
        segment; until then see :func:`parts_of`.
    info
        What the files shall say about themselves.
    segment_s
        A new segment begins this long after the first moment of the last one [s].
    part_s
        A crash costs at most this much [s].
    clock
        Tells the time [s].
    resume
        Go on with the recording at `path`, finished or not, if there is one. Moments that are not
        later than its last one are left out.

    Raises
    ------
    InputError
        When the place is wrong, in use, or holds parts of a recording that has not ended.
    SetupError
        When the disk has no room; what was written before is kept.
    """

    def __init__(
        self,
        path: Path,
        info: TracksInfo = TracksInfo(),  # noqa: B008
        *,
        segment_s: float = math.inf,
        part_s: float = _PART_S,
        clock: Callable[[], float] = time.monotonic,
        resume: bool = False,
    ) -> None:
        self._path = path.resolve() if path.is_symlink() else path
        self._info = info
        self._segment_s = segment_s
        self._part_s = part_s
        self._clock = clock
        self._parts = parts_of(self._path)
        self._claim = _claimed(self._path, resume)
        try:
            self._segments = _recovered(self._parts, info) if resume else []
        except BaseException:
            self._claim.release()
            raise
        self._after_s = max((one.contents.last_s for one in self._segments), default=-math.inf)
        self._number = max(segment_files(self._parts), default=0)
        self._open: _OpenSegment | None = None
        self._rows: list[Rows] = []
        self._flushed_s = clock()
        self._ended = False

    def write(self, snapshot: Snapshot) -> None:
        """Add one moment."""
        if snapshot.t_s <= self._after_s:
            return
        if self._open is not None and snapshot.t_s - self._open.first_s >= self._segment_s:
            self._end_segment()
        rows = rows_of(snapshot)
        if len(rows) and self._open is None:
            self._number += 1
            self._open = _OpenSegment(self._parts, self._number, snapshot.t_s, self._info)
        self._rows.append(rows)
        due = self._clock() - self._flushed_s >= self._part_s
        if due or sum(map(len, self._rows)) >= _ROWS_OF_A_PART:
            self._flush()

    def _flush(self) -> None:
        self._flushed_s = self._clock()
        rows = np.concatenate(self._rows) if self._rows else np.empty(0, ROW)
        self._rows.clear()
        if len(rows) and self._open is not None:
            self._open.append(rows)

    def _end_segment(self) -> None:
        self._flush()
        if self._open is None:
            return
        self._segments.append(self._open.close())
        write_catalogue(self._parts, self._segments)
        self._open.remove_parts()
        self._open = None

    def close(self) -> None:
        """End the recording: it takes its final name."""
        with self:
            pass

    def abandon(self) -> None:
        """End early: what was written stays in the folder of parts."""
        if self._ended:
            return
        self._ended = True
        try:
            self._flush()
        finally:
            if self._open is not None:
                self._open.abandon()
            self._claim.release()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if kind is not None:
            if isinstance(error, SetupError):
                with suppress(SetupError):  # the same again, and the first is told
                    self.abandon()
                raise self._with_kept(error) from error
            self.abandon()
        elif not self._ended:
            self._finish()

    def _finish(self) -> None:
        try:
            self._end_segment()
            with disk_faults(self._path, running=True):
                self._take_name()
            self._ended = True
        except SetupError as fault:
            with suppress(SetupError):
                self.abandon()
            raise self._with_kept(fault) from fault
        except BaseException:
            self.abandon()
            raise

    def _take_name(self) -> None:
        files = segment_files(self._parts)
        if not files:
            write_file(self._path, [], self._info)
        if len(files) > 1:
            self._claim.release()
            if self._path.is_file():
                self._path.unlink()
            self._parts.rename(self._path)
        else:
            for file in files.values():
                file.replace(self._path)
            (self._parts / CATALOGUE).unlink(missing_ok=True)
            self._claim.release()
        sync_directory(self._path.parent)

    def _with_kept(self, error: SetupError) -> SetupError:
        if not self._parts.is_dir() or not files_in(self._parts):
            return error
        return SetupError(f"{error}; what was recorded is kept in {self._parts}")


class _OpenSegment:
    """A segment that is being written: its parts, complete, and its file, still without an end."""

    def __init__(self, folder: Path, number: int, first_s: float, info: TracksInfo) -> None:
        self.first_s = first_s
        self._folder = folder
        self._info = info
        self._parts = folder / segment_name(number)
        self._target = folder / f"{segment_name(number)}{SUFFIX}"
        self._temporary = folder / f".{self._target.name}.tmp"
        self._part = 0
        self._contents = Contents()
        self._waiting: list[pa.Table] = []
        with disk_faults(self._target, running=True):
            flags = os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_CLOEXEC
            self._file = os.fdopen(os.open(self._temporary, flags, PRIVATE_FILE), "wb")
            self._writer = parquet_file(self._file, info)

    def append(self, rows: Rows) -> None:
        """Write rows, whole moments, as a part, and to the file of the segment."""
        table = table_of(rows, self._info.skeleton, details=self._info.details)
        self._part += 1
        part = self._parts / f"{self._part:06d}{SUFFIX}"
        with disk_faults(part, running=True):
            self._parts.mkdir(mode=PRIVATE_FOLDER, exist_ok=True)
            write_file(part, [table], self._info)
            self._contents = self._contents.with_rows(rows)
            self._waiting.append(table)
            if sum(map(len, self._waiting)) >= ROWS_OF_A_GROUP:
                self._write_group()

    def _write_group(self) -> None:
        write_group(self._writer, joined(self._waiting))
        self._waiting.clear()

    def close(self) -> Segment:
        """Complete the file of the segment; the parts stay."""
        with disk_faults(self._target, running=True):
            if self._waiting:
                self._write_group()
            self._writer.close()
            self._file.flush()
            os.fsync(self._file.fileno())
            self._file.close()
            size_bytes = self._temporary.stat().st_size
            self._temporary.replace(self._target)
            sync_directory(self._folder)
        return Segment(self._target, size_bytes, self._contents)

    def remove_parts(self) -> None:
        """Remove the parts, which the file of the segment replaces."""
        with suppress(OSError):  # what remains does no harm
            shutil.rmtree(self._parts)

    def abandon(self) -> None:
        """Give up the file of the segment; the parts stay."""
        with suppress(OSError, pa.ArrowException):
            self._writer.close()
        with suppress(OSError):
            self._file.close()
        with suppress(OSError):
            self._temporary.unlink(missing_ok=True)


def parts_of(path: Path) -> Path:
    """Return the folder that holds the recording `path` until it is complete."""
    return path.with_name(path.name + ".parts")


def _claimed(path: Path, resume: bool) -> FolderClaim:
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
    for temporary in parts.rglob(".*.tmp"):  # halves of files, which a crash left
        temporary.unlink()
    if resume and path.is_file():
        path.replace(parts / f"{segment_name(1)}{SUFFIX}")


def _recovered(parts: Path, info: TracksInfo) -> list[Segment]:
    """Make a segment of the parts that a crash left."""
    with disk_faults(parts):
        whole = segment_files(parts)
        for number, folder in part_folders(parts).items():
            files = segment_files(folder).values()
            if number not in whole and files:
                tables = (
                    table_of(rows, info.skeleton, details=info.details)
                    for file in files
                    for rows in file_rows(file, info.skeleton)
                )
                write_file(parts / f"{segment_name(number)}{SUFFIX}", tables, info)
            shutil.rmtree(folder)
        segments = [one for one in segments_in(parts) if one.contents.rows]
        write_catalogue(parts, segments)
    return segments


def write_parquet(path: Path, tables: Iterable[pa.Table], info: TracksInfo) -> None:
    """Write one complete file from tables, one after the other, in little memory."""
    write_file(path, tables, info)


def tables_of(snapshots: Iterable[Snapshot], info: TracksInfo) -> Iterator[pa.Table]:
    """Lay snapshots out as tables of a convenient size."""
    rows: list[Rows] = []
    for snapshot in snapshots:
        rows.append(rows_of(snapshot))
        if sum(map(len, rows)) >= _BATCH_ROWS:
            yield table_of(np.concatenate(rows), info.skeleton, details=info.details)
            rows.clear()
    if rows:
        yield table_of(np.concatenate(rows), info.skeleton, details=info.details)


def read_parquet(
    path: Path, from_s: float = -math.inf, until_s: float = math.inf
) -> Iterator[Snapshot]:
    """Read tracks one moment at a time; of an unfinished recording, read segments and parts.

    Parameters
    ----------
    path
        A Parquet file of tracks, complete or not, or a folder of segments or parts.
    from_s, until_s
        Read what lies between these times, both included [s]; no file in which nothing of it is
        opened, as far as the catalogue tells.

    Raises
    ------
    InputError
        When there is no such recording, or it is not right.
    """
    skeleton = read_info(path).skeleton
    blocks = _blocks(path, skeleton, from_s, until_s)
    yield from snapshots_of(blocks, skeleton, path, unit="row", first=1)


def _blocks(path: Path, skeleton: Skeleton, from_s: float, until_s: float) -> Iterator[Rows]:
    next_s = from_s
    for file in _files_between(path, from_s, until_s):
        if file != path and not file.exists():  # its hour, or the recording, has just ended
            yield from _blocks(path, skeleton, next_s, until_s)
            return
        for rows in file_rows(file, skeleton, from_s, until_s):
            yield rows
            if len(rows):
                next_s = math.nextafter(float(rows["t_s"][-1]), math.inf)


def _files_between(path: Path, from_s: float, until_s: float) -> list[Path]:
    folder = _folder_of(path)
    if folder is None:
        return [path]
    if from_s == -math.inf and until_s == math.inf:
        return files_in(folder)
    return [one.file for one in segments_in(folder) if one.contents.overlaps(from_s, until_s)]


def _folder_of(path: Path) -> Path | None:
    """Return the folder of segments or parts that stands for a recording; None for a file."""
    if path.is_dir():
        return path
    return parts_of(path) if not path.exists() and parts_of(path).is_dir() else None


def read_info(path: Path) -> TracksInfo:
    """Read what a recording says about itself; a file written by others says nothing.

    Raises
    ------
    InputError
        When it is not a Parquet file, or of a format that is not known.
    """
    folder = _folder_of(path)
    files = files_in(folder) if folder is not None else [path]
    return read_file_info(files[0]) if files else TracksInfo()


def recording_segments(path: Path) -> list[Segment]:
    """Return the files of a recording in order, with what each holds.

    Raises
    ------
    InputError
        When there is no such recording, or it is damaged.
    """
    folder = _folder_of(path)
    return segments_in(folder) if folder is not None else [segment_of(path)]
