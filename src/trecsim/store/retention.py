"""Delete what a live site has kept long enough: the oldest hours first, by age and by size.

What an event points to stays as long as the event. Of an hour that is old enough, only that stays.
Recordings that were not made live are left alone.
"""

import logging
import math
import shutil
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow as pa
from jaxtyping import Bool

from trecsim.errors import Error, InputError, SetupError
from trecsim.store.arrow_arrays import numbers_of
from trecsim.store.claiming import is_claimed
from trecsim.store.erasing import catalogue_anew, changing_tracks, keep_rows
from trecsim.store.ledger import Ledger
from trecsim.store.ledger_file import NAME as LEDGER
from trecsim.store.names import LIVE, SIGNALS, TRACKS
from trecsim.store.parquet_reading import parts_of, recording_segments
from trecsim.store.playback import has_tracks
from trecsim.store.recordings import discard_recording
from trecsim.store.segments import Segment
from trecsim.store.timing_csv import NAME as TIMING

logger = logging.getLogger(__name__)

UNIX_FROM_S = 1e9  # smaller times have another origin; then the age of the file counts

Spans = Sequence[tuple[float, float]]


@dataclass(frozen=True, slots=True)
class Retention:
    """How long a live site keeps what it stores.

    Attributes
    ----------
    tracks_s
        Tracks are deleted when they are older [s].
    events_s
        Events, and the tracks they point to, are deleted when they are older [s].
    tracks_bytes
        The oldest tracks are deleted when all together are larger; None for no limit.
    """

    tracks_s: float = 72 * 3600.0
    events_s: float = 90 * 86400.0
    tracks_bytes: float | None = None


@dataclass(slots=True)
class _Old:
    """A file of tracks that may be deleted, with its recording."""

    recording: Path
    segment: Segment
    written_s: float  # when the file was written


def tidy(folder: Path, ledger: Ledger, limits: Retention, now_s: float) -> int:
    """Delete what is older or more than the limits; return the number of files changed.

    Parameters
    ----------
    folder
        The folder with the recordings of a site; those that are still written too.
    ledger
        Its events. What was deleted is entered in its audit log.
    limits
        How long and how much is kept.
    now_s
        The present, Unix time [s].

    Raises
    ------
    InputError
        When a recording is damaged; it is left alone, and all others are tidied.
    SetupError
        When the disk has no room or does not work; what makes room is deleted all the same.
    """
    faults: list[Error] = []
    try:
        events = ledger.forget_events(now_s - limits.events_s)
    except SetupError as error:  # on a full disk tracks are deleted first: that makes room
        events = 0
        faults.append(error)
    evidence = ledger.evidence()
    live = sorted(one for one in (folder, *folder.glob("*")) if (one / LIVE).exists())
    changed = 0
    for one in live.copy():
        try:
            for old in _files_of(one):
                if _age_s(old, now_s) > limits.tracks_s:
                    changed += _shrink(old, _within(evidence, old.segment))
        except InputError as error:
            live.remove(one)
            faults.append(error)
    if limits.tracks_bytes is not None:
        changed += _reduce(live, evidence, limits.tracks_bytes)
    for one in live:
        _remove_what_is_empty(one, now_s - limits.tracks_s)
    if changed or events:
        ledger.append_audit("retention", "delete", {"files": changed, "events": events})
    if faults:
        raise faults[0]
    return changed


def _files_of(recording: Path) -> list[_Old]:
    """Return the files of a recording, without parts that are still written."""
    if not has_tracks(recording):
        return []
    tracks = recording / TRACKS
    written = is_claimed(parts_of(tracks))
    return [
        _Old(recording, one, one.file.stat().st_mtime)
        for one in recording_segments(tracks)
        if not (written and one.file.parent.parent == parts_of(tracks))
    ]


def _age_s(old: _Old, now_s: float) -> float:
    last_s = old.segment.contents.last_s
    return now_s - (last_s if last_s >= UNIX_FROM_S else old.written_s)


def _within(evidence: Spans, segment: Segment) -> list[tuple[float, float]]:
    first_s, last_s = segment.contents.first_s, segment.contents.last_s
    return [span for span in evidence if span[0] <= last_s and span[1] >= first_s]


def _shrink(old: _Old, needed: Spans) -> bool:
    """Keep only what events point to; return whether anything has changed."""
    contents = old.segment.contents
    first_s = min((low for low, _ in needed), default=math.inf)
    last_s = max((high for _, high in needed), default=-math.inf)
    if contents.first_s >= first_s and contents.last_s <= last_s:
        return False  # it was shrunk before

    def stays(table: pa.Table) -> Bool[np.ndarray, " row"]:
        t_s = numbers_of(table["t_s"])
        inside = np.zeros(len(t_s), bool)
        for low, high in needed:
            inside |= (t_s >= low) & (t_s <= high)
        return inside

    tracks = old.recording / TRACKS
    with changing_tracks(tracks):
        with suppress(SetupError):  # a full disk has room again afterwards
            catalogue_anew(tracks)  # remembers the highest identity
        gone = keep_rows(old.segment.file, stays) if old.segment.file.exists() else 0
        catalogue_anew(tracks)
    return gone > 0


def _reduce(live: Iterable[Path], evidence: Spans, limit_bytes: float) -> int:
    """Delete whole files, the oldest first, until the rest is small enough."""
    files = [old for one in live for old in _files_of(one)]
    files.sort(key=lambda old: old.segment.contents.first_s)
    size_bytes = sum(old.segment.size_bytes for old in files)
    changed = 0
    for old in files:
        if size_bytes <= limit_bytes:
            return changed
        if not _within(evidence, old.segment):
            changed += _shrink(old, ())
            size_bytes -= old.segment.size_bytes
    if size_bytes > limit_bytes:
        logger.warning(
            "tracks take %.1f GB, more than the %.1f GB that are allowed: the rest belongs to "
            "events, or is written now", size_bytes / 1e9, limit_bytes / 1e9,
        )  # fmt: skip
    return changed


def _remove_what_is_empty(recording: Path, before_s: float) -> None:
    """Remove a recording that has ended and has no tracks left, and old small files of others."""
    for path in recording.glob(SIGNALS.format("*")):
        if path.stat().st_mtime < before_s:
            path.unlink()
    if is_claimed(recording) or is_claimed(parts_of(recording / TRACKS)):
        for path in (recording / f"{TIMING}.parts").glob("[0-9]*.csv"):
            if path.stat().st_mtime < before_s:
                path.unlink()
    elif has_tracks(recording) and recording_segments(recording / TRACKS):
        return
    elif (recording / LEDGER).exists():
        discard_recording(recording)
    else:
        shutil.rmtree(recording)
