"""The files of a recording."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from trecsim.errors import InputError
from trecsim.store.atomic import partial_path
from trecsim.store.names import POSES, RIG, TRUTH
from trecsim.store.parquet_reading import parts_of
from trecsim.store.timing_csv import NAME as TIMING

PIECES = {
    "rig": RIG,
    "poses": POSES,
    "truth": TRUTH,
    "timing": TIMING,
    "summary": "summary.json",
}
RUN = "run"


@dataclass(frozen=True, slots=True)
class Places:
    """The files of a recording; None if missing."""

    tracks: Path
    rig: Path | None = None
    poses: Path | None = None
    truth: Path | None = None
    timing: Path | None = None
    summary: Path | None = None


def find(
    path: Path, *, rig: Path | None = None, poses: Path | None = None, truth: Path | None = None
) -> Places:
    """Return the files of a recording, those given instead of or beside those found.

    `path` is the folder of a recording or of a demo, or a file of tracks alone.

    Raises
    ------
    InputError
        There are no tracks.
    """
    if not path.is_dir() or path.suffix in (".parts", ".parquet"):
        if not path.exists() and not parts_of(path).is_dir():
            raise InputError(
                f"there is no recording at {path}; give a folder written by `trecsim run`, or a "
                "file of tracks"
            )
        return Places(path, rig, poses, truth)
    folders = (
        path / RUN,
        path,
    )  # a demo keeps its run, dated from its start on, in a folder of its own
    present = {name: place for name, file in PIECES.items() if (place := _first_of(folders, file))}
    given = {"rig": rig, "poses": poses, "truth": truth}
    present |= {name: place for name, place in given.items() if place is not None}
    return Places(_tracks_in(folders), **present)


def _first_of(folders: Sequence[Path], file: str) -> Path | None:
    """Return where a piece is, complete or as an interrupted run left it."""
    for folder in folders:
        whole = folder / file
        for place in (whole, partial_path(whole), parts_of(whole)):
            if place.exists():
                return place
    return None


def _tracks_in(folders: Sequence[Path]) -> Path:
    for folder in folders:
        whole = folder / "tracks.parquet"
        for tracks in (whole, folder / "tracks.csv", folder / "tracks.csv.partial"):
            if tracks.exists() or (tracks == whole and parts_of(whole).is_dir()):
                return tracks
    raise InputError(
        f"there are no tracks in {folders[0]}: expected tracks.parquet or tracks.csv, as "
        "`trecsim run` and `trecsim track` write them"
    )
