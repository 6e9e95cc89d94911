"""Play recordings back: which there are, and their snapshots from one time to another."""

import logging
import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from trecsim.errors import Error
from trecsim.store.compaction import people_of
from trecsim.store.gaps import Gap, read_gaps
from trecsim.store.names import TRACKS
from trecsim.store.parquet_file import file_groups
from trecsim.store.parquet_reading import parts_of, read_parquet, recording_segments
from trecsim.store.segments import Segment
from trecsim.values import Snapshot

logger = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class Recording:
    """A recording of a site.

    Attributes
    ----------
    id
        Name of its folder.
    folder
        Its folder.
    from_s, to_s
        Its first and last time [s].
    people
        Number of identities that were not only provisional.
    size_bytes
        Room that its tracks take.
    gaps
        Times between, of which nothing is stored.
    """

    id: str
    folder: Path
    from_s: float
    to_s: float
    people: int
    size_bytes: int
    gaps: tuple[Gap, ...] = ()


def recordings(folder: Path) -> list[Recording]:
    """Return the recordings in a folder, or the folder itself if it is one, in order of time.

    Recordings that are still written are there too; what cannot be read is left out and logged.
    """
    found = [_recording(one) for one in recording_folders(folder)]
    return sorted((one for one in found if one is not None), key=lambda one: (one.from_s, one.id))


def recording_folders(folder: Path) -> list[Path]:
    """Return the folders of recordings in a folder: itself, or those directly in it."""
    try:
        inside = sorted(path for path in folder.iterdir() if path.is_dir())
    except OSError:
        return []
    return [path for path in (folder, *inside) if has_tracks(path)]


def has_tracks(folder: Path) -> bool:
    """Return whether a folder holds a recording, complete or not."""
    return (folder / TRACKS).exists() or parts_of(folder / TRACKS).is_dir()


def _recording(folder: Path) -> Recording | None:
    try:
        segments = [one for one in recording_segments(folder / TRACKS) if one.contents.rows]
        if not segments:
            return None
        people = _people(segments)
    except (Error, OSError) as error:
        logger.warning("a recording is left out: %s", error)
        return None
    return Recording(
        id=folder.name,
        folder=folder,
        from_s=segments[0].contents.first_s,
        to_s=segments[-1].contents.last_s,
        people=people,
        size_bytes=sum(one.size_bytes for one in segments),
        gaps=tuple(read_gaps(folder)),
    )


def _people(segments: list[Segment]) -> int:
    """Return the number of people; whom the catalogue has counted is not looked for again."""
    count, before = 0, frozenset[int]()
    for number, one in enumerate(segments):
        contents = one.contents
        if contents.people >= 0 and (number == 0 or segments[number - 1].contents.people >= 0):
            count += contents.people if number == 0 else contents.new_people
            before = frozenset()
            continue
        if number and not before:
            before = _people_in(segments[number - 1].file, segments[number - 1].size_bytes)
        here = _people_in(one.file, one.size_bytes)
        count += len(here - before)
        before |= here
    return count


@lru_cache(maxsize=4096)
def _people_in(file: Path, size_bytes: int) -> frozenset[int]:
    """Return the people in a file of this size; files do not change but by being replaced."""
    people: set[int] = set()
    for group in file_groups(file, ["person", "state", "support"]):
        people |= people_of(group)
    return frozenset(people)


def snapshots(
    folder: Path, from_s: float = -math.inf, to_s: float = math.inf
) -> Iterator[Snapshot]:
    """Yield the snapshots of a recording between two times, both included, in order.

    They are the ones that were stored, bit for bit: with provisional people, and empty ones where
    nobody was there (in recordings of live sites). Files before `from_s` are not opened.

    Parameters
    ----------
    folder
        Of the recording; also of one that is still written.
    from_s, to_s
        First and last time [s].

    Raises
    ------
    InputError
        When the recording is missing or damaged.
    """
    return read_parquet(folder / TRACKS, from_s, to_s)
