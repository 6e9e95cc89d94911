"""Read recordings of tracks in Parquet: files, folders of segments, and what is being written."""

import math
from collections.abc import Iterator
from pathlib import Path

from trecsim.errors import InputError
from trecsim.skeleton import Skeleton
from trecsim.store.compact_file import compact_moments
from trecsim.store.parquet_file import TracksInfo, file_rows, read_file_info
from trecsim.store.rows import Rows, snapshots_of
from trecsim.store.segments import Segment, files_in, segment_of, segments_in
from trecsim.values import Snapshot


def parts_of(path: Path) -> Path:
    """Return the folder of the recording `path` until it is complete."""
    return path.with_name(path.name + ".parts")


def read_parquet(
    path: Path, from_s: float = -math.inf, until_s: float = math.inf
) -> Iterator[Snapshot]:
    """Read tracks, one snapshot per time; of an unfinished recording, read segments and parts.

    Compact recordings also hold times without people, whose snapshots are empty.

    Parameters
    ----------
    path
        A Parquet file of tracks, or a folder of segments or parts.
    from_s, until_s
        Only snapshots between these times are read, both included [s]; other segments are not
        opened.

    Raises
    ------
    InputError
        When the recording is missing or wrong.
    """
    info = read_info(path)
    if info.is_compact:
        yield from _moments(path, info.skeleton, from_s, until_s)
        return
    blocks = _blocks(path, info.skeleton, from_s, until_s)
    yield from snapshots_of(blocks, info.skeleton, path, unit="row", first=1)


def _moments(path: Path, skeleton: Skeleton, from_s: float, until_s: float) -> Iterator[Snapshot]:
    next_s = from_s
    for file in _files_between(path, from_s, until_s):
        try:
            for moment in compact_moments(file, skeleton, next_s, until_s):
                _check_order(file, moment.t_s, next_s)
                yield moment
                next_s = math.nextafter(moment.t_s, math.inf)
        except InputError:
            if file == path or file.exists():
                raise
            yield from _moments(path, skeleton, next_s, until_s)  # parts have just been merged
            return


def _check_order(file: Path, t_s: float, next_s: float) -> None:
    if t_s < next_s:
        raise InputError(f"{file}: time runs backwards at {t_s:.6f} s")


def _blocks(path: Path, skeleton: Skeleton, from_s: float, until_s: float) -> Iterator[Rows]:
    next_s = from_s
    for file in _files_between(path, from_s, until_s):
        if file != path and not file.exists():  # parts have just become a segment
            yield from _blocks(path, skeleton, next_s, until_s)
            return
        for rows in file_rows(file, skeleton, from_s, until_s):
            yield rows
            if len(rows):
                next_s = math.nextafter(float(rows["t_s"][-1]), math.inf)


def _files_between(path: Path, from_s: float, until_s: float) -> list[Path]:
    folder = _folder_of(path)
    if folder is None:
        return [path]
    if from_s == -math.inf and until_s == math.inf:
        return files_in(folder)
    return [one.file for one in segments_in(folder) if one.contents.overlaps(from_s, until_s)]


def _folder_of(path: Path) -> Path | None:
    """Return the folder of segments or parts of a recording; None for a file."""
    if path.is_dir():
        return path
    return parts_of(path) if not path.exists() and parts_of(path).is_dir() else None


def read_info(path: Path) -> TracksInfo:
    """Read the metadata of a recording; files of other programs have none, and get the default.

    Raises
    ------
    InputError
        When it is not a Parquet file, or of a format that is not known.
    """
    folder = _folder_of(path)
    files = files_in(folder) if folder is not None else [path]
    return read_file_info(files[0]) if files else TracksInfo()


def recording_segments(path: Path) -> list[Segment]:
    """Return the files of a recording in order, with their extents.

    Raises
    ------
    InputError
        When the recording is missing or damaged.
    """
    folder = _folder_of(path)
    return segments_in(folder) if folder is not None else [segment_of(path)]
