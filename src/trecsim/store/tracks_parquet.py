"""Tracks as Parquet: compact, and safe against a crash at any time.

A Parquet file is unreadable until its footer is written, at the end. So during a recording a
complete small file, a part, is written every two seconds; once an hour the parts are replaced by a
segment::

    tracks.parquet.parts/00000001.parquet           a segment: the first hour
    tracks.parquet.parts/00000002/000001.parquet    a part of the second hour

The file of a segment grows along with its parts and gets its name when its hour is over; then the
parts are removed. At the end a recording of one segment becomes the file ``tracks.parquet``, a
longer one the folder ``tracks.parquet``. After SIGKILL or a power failure all segments and parts
are complete, and :func:`read_parquet` reads them; only the seconds since the last part are lost.
After an error the parts stay, so an unfinished recording never looks like a complete one.

The columns are those of the CSV file, followed by the state of each person and the velocity and
covariance of each joint, rounded and stored as :mod:`trecsim.store.compact` says.
"""

import math
import shutil
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Self

import numpy as np
import pyarrow as pa

from trecsim.errors import SetupError
from trecsim.store.atomic import disk_faults, sync_directory
from trecsim.store.compact import joined
from trecsim.store.compact_file import compact_groups, write_compact
from trecsim.store.open_segment import OpenSegment
from trecsim.store.parquet_file import ROWS_OF_A_GROUP, TracksInfo
from trecsim.store.parquet_reading import parts_of
from trecsim.store.rows import Rows, rows_of, table_of
from trecsim.store.segments import (
    CATALOGUE,
    SUFFIX,
    Segment,
    part_folders,
    segment_files,
    segment_name,
    segments_in,
    write_catalogue,
)
from trecsim.store.unfinished import check_continued, claim_parts, with_kept
from trecsim.values import Snapshot

HOUR_S = 3600.0

_PART_S = 2.0
_REMOVED_AT_ONCE = 20
_ROWS_OF_A_PART = 1 << 18
_BATCH_ROWS = 1 << 16


class ParquetTracksWriter:
    """Writes tracks as Parquet; a crash loses at most the last `part_s`.

    Parameters
    ----------
    path
        The complete recording: a file, or a folder if there are several segments. Until it is
        complete, the recording is at :func:`parts_of`.
    info
        Metadata of the files.
    segment_s
        A new segment begins this long after the first time in the last one [s].
    part_s
        Time from one part to the next [s].
    clock
        Returns the time [s].
    resume
        Continue the recording at `path`, complete or not, if it exists. Snapshots that are not
        later than its last one are skipped.

    Raises
    ------
    InputError
        When `path` cannot be written to, is in use, has parts of an unfinished recording, or holds
        one of an older format to be continued.
    SetupError
        When the disk has no room; the earlier content is kept.
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
        self._claim = claim_parts(self._path, resume=resume)
        try:
            self._segments = _recovered(self._parts, info) if resume else []
        except BaseException:
            self._claim.release()
            raise
        self._after_s = max((one.contents.last_s for one in self._segments), default=-math.inf)
        self._number = max(segment_files(self._parts), default=0)
        self._open: OpenSegment | None = None
        self._obsolete: Path | None = None  # parts that a segment has replaced
        self._moments: list[Snapshot] = []
        self._waiting_rows = 0
        self._flushed_s = clock()
        self._ended = False

    def write(self, snapshot: Snapshot) -> None:
        """Append one snapshot; times without people are not recorded."""
        if snapshot.t_s <= self._after_s:
            return
        if self._open is not None and snapshot.t_s - self._open.first_s >= self._segment_s:
            self._end_segment()
        if len(snapshot.id):
            if self._open is None:
                self._number += 1
                self._open = OpenSegment(self._parts, self._number, snapshot.t_s, self._info)
            self._moments.append(snapshot)
            self._waiting_rows += snapshot.support.size
        due = self._clock() - self._flushed_s >= self._part_s
        if due or self._waiting_rows >= _ROWS_OF_A_PART:
            self._flush()

    def _flush(self) -> None:
        self._flushed_s = self._clock()
        self._remove_some()
        moments, self._moments, self._waiting_rows = self._moments, [], 0
        if moments and self._open is not None:
            self._open.append(moments)

    def _end_segment(self) -> None:
        self._flush()
        if self._open is None:
            return
        self._segments.append(self._open.close())
        write_catalogue(self._parts, self._segments)
        self._remove_rest()
        self._obsolete = self._open.parts
        self._open = None

    def _remove_some(self) -> None:
        """Remove a few parts of the last hour; all at once would stall the caller."""
        if self._obsolete is None:
            return
        with suppress(OSError):  # the segment replaces them anyway
            parts = list(segment_files(self._obsolete).values())
            for part in parts[:_REMOVED_AT_ONCE]:
                part.unlink()
            if len(parts) <= _REMOVED_AT_ONCE:
                self._obsolete.rmdir()
                self._obsolete = None

    def _remove_rest(self) -> None:
        if self._obsolete is not None:
            with suppress(OSError):
                shutil.rmtree(self._obsolete)
            self._obsolete = None

    def close(self) -> None:
        """Complete the recording: rename it to its final name."""
        with self:
            pass

    def abandon(self) -> None:
        """End early: keep the content in the folder of parts."""
        if self._ended:
            return
        self._ended = True
        try:
            self._flush()
        finally:
            if self._open is not None:
                self._open.abandon()
            self._remove_rest()
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
                with suppress(SetupError):  # the disk is still full; report the first error
                    self.abandon()
                raise with_kept(error, self._parts) from error
            self.abandon()
        elif not self._ended:
            self._finish()

    def _finish(self) -> None:
        try:
            self._end_segment()
            self._remove_rest()
            with disk_faults(self._path, running=True):
                self._take_name()
            self._ended = True
        except SetupError as fault:
            with suppress(SetupError):
                self.abandon()
            raise with_kept(fault, self._parts) from fault
        except BaseException:
            self.abandon()
            raise

    def _take_name(self) -> None:
        files = segment_files(self._parts)
        if not files or (len(files) > 1 and self._duration_s() < self._segment_s):
            write_compact(self._path, _groups(files.values()), self._info)
            shutil.rmtree(self._parts)
            self._claim.release()
        elif len(files) > 1:
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

    def _duration_s(self) -> float:
        return self._segments[-1].contents.last_s - self._segments[0].contents.first_s


def _recovered(parts: Path, info: TracksInfo) -> list[Segment]:
    """Merge the parts that a crash left into a segment."""
    check_continued(parts)
    with disk_faults(parts):
        whole = segment_files(parts)
        for number, folder in part_folders(parts).items():
            files = segment_files(folder).values()
            if number not in whole and files:
                target = parts / f"{segment_name(number)}{SUFFIX}"
                write_compact(target, _groups(files), info)
            shutil.rmtree(folder)
        segments = [one for one in segments_in(parts) if one.contents.rows]
        write_catalogue(parts, segments)
    return segments


def _groups(files: Iterable[Path]) -> Iterator[pa.Table]:
    """Yield the rows of files of consecutive times in groups of a convenient size."""
    waiting: list[pa.Table] = []
    for file in files:
        for table in compact_groups(file):
            waiting.append(table)
            if sum(map(len, waiting)) >= ROWS_OF_A_GROUP:
                yield joined(waiting)
                waiting.clear()
    if waiting:
        yield joined(waiting)


def tables_of(snapshots: Iterable[Snapshot], info: TracksInfo) -> Iterator[pa.Table]:
    """Convert snapshots to Arrow tables of moderate size."""
    rows: list[Rows] = []
    for snapshot in snapshots:
        rows.append(rows_of(snapshot))
        if sum(map(len, rows)) >= _BATCH_ROWS:
            yield table_of(np.concatenate(rows), info.skeleton, details=info.details)
            rows.clear()
    if rows:
        yield table_of(np.concatenate(rows), info.skeleton, details=info.details)
