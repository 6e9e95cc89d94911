"""Record the tracks of a live site in a thread of its own; the tracking never waits for the disk.

Snapshots wait in memory until they are written as a part, every second, so the end of the program
at any moment costs less than 2 s. Another thread merges parts to minutes and hours. While the disk
is full or does not work, snapshots wait for 30 s; later ones are lost, and the gap is listed in
``gaps.json`` beside the recording. Writing is tried again all the time. A clock that is set back
ends the recording of people until it has caught up, as the times of a recording increase; that is
a fault, and listed as a gap.

::

    tracks.parquet.parts/00000001.parquet                  a segment: the first hour
    tracks.parquet.parts/00000002/000001-000060.parquet    a minute of the second hour
    tracks.parquet.parts/00000002/000061.parquet           a part of the minute after it
"""

import logging
import math
import os
import threading
import time
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from trecsim.cloud_events import rfc3339
from trecsim.errors import Error, SetupError
from trecsim.health import StoreHealth
from trecsim.recent import Recent
from trecsim.store.atomic import PRIVATE_FOLDER, disk_faults, sync_directory
from trecsim.store.compact import compact_table
from trecsim.store.compact_file import write_compact
from trecsim.store.compaction import changing, complete_segment, merge_parts, remove_parts
from trecsim.store.gaps import Gap, add_gaps
from trecsim.store.growing import KeepsPartial
from trecsim.store.parquet_file import TracksInfo
from trecsim.store.parquet_reading import parts_of, recording_segments
from trecsim.store.segments import (
    SUFFIX,
    files_in,
    part_folders,
    segment_files,
    segment_name,
)
from trecsim.store.unfinished import check_continued, claim_parts, with_kept
from trecsim.values import Snapshot

logger = logging.getLogger(__name__)

HOUR_S = 3600.0
PART_S = 1.0
"""Time from one part to the next; with the time that writing takes, a crash costs less than 2 s."""

BACK_S = 1.0
"""Times that fall back by more mean that the clock was set [s]."""

_WAITING_PEOPLE = 15_000  # of all waiting snapshots together: 20 people for 30 s, about 50 MB
_LOW_PRIORITY = 10


@dataclass(slots=True)
class _Batch:
    """Snapshots that become one part."""

    segment: int
    part: int
    moments: list[Snapshot]


class Recorder(KeepsPartial):
    """Records snapshots of a live site; `write` never waits and never fails.

    Parameters
    ----------
    path
        The complete recording: a file, or a folder if there are several segments. Until it is
        complete, the recording is at :func:`~trecsim.store.parquet_reading.parts_of`.
    info
        Metadata of the files.
    segment_s
        A new segment begins this long after the first time in the last one [s].
    part_s
        Time from one part to the next [s].
    parts_of_a_minute
        So many parts are merged to one file.
    resume
        Continue the recording at `path`, complete or not, if it exists. Snapshots that are not
        later than its last one are skipped.
    chores
        Is called about once a minute in the thread that merges, for example to delete what is old.

    Raises
    ------
    InputError
        When `path` cannot be written to, is in use, has parts of an unfinished recording, or holds
        a recording of another format.
    SetupError
        When the disk has no room.
    """

    def __init__(
        self,
        path: Path,
        info: TracksInfo,
        *,
        segment_s: float = HOUR_S,
        part_s: float = PART_S,
        parts_of_a_minute: int = 60,
        resume: bool = False,
        chores: Callable[[], None] = lambda: None,
    ) -> None:
        self._path = path.resolve() if path.is_symlink() else path
        self._parts = parts_of(self._path)
        self._info = info
        self._segment_s, self._part_s = segment_s, part_s
        self._parts_of_a_minute = parts_of_a_minute
        self._chores = chores
        self._claim = claim_parts(self._path, resume=resume)
        try:
            self._last_s = self._stored_s = _end_of(self._parts)
        except BaseException:
            self._claim.release()
            raise
        self._lock = threading.Lock()
        self._waiting: deque[Snapshot] = deque()
        self._waiting_people = 0
        self._batches: deque[_Batch] = deque()
        self._number = max([0, *segment_files(self._parts), *part_folders(self._parts)])
        self._written_number = self._number  # segments before it are complete
        self._part = 0
        self._segment_from_s = -math.inf
        self._people: frozenset[int] = frozenset()  # of the segment before
        self._lost_after_s: float | None = self._last_s if math.isfinite(self._last_s) else None
        self._lost_for = "nothing was recorded between two runs"
        self._gaps: list[Gap] = []
        self._fault: str | None = None
        self._set_back: str | None = None  # what is wrong with the clock
        self.writing = Recent()  # how long each part took, and how old its newest snapshot was [ms]
        self._stop = threading.Event()
        self._threads = [
            threading.Thread(target=self._write_parts, name="recorder", daemon=True),
            threading.Thread(target=self._merge, name="compaction", daemon=True),
        ]
        for thread in self._threads:
            thread.start()

    @property
    def folder(self) -> Path:
        """The folder in which the recording is."""
        return self._path.parent

    @property
    def stored_s(self) -> float:
        """The time up to which everything that was not lost is on the disk [s]; -inf at first."""
        return self._stored_s

    @property
    def health(self) -> StoreHealth:
        """Whether the disk takes what is recorded, and why not."""
        fault = self._fault or self._set_back
        return StoreHealth("writing" if fault is None else "failing", fault)

    def write(self, snapshot: Snapshot) -> None:
        """Take one snapshot, which is written soon."""
        if snapshot.t_s <= self._last_s:
            if snapshot.t_s < self._last_s - BACK_S:
                self._note_set_back()
            return
        self._set_back = None
        people = 1 + len(snapshot.id)
        with self._lock:
            if self._waiting_people + people > _WAITING_PEOPLE:
                if self._lost_after_s is None:
                    self._lost_after_s = self._last_s
                    self._lost_for = self._fault or "the disk is too slow"
                return
            if self._lost_after_s is not None:
                self._gaps.append(Gap(self._lost_after_s, snapshot.t_s, self._lost_for))
                self._lost_after_s = None
            self._waiting.append(snapshot)
            self._waiting_people += people
            self._last_s = snapshot.t_s

    def _note_set_back(self) -> None:
        """Tell that nothing is recorded until the clock has caught up with the recording."""
        if self._set_back is not None:
            return
        self._set_back = (
            "the clock was set back, so that nothing is recorded until it shows "
            f"{rfc3339(self._last_s)} again; start the site again to record at once"
        )
        logger.error("%s; people are tracked all the same", self._set_back)
        with self._lock:
            if self._lost_after_s is None:
                self._lost_after_s, self._lost_for = self._last_s, self._set_back

    def _write_parts(self) -> None:
        pause_s = self._part_s
        while not self._stop.wait(pause_s):
            began_s = time.monotonic()
            try:
                self._flush()
            except Error as error:
                self._failed(str(error))
            except Exception as error:  # the thread must go on
                logger.exception("a part of the recording cannot be written; it is left out")
                self._failed(f"{type(error).__name__}: {error}")
                self._give_up_batch()
            pause_s = max(0.0, self._part_s - (time.monotonic() - began_s))

    def _failed(self, fault: str) -> None:
        if self._fault is None:
            logger.error("%s; people are tracked all the same, and it is tried again", fault)
        self._fault = fault

    def _give_up_batch(self) -> None:
        with self._lock:
            if self._batches:
                batch = self._batches.popleft()
                self._waiting_people -= sum(1 + len(one.id) for one in batch.moments)

    def _flush(self) -> None:
        """Write all that waits."""
        self._take_waiting()
        while self._batches:
            batch = self._batches[0]
            self._write_part(batch)
            with self._lock:
                self._batches.popleft()
                self._waiting_people -= sum(1 + len(one.id) for one in batch.moments)
        self._write_gaps()
        if self._fault is not None:
            logger.warning("recording again")
            self._fault = None

    def _take_waiting(self) -> None:
        with self._lock:
            moments = list(self._waiting)
            self._waiting.clear()
        for moment in moments:
            if moment.t_s - self._segment_from_s >= self._segment_s:
                self._segment_from_s = moment.t_s
                self._number += 1
                self._part = 0
            last = self._batches[-1] if self._batches else None
            if last is None or last.segment != self._number or moment is moments[0]:
                self._part += 1
                self._batches.append(last := _Batch(self._number, self._part, []))
            last.moments.append(moment)

    def _write_part(self, batch: _Batch) -> None:
        self._written_number = batch.segment
        began_s = time.perf_counter()
        folder = self._parts / segment_name(batch.segment)
        part = folder / f"{batch.part:06d}{SUFFIX}"
        with disk_faults(part, running=True):
            folder.mkdir(mode=PRIVATE_FOLDER, parents=True, exist_ok=True)
            write_compact(part, [compact_table(batch.moments, self._info.skeleton)], self._info)
        self._stored_s = batch.moments[-1].t_s
        took_s, age_s = time.perf_counter() - began_s, time.time() - self._stored_s
        self.writing.add(time.monotonic(), 1e3 * took_s, 1e3 * age_s)

    def _write_gaps(self) -> None:
        with self._lock:
            gaps, self._gaps = self._gaps, []
        if gaps:
            try:
                add_gaps(self._path.parent, gaps)
            except Error:
                with self._lock:
                    self._gaps = [*gaps, *self._gaps]
                raise

    def _merge(self) -> None:
        with suppress(OSError, AttributeError):
            os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), _LOW_PRIORITY)
        told: list[str] = []
        while not self._stop.wait(self._part_s * self._parts_of_a_minute / 2.0):
            faults = []
            for task in (self._merge_once, self._chores):  # on a full disk only deleting helps
                try:
                    task()
                except Exception as error:  # what is there stays as it is, and it is tried again
                    faults.append(str(error))
            for fault in faults:
                if fault not in told:
                    logger.warning("recordings cannot be tidied up: %s", fault)
            told = faults

    def _merge_once(self, *, everything: bool = False) -> None:
        """Complete the segments that are over; merge parts of the one that is written."""
        current = self._written_number
        for number, folder in part_folders(self._parts).items():
            if number < current or everything:
                self._people = complete_segment(
                    self._parts, number, self._info, self._people, self._parts_of_a_minute
                )
            else:
                with changing(self._parts):
                    while merge_parts(folder, self._info, self._parts_of_a_minute):
                        pass

    def close(self) -> None:
        """Complete the recording: merge it and rename it to its final name.

        Raises
        ------
        SetupError
            When the disk has no room or does not work; what was recorded is kept.
        """
        if self._stop.is_set():
            return
        self._end_threads()
        try:
            with disk_faults(self._path, running=True):
                self._flush()
                self._merge_once(everything=True)
                with changing(self._parts):
                    self._take_name()
        except SetupError as error:
            raise with_kept(error, self._parts) from error
        finally:
            self._claim.release()

    def abandon(self) -> None:
        """End early: keep the content in the folder of parts."""
        if self._stop.is_set():
            return
        self._end_threads()
        try:
            self._flush()
        finally:
            self._claim.release()

    def _end_threads(self) -> None:
        self._stop.set()
        for thread in self._threads:
            thread.join()

    def _take_name(self) -> None:
        files = segment_files(self._parts)
        if len(files) > 1:
            self._claim.release()
            if self._path.is_file():
                self._path.unlink()
            self._parts.rename(self._path)
        elif files:
            for file in files.values():
                file.replace(self._path)
            remove_parts(self._parts)
        else:
            write_compact(self._path, [], self._info)
            remove_parts(self._parts)
        sync_directory(self._path.parent)


def _end_of(parts: Path) -> float:
    """Return the last time of a recording that is continued [s]; -inf if there is none.

    Raises
    ------
    InputError
        When it has another format.
    """
    if not files_in(parts):
        return -math.inf
    check_continued(parts)
    return max((one.contents.last_s for one in recording_segments(parts)), default=-math.inf)
