"""One Parquet file of tracks: what it says about itself, and its rows between two times."""

import json
import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from pyarrow import parquet as pq

from trecsim.errors import InputError
from trecsim.skeleton import COCO17, SKELETONS, Skeleton
from trecsim.store.arrow_arrays import numbers_of
from trecsim.store.atomic import opened_for_reading
from trecsim.store.native import native_file
from trecsim.store.rows import (
    COLUMNS,
    DETAIL_SCHEMA,
    DETAILS,
    Rows,
    rows_in,
)
from trecsim.values import Snapshot

FORMAT = "trecsim.tracks/1"
SIX_COVARIANCES_FORMAT = "trecsim.tracks/2"
COMPACT_FORMAT = "trecsim.tracks/3"
FORMATS = (FORMAT, SIX_COVARIANCES_FORMAT, COMPACT_FORMAT)
ROWS_OF_A_GROUP = 1 << 19

_FORMAT_NAME = "trecsim.tracks/"

_BATCH_ROWS = 1 << 16


@dataclass(frozen=True, slots=True)
class TracksInfo:
    """Metadata of a Parquet file of tracks.

    Attributes
    ----------
    skeleton
        The joints of its people.
    rig_sha256
        Digest of the rig; None when unknown.
    details
        Whether it holds states, velocities and covariances beside the columns of the CSV file.
    format
        Name of its version.
    """

    skeleton: Skeleton = COCO17
    rig_sha256: str | None = None
    details: bool = True
    format: str = COMPACT_FORMAT

    @property
    def is_compact(self) -> bool:
        """Whether its numbers are rounded: see `trecsim.store.precision`."""
        return self.format != FORMAT


@dataclass(frozen=True, slots=True)
class Contents:
    """Extent of a Parquet file of tracks.

    Attributes
    ----------
    rows
        Number of rows: one per time, person and joint.
    first_s, last_s
        Its first and last time [s]; NaN when it is empty.
    highest_person
        Its highest identity; -1 when it is empty.
    people, new_people
        Number of identities that were not only provisional, and of those among them that the
        segment before does not hold; -1 where they were not counted.
    """

    rows: int = 0
    first_s: float = math.nan
    last_s: float = math.nan
    highest_person: int = -1
    people: int = -1
    new_people: int = -1

    def overlaps(self, from_s: float, until_s: float) -> bool:
        """Return whether it overlaps the time between two times, both included [s]."""
        return self.rows > 0 and self.first_s <= until_s and self.last_s >= from_s

    def with_moments(self, moments: Sequence[Snapshot]) -> "Contents":
        """Return the extent after snapshots with people were appended."""
        if not moments:
            return self
        return Contents(
            self.rows + sum(one.support.size for one in moments),
            moments[0].t_s if self.rows == 0 else self.first_s,
            moments[-1].t_s,
            max(self.highest_person, *(int(one.id.max()) for one in moments)),
        )


def read_file_info(path: Path) -> TracksInfo:
    """Read the metadata of a file; files of other programs have none, and get the default.

    Raises
    ------
    InputError
        When it is not a Parquet file, or of a format that is not known.
    """
    with opened(path) as file:
        metadata = (file.schema_arrow.metadata or {}).get(b"trecsim", b"{}")
        details = set(file.schema_arrow.names).issuperset(DETAILS)
    try:
        facts = json.loads(metadata)
        made = facts.get("format", FORMAT)
        skeleton = SKELETONS[facts.get("skeleton", COCO17.name)]
    except (ValueError, AttributeError, KeyError, TypeError, RecursionError):
        raise InputError(f"{path}: its note for trecsim is damaged: {metadata[:80]!r}") from None
    if made not in FORMATS:
        newer = str(made).startswith(_FORMAT_NAME) and str(made)[len(_FORMAT_NAME) :].isdecimal()
        why = "; it was made by a newer trecsim: install that one" if newer else ""
        raise InputError(
            f"{path}: expected one of the formats {', '.join(FORMATS)}, found {made!r}{why}"
        )
    return TracksInfo(skeleton, facts.get("rig_sha256"), details, made)


def read_contents(path: Path) -> Contents:
    """Read the extent of a file from its footer, or from its rows if there are no statistics.

    Raises
    ------
    InputError
        When it is not a Parquet file of tracks.
    """
    with opened(path) as file:
        check_columns(file, path)
        rows = file.metadata.num_rows
        if rows == 0:
            return Contents()
        first_s, last_s = _extent(file, "t_s")
        _, highest = _extent(file, "person")
    nobody = math.isnan(highest)
    first_s, last_s = first_s + 0.0, last_s + 0.0  # the statistics of Parquet write 0 as -0
    return Contents(rows, float(first_s), float(last_s), -1 if nobody else int(highest))


def _extent(file: pq.ParquetFile, name: str) -> tuple[float, float]:
    """Return the smallest and largest number in a column; NaN where it is empty."""
    groups = [_statistics(file, name, group) for group in range(file.num_row_groups)]
    known = [one for one in groups if one is not None]
    if len(known) < len(groups):  # others write files without statistics
        numbers = numbers_of(file.read(columns=[name])[name].drop_null())
        if not len(numbers):
            return math.nan, math.nan
        return numbers.min().item(), numbers.max().item()
    return min(low for low, _ in known), max(high for _, high in known)


def _statistics(file: pq.ParquetFile, name: str, group: int) -> tuple[float, float] | None:
    row_group = file.metadata.row_group(group)
    for number in range(row_group.num_columns):
        column = row_group.column(number)
        if column.path_in_schema == name:
            found = column.statistics
            return (found.min, found.max) if found is not None and found.has_min_max else None
    return None


def read_file(
    path: Path, from_s: float = -math.inf, until_s: float = math.inf
) -> Iterator[pa.Table]:
    """Read the rows between two times, both included, in tables of a convenient size.

    Row groups in which nothing lies between the times are not read.

    Raises
    ------
    InputError
        When the file is not a Parquet file of tracks.
    """
    with opened(path) as file:
        check_columns(file, path)
        everything = from_s == -math.inf and until_s == math.inf
        groups = groups_between(file, from_s, until_s)
        columns = [name for name in file.schema_arrow.names if name in DETAIL_SCHEMA.names]
        for batch in file.iter_batches(_BATCH_ROWS, row_groups=groups, columns=columns):
            table = pa.Table.from_batches([batch])
            yield table if everything else _between(table, from_s, until_s)


def file_groups(path: Path, columns: Sequence[str] | None = None) -> Iterator[pa.Table]:
    """Read the row groups of a file, with those of the columns that it has, or all.

    Raises
    ------
    InputError
        When it is not a Parquet file of tracks.
    """
    with opened(path) as file:
        check_columns(file, path)
        everything = file.schema_arrow.names
        there = [name for name in everything if columns is None or name in columns]
        for group in range(file.num_row_groups):
            yield file.read_row_group(group, columns=there, use_threads=False)


def groups_between(file: pq.ParquetFile, from_s: float, until_s: float) -> list[int]:
    """Return the row groups that may hold something between two times, both included."""
    everything = from_s == -math.inf and until_s == math.inf
    return [
        group
        for group in range(file.num_row_groups)
        if everything or _may_overlap(_statistics(file, "t_s", group), from_s, until_s)
    ]


def _may_overlap(extent: tuple[float, float] | None, from_s: float, until_s: float) -> bool:
    return extent is None or (extent[0] <= until_s and extent[1] >= from_s)


def _between(table: pa.Table, from_s: float, until_s: float) -> pa.Table:
    t_s = table["t_s"].cast(pa.float64()).to_numpy()
    inside = (t_s >= from_s) & (t_s <= until_s)
    return table if inside.all() else table.take(pa.array(np.flatnonzero(inside)))


def file_rows(
    path: Path, skeleton: Skeleton, from_s: float = -math.inf, until_s: float = math.inf
) -> Iterator[Rows]:
    """Read the rows between two times, both included.

    Raises
    ------
    InputError
        When the file is not right.
    """
    for table in read_file(path, from_s, until_s):
        with arrow_faults(path):
            rows = rows_in(table, skeleton)
        yield rows


def check_columns(file: pq.ParquetFile, path: Path) -> None:
    """Refuse a file without the columns of tracks.

    Raises
    ------
    InputError
        When one is missing.
    """
    missing = [name for name in COLUMNS if name not in file.schema_arrow.names]
    if missing:
        raise InputError(
            f"{path}: expected the columns {', '.join(COLUMNS)}; missing: {', '.join(missing)}"
        )


@contextmanager
def opened(path: Path) -> Iterator[Any]:
    """Open a Parquet file.

    Raises
    ------
    InputError
        When it cannot be read, or is damaged.
    """
    with opened_for_reading(path):  # it tells better than Arrow why a file cannot be opened
        pass
    with arrow_faults(path), native_file(path) as file:
        yield pq.ParquetFile(file)


@contextmanager
def arrow_faults(path: Path) -> Iterator[None]:
    """Turn Arrow's errors about a damaged file into our own.

    Raises
    ------
    InputError
        When the file is damaged.
    """
    try:
        yield
    except (pa.ArrowException, OSError, ValueError) as error:
        reason = " ".join(str(error).split())[:200]
        raise InputError(f"{path} is not a readable Parquet file of tracks: {reason}") from None
