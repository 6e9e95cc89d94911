"""What each frame set cost, `timing.csv`: `t_s,images,people,fusion_ms`, one row per frame set."""

import io
import os
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Self

import numpy as np
import pyarrow as pa
from jaxtyping import Float64, Int64
from pyarrow import csv as pa_csv

from trecsim.errors import InputError
from trecsim.store.atomic import opened_for_reading, partial_path
from trecsim.store.growing import GrowingFile, without_cut_line

NAME = "timing.csv"
COLUMNS = {
    "t_s": pa.float64(),
    "images": pa.int64(),
    "people": pa.int64(),
    "fusion_ms": pa.float64(),
}

_LARGEST_BYTES = 2**29  # about 20 million frame sets: more than a week at 25 a second


@dataclass(frozen=True, slots=True)
class StepTiming:
    """What one frame set cost.

    Attributes
    ----------
    t_s
        Time of its newest image [s].
    images
        How many images it holds.
    people
        How many people were there after it.
    fusion_ms
        Time that association and fit took [ms].
    """

    t_s: float
    images: int
    people: int
    fusion_ms: float


@dataclass(frozen=True, slots=True, eq=False)
class Timing:
    """What the frame sets of a recording cost, in their order.

    Attributes
    ----------
    t_s
        Times of their newest images [s].
    images
        How many images each holds.
    people
        How many people were there after each.
    fusion_ms
        Time that association and fit took [ms].
    """

    t_s: Float64[np.ndarray, " step"]
    images: Int64[np.ndarray, " step"]
    people: Int64[np.ndarray, " step"]
    fusion_ms: Float64[np.ndarray, " step"]


class TimingWriter:
    """Writes timings; at most the last two seconds are lost, however the program ends.

    The rows go to ``NAME.partial``, which takes its final name when the block ends without an
    error.

    Parameters
    ----------
    path
        The file, usually ``timing.csv``.
    clock
        Tells the time [s].

    Raises
    ------
    InputError
        The place cannot be written to.
    SetupError
        The disk is full.
    """

    def __init__(self, path: Path, *, clock: Callable[[], float] = time.monotonic) -> None:
        self._file = GrowingFile(path, (",".join(COLUMNS) + "\n").encode(), clock=clock)

    def write(self, step: StepTiming) -> None:
        """Append one frame set."""
        row = f"{step.t_s!r},{step.images},{step.people},{step.fusion_ms:.4f}\n"
        self._file.write(row.encode())

    def close(self) -> None:
        """Give the complete file its name."""
        self._file.close()

    def abandon(self) -> None:
        """End early: what was written stays under the name of an unfinished file."""
        self._file.abandon()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._file.__exit__(kind, error, trace)


def timing_writer(path: Path) -> TimingWriter:
    """Open a file of timings for writing as long as a block runs."""
    return TimingWriter(path)


def timing_in(folder: Path) -> Path | None:
    """Return where the timings of a recording are, complete or not; None if it has none."""
    whole = folder / NAME
    return next((path for path in (whole, partial_path(whole)) if path.exists()), None)


def read_timing(path: Path) -> Timing:
    """Read a file of timings.

    Parameters
    ----------
    path
        The file.

    Raises
    ------
    InputError
        It is not there or not right.
    """
    with opened_for_reading(path) as file:
        size_bytes = os.fstat(file.fileno()).st_size
        if size_bytes > _LARGEST_BYTES:
            raise InputError(
                f"{path} has {size_bytes / 1e6:.0f} MB, timings may have up to "
                f"{_LARGEST_BYTES / 1e6:.0f} MB; cut the file"
            )
        table = _table(without_cut_line(file.read(), path), path)
    timing = Timing(**{name: table[name].to_numpy() for name in COLUMNS})
    faults = {
        "t_s must be finite": ~np.isfinite(timing.t_s),
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
            io.BytesIO(content),
            convert_options=pa_csv.ConvertOptions(column_types=COLUMNS, null_values=[]),
        )
    except (pa.ArrowException, ValueError, OSError) as error:
        reason = " ".join(str(error).split())[:200]
        raise InputError(f"{path} is not a file of timings: {reason}") from None
    if sorted(table.column_names) != sorted(COLUMNS):
        found = ", ".join(table.column_names)[:120]
        raise InputError(f"{path}: expected the columns {','.join(COLUMNS)}, found: {found}")
    return table
