"""Writes one Parquet file of tracks, in row groups."""

import json
from collections.abc import Iterable, Iterator
from io import BytesIO
from pathlib import Path
from typing import IO

import pyarrow as pa
from pyarrow import parquet as pq

from trecsim.store.atomic import atomic_write
from trecsim.store.parquet_file import FORMAT, ROWS_OF_A_GROUP, TracksInfo
from trecsim.store.rows import COVARIANCE, DETAIL_SCHEMA, MAY_BE_MISSING, SCHEMA, VELOCITY

_SPLIT = (*MAY_BE_MISSING, *VELOCITY, *COVARIANCE)


def parquet_file(file: IO[bytes] | BytesIO, info: TracksInfo) -> pq.ParquetWriter:
    """Open a Parquet writer; the file is readable once the writer is closed."""
    schema = DETAIL_SCHEMA if info.details else SCHEMA
    facts = {
        "format": FORMAT,
        "skeleton": info.skeleton.name,
        "unit": "m",
        "rig_sha256": info.rig_sha256,
    }
    return pq.ParquetWriter(
        file,
        schema.with_metadata({"trecsim": json.dumps(facts)}),
        compression="zstd",
        use_byte_stream_split=[name for name in schema.names if name in _SPLIT],
        use_dictionary=[name for name in schema.names if name not in _SPLIT],
    )


def write_file(path: Path, tables: Iterable[pa.Table], info: TracksInfo) -> None:
    """Write tables to one file, one row group at a time."""
    with atomic_write(path, "wb", private=True) as file:
        write_file_to(file, tables, info)


def write_file_to(file: IO[bytes], tables: Iterable[pa.Table], info: TracksInfo) -> None:
    """Write tables to an open file, one row group at a time."""
    with parquet_file(file, info) as writer:
        for table in _regrouped(tables):
            write_group(writer, table)


def write_group(writer: pq.ParquetWriter, table: pa.Table) -> None:
    """Append a row group."""
    writer.write_table(table.cast(writer.schema))


def _regrouped(tables: Iterable[pa.Table]) -> Iterator[pa.Table]:
    waiting: list[pa.Table] = []
    for table in tables:
        waiting.append(table)
        if sum(map(len, waiting)) >= ROWS_OF_A_GROUP:
            yield joined(waiting)
            waiting.clear()
    if waiting:
        yield joined(waiting)


def joined(tables: list[pa.Table]) -> pa.Table:
    """Concatenate tables."""
    return pa.concat_tables(tables).unify_dictionaries().combine_chunks()
