"""One Parquet file of compact tracks."""

import inspect
import json
import math
from collections.abc import Iterable, Iterator
from io import BytesIO
from itertools import chain
from pathlib import Path
from typing import IO, Any

import pyarrow as pa
from pyarrow import parquet as pq

from trecsim.skeleton import Skeleton
from trecsim.store.atomic import atomic_write
from trecsim.store.compact import COMPACT_SCHEMA, joined, moments_in
from trecsim.store.parquet_file import (
    COMPACT_FORMAT,
    SIX_COVARIANCES_FORMAT,
    TracksInfo,
    arrow_faults,
    check_columns,
    file_groups,
    groups_between,
    opened,
)
from trecsim.store.rows import COVARIANCE
from trecsim.values import Snapshot

_ONE_PAGE = 1 << 22  # rows and bytes: times repeat from person to person, which a page must span
_HAS_ROWS_OF_A_PAGE = "max_rows_per_page" in inspect.signature(pq.ParquetWriter).parameters
_LEVEL = 6  # of Zstandard: covariances take a tenth less room than at 3, in 2 ms more for a minute


def compact_writer(
    file: IO[bytes] | BytesIO, info: TracksInfo, schema: pa.Schema = COMPACT_SCHEMA
) -> pq.ParquetWriter:
    """Open a Parquet writer; the file is readable once the writer is closed.

    Parameters
    ----------
    file
        Where the content goes.
    info
        Metadata.
    schema
        That of the tables: the present one, or that of files which are written anew.
    """
    decimals = [name for name in schema.names if pa.types.is_decimal(schema.field(name).type)]
    floats = [name for name in COVARIANCE if name not in decimals]
    facts = {
        "format": COMPACT_FORMAT if floats else SIX_COVARIANCES_FORMAT,
        "skeleton": info.skeleton.name,
        "unit": "m",
        "rig_sha256": info.rig_sha256,
    }
    more: dict[str, Any] = {"max_rows_per_page": _ONE_PAGE} if _HAS_ROWS_OF_A_PAGE else {}
    deltas = [name for name in decimals if name != "sigma_m"]
    return pq.ParquetWriter(
        file,
        schema.with_metadata({"trecsim": json.dumps(facts)}),
        compression="zstd",
        compression_level=_LEVEL,
        use_dictionary=["person", "joint", "sigma_m", "support", "state"],
        column_encoding={
            "t_s": "PLAIN",
            **dict.fromkeys(deltas, "DELTA_BINARY_PACKED"),
            **dict.fromkeys(floats, "BYTE_STREAM_SPLIT"),
        },
        write_statistics=["t_s", "person"],
        store_decimal_as_integer=True,
        data_page_size=_ONE_PAGE,
        **more,
    )


def write_compact(path: Path, tables: Iterable[pa.Table], info: TracksInfo) -> None:
    """Write tables of one schema to one file, each as a row group."""
    with atomic_write(path, "wb", private=True) as file:
        write_compact_to(file, tables, info)


def write_compact_to(
    file: IO[bytes] | BytesIO, tables: Iterable[pa.Table], info: TracksInfo
) -> None:
    """Write tables of one schema, each as a row group, to an open file."""
    rest = iter(tables)
    first = next(rest, None)
    if first is None:
        first = COMPACT_SCHEMA.empty_table()
    with compact_writer(file, info, first.schema.remove_metadata()) as writer:
        for table in chain([first], rest):
            if len(table):
                writer.write_table(table, row_group_size=len(table))


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
    return joined(table for path in paths for table in compact_groups(path))


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
