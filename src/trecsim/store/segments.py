"""The files of a recording in segments, in order, and their catalogue.

A folder of tracks holds::

    00000001.parquet            a segment: an hour of tracks
    00000002.parquet
    00000003/000001.parquet     the parts of the segment that is being written, two seconds each
    00000003/000002.parquet
    00000003/000003-000042.parquet   many parts that were merged, of a live site
    _catalogue.json             when each segment begins and ends, and its highest identity

Segments and parts are ordered by number. Parts are read only while the segment of their number
does not exist, and not where a file of merged parts holds them. The catalogue makes it unnecessary
to open every segment. It can be rebuilt: segments that are missing in it, or whose size has
changed, are opened.
"""

import json
import logging
import math
import os
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from trecsim.errors import InputError
from trecsim.store.atomic import atomic_write
from trecsim.store.parquet_file import Contents, read_contents

logger = logging.getLogger(__name__)

CATALOGUE = "_catalogue.json"  # Arrow leaves out names that begin so when it reads a folder
SUFFIX = ".parquet"

_FORMAT = "trecsim.catalogue/1"
_LARGEST_BYTES = 100_000_000  # a century of hours


@dataclass(frozen=True, slots=True)
class Segment:
    """One file of a recording.

    Attributes
    ----------
    file
        Where it is.
    size_bytes
        Its size, by which a changed file is noticed.
    contents
        Its extent.
    """

    file: Path
    size_bytes: int
    contents: Contents


def segment_name(number: int) -> str:
    """Return the name of a segment without its suffix.

    Examples
    --------
    >>> segment_name(12)
    '00000012'
    """
    return f"{number:08d}"


def segment_files(folder: Path, suffix: str = SUFFIX) -> dict[int, Path]:
    """Return the segments or parts in a folder by number, in order.

    Examples
    --------
    >>> folder = getfixture("tmp_path")
    >>> for name in ("1000000.parquet", "999999.parquet", "notes.parquet", "000007.csv"):
    ...     (folder / name).touch()
    >>> [path.name for path in segment_files(folder).values()]
    ['999999.parquet', '1000000.parquet']
    """
    return _not_merged(_files(folder, suffix))


def merged_parts(folder: Path) -> list[Path]:
    """Return the parts in a folder that a file of merged parts holds."""
    files = _files(folder, SUFFIX)  # one look: a part that comes now is in neither list
    kept = set(_not_merged(files).values())
    return [path for path in files if path not in kept]


def _files(folder: Path, suffix: str) -> list[Path]:
    return [
        folder / one.name for one in _entries(folder) if one.name.endswith(suffix) and one.is_file()
    ]


def merged_name(first: int, last: int) -> str:
    """Return the name of a file of merged parts.

    Examples
    --------
    >>> merged_name(3, 42)
    '000003-000042.parquet'
    """
    return f"{first:06d}-{last:06d}{SUFFIX}"


def part_numbers(path: Path) -> tuple[int, int] | None:
    """Return the first and last number of the parts in a file; None for other files.

    Examples
    --------
    >>> part_numbers(Path("000003-000042.parquet")), part_numbers(Path("000007.parquet"))
    ((3, 42), (7, 7))
    """
    first, dash, last = path.name.partition(".")[0].partition("-")
    last = last if dash else first
    return (int(first), int(last)) if first.isdecimal() and last.isdecimal() else None


def _not_merged(paths: Iterable[Path]) -> dict[int, Path]:
    """Return files by their first number, in order, without parts that another one holds."""
    numbered = [(numbers, path) for path in paths if (numbers := part_numbers(path)) is not None]
    files: dict[int, Path] = {}
    end = -1
    for (first, last), path in sorted(numbered, key=lambda one: (one[0][0], -one[0][1])):
        if last > end:
            files[first], end = path, last
    return files


def part_folders(folder: Path) -> dict[int, Path]:
    """Return the folders of parts in a folder by number, in order."""
    return _numbered(folder / one.name for one in _entries(folder) if one.is_dir())


def files_in(folder: Path) -> list[Path]:
    """Return all files of a recording in order: segments, and parts of the unfinished segment.

    The folder may change meanwhile: files are merged to one, which appears before they go. So it
    is looked at until two looks see the same; names never come back.
    """
    before = None
    while (files := _files_seen(folder)) != before:
        before = files
    return files


def _files_seen(folder: Path) -> list[Path]:
    parts = part_folders(folder)
    segments = segment_files(folder)
    files: list[Path] = []
    for number in sorted({*segments, *parts}):
        if number in segments:
            files.append(segments[number])
        else:
            files += segment_files(parts[number]).values()
    return files


def _entries(folder: Path) -> list[os.DirEntry[str]]:
    """Return what is in a folder whose name begins with a digit; nothing if it is gone."""
    try:
        with os.scandir(folder) as entries:
            return [one for one in entries if one.name[:1].isdecimal()]
    except (FileNotFoundError, NotADirectoryError):
        return []


def _numbered(paths: Iterable[Path]) -> dict[int, Path]:
    named = ((path.name.partition(".")[0], path) for path in paths)
    return dict(sorted((int(name), path) for name, path in named if name.isdecimal()))


def segments_in(folder: Path) -> list[Segment]:
    """Return all files of a recording in order, with their extents.

    Raises
    ------
    InputError
        When a file that is not in the catalogue is damaged.
    """
    known = _read_catalogue(folder)
    segments = []
    for file in files_in(folder):
        try:
            segments.append(_segment(file, known.get(file.relative_to(folder).as_posix())))
        except (InputError, FileNotFoundError):
            if file.exists():
                raise
            return segments_in(folder)  # parts have just become a segment
    return segments


def segment_of(file: Path) -> Segment:
    """Return a file with its extent.

    Raises
    ------
    InputError
        When it is damaged.
    """
    return _segment(file, None)


def _segment(file: Path, known: tuple[int, Contents] | None) -> Segment:
    size_bytes = file.stat().st_size
    if known is not None and known[0] == size_bytes:
        return Segment(file, *known)
    return Segment(file, size_bytes, read_contents(file))


def write_catalogue(folder: Path, segments: Iterable[Segment], *, highest_person: int = -1) -> None:
    """Write the catalogue of the complete segments in a folder.

    It remembers the highest identity of files that were deleted, so that none is used again, and
    at least `highest_person`.

    Raises
    ------
    SetupError
        When the disk has no room.
    """
    everything = list(segments)
    complete = [one for one in everything if one.file.parent == folder and one.contents.rows]
    facts = [
        {"file": one.file.name, "size_bytes": one.size_bytes, **_known(one.contents)}
        for one in complete
    ]
    known = [highest_person, highest_ever(folder)]
    highest = max([*known, *(one.contents.highest_person for one in everything)])
    content = {"format": _FORMAT, "highest_person": highest, "segments": facts}
    with atomic_write(folder / CATALOGUE, private=True) as file:
        file.write(json.dumps(content, indent=1) + "\n")


def _known(contents: Contents) -> dict[str, Any]:
    facts = asdict(contents)
    if contents.people < 0:
        del facts["people"], facts["new_people"]
    return facts


def highest_ever(folder: Path) -> int:
    """Return the highest identity that the catalogue of a folder knows; -1 if there is none."""
    try:
        return max(-1, int(_catalogue(folder).get("highest_person", -1)))
    except (ValueError, TypeError):
        return -1


def _read_catalogue(folder: Path) -> dict[str, tuple[int, Contents]]:
    """Return size and extent of the files in the catalogue."""
    try:
        return {str(one["file"]): _entry(one) for one in _catalogue(folder).get("segments", ())}
    except (ValueError, KeyError, TypeError) as error:
        logger.debug("%s is not used: %s", folder / CATALOGUE, error)
        return {}


def _catalogue(folder: Path) -> dict[str, Any]:
    path = folder / CATALOGUE
    try:
        if path.stat().st_size > _LARGEST_BYTES:
            return {}
        facts = json.loads(path.read_bytes())
    except FileNotFoundError:
        return {}
    except (OSError, ValueError, RecursionError) as error:
        logger.debug("%s is not used: %s", path, error)
        return {}
    known = isinstance(facts, dict) and facts.get("format") == _FORMAT
    return facts if known else {}


def _entry(facts: dict[str, Any]) -> tuple[int, Contents]:
    contents = Contents(
        rows=int(facts["rows"]),
        first_s=float(facts["first_s"]),
        last_s=float(facts["last_s"]),
        highest_person=int(facts["highest_person"]),
        people=int(facts.get("people", -1)),
        new_people=int(facts.get("new_people", -1)),
    )
    if contents.rows < 0 or not math.isfinite(contents.first_s + contents.last_s):
        raise ValueError(f"{facts['file']} has impossible numbers")
    return int(facts["size_bytes"]), contents
