"""The files of a recording in segments, in order, and their catalogue.

A folder of tracks holds::

    00000001.parquet            a segment: an hour of tracks
    00000002.parquet
    00000003/000001.parquet     the parts of the segment that is being written, two seconds each
    00000003/000002.parquet
    _catalogue.json             when each segment begins and ends, and its highest identity

Segments and parts are ordered by number. Parts are read only while the segment of their number
does not exist. The catalogue makes it unnecessary to open every segment. It can be rebuilt:
segments that are missing in it, or whose size has changed, are opened.
"""

import json
import logging
import math
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
    return _numbered(path for path in folder.glob(f"[0-9]*{suffix}") if path.is_file())


def part_folders(folder: Path) -> dict[int, Path]:
    """Return the folders of parts in a folder by number, in order."""
    return _numbered(path for path in folder.glob("[0-9]*") if path.is_dir())


def files_in(folder: Path) -> list[Path]:
    """Return all files of a recording in order: segments, and parts of the unfinished segment."""
    segments, parts = segment_files(folder), part_folders(folder)
    files: list[Path] = []
    for number in sorted({*segments, *parts}):
        if number in segments:
            files.append(segments[number])
        else:
            files += segment_files(parts[number]).values()
    return files


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


def write_catalogue(folder: Path, segments: Iterable[Segment]) -> None:
    """Write the catalogue of the complete segments in a folder.

    Raises
    ------
    SetupError
        When the disk has no room.
    """
    facts = [
        {"file": segment.file.name, "size_bytes": segment.size_bytes, **asdict(segment.contents)}
        for segment in segments
        if segment.file.parent == folder and segment.contents.rows
    ]
    with atomic_write(folder / CATALOGUE, private=True) as file:
        file.write(json.dumps({"format": _FORMAT, "segments": facts}, indent=1) + "\n")


def _read_catalogue(folder: Path) -> dict[str, tuple[int, Contents]]:
    """Return size and extent of the files in the catalogue."""
    path = folder / CATALOGUE
    try:
        if path.stat().st_size > _LARGEST_BYTES:
            return {}
        facts = json.loads(path.read_bytes())
        if facts["format"] != _FORMAT:
            return {}
        return {str(one["file"]): _entry(one) for one in facts["segments"]}
    except FileNotFoundError:
        return {}
    except (OSError, ValueError, KeyError, TypeError, RecursionError) as error:
        logger.debug("%s is not used: %s", path, error)
        return {}


def _entry(facts: dict[str, Any]) -> tuple[int, Contents]:
    contents = Contents(
        rows=int(facts["rows"]),
        first_s=float(facts["first_s"]),
        last_s=float(facts["last_s"]),
        highest_person=int(facts["highest_person"]),
    )
    if contents.rows < 0 or not math.isfinite(contents.first_s + contents.last_s):
        raise ValueError(f"{facts['file']} has impossible numbers")
    return int(facts["size_bytes"]), contents
