"""The folder of a recording of `trecsim run`: reserve, write, continue, discard.

::

    rig.toml           the cameras, as in the site file
    rig-from-*.toml    the cameras from a Unix time on, if the site repaired its rig
    tracks.parquet     the tracks: a file, or a folder of segments of an hour each
    timing.csv         what each frame set cost: a file, or a folder of segments
    poses.jsonl        the 2D poses, if the site file asks for them
"""

import math
import shutil
from dataclasses import dataclass
from pathlib import Path

from trecsim.errors import InputError
from trecsim.store.atomic import partial_path
from trecsim.store.claiming import FolderClaim
from trecsim.store.gaps import NAME as GAPS
from trecsim.store.ledger_file import NAME as LEDGER
from trecsim.store.names import LIVE, POSES, RIG, RIG_FROM, SIGNALS, TRACKS
from trecsim.store.parquet_file import TracksInfo
from trecsim.store.parquet_reading import parts_of, read_info, recording_segments
from trecsim.store.poses_writer import PosesWriter
from trecsim.store.recorder import Recorder
from trecsim.store.segments import highest_ever
from trecsim.store.timing_csv import NAME as TIMING
from trecsim.store.timing_csv import last_time_s, read_timing, timing_in
from trecsim.store.timing_writer import TimingWriter
from trecsim.store.tracks_parquet import HOUR_S, ParquetTracksWriter

_RIGS_FROM = RIG_FROM.format("[0-9]*.[0-9][0-9][0-9]")
"""Other files that begin so belong to somebody else."""


@dataclass(frozen=True, slots=True)
class Stored:
    """Extent of a recording that a run continues.

    Attributes
    ----------
    next_person
        The highest stored identity plus one.
    last_s
        The time up to which the recording is complete [s]: the last one in the timings, or the last
        one in the tracks if the timings list people after it; None for an empty recording.
    rig_sha256
        Digest of the rig; None when unknown.
    """

    next_person: int = 0
    last_s: float | None = None
    rig_sha256: str | None = None


def claim_folder(folder: Path, *, resume: bool = False) -> FolderClaim:
    """Reserve a folder for a recording; create it if it is missing.

    Parameters
    ----------
    folder
        The folder of the recording.
    resume
        Whether the folder may hold a recording that will be continued.

    Raises
    ------
    InputError
        When another run uses the folder, when it holds more than a ledger, or, with `resume`, when
        it holds something else than a recording.
    SetupError
        When the disk has no room.
    """
    claim = FolderClaim(folder)
    names = [path.name for path in claim.content if not path.name.startswith(LEDGER)]
    if not names or (resume and RIG in names):
        return claim
    claim.release()
    if not resume:
        raise InputError(
            f"{folder} is not empty; nothing is overwritten: give another --out, or --resume to go "
            "on with the recording in it"
        )
    raise InputError(
        f"{folder} holds no recording to go on with: expected {RIG} and {TRACKS}, found "
        f"{', '.join(names[:5])}"
    )


def tracks_recorder(folder: Path, info: TracksInfo, *, resume: bool = False) -> ParquetTracksWriter:
    """Open the tracks of a recording for writing, in segments of an hour."""
    return ParquetTracksWriter(folder / TRACKS, info, segment_s=HOUR_S, resume=resume)


def live_recorder(folder: Path, info: TracksInfo, *, resume: bool = False) -> Recorder:
    """Open the tracks of a live site for writing, in segments of an hour."""
    return Recorder(folder / TRACKS, info, resume=resume)


def timing_recorder(folder: Path, *, resume: bool = False) -> TimingWriter:
    """Open the timings of a recording for writing, in segments of an hour."""
    return TimingWriter(folder / TIMING, segment_s=HOUR_S, resume=resume)


def poses_recorder(folder: Path, *, resume: bool = False) -> PosesWriter:
    """Open the 2D poses of a recording for writing."""
    return PosesWriter(folder / POSES, resume=resume)


def stored_in(folder: Path) -> Stored:
    """Return the extent of a recording from its catalogue and the ends of its files.

    Raises
    ------
    InputError
        When something in the folder is damaged.
    """
    tracks = folder / TRACKS
    there = tracks.exists() or parts_of(tracks).is_dir()
    contents = [one.contents for one in recording_segments(tracks)] if there else []
    tracked_s = max((one.last_s for one in contents if one.rows), default=-math.inf)
    last_s = _complete_until_s(folder, tracked_s)
    return Stored(
        next_person=1
        + max([highest_ever(_folder_of(tracks)), *(c.highest_person for c in contents)]),
        last_s=last_s if math.isfinite(last_s) else None,
        rig_sha256=read_info(tracks).rig_sha256 if there else None,
    )


def _folder_of(tracks: Path) -> Path:
    return tracks if tracks.is_dir() else parts_of(tracks)


def _complete_until_s(folder: Path, tracked_s: float) -> float:
    """Return the time up to which tracks and timings are complete [s]; -inf if they are empty.

    Timings after the last track mean that nobody was there or that a crash lost the tracks; the
    numbers of people in the timings tell which.
    """
    path = timing_in(folder)
    timed_s = last_time_s(path) if path is not None else math.nan
    if path is None or math.isnan(timed_s):
        return tracked_s
    if timed_s <= tracked_s:
        return timed_s
    from_s = max(math.nextafter(tracked_s, math.inf), timed_s - HOUR_S)
    lost = bool((read_timing(path, from_s).people > 0).any())
    return tracked_s if lost else timed_s


def newest_rig(folder: Path) -> Path:
    """Return the file of the rig that was in force last; the rules judge by ``rig.toml``."""
    repaired = sorted(folder.glob(_RIGS_FROM))  # named by times of one length
    return repaired[-1] if repaired else folder / RIG


def discard_recording(folder: Path) -> None:
    """Remove the files of a recording, complete or not; the folder and other files stay.

    Raises
    ------
    OSError
        When one of them cannot be removed.
    """
    kinds = SIGNALS.format("*"), _RIGS_FROM
    many = [path.name for kind in kinds for path in folder.glob(kind)]
    for name in (TRACKS, TIMING, POSES, RIG, GAPS, LIVE, *many):
        for path in (folder / name, partial_path(folder / name), parts_of(folder / name)):
            if path.is_dir() and not path.is_symlink():
                shutil.rmtree(path)
            else:
                path.unlink(missing_ok=True)
