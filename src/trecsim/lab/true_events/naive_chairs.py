"""Chairs that go by a timetable, and who is on one of them, read naively from their definition."""

import json
import math
from collections.abc import Iterator, Mapping
from functools import lru_cache
from typing import Any

import numpy as np
from jaxtyping import Float64

from trecsim.lab.true_events.naive_places import left_of_m

Table = Mapping[str, Any]
Line = Float64[np.ndarray, "2 2"]


def _chairs(table: Table, t_s: float) -> Iterator[tuple[int, float]]:
    """Yield number and time since the start of each chair that is under way [s]."""
    start_s, period_s = table.get("start_s", 0.0), table.get("period_s")
    newest = 0 if period_s is None else math.floor((t_s - start_s) / period_s)
    for number in range(max(newest - 100, 0), newest + 1):
        since_s = t_s - start_s - number * (period_s or 0.0)
        if 0.0 <= since_s <= table["path_s"][-1]:
            yield number, since_s


def _middle_m(table: Table, since_s: float) -> Float64[np.ndarray, " 2"]:
    path_m = np.array(table["path_m"], float)
    return np.array([np.interp(since_s, table["path_s"], path_m[:, axis]) for axis in (0, 1)])


def _past_m(table: Table, line_m: Line, since_s: float) -> float:
    return float(left_of_m(line_m, _middle_m(table, since_s)[None])[0])


def coming_since_s(
    table: Table, line_m: Line, next_s: float, t_s: Float64[np.ndarray, " time"]
) -> list[float]:
    """Return since when each chair comes that does so at the last of some times [s].

    A chair comes while it has not passed the line, and will have done so in `next_s`.
    """
    now = float(t_s[-1])
    after_s = _passes_after_s(json.dumps(table), tuple(map(tuple, line_m.tolist())))
    if math.isnan(after_s):
        return []
    start_s, period_s = table.get("start_s", 0.0), table.get("period_s")
    first = 0 if period_s is None else max(math.floor((now - start_s - after_s) / period_s), 0)
    numbers = range(1) if period_s is None else range(first, first + 1000)
    since = []
    for number in numbers:
        passes_s = start_s + number * (period_s or 0.0) + after_s
        if passes_s > now + next_s:
            break
        if passes_s > now:
            since.append(float(t_s[np.searchsorted(t_s, passes_s - next_s)]))
    return since


@lru_cache
def _passes_after_s(table_text: str, line: tuple[tuple[float, ...], ...]) -> float:
    """Return how long after its start a chair passes the line [s]; NaN where it does not."""
    table, line_m = json.loads(table_text), np.array(line)
    for since_s in np.arange(0.0, table["path_s"][-1], 0.001).tolist():
        if _past_m(table, line_m, since_s) > 0.0:
            return float(since_s)
    return math.nan


def is_on_a_chair_past(
    table: Table, line_m: Line, t_s: float, xyz_m: Float64[np.ndarray, "joint 3"]
) -> bool:
    """Tell whether a joint is inside a chair whose middle has passed the line."""
    length_m, width_m, height_m = table["size_m"]
    low_m = table.get("bottom_m", 0.0)
    path_m, path_s = np.array(table["path_m"], float), table["path_s"]
    for _, since_s in _chairs(table, t_s):
        if _past_m(table, line_m, since_s) <= 0.0:
            continue
        part = min(max(int(np.searchsorted(path_s, since_s)), 1), len(path_s) - 1)
        way_m = path_m[part] - path_m[part - 1]
        ahead = way_m / np.hypot(*way_m)
        away_m = xyz_m[:, :2] - _middle_m(table, since_s)
        along_m, across_m = away_m @ ahead, away_m @ np.array([-ahead[1], ahead[0]])
        inside = (np.abs(along_m) <= length_m / 2) & (np.abs(across_m) <= width_m / 2)
        if (inside & (xyz_m[:, 2] >= low_m) & (xyz_m[:, 2] <= low_m + height_m)).any():
            return True
    return False
