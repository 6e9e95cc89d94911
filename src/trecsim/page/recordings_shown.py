"""Recordings as the page lists and replays them."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from itertools import islice
from pathlib import Path
from time import time
from types import MappingProxyType
from typing import Any

from trecsim.page.kept_vehicles import KeptVehicles
from trecsim.page.last_seen import LastSeen, snapshot_part
from trecsim.page.messages import message, snapshot_body

LOOK_BACK_S = 10.0  # for when people were last seen before the part, and where vehicles were
LINES_AT_ONCE = 25
Volumes = Mapping[str, Any]
NO_VOLUMES: Volumes = MappingProxyType({})
_ID = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,127}")


@dataclass(frozen=True, slots=True)
class ShownRecording:
    """A recording in a list.

    Attributes
    ----------
    id
        Name of its folder.
    from_s, to_s
        Its first and last time [s].
    people
        Number of identities that were not only provisional.
    gaps
        Times between, of which nothing is stored: from and to [s], and why.
    """

    id: str
    from_s: float
    to_s: float
    people: int
    gaps: tuple[dict[str, Any], ...] = ()


def shown_recordings(folder: Path) -> list[ShownRecording]:
    """Return the recordings in a folder, or the folder itself if it is one, in order of time.

    Folders without tracks are left out, and so is what cannot be read.
    """
    from trecsim.store.playback import recordings

    return [
        ShownRecording(
            one.id, one.from_s, one.to_s, one.people, tuple(asdict(gap) for gap in one.gaps)
        )
        for one in recordings(folder)
        if _ID.fullmatch(one.id)
    ]


def recording_folder(folder: Path, identity: str) -> Path | None:
    """Return the folder of a recording; None where there is none of this name."""
    from trecsim.store.playback import recording_folders

    if not _ID.fullmatch(identity):
        return None

    found = {one.name: one for one in recording_folders(folder)}
    return found.get(identity)


def snapshot_lines(
    folder: Path, from_s: float, to_s: float, volumes: Volumes = NO_VOLUMES
) -> Iterator[str]:
    """Yield the snapshots of a part of a recording as lines of JSON, several lines at once.

    Parameters
    ----------
    folder
        Of the recording.
    from_s, to_s
        First and last time, both included [s].
    volumes
        Those of the site; vehicles that feeds told come with the people.

    Raises
    ------
    InputError
        The recording is damaged.
    """
    lines = _lines(folder, from_s, to_s, volumes)
    while block := list(islice(lines, LINES_AT_ONCE)):
        yield "".join(block)


def _lines(folder: Path, from_s: float, to_s: float, volumes: Volumes) -> Iterator[str]:
    from trecsim.store.playback import snapshots

    seen, vehicles = LastSeen(), KeptVehicles(folder, volumes, from_s - LOOK_BACK_S, to_s)
    for snapshot in snapshots(folder, from_s - LOOK_BACK_S, to_s):
        seen_s = seen.ages_s(snapshot)
        if snapshot.t_s >= from_s:
            part = snapshot_part(snapshot, seen_s, vehicles.at(snapshot.t_s))
            body = snapshot_body(part)
            yield message("snapshot", time(), body) + "\n"
