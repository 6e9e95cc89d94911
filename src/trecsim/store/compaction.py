"""Merge the parts of a live recording: to minutes, then to the segment of an hour.

Each step leaves the recording complete, whenever it is interrupted: a merged file takes its name
before the files that it replaces are removed, and readers prefer it.
"""

import os
import secrets
import shutil
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow as pa

from trecsim.store.arrow_arrays import filled
from trecsim.store.atomic import PRIVATE_FILE, disk_faults
from trecsim.store.compact_file import compact_groups, merged, write_compact
from trecsim.store.growing import is_file_at, lock_waiting
from trecsim.store.parquet_file import TracksInfo, read_contents
from trecsim.store.segments import (
    SUFFIX,
    Segment,
    merged_name,
    merged_parts,
    part_numbers,
    segment_files,
    segment_name,
    segments_in,
    write_catalogue,
)
from trecsim.values import PROVISIONAL

MOST_ROWS = 2_000_000
"""A minute of more rows is merged in several files: it bounds the memory."""

CHANGING = ".changing"
"""Locked while the files of a recording are changed."""


@contextmanager
def changing(folder: Path) -> Iterator[bool]:
    """Change the files of a recording alone; another program that changes them is waited for.

    Yields
    ------
    False when the recording ended meanwhile, so that `folder` has another name or is gone.
    """
    with disk_faults(folder, running=True):
        handle = os.open(folder / CHANGING, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, PRIVATE_FILE)
    try:
        lock_waiting(handle)
        yield is_file_at(handle, folder / CHANGING)
    finally:
        os.close(handle)


def remove_parts(folder: Path) -> None:
    """Remove what is left in a folder of parts.

    It loses its name first: another program that is about to lock it makes no file in it.
    """
    gone = folder.with_name(f".{folder.name}.{secrets.token_hex(4)}.tmp")
    folder.rename(gone)
    shutil.rmtree(gone)


def merge_parts(folder: Path, info: TracksInfo, at_least: int) -> bool:
    """Merge the oldest parts in the folder of a segment; return False if there are too few.

    Parameters
    ----------
    folder
        The parts.
    info
        Metadata of the file.
    at_least
        So many parts are merged, or less if they have very many rows.

    Raises
    ------
    InputError
        When a part is damaged.
    SetupError
        When the disk has no room.
    """
    with disk_faults(folder, running=True):
        for part in merged_parts(folder):  # a crash came between
            part.unlink(missing_ok=True)
        parts = _unmerged(folder)
        if len(parts) < max(at_least, 2):
            return False
        parts = _of_moderate_size(parts[:at_least])
        first, last = (_number(part) for part in (parts[0], parts[-1]))
        write_compact(folder / merged_name(first, last), [merged(parts)], info)
        for part in parts:
            part.unlink()
    return True


def _unmerged(folder: Path) -> list[Path]:
    return [path for path in segment_files(folder).values() if "-" not in path.name]


def _number(part: Path) -> int:
    numbers = part_numbers(part)
    return -1 if numbers is None else numbers[0]


def _of_moderate_size(parts: list[Path]) -> list[Path]:
    """Return the first parts, at least one, with rows that memory holds."""
    rows = 0
    kept: list[Path] = []
    for part in parts:
        rows += read_contents(part).rows
        if kept and rows > MOST_ROWS:
            break
        kept.append(part)
    return kept


def complete_segment(
    parts: Path, number: int, info: TracksInfo, before: frozenset[int], parts_of_a_minute: int
) -> frozenset[int]:
    """Make a segment of its parts, if it is not there yet, and remove them.

    Parameters
    ----------
    parts
        The folder of the recording.
    number
        Of the segment.
    info
        Metadata of the file.
    before
        People of the segment before.
    parts_of_a_minute
        So many parts become a row group.

    Returns
    -------
    The people of the segment who were not only provisional.

    Raises
    ------
    InputError
        When a part is damaged.
    SetupError
        When the disk has no room.
    """
    folder, target = parts / segment_name(number), parts / f"{segment_name(number)}{SUFFIX}"
    people: set[int] = set()
    with changing(parts), disk_faults(target, running=True):
        if not target.exists() and segment_files(folder):
            while merge_parts(folder, info, parts_of_a_minute):
                pass
            while merge_parts(folder, info, len(_unmerged(folder))):
                pass
            groups = _counted(segment_files(folder).values(), people)
            write_compact(target, groups, info)
            write_catalogue(parts, _with_people(parts, target, people, before))
        shutil.rmtree(folder)
    return frozenset(people)


def _counted(files: Iterable[Path], people: set[int]) -> Iterator[pa.Table]:
    for file in files:
        for group in compact_groups(file):
            people |= people_of(group)
            yield group


def people_of(table: pa.Table) -> set[int]:
    """Return the identities in a table that are not only provisional."""
    person = filled(table["person"], -1)
    if "state" in table.column_names:
        coded = table["state"].combine_chunks()
        coded = coded if pa.types.is_dictionary(coded.type) else coded.dictionary_encode()
        known = [n for n, name in enumerate(coded.dictionary.to_pylist()) if name != PROVISIONAL]
        person = person[np.isin(filled(coded.indices, -1), known)]
    return set(np.unique(person).tolist()) - {-1}


def _with_people(
    parts: Path, target: Path, people: set[int], before: frozenset[int]
) -> list[Segment]:
    new = len(people - before)
    return [
        one
        if one.file != target
        else replace(one, contents=replace(one.contents, people=len(people), new_people=new))
        for one in segments_in(parts)
    ]
