"""Timings, `timing.csv`: `t_s,images,people,fusion_ms`, one row per frame set."""

import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pyarrow as pa
from jaxtyping import Float64, Int64
from pyarrow import csv as pa_csv

from trecsim.errors import InputError
from trecsim.store.atomic import opened_for_reading, partial_path
from trecsim.store.growing import without_cut_line
from trecsim.store.limits import LATEST_S
from trecsim.store.native import native_reader
from trecsim.store.segments import segment_files

NAME = "timing.csv"
COLUMNS = {
    "t_s": pa.float64(),
    "images": pa.int64(),
    "people": pa.int64(),
    "fusion_ms": pa.float64(),
}

HEADING = (",".join(COLUMNS) + "\n").encode()
SUFFIX = ".csv"
_LONGEST_LINE = 4096
_LARGEST_BYTES = 2**29  # about 20 million frame sets: more than a week at 25 a second


@dataclass(frozen=True, slots=True)
class StepTiming:
    """Timing of one frame set.

    Attributes
    ----------
    t_s
        Time of its newest image [s].
    images
        Number of its images.
    people
        Number of tracked people after it.
    fusion_ms
        Time that association and fit took [ms].
    waited_ms
        How long its newest image waited for the others [ms]; NaN in a recording. It is not kept.
    late_s
        By how much the clocks of cameras are late, as far as tracking has learnt it [s]. It is not
        kept.
    """

    t_s: float
    images: int
    people: int
    fusion_ms: float
    waited_ms: float = math.nan
    late_s: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, eq=False)
class Timing:
    """Timings of the frame sets of a recording, in order.

    Attributes
    ----------
    t_s
        Times of their newest images [s].
    images
        Number of images of each.
    people
        Number of tracked people after each.
    fusion_ms
        Time that association and fit took [ms].
    """

    t_s: Float64[np.ndarray, " step"]
    images: Int64[np.ndarray, " step"]
    people: Int64[np.ndarray, " step"]
    fusion_ms: Float64[np.ndarray, " step"]


def parts_of_timing(path: Path) -> Path:
    """Return the folder of the segments of timings that are not complete."""
    return path.with_name(path.name + ".parts")


def timing_in(folder: Path) -> Path | None:
    """Return the path of the timings of a recording, complete or not; None if it has none."""
    return timing_at(folder / NAME)


def timing_at(whole: Path) -> Path | None:
    """Return the path of timings with this name, complete or not; None if there are none."""
    places = (whole, partial_path(whole), parts_of_timing(whole))
    return next((path for path in places if path.exists()), None)


def timing_duration_s(path: Path) -> float:
    """Return the time between the first and the last frame set in a folder of segments [s]."""
    files = _files_of(path)
    return last_time_s(path) - _first_time_s(files[0]) if files else 0.0


def _files_of(path: Path) -> list[Path]:
    """Return the files of timings in order."""
    if path.is_dir():
        return list(segment_files(path, SUFFIX).values())
    earlier = parts_of_timing(path.with_name(path.name.removesuffix(".partial")))
    if path.suffix == ".partial" and earlier.is_dir():
        return [*segment_files(earlier, SUFFIX).values(), path]
    return [path]


def read_timing(path: Path, from_s: float = -math.inf, until_s: float = math.inf) -> Timing:
    """Read timings.

    Parameters
    ----------
    path
        A file, complete or not, or a folder of segments.
    from_s, until_s
        Only frame sets between these times are read, both included [s].

    Raises
    ------
    InputError
        When they are missing or wrong.
    """
    files = _between(_files_of(path), from_s, until_s)
    size_bytes = sum(file.stat().st_size for file in files if file.exists())
    if size_bytes > _LARGEST_BYTES:
        raise InputError(
            f"{path} has {size_bytes / 1e6:.0f} MB, timings may have up to "
            f"{_LARGEST_BYTES / 1e6:.0f} MB; read less of the time, or cut the file"
        )
    parts = [_read_file(file) for file in files]
    columns = {
        name: np.concatenate([getattr(part, name) for part in parts]) if parts else np.empty(0)
        for name in COLUMNS
    }
    inside = (columns["t_s"] >= from_s) & (columns["t_s"] <= until_s)
    return Timing(**{name: column[inside] for name, column in columns.items()})


def _between(files: Sequence[Path], from_s: float, until_s: float) -> list[Path]:
    """Return the files that overlap the time between two times, by their first times."""
    if len(files) < 2 or (from_s == -math.inf and until_s == math.inf):
        return list(files)
    first_s = [_first_time_s(file) for file in files]
    next_s = [*first_s[1:], math.inf]
    return [
        file
        for file, begin_s, end_s in zip(files, first_s, next_s, strict=True)
        if begin_s <= until_s and end_s >= from_s
    ]


def _first_time_s(path: Path) -> float:
    with opened_for_reading(path) as file:
        file.readline(_LONGEST_LINE)
        row = file.readline(_LONGEST_LINE)
    try:
        return float(row.partition(b",")[0])
    except ValueError:
        return -math.inf  # reading the file reports what is wrong


def last_time_s(path: Path) -> float:
    """Return the last time in timings from the end of the last file [s]; NaN if there is none."""
    for file in reversed(_files_of(path)):
        with opened_for_reading(file) as opened:
            end = opened.seek(0, os.SEEK_END)
            opened.seek(max(0, end - _LONGEST_LINE))
            content = without_cut_line(opened.read(), file)
        last = content.rstrip().rpartition(b"\n")[2].partition(b",")[0]
        try:
            return float(last)
        except ValueError:  # the heading, or damage that reading reports
            continue
    return math.nan


def _read_file(path: Path) -> Timing:
    with opened_for_reading(path) as file:
        content = without_cut_line(file.read(_LARGEST_BYTES), path)
    if not content and path.suffix == ".partial":  # its program was killed at once
        content = HEADING
    table = _table(content, path)
    timing = Timing(**{name: table[name].to_numpy() for name in COLUMNS})
    faults = {
        f"t_s must be finite, up to {LATEST_S:g} s": ~(np.abs(timing.t_s) <= LATEST_S),
        "images and people must not be negative": (timing.images < 0) | (timing.people < 0),
        "fusion_ms must be a finite number from 0 up": ~(
            (timing.fusion_ms >= 0) & np.isfinite(timing.fusion_ms)
        ),
    }
    told = [f"line {np.argmax(bad) + 2}: {text}" for text, bad in faults.items() if bad.any()]
    if told:
        raise InputError(f"{path}: " + "; ".join(told))
    return timing


def _table(content: bytes, path: Path) -> pa.Table:
    try:
        table = pa_csv.read_csv(
            native_reader(content),
            pa_csv.ReadOptions(use_threads=False),  # else a thread may outlive the reading
            convert_options=pa_csv.ConvertOptions(column_types=COLUMNS, null_values=[]),
        )
    except (pa.ArrowException, ValueError, OSError) as error:
        reason = " ".join(str(error).split())[:200]
        raise InputError(f"{path} is not a file of timings: {reason}") from None
    if sorted(table.column_names) != sorted(COLUMNS):
        found = ", ".join(table.column_names)[:120]
        raise InputError(f"{path}: expected the columns {','.join(COLUMNS)}, found: {found}")
    return table
