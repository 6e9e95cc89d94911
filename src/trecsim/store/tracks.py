"""Tracks in CSV and Parquet; the suffix of the file sets the format."""

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Protocol, Self, runtime_checkable

from trecsim.errors import InputError
from trecsim.store.atomic import partial_path
from trecsim.store.frames import tidy_frame, wide_frame
from trecsim.store.parquet_file import TracksInfo
from trecsim.store.parquet_reading import parts_of, read_info, read_parquet
from trecsim.store.parquet_writing import write_file
from trecsim.store.rows import confirmed_only
from trecsim.store.tracks_csv import CsvWriter, csv_skeleton, read_csv
from trecsim.store.tracks_parquet import ParquetTracksWriter, tables_of
from trecsim.values import Snapshot

if TYPE_CHECKING:
    from pandas import DataFrame

SUFFIXES = (".csv", ".parquet")


@runtime_checkable
class TracksWriter(Protocol):
    """Takes snapshots in order of time until its block ends."""

    def write(self, snapshot: Snapshot) -> None:
        """Add one moment."""
        ...

    def close(self) -> None:
        """Complete the file: rename it to its final name."""
        ...

    def abandon(self) -> None:
        """End early: keep the content under the name of an unfinished file."""
        ...

    def __enter__(self) -> Self: ...

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None: ...


@dataclass(frozen=True, slots=True)
class TracksExtent:
    """Extent of a recording.

    Attributes
    ----------
    moments
        Number of times with at least one person.
    people
        Number of identities.
    rows
        Number of rows: one per time, person and joint.
    first_s, last_s
        The first and last time [s]; NaN without people.
    """

    moments: int
    people: int
    rows: int
    first_s: float
    last_s: float


def tracks_writer(
    path: Path,
    info: TracksInfo | None = None,
    *,
    segment_s: float = math.inf,
    resume: bool = False,
    provisional: bool = False,
) -> TracksWriter:
    """Open a file of tracks for writing until its block ends.

    While the block runs, and after an error or Ctrl-C, the content is beside the file: of CSV in
    ``NAME.partial``, of Parquet in the folder ``NAME.parts``.

    Parameters
    ----------
    path
        ``*.csv`` or ``*.parquet``.
    info
        Metadata of a Parquet file; CSV files have none.
    segment_s
        Parquet only: a new segment begins this long after the first moment of the last one [s].
        Several segments make a folder of the name `path`.
    resume
        Parquet only: continue the recording at `path`, complete or not, if it exists.
    provisional
        CSV only: whether provisional people are written. Parquet always holds them, with their
        state.

    Raises
    ------
    InputError
        When the suffix is not known or the place cannot be written to.
    SetupError
        When the disk has no room.
    """
    info = info or TracksInfo()
    if _suffix(path) == ".csv":
        if resume:
            raise InputError(f"{path}: CSV tracks cannot be continued; write *.parquet")
        return CsvWriter(path, info.skeleton, provisional=provisional)
    return ParquetTracksWriter(path, info, segment_s=segment_s, resume=resume)


def kept_of(path: Path) -> Path:
    """Return where :func:`tracks_writer` keeps the content after an error."""
    return partial_path(path) if _suffix(path) == ".csv" else parts_of(path)


@dataclass(slots=True, repr=False)
class Tracks(Iterator[Snapshot]):
    r"""Recorded tracks: an iterator of snapshots, or a table.

    The iterator is used up after one pass, like a file; `to_dataframe` reads the file again.

    Attributes
    ----------
    path
        File or folder of the tracks.
    from_s, until_s
        Only snapshots between these times are read, both included [s].
    provisional
        Whether provisional people are included.

    Examples
    --------
    >>> path = getfixture("tmp_path") / "walk.csv"
    >>> _ = path.write_text("t_s,person,joint,x_m,y_m,z_m,sigma_m,support\n"
    ...                     "0.5,3,nose,1.0,2.0,1.6,0.02,4\n")
    >>> tracks = read_tracks(path)
    >>> tracks
    <Tracks of walk.csv>
    >>> next(tracks)
    <Snapshot t_s=0.5, 1 person: 3>
    """

    path: Path
    from_s: float = -math.inf
    until_s: float = math.inf
    provisional: bool = False
    _snapshots: Iterator[Snapshot] = field(init=False)

    def __post_init__(self) -> None:
        self._snapshots = self._read()

    def _read(self) -> Iterator[Snapshot]:
        if _suffix(self.path) == ".csv":
            everything = read_csv(self.path, csv_skeleton(self.path))
            return (one for one in everything if self.from_s <= one.t_s <= self.until_s)
        snapshots = read_parquet(self.path, self.from_s, self.until_s)
        if self.provisional:
            return (one for one in snapshots if len(one.id))
        return confirmed_only(snapshots)

    def __next__(self) -> Snapshot:
        return next(self._snapshots)

    def __repr__(self) -> str:
        span = ""
        if math.isfinite(self.from_s) or math.isfinite(self.until_s):
            span = f", {self.from_s:g} to {self.until_s:g} s"
        return f"<Tracks of {self.path.name}{span}>"

    def to_dataframe(self, *, wide: bool = False, details: bool = False) -> "DataFrame":
        """Return the tracks as a pandas table.

        Parameters
        ----------
        wide
            One row per time and person, with columns like ``nose_x_m``, in place of one row per
            time, person and joint with the columns of the CSV file.
        details
            Also the state of each person, and the velocity and covariance of each joint. For CSV
            files, which do not hold these, velocities are NaN and covariances isotropic.

        Raises
        ------
        InputError
            When the file is wrong.
        SetupError
            When pandas is not installed.
        """
        info = TracksInfo(details=details)
        tables = list(tables_of(self._read(), info))
        return wide_frame(tables, details) if wide else tidy_frame(tables, details)


def read_tracks(
    path: Path | str,
    *,
    from_s: float = -math.inf,
    until_s: float = math.inf,
    provisional: bool = False,
) -> Tracks:
    """Read recorded tracks, one snapshot per time; times without people are not recorded.

    ``read_tracks(path).to_dataframe()`` returns them as a pandas table.

    Parameters
    ----------
    path
        A CSV or Parquet file, or a directory with ``tracks.parquet`` (as `trecsim run` writes it)
        or ``tracks.csv``; also of a run that has not ended.
    from_s, until_s
        Only snapshots between these times are read, both included [s]. Other segments of a long
        recording are not opened.
    provisional
        Whether provisional people are included. CSV does not say who is one, and holds them only
        where it was asked to.

    Raises
    ------
    InputError
        When the file is missing or wrong.
    """
    return Tracks(_file_of(Path(path)), from_s, until_s, provisional)


def every_moment(path: Path | str) -> Iterator[Snapshot]:
    """Yield all snapshots that a recording holds, in order, as they were stored.

    Provisional people are among them, as are, in recordings of live sites, times without people.

    Parameters
    ----------
    path
        What :func:`read_tracks` reads.

    Raises
    ------
    InputError
        When the file is missing or wrong.
    """
    file = _file_of(Path(path))
    return read_csv(file, csv_skeleton(file)) if _suffix(file) == ".csv" else read_parquet(file)


def export_tracks(
    path: Path | str,
    out: Path | str,
    progress: Callable[[int, int | None], None] | None = None,
    *,
    provisional: bool = False,
) -> TracksExtent:
    """Write recorded tracks in the format that the suffix of `out` sets.

    CSV to Parquet and back gives the same file. Metadata (:class:`TracksInfo`) and details of
    Parquet files are kept only in Parquet.

    Parameters
    ----------
    path
        What :func:`read_tracks` reads.
    out
        ``*.csv`` or ``*.parquet``.
    progress
        Called with the number of times done.
    provisional
        Whether a CSV file gets provisional people, too; it does not say who is one. Parquet gets
        all that there are, with their state.

    Raises
    ------
    InputError
        When one of the two is wrong.
    SetupError
        When the disk has no room.
    """
    path, out = _file_of(Path(path)), Path(out)
    suffix = _suffix(out)
    is_csv = _suffix(path) == ".csv"
    info = TracksInfo(csv_skeleton(path), details=False) if is_csv else read_info(path)
    extent = _Extent(progress)
    snapshots = extent.watch(read_tracks(path, provisional=provisional or suffix == ".parquet"))
    if suffix == ".csv":
        with CsvWriter(out, info.skeleton, provisional=provisional) as writer:
            for snapshot in snapshots:
                writer.write(snapshot)
    else:
        write_file(out, tables_of(snapshots, info), info)
    return extent.total()


class _Extent:
    def __init__(self, progress: Callable[[int, int | None], None] | None) -> None:
        self._progress = progress
        self._people: set[int] = set()
        self._moments = self._rows = 0
        self._first_s = self._last_s = math.nan

    def watch(self, snapshots: Iterable[Snapshot]) -> Iterator[Snapshot]:
        for snapshot in snapshots:
            self._first_s = snapshot.t_s if self._moments == 0 else self._first_s
            self._last_s = snapshot.t_s
            self._moments += 1
            self._rows += snapshot.support.size
            self._people.update(snapshot.id.tolist())
            if self._progress is not None:
                self._progress(self._moments, None)
            yield snapshot

    def total(self) -> TracksExtent:
        return TracksExtent(
            self._moments, len(self._people), self._rows, self._first_s, self._last_s
        )


def _file_of(path: Path) -> Path:
    recording, table = path / "tracks.parquet", path / "tracks.csv"
    if recording.exists() or parts_of(recording).is_dir():
        return recording
    for file in (table, partial_path(table)):
        if file.is_file():
            return file
    if path.is_dir() and path.suffix != ".parts" and not any(path.glob("[0-9]*.parquet")):
        raise InputError(f"there are no tracks in {path}: expected tracks.parquet or tracks.csv")
    if not path.exists() and not parts_of(path).is_dir():
        raise InputError(f"there are no tracks at {path}")
    return path


def _suffix(path: Path) -> str:
    kept = path.suffix == ".partial"  # what an interrupted run left
    suffix = Path(path.stem).suffix.lower() if kept else path.suffix.lower()
    if suffix in SUFFIXES:
        return suffix
    if path.is_dir():
        return ".parquet"
    raise InputError(f"{path}: tracks end with one of {', '.join(SUFFIXES)}, not with {suffix!r}")
