"""Delete parts of recordings: files are written anew without the rows that are to go."""

import json
import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, replace
from io import BytesIO
from pathlib import Path

import numpy as np
import pyarrow as pa
from jaxtyping import Bool

from trecsim.errors import InputError, SetupError
from trecsim.store.arrow_arrays import filled, flag_array, numbers_of
from trecsim.store.atomic import atomic_write, partial_path
from trecsim.store.compact_file import write_compact, write_compact_to
from trecsim.store.compaction import changing
from trecsim.store.in_place import keep_lines, overwrite
from trecsim.store.ledger import Ledger
from trecsim.store.ledger_file import NAME as LEDGER
from trecsim.store.names import POSES, TRACKS
from trecsim.store.parquet_file import file_groups, read_file_info
from trecsim.store.parquet_reading import parts_of, recording_segments
from trecsim.store.parquet_writing import write_file, write_file_to
from trecsim.store.playback import recording_folders
from trecsim.store.segments import segments_in, write_catalogue

Kept = Callable[[pa.Table], Bool[np.ndarray, " row"]]
"""Tells which rows of a table stay."""

_EVERYTHING = ("t_s", "person")


@dataclass(frozen=True, slots=True)
class Erased:
    """What was deleted.

    Attributes
    ----------
    rows
        Number of rows of tracks: one per time, person and joint.
    files
        Number of files that were written anew or removed.
    recordings
        The recordings in which something was found.
    remarks
        What could not be deleted, and why.
    events
        Number of events that do not list these people any more.
    """

    rows: int = 0
    files: int = 0
    recordings: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()
    events: int = 0


def erase(
    folder: Path,
    from_s: float,
    to_s: float,
    *,
    person: int | None = None,
    who: str = "trecsim erase",
) -> Erased:
    """Delete a period from recordings, for everybody or for one person.

    A site may go on recording meanwhile. On a full disk files are changed where they lie. The act
    is entered in the audit log of the folder. Events of the time stay until their own limit,
    without the people whom they list and where these were.

    Parameters
    ----------
    folder
        A recording, or the folder with the recordings of a site.
    from_s, to_s
        The time, both included [s].
    person
        The identity; None for everybody.
    who
        Who does it, for the audit log.

    Raises
    ------
    InputError
        When there is no recording, the time is none, or a file is damaged; the period is then
        gone from all other recordings, and the audit log says so.
    SetupError
        When the disk has no room.
    """
    if not from_s <= to_s:
        raise InputError(f"expected a time from an earlier to a later moment: {from_s} to {to_s} s")
    folders = recording_folders(folder)
    if not folders:
        raise InputError(f"there is no recording with {TRACKS} in {folder}")

    def stays(table: pa.Table) -> Bool[np.ndarray, " row"]:
        t_s = numbers_of(table["t_s"])
        goes = (t_s >= from_s) & (t_s <= to_s)
        if person is not None:
            goes &= filled(table["person"], -1) == person
        kept: Bool[np.ndarray, " row"] = ~goes
        return kept

    place = _place_of_ledger(folder, folders)
    _check_ledger(place)
    done, damaged = _erase_tracks(folders, from_s, to_s, person, stays)
    with Ledger(place, repair=False) as ledger:
        done = replace(done, events=ledger.erase_people(from_s, to_s, person))
        times = {"from_s": _finite(from_s), "to_s": _finite(to_s)}  # JSON has no infinity
        what = {**times, "person": person, "recordings": list(done.recordings), "rows": done.rows}
        ledger.append_audit(who, "erase", {**what, "events": done.events})
    if damaged:
        raise InputError(
            f"{damaged[0]}; {len(damaged)} of {len(folders)} recordings still hold this period, "
            "or a part of it: remove the damaged files, then erase again"
        )
    return done


def _erase_tracks(
    folders: Sequence[Path], from_s: float, to_s: float, person: int | None, stays: Kept
) -> tuple[Erased, list[InputError]]:
    """Delete rows of all recordings; return what was done, and what is damaged."""
    done = Erased()
    damaged: list[InputError] = []
    for one in folders:
        try:
            found = _erase_in(one, from_s, to_s, stays)
            remarks = _erase_poses(one, from_s, to_s, person)
        except InputError as error:
            damaged.append(error)
            continue
        name = (one.name,) if found.files else ()
        done = Erased(
            done.rows + found.rows,
            done.files + found.files,
            done.recordings + name,
            done.remarks + remarks,
        )
    return done, damaged


def _check_ledger(place: Path) -> None:
    """Refuse a ledger that cannot be read before anything is deleted: it holds people, too."""
    if not (place / LEDGER).exists():
        return
    try:
        with suppress(SetupError):  # a full disk has room again afterwards
            Ledger(place, repair=False).close()
    except InputError as error:
        raise InputError(
            f"{error}; nothing was deleted: move the file away, as it may hold people of this "
            "period, then erase again"
        ) from None


def _finite(t_s: float) -> float | None:
    return t_s if math.isfinite(t_s) else None


def _place_of_ledger(folder: Path, folders: Sequence[Path]) -> Path:
    places = dict.fromkeys([folder, folder.parent, *folders])
    return next((one for one in places if (one / LEDGER).exists()), folder)


def _erase_in(folder: Path, from_s: float, to_s: float, stays: Kept) -> Erased:
    """Delete rows of a recording; a file without any left is removed."""
    tracks = folder / TRACKS
    with changing_tracks(tracks):
        highest = max(
            (one.contents.highest_person for one in recording_segments(tracks)), default=-1
        )
        with suppress(SetupError):  # a full disk has room again afterwards
            catalogue_anew(tracks)  # remembers the highest identity, should this be killed
        rows = files = 0
        for segment in recording_segments(tracks):
            if segment.contents.overlaps(from_s, to_s):
                gone = keep_rows(segment.file, stays)
                rows, files = rows + gone, files + (gone > 0)
        if files:
            with suppress(SetupError):  # the sizes of files tell that it is old
                catalogue_anew(tracks, highest)
    return Erased(rows, files)


@contextmanager
def changing_tracks(tracks: Path) -> Iterator[None]:
    """Change the files of a recording alone, in a block; it may end while this waits."""
    while place := _folder_of(tracks):
        with ExitStack() as lock:
            try:
                is_there = lock.enter_context(changing(place))
            except SetupError:
                if place.is_dir():
                    raise
                continue  # it has just ended
            if is_there:
                yield
                return
    yield


def _folder_of(tracks: Path) -> Path | None:
    places = (tracks, parts_of(tracks))
    return next((place for place in places if place.is_dir()), None)


def catalogue_anew(tracks: Path, highest_person: int = -1) -> None:
    """Write the catalogue of a recording again after files have changed."""
    place = tracks if tracks.is_dir() else parts_of(tracks)
    if place.is_dir():
        write_catalogue(place, segments_in(place), highest_person=highest_person)


def keep_rows(path: Path, stays: Kept) -> int:
    """Write a file anew with only some of its rows, or remove it; return how many are gone.

    Raises
    ------
    InputError
        When the file is damaged.
    SetupError
        When the disk does not work; the file is as before.
    """
    info = read_file_info(path)
    counts = [(len(group), int(stays(group).sum())) for group in file_groups(path, _EVERYTHING)]
    before, after = (sum(count) for count in zip(*counts, strict=True)) if counts else (0, 0)
    if after == before:
        return 0
    if after == 0:
        path.unlink()
        return before
    try:
        (write_compact if info.is_compact else write_file)(path, _filtered(path, stays), info)
    except SetupError:  # no room for a second file
        content = BytesIO()
        write = write_compact_to if info.is_compact else write_file_to
        write(content, _filtered(path, stays), info)
        overwrite(path, content.getvalue())
    return before - after


def _filtered(path: Path, stays: Kept) -> Iterator[pa.Table]:
    for group in file_groups(path):
        mask = stays(group)
        if mask.any():
            yield group.filter(flag_array(mask))


def _erase_poses(folder: Path, from_s: float, to_s: float, person: int | None) -> tuple[str, ...]:
    """Delete the 2D poses of a time; return what could not be deleted."""
    path = folder / POSES
    if partial_path(path).exists():
        return (f"{partial_path(path)} is still written: its 2D poses stay",)
    if not path.exists():
        return ()
    if person is not None:
        return (f"{path}: 2D poses have no identities and stay; erase the time of everybody",)

    def stays(line: bytes) -> bool:
        return not _is_between(line, from_s, to_s)

    try:
        with path.open("rb") as lines, atomic_write(path, "wb", private=True) as file:
            file.writelines(filter(stays, lines))
    except SetupError:  # no room for a second file
        keep_lines(path, stays)
    return ()


def _is_between(line: bytes, from_s: float, to_s: float) -> bool:
    try:
        t_s = json.loads(line).get("t_s")
    except (ValueError, AttributeError):
        return False
    return isinstance(t_s, int | float) and from_s <= t_s <= to_s
