"""One Parquet file of compact tracks."""

import inspect
import json
import math
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import IO, Any

import pyarrow as pa
from pyarrow import parquet as pq

from trecsim.skeleton import Skeleton
from trecsim.store.atomic import atomic_write
from trecsim.store.compact import COMPACT_SCHEMA, DECIMALS, moments_in, sorted_by_person
from trecsim.store.parquet_file import (
    COMPACT_FORMAT,
    TracksInfo,
    arrow_faults,
    check_columns,
    file_groups,
    groups_between,
    opened,
)
from trecsim.values import Snapshot

_ONE_PAGE = 1 << 22  # rows and bytes: times repeat from person to person, which a page must span
_HAS_ROWS_OF_A_PAGE = "max_rows_per_page" in inspect.signature(pq.ParquetWriter).parameters


def compact_writer(file: IO[bytes], info: TracksInfo) -> pq.ParquetWriter:
    """Open a Parquet writer; the file is readable once the writer is closed."""
    facts = {
        "format": COMPACT_FORMAT,
        "skeleton": info.skeleton.name,
        "unit": "m",
        "rig_sha256": info.rig_sha256,
    }
    more: dict[str, Any] = {"max_rows_per_page": _ONE_PAGE} if _HAS_ROWS_OF_A_PAGE else {}
    return pq.ParquetWriter(
        file,
        COMPACT_SCHEMA.with_metadata({"trecsim": json.dumps(facts)}),
        compression="zstd",
        use_dictionary=["person", "joint", "support", "state"],
        column_encoding={"t_s": "PLAIN", **dict.fromkeys(DECIMALS, "DELTA_BINARY_PACKED")},
        write_statistics=["t_s", "person"],
        store_decimal_as_integer=True,
        data_page_size=_ONE_PAGE,
        **more,
    )


def write_compact(path: Path, tables: Iterable[pa.Table], info: TracksInfo) -> None:
    """Write tables to one file, each as a row group."""
    with (
        atomic_write(path, "wb", private=True) as file,
        compact_writer(file, info) as writer,
    ):
        for table in tables:
            writer.write_table(table, row_group_size=max(len(table), 1))


def compact_groups(path: Path) -> Iterator[pa.Table]:
    """Read the row groups of a file.

    Raises
    ------
    InputError
        When it is not a Parquet file of tracks.
    """
    return file_groups(path, COMPACT_SCHEMA.names)


def merged(paths: Iterable[Path]) -> pa.Table:
    """Read files of consecutive times as one table, sorted by person, joint and time.

    Raises
    ------
    InputError
        When one of them is not a Parquet file of tracks.
    """
    tables = [table for path in paths for table in compact_groups(path)]
    return sorted_by_person(pa.concat_tables(tables).unify_dictionaries())


def compact_moments(
    path: Path, skeleton: Skeleton, from_s: float = -math.inf, until_s: float = math.inf
) -> Iterator[Snapshot]:
    """Read the moments between two times, both included, in the order of time.

    Row groups in which nothing lies between the times are not read.

    Raises
    ------
    InputError
        When the file is not right.
    """
    with opened(path) as file:
        check_columns(file, path)
        for group in groups_between(file, from_s, until_s):
            with arrow_faults(path):
                table = file.read_row_group(group, columns=COMPACT_SCHEMA.names)
                yield from moments_in(_between(table, from_s, until_s), skeleton)


def _between(table: pa.Table, from_s: float, until_s: float) -> pa.Table:
    t_s = table["t_s"].cast(pa.float64()).to_numpy()
    outside = (t_s < from_s) | (t_s > until_s)  # not NaN, which is a fault
    return table.filter(pa.array(~outside)) if outside.any() else table
