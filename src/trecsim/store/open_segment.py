"""The segment of a recording that is being written."""

import os
from contextlib import suppress
from pathlib import Path

import pyarrow as pa

from trecsim.store.atomic import PRIVATE_FILE, PRIVATE_FOLDER, disk_faults, sync_directory
from trecsim.store.parquet_file import ROWS_OF_A_GROUP, Contents, TracksInfo
from trecsim.store.parquet_writing import joined, parquet_file, write_file, write_group
from trecsim.store.rows import Rows, table_of
from trecsim.store.segments import SUFFIX, Segment, segment_name


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
            self._writer = parquet_file(self._file, info)

    def append(self, rows: Rows) -> None:
        """Write the rows of whole snapshots as a part, and to the file of the segment."""
        table = table_of(rows, self._info.skeleton, details=self._info.details)
        self._part += 1
        part = self.parts / f"{self._part:06d}{SUFFIX}"
        with disk_faults(part, running=True):
            self.parts.mkdir(mode=PRIVATE_FOLDER, exist_ok=True)
            write_file(part, [table], self._info)
            self._contents = self._contents.with_rows(rows)
            self._waiting.append(table)
            if sum(map(len, self._waiting)) >= ROWS_OF_A_GROUP:
                self._write_group()

    def _write_group(self) -> None:
        write_group(self._writer, joined(self._waiting))
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
