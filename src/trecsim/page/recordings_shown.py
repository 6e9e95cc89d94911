"""Recordings as the page lists and replays them."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from time import time

from trecsim.page.last_seen import LastSeen, snapshot_part
from trecsim.page.messages import message, snapshot_body

LOOK_BACK_S = 10.0  # for when people were last seen before the part that is asked for
LINES_AT_ONCE = 25
_ID = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,127}")


@dataclass(frozen=True, slots=True)
class ShownRecording:
    """A recording in a list.

    Attributes
    ----------
    id
        Name of its folder.
    from_s, to_s
        Times of the first and last snapshot with people [s].
    people
        Number of identities.
    """

    id: str
    from_s: float
    to_s: float
    people: int


def shown_recordings(folder: Path) -> list[ShownRecording]:
    """Return the recordings in a folder, or the folder itself if it is one, in order of time.

    Folders without tracks are left out, and so is what cannot be read.
    """
    folders = [folder, *(path for path in folder.iterdir() if path.is_dir())]
    found = [one for path in folders if (one := _shown(path)) is not None]
    return sorted(found, key=lambda one: one.from_s)


def recording_folder(folder: Path, identity: str) -> Path | None:
    """Return the folder of a recording; None where there is none of this name."""
    if not _ID.fullmatch(identity):
        return None
    if folder.name == identity and _tracks(folder) is not None:
        return folder
    found = folder / identity
    return found if found.is_dir() and _tracks(found) is not None else None


def snapshot_lines(folder: Path, from_s: float, to_s: float) -> Iterator[str]:
    """Yield the snapshots of a part of a recording as lines of JSON, several lines at once.

    Parameters
    ----------
    folder
        Of the recording.
    from_s, to_s
        First and last time, both included [s].

    Raises
    ------
    InputError
        The recording is damaged.
    """
    lines = _lines(folder, from_s, to_s)
    while block := list(islice(lines, LINES_AT_ONCE)):
        yield "".join(block)


def _lines(folder: Path, from_s: float, to_s: float) -> Iterator[str]:
    from trecsim.store.tracks import read_tracks

    seen = LastSeen()
    for snapshot in read_tracks(folder, from_s=from_s - LOOK_BACK_S, until_s=to_s):
        seen_s = seen.ages_s(snapshot)
        if snapshot.t_s >= from_s:
            body = snapshot_body(snapshot_part(snapshot, seen_s))
            yield message("snapshot", time(), body) + "\n"


def _tracks(folder: Path) -> Path | None:
    """Return the tracks of a recording, complete or not."""
    from trecsim.store.recordings import TRACKS

    complete = folder / TRACKS
    unfinished = folder / f"{TRACKS}.parts"
    return complete if complete.exists() or unfinished.is_dir() else None


def _shown(folder: Path) -> ShownRecording | None:
    from trecsim.errors import Error
    from trecsim.store.tracks_parquet import recording_segments

    tracks = _tracks(folder)
    if tracks is None or not _ID.fullmatch(folder.name):
        return None
    try:
        contents = [one.contents for one in recording_segments(tracks) if one.contents.rows]
    except (Error, OSError):
        return None
    if not contents:
        return None
    return ShownRecording(
        folder.name, contents[0].first_s, contents[-1].last_s,
        1 + max(one.highest_person for one in contents),
    )  # fmt: skip
