"""Floor paths from files: tracks, a CSV of floor points, or the layout of ETH/UCY."""

import csv
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np

from trecsim.errors import InputError
from trecsim.floor_points import path_xy
from trecsim.forecasting import Moment
from trecsim.store.atomic import opened_for_reading
from trecsim.store.limits import FARTHEST_M, LATEST_S
from trecsim.store.row_faults import raise_faults
from trecsim.store.rows import COLUMNS as TRACK_COLUMNS
from trecsim.store.tracks import read_tracks

COLUMNS = ("t_s", "person", "x_m", "y_m")
SAMPLE_S = 0.4
"""Time between two samples of one person in the layout of ETH/UCY [s]."""
Row = tuple[float, int, float, float]


def read_floor_paths(path: Path | str) -> list[Moment]:
    """Read where people were on the floor: all moments, in order of time.

    Parameters
    ----------
    path
        Tracks (`*.csv`, `*.parquet` or the folder of a recording); a CSV file with the columns
        ``t_s,person,x_m,y_m``; or a text file of ETH/UCY with ``frame person x y``, whose usual
        step between two frames of a person is 0.4 s.

    Raises
    ------
    InputError
        When the file is missing or wrong; the message names the lines.
    """
    path = Path(path)
    if not path.is_file() or path.suffix.lower() in (".parquet", ".partial"):
        return _of_tracks(path)
    with opened_for_reading(path) as file:
        first = file.readline(1 << 16).decode("utf-8-sig", errors="replace")
    header = [name.strip() for name in first.split(",")]
    if set(COLUMNS) <= set(header) and "joint" not in header:
        return _moments(_rows_of_csv(path), path)
    if _numbers(first.split()) is not None or path.suffix.lower() == ".txt":
        return _moments(_rows_of_frames(path), path)
    if "joint" not in header:
        raise InputError(
            f"{path}: line 1: expected the columns {','.join(COLUMNS)} of floor points, or "
            f"{','.join(TRACK_COLUMNS)} of tracks; found {first.strip()[:80] or 'nothing'}"
        )
    return _of_tracks(path)


def _of_tracks(path: Path) -> list[Moment]:
    return [(one.t_s, one.id, path_xy(one.xyz_m, one.support)) for one in read_tracks(path)]


def _rows_of_csv(path: Path) -> list[Row]:
    rows: list[Row] = []
    faults: list[tuple[int, str]] = []
    with opened_for_reading(path) as file:
        lines = (line.decode("utf-8-sig", errors="replace") for line in file)
        for number, record in enumerate(csv.DictReader(lines, skipinitialspace=True), start=2):
            fields = _numbers([record.get(name) or "" for name in COLUMNS])
            _take(rows, faults, number, fields, "expected t_s, person, x_m, y_m as numbers")
    raise_faults(path, faults, "line")
    return rows


def _rows_of_frames(path: Path) -> list[Row]:
    rows: list[Row] = []
    faults: list[tuple[int, str]] = []
    with opened_for_reading(path) as file:
        for number, line in enumerate(file, start=1):
            if words := line.decode("utf-8", errors="replace").split():
                fields = _numbers(words)
                _take(rows, faults, number, fields, "expected four numbers: frame, person, x, y")
    raise_faults(path, faults, "line")
    step = _usual_step(rows, path)
    return [(frame / step * SAMPLE_S, person, x, y) for frame, person, x, y in rows]


def _take(
    rows: list[Row],
    faults: list[tuple[int, str]],
    number: int,
    fields: tuple[float, ...] | None,
    expected: str,
) -> None:
    if fields is None or len(fields) != len(COLUMNS):
        faults.append((number, expected))
        return
    t_s, person, x, y = fields
    if not abs(t_s) <= LATEST_S or person < 0 or person % 1:
        faults.append((number, "expected a finite time and a whole number from 0 up as person"))
    elif abs(x) > FARTHEST_M or abs(y) > FARTHEST_M:
        faults.append((number, f"x and y must be within {FARTHEST_M:g} m"))
    else:
        rows.append((t_s, int(person), x, y))


def _numbers(words: Iterable[str]) -> tuple[float, ...] | None:
    try:
        return tuple(float(word) for word in words) or None
    except ValueError:
        return None


def _usual_step(rows: list[Row], path: Path) -> float:
    frames: defaultdict[int, list[float]] = defaultdict(list)
    for frame, person, _, _ in rows:
        frames[person].append(frame)
    steps = Counter(b - a for seen in frames.values() for a, b in pairwise(sorted(seen)) if b > a)
    if not steps:
        raise InputError(f"{path}: nobody is there twice, so the time between frames is unknown")
    return steps.most_common(1)[0][0]


def _moments(rows: list[Row], path: Path) -> list[Moment]:
    by_time: defaultdict[float, dict[int, tuple[float, float]]] = defaultdict(dict)
    for t_s, person, x_m, y_m in rows:
        if person in by_time[round(t_s, 6)]:
            raise InputError(
                f"{path}: person {person} is there twice at {t_s:.13g} s; keep one row"
            )
        by_time[round(t_s, 6)][person] = (x_m, y_m)
    return list(_sorted(by_time))


def _sorted(by_time: dict[float, dict[int, tuple[float, float]]]) -> Iterator[Moment]:
    for t_s, there in sorted(by_time.items()):
        yield t_s, np.array(list(there), np.int64), np.array(list(there.values()), np.float64)
