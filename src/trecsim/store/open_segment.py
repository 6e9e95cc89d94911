"""The segment of a recording that is being written."""

import os
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

import pyarrow as pa

from trecsim.store.atomic import PRIVATE_FILE, PRIVATE_FOLDER, disk_faults, sync_directory
from trecsim.store.compact import compact_table, joined
from trecsim.store.compact_file import compact_writer, write_compact
from trecsim.store.parquet_file import ROWS_OF_A_GROUP, Contents, TracksInfo
from trecsim.store.segments import SUFFIX, Segment, segment_name
from trecsim.values import Snapshot


class OpenSegment:
    """The unfinished segment: its complete parts, and its file without a footer."""

    def __init__(self, folder: Path, number: int, first_s: float, info: TracksInfo) -> None:
        self.first_s = first_s
        self._folder = folder
        self._info = info
        self.parts = folder / segment_name(number)
        self._target = folder / f"{segment_name(number)}{SUFFIX}"
        self._temporary = folder / f".{self._target.name}.tmp"
        self._part = 0
        self._contents = Contents()
        self._waiting: list[pa.Table] = []
        with disk_faults(self._target, running=True):
            flags = os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_CLOEXEC
            self._file = os.fdopen(os.open(self._temporary, flags, PRIVATE_FILE), "wb")
            self._writer = compact_writer(self._file, info)

    def append(self, moments: Sequence[Snapshot]) -> None:
        """Write snapshots as a part, and to the file of the segment."""
        table = compact_table(moments, self._info.skeleton)
        self._part += 1
        part = self.parts / f"{self._part:06d}{SUFFIX}"
        with disk_faults(part, running=True):
            self.parts.mkdir(mode=PRIVATE_FOLDER, exist_ok=True)
            write_compact(part, [table], self._info)
            self._contents = self._contents.with_moments(moments)
            self._waiting.append(table)
            if sum(map(len, self._waiting)) >= ROWS_OF_A_GROUP:
                self._write_group()

    def _write_group(self) -> None:
        table = joined(self._waiting)
        self._writer.write_table(table, row_group_size=len(table))
        self._waiting.clear()
        self._file.flush()
        os.fsync(self._file.fileno())  # so that little is left to do when the hour ends

    def close(self) -> Segment:
        """Complete the file of the segment; keep the parts."""
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

    def abandon(self) -> None:
        """Remove the file of the segment; keep the parts."""
        with suppress(OSError, pa.ArrowException):
            self._writer.close()
        with suppress(OSError):
            self._file.close()
        with suppress(OSError):
            self._temporary.unlink(missing_ok=True)
