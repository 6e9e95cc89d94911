"""Writes timings while a program runs: one file, or the segments of a long recording."""

import math
import shutil
import time
from collections.abc import Callable
from pathlib import Path

from trecsim.store.atomic import PRIVATE_FOLDER, atomic_write, disk_faults
from trecsim.store.growing import GrowingFile, KeepsPartial
from trecsim.store.segments import segment_files, segment_name
from trecsim.store.timing_csv import (
    HEADING,
    SUFFIX,
    StepTiming,
    last_time_s,
    parts_of_timing,
    timing_at,
    timing_duration_s,
)


class TimingWriter(KeepsPartial):
    """Writes timings; a crash loses at most the last two seconds.

    The rows go to ``NAME.partial``, which gets its final name when the block ends without an error.
    A long recording has segments, files in the folder ``NAME.parts``, which gets the final name
    instead.

    Parameters
    ----------
    path
        The file, usually ``timing.csv``.
    segment_s
        A new segment begins this long after the first time in the last one [s].
    clock
        Returns the time [s].
    resume
        Continue the timings at `path`, complete or not, if they exist. Frame sets that are not
        later than the last one are skipped.

    Raises
    ------
    InputError
        The place cannot be written to.
    SetupError
        The disk is full.
    """

    def __init__(
        self,
        path: Path,
        *,
        segment_s: float = math.inf,
        clock: Callable[[], float] = time.monotonic,
        resume: bool = False,
    ) -> None:
        self._path = path
        self._clock = clock
        self._segment_s = segment_s
        self._first_s = math.nan
        if resume:
            self._reopen()
        earlier = timing_at(path) if resume else None
        self._after_s = last_time_s(earlier) if earlier is not None else math.nan
        self._file = self._begun(resume)
        if resume and not self._file.empty:
            self._end_segment()

    def _reopen(self) -> None:
        """Rename complete timings to the names of unfinished ones."""
        with disk_faults(self._path):
            if self._path.is_dir():
                self._path.rename(parts_of_timing(self._path))
            elif self._path.is_file():
                self._path.replace(self._next_name())

    def _begun(self, resume: bool = False) -> GrowingFile:
        return GrowingFile(self._path, HEADING, clock=self._clock, resume=resume)

    def _next_name(self) -> Path:
        parts = parts_of_timing(self._path)
        parts.mkdir(mode=PRIVATE_FOLDER, exist_ok=True)
        number = 1 + max(segment_files(parts, SUFFIX), default=0)
        return parts / f"{segment_name(number)}{SUFFIX}"

    def write(self, step: StepTiming) -> None:
        """Append one frame set."""
        if step.t_s <= self._after_s:  # never where it is NaN
            return
        if self._file.closed:  # the disk was full when a segment ended: it goes on
            self._file = self._begun(resume=True)
        if step.t_s - self._first_s >= self._segment_s:
            self._end_segment()
        if self._file.empty:
            self._first_s = step.t_s
        row = f"{step.t_s!r},{step.images},{step.people},{step.fusion_ms:.4f}\n"
        self._file.write(row.encode())

    def _end_segment(self) -> None:
        with disk_faults(self._path, running=True):
            name = self._next_name()
        self._file.close(name)
        self._file = self._begun()

    def close(self) -> None:
        """Complete the timings: rename the file or folder to its final name."""
        parts = parts_of_timing(self._path)
        if not parts.is_dir():
            self._file.close()
            return
        with disk_faults(self._path, running=True):
            if self._file.empty:
                self._file.abandon()
            else:
                self._file.close(self._next_name())
            if timing_duration_s(parts) < self._segment_s:
                self._merge(parts)
            else:
                parts.rename(self._path)

    def _merge(self, parts: Path) -> None:
        """Write the segments of a short recording, which was continued, to one file."""
        with atomic_write(self._path, "wb", private=True) as whole:
            whole.write(HEADING)
            for file in segment_files(parts, SUFFIX).values():
                whole.write(file.read_bytes().partition(b"\n")[2])
        shutil.rmtree(parts)

    def abandon(self) -> None:
        """End early: keep the content under the name of unfinished timings."""
        self._file.abandon()
