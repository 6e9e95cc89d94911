"""Tracks as a tidy CSV file: `t_s,person,joint,x_m,y_m,z_m,sigma_m,support`.

Numbers are the shortest decimals that give the same float32 (`t_s`: float64), so CSV and Parquet
hold the same numbers. An unknown joint is ``nan``.
"""

import csv
import io
import re
import time
from collections.abc import Callable, Iterator, Sequence
from difflib import get_close_matches
from pathlib import Path
from typing import IO

import numpy as np
import pyarrow as pa
from pyarrow import csv as pa_csv

from trecsim.errors import InputError
from trecsim.skeleton import COCO17, HALPE26, Skeleton
from trecsim.store.atomic import opened_for_reading
from trecsim.store.growing import GrowingFile, KeepsPartial, without_cut_line
from trecsim.store.native import native_reader
from trecsim.store.row_faults import raise_faults
from trecsim.store.rows import (
    COLUMNS,
    MAY_BE_MISSING,
    SCHEMA,
    Rows,
    confirmed_only,
    rows_in,
    rows_of,
    snapshots_of,
    table_of,
)
from trecsim.values import Snapshot

_MISSING = ["", "nan", "NaN", "NA"]  # what we, pandas and R write
_AS_TEXT = SCHEMA.set(SCHEMA.get_field_index("joint"), pa.field("joint", pa.string(), False))
_BUFFERED_ROWS = 4096
_HEAD_BYTES = 1 << 16  # holds the joints of the first people
_CHUNK_BYTES = 1 << 20


class CsvWriter(KeepsPartial):
    """Writes tracks as CSV; a crash loses at most the last two seconds.

    The rows go to ``NAME.partial``, which gets its final name when the block ends without an error.

    Parameters
    ----------
    path
        The file to write.
    skeleton
        Names of the joints.
    clock
        Returns the time [s].
    provisional
        Whether provisional people are written; the file does not say who is one.

    Raises
    ------
    InputError
        When the place cannot be written to.
    SetupError
        When the disk has no room.
    """

    def __init__(
        self,
        path: Path,
        skeleton: Skeleton = COCO17,
        *,
        clock: Callable[[], float] = time.monotonic,
        provisional: bool = False,
    ) -> None:
        self._provisional = provisional
        self._file = GrowingFile(path, (",".join(COLUMNS) + "\n").encode(), clock=clock)
        self._skeleton = skeleton
        self._rows: list[Rows] = []

    def write(self, snapshot: Snapshot) -> None:
        """Append one snapshot."""
        self._rows += map(rows_of, [snapshot] if self._provisional else confirmed_only([snapshot]))
        if self._file.due or sum(map(len, self._rows)) >= _BUFFERED_ROWS:
            self._write_rows()

    def _write_rows(self) -> None:
        if not self._rows:
            return
        rows = np.concatenate(self._rows)
        self._rows.clear()
        text = io.BytesIO()
        table = table_of(rows, self._skeleton).cast(_AS_TEXT)
        options = pa_csv.WriteOptions(include_header=False, quoting_style="none")
        pa_csv.write_csv(table, text, write_options=options)
        self._file.write(text.getvalue())

    def close(self) -> None:
        """Complete the file: rename it to its final name."""
        with self._file:
            self._write_rows()

    def abandon(self) -> None:
        """End early: keep the content in ``NAME.partial``."""
        try:
            self._write_rows()
        finally:
            self._file.abandon()


def csv_skeleton(path: Path) -> Skeleton:
    """Return the skeleton of a file of tracks: the joints of its first people tell it."""
    with opened_for_reading(path) as file:
        head = file.read(_HEAD_BYTES)
    more = set(HALPE26.joints) - set(COCO17.joints)
    head = head.replace(b'"', b"")  # R quotes texts
    field = rb"(?:^|[,\n])(?:" + "|".join(more).encode() + rb")(?:$|[,\r\n])"
    return HALPE26 if re.search(field, head) else COCO17


def read_csv(path: Path, skeleton: Skeleton = COCO17) -> Iterator[Snapshot]:
    """Read tracks, one snapshot per time, in bounded memory.

    Parameters
    ----------
    path
        A file with the columns of the contract, in any order.
    skeleton
        The joints that may occur.

    Raises
    ------
    InputError
        When the file is missing or wrong; the message names the lines.
    """
    with opened_for_reading(path) as file:
        yield from snapshots_of(_blocks(file, path, skeleton), skeleton, path, unit="line", first=2)


def _blocks(file: IO[bytes], path: Path, skeleton: Skeleton) -> Iterator[Rows]:
    header = without_cut_line(file.readline(_CHUNK_BYTES), path)
    if not header and path.suffix == ".partial":
        return
    columns = _columns(path, header)
    line = 2
    for chunk in _chunks(file, path):
        try:
            yield _parse(chunk, columns, skeleton)
        except (pa.ArrowInvalid, ValueError) as error:
            raise_faults(path, list(_diagnose(chunk, columns, line, skeleton)), "line")
            raise InputError(f"{path}: after line {line}: {error}") from None
        line += chunk.count(b"\n")


def _columns(path: Path, header: bytes) -> list[str]:
    text = header.decode("utf-8-sig", errors="replace")
    try:
        found = next(csv.reader([text.rstrip("\r\n")]), [])
    except csv.Error as error:
        raise InputError(
            f"{path}: line 1: expected the columns {','.join(COLUMNS)}: {error}"
        ) from None
    if sorted(found) == sorted(COLUMNS):
        return found
    faults = [f"the column {name!r} is missing" for name in COLUMNS if name not in found]
    for name in found:
        if name not in COLUMNS:
            near = get_close_matches(name, COLUMNS, n=1)
            hint = f"; did you mean {near[0]!r}?" if near else ""
            faults.append(f"unknown column {name[:40]!r}{hint}")
    told = "; ".join(faults[:8]) or "a column is there twice"
    raise InputError(f"{path}: line 1: expected the columns {','.join(COLUMNS)}: {told}")


def _chunks(file: IO[bytes], path: Path) -> Iterator[bytes]:
    rest = b""
    while more := file.read(_CHUNK_BYTES):
        whole, end, rest = (rest + more).rpartition(b"\n")
        if whole:
            yield whole + end
        elif len(rest) > 2 * _CHUNK_BYTES:
            raise InputError(f"{path}: a line is longer than {_CHUNK_BYTES} bytes; not a CSV file")
    if rest := without_cut_line(rest, path):
        yield rest


def _parse(chunk: bytes, columns: Sequence[str], skeleton: Skeleton) -> Rows:
    table = pa_csv.read_csv(
        native_reader(chunk),
        pa_csv.ReadOptions(column_names=columns, use_threads=False, block_size=len(chunk) + 1),
        pa_csv.ParseOptions(ignore_empty_lines=False),
        pa_csv.ConvertOptions(
            column_types={field.name: field.type for field in _AS_TEXT}, null_values=_MISSING
        ),
    )
    return rows_in(table, skeleton)


def _diagnose(
    chunk: bytes, columns: Sequence[str], line: int, skeleton: Skeleton
) -> Iterator[tuple[int, str]]:
    for number, raw in enumerate(chunk.splitlines(), start=line):
        try:
            values = next(csv.reader([raw.decode()], strict=True), [])
        except UnicodeDecodeError:
            yield number, "not UTF-8 text"
            continue
        except csv.Error as error:
            yield number, str(error)
            continue
        if len(values) != len(columns):
            yield number, f"expected {len(columns)} values, found {len(values)}"
            continue
        for name, value in zip(columns, values, strict=True):
            if fault := _value_fault(name, value, skeleton):
                yield number, fault


def _value_fault(name: str, value: str, skeleton: Skeleton) -> str | None:
    shown = value if len(value) < 40 else value[:37] + "..."
    if name == "joint":
        if value in skeleton.joints:
            return None
        near = get_close_matches(value, skeleton.joints, n=1)
        hint = f"; did you mean {near[0]!r}?" if near else ""
        return f"joint: {shown!r} is not in the skeleton {skeleton.name}{hint}"
    if value in _MISSING:
        return None if name in MAY_BE_MISSING else f"{name}: a value is missing"
    convert: Callable[[str], float] = int if name in ("person", "support") else float
    kind = "a whole number" if convert is int else "a number"
    try:
        number = convert(value)
    except ValueError:
        return f"{name}: expected {kind}, found {shown!r}"
    if name == "support" and not 0 <= number < 1 << 16:
        return f"support: expected a number of cameras, found {shown}"
    if name == "person" and not -(1 << 63) <= number < 1 << 63:
        return f"person: {shown} is too large"
    return None
