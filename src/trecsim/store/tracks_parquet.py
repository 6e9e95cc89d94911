"""Tracks as Parquet: the rows of the CSV file, compact, and safe against a crash at any moment.

A Parquet file without its footer is unreadable, and the footer is written last. So while a
recording runs, a complete small file goes into a directory beside it every two seconds::

    tracks.parquet.parts/000001.parquet
    tracks.parquet.parts/000002.parquet

At the end they are merged into ``tracks.parquet`` and removed. After a crash, even by SIGKILL or
loss of power, the parts are there, every one of them whole, and :func:`read_parquet` reads them
in place of the missing file; lost are the seconds since the last part. A recording that ends with
an error keeps its parts, so that an unfinished recording never looks like a finished one.

The columns are those of the CSV file, which pandas, R, DuckDB and others open as they are;
positions and uncertainties are float32, stored byte by byte (BYTE_STREAM_SPLIT) and compressed
with Zstandard: about 210 bytes per person and moment. See ``docs/decisions/``.
"""

import json
import shutil
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from pyarrow import parquet as pq

from trecsim.errors import InputError, SetupError
from trecsim.skeleton import COCO17, SKELETONS, Skeleton
from trecsim.store.atomic import atomic_write, disk_faults, opened_for_reading
from trecsim.store.rows import (
    COLUMNS,
    ROW,
    SCHEMA,
    Rows,
    rows_in,
    rows_of,
    snapshots_of,
    table_of,
)
from trecsim.values import Snapshot

FORMAT = "trecsim.tracks/1"

_SPLIT = ["x_m", "y_m", "z_m", "sigma_m"]
_ROWS_OF_A_GROUP = 1 << 18
_ROWS_OF_A_PART = 1 << 18
_BATCH_ROWS = 1 << 16


@dataclass(frozen=True, slots=True)
class TracksInfo:
    """What a Parquet file of tracks says about itself.

    Attributes
    ----------
    skeleton
        The joints of its people.
    rig_sha256
        Digest of the rig it was made with; None when that is not known.
    """

    skeleton: Skeleton = COCO17
    rig_sha256: str | None = None


class _PartWriter:
    """Collects rows and writes them as complete files, one after the other."""

    def __init__(
        self, folder: Path, info: TracksInfo, part_s: float, clock: Callable[[], float]
    ) -> None:
        self._folder = folder
        self._info = info
        self._part_s = part_s
        self._clock = clock
        self._began_s = clock()
        self._rows: list[Rows] = []
        self._parts = 0

    def write(self, snapshot: Snapshot) -> None:
        self._rows.append(rows_of(snapshot))
        old = self._clock() - self._began_s >= self._part_s
        if old or sum(map(len, self._rows)) >= _ROWS_OF_A_PART:
            self.flush()

    def flush(self) -> None:
        self._began_s = self._clock()
        rows = np.concatenate(self._rows) if self._rows else np.empty(0, ROW)
        self._rows.clear()
        if len(rows):
            self._parts += 1
            part = self._folder / f"{self._parts:06d}.parquet"
            _write_file(part, [table_of(rows, self._info.skeleton)], self._info)


@contextmanager
def parquet_writer(
    path: Path,
    info: TracksInfo = TracksInfo(),
    *,
    part_s: float = 2.0,
    clock: Callable[[], float] = time.monotonic,
) -> Iterator[_PartWriter]:
    """Open a recording of tracks; whatever happens, what is older than `part_s` is on the disk.

    Parameters
    ----------
    path
        The file that will hold the whole recording; until then see :func:`parts_of`.
    info
        What the file shall say about itself.
    part_s
        A crash costs at most this much [s].
    clock
        Tells the time [s].

    Raises
    ------
    InputError
        When the place is wrong, or holds parts of a recording that has not ended.
    SetupError
        When the disk has no room; what was written before is kept.
    """
    parts = _begin(path)
    writer = _PartWriter(parts, info, part_s, clock)
    try:
        try:
            yield writer
        finally:
            writer.flush()
        write_parquet(path, _tables(_files(parts)), info)
        shutil.rmtree(parts)
    except SetupError as error:
        if _files(parts):
            raise SetupError(f"{error}; what was recorded is kept in {parts}") from error
        raise
    finally:
        with suppress(OSError):  # there is something in it, and that is kept
            parts.rmdir()


def parts_of(path: Path) -> Path:
    """Return the directory that holds the recording `path` until it is complete."""
    return path.with_name(path.name + ".parts")


def write_parquet(path: Path, tables: Iterable[pa.Table], info: TracksInfo) -> None:
    """Write one complete file from tables, one after the other, in little memory."""
    _write_file(path, _regrouped(tables), info)


def tables_of(snapshots: Iterable[Snapshot], skeleton: Skeleton) -> Iterator[pa.Table]:
    """Lay snapshots out as tables of a convenient size."""
    rows: list[Rows] = []
    for snapshot in snapshots:
        rows.append(rows_of(snapshot))
        if sum(map(len, rows)) >= _BATCH_ROWS:
            yield table_of(np.concatenate(rows), skeleton)
            rows.clear()
    if rows:
        yield table_of(np.concatenate(rows), skeleton)


def read_parquet(path: Path) -> Iterator[Snapshot]:
    """Read tracks one moment at a time; of an unfinished recording, read its parts.

    Parameters
    ----------
    path
        A Parquet file of tracks, complete or not, or a directory of parts.

    Raises
    ------
    InputError
        When there is no such recording, or it is not right.
    """
    files = _files_of(path)
    skeleton = read_info(path).skeleton
    blocks = (_rows(table, file, skeleton) for file in files for table in _batches(file))
    yield from snapshots_of(blocks, skeleton, path, unit="row", first=1)


def read_info(path: Path) -> TracksInfo:
    """Read what a recording says about itself; a file written by others says nothing.

    Raises
    ------
    InputError
        When it is not a Parquet file, or of a format that is not known.
    """
    files = _files_of(path)
    if not files:
        return TracksInfo()
    with _opened(files[0]) as file:
        metadata = (file.schema_arrow.metadata or {}).get(b"trecsim", b"{}")
    try:
        facts = json.loads(metadata)
        made = facts.get("format", FORMAT)
        skeleton = SKELETONS[facts.get("skeleton", COCO17.name)]
    except (ValueError, AttributeError, KeyError, TypeError, RecursionError):
        raise InputError(f"{path}: its note for trecsim is damaged: {metadata[:80]!r}") from None
    if made != FORMAT:
        raise InputError(f"{path}: expected the format {FORMAT!r}, found {made!r}")
    return TracksInfo(skeleton, facts.get("rig_sha256"))


def _begin(path: Path) -> Path:
    parts = parts_of(path)
    with disk_faults(parts):
        parts.mkdir(exist_ok=True)
        if any(parts.iterdir()):
            raise InputError(
                f"{parts} holds a recording that has not ended: keep it with "
                f"`trecsim export {parts} OUT.parquet`, then delete the directory"
            )
    return parts


def _files_of(path: Path) -> list[Path]:
    if path.is_dir():
        return _files(path)
    if not path.exists() and parts_of(path).is_dir():
        return _files(parts_of(path))
    return [path]


def _files(parts: Path) -> list[Path]:
    return sorted(parts.glob("[0-9]*.parquet"))


def _write_file(path: Path, tables: Iterable[pa.Table], info: TracksInfo) -> None:
    facts = {
        "format": FORMAT,
        "skeleton": info.skeleton.name,
        "unit": "m",
        "rig_sha256": info.rig_sha256,
    }
    schema = SCHEMA.with_metadata({"trecsim": json.dumps(facts)})
    with (
        atomic_write(path, "wb") as file,
        pq.ParquetWriter(
            file,
            schema,
            compression="zstd",
            use_byte_stream_split=_SPLIT,
            use_dictionary=[name for name in COLUMNS if name not in _SPLIT],
        ) as writer,
    ):
        for table in tables:
            writer.write_table(table.cast(schema))


def _regrouped(tables: Iterable[pa.Table]) -> Iterator[pa.Table]:
    waiting: list[pa.Table] = []
    for table in tables:
        waiting.append(table)
        if sum(map(len, waiting)) >= _ROWS_OF_A_GROUP:
            yield _joined(waiting)
            waiting.clear()
    if waiting:
        yield _joined(waiting)


def _joined(tables: list[pa.Table]) -> pa.Table:
    return pa.concat_tables(tables).unify_dictionaries().combine_chunks()


def _tables(files: Iterable[Path]) -> Iterator[pa.Table]:
    return (table for file in files for table in _batches(file))


@contextmanager
def _opened(path: Path) -> Iterator[Any]:
    with opened_for_reading(path) as stream, _arrow_faults(path):
        yield pq.ParquetFile(stream)


@contextmanager
def _arrow_faults(path: Path) -> Iterator[None]:
    try:
        yield
    except (pa.ArrowException, OSError, ValueError) as error:
        reason = " ".join(str(error).split())[:200]
        raise InputError(f"{path} is not a readable Parquet file of tracks: {reason}") from None


def _batches(path: Path) -> Iterator[pa.Table]:
    with _opened(path) as file:
        missing = [name for name in COLUMNS if name not in file.schema_arrow.names]
        if missing:
            raise InputError(
                f"{path}: expected the columns {', '.join(COLUMNS)}; missing: {', '.join(missing)}"
            )
        for batch in file.iter_batches(_BATCH_ROWS, columns=list(COLUMNS)):
            yield pa.Table.from_batches([batch])


def _rows(table: pa.Table, path: Path, skeleton: Skeleton) -> Rows:
    with _arrow_faults(path):
        return rows_in(table, skeleton)
