"""A naive reading of chairs that go by a timetable or a feed, and of who is on one of them."""

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float64

from trecsim.lab.true_events.naive_places import left_of_m

Table = Mapping[str, Any]
Line = Float64[np.ndarray, "2 2"]


class Chair(NamedTuple):
    """A chair at one time: which one, its middle, where it points to, and how long it has gone."""

    key: str
    middle_m: Float64[np.ndarray, " 2"]
    ahead: Float64[np.ndarray, " 2"]
    since_s: float


@lru_cache
def coming(
    table_text: str,
    messages_text: str,
    line: tuple[tuple[float, ...], ...],
    next_s: float,
    t_s: tuple[float, ...],
) -> list[dict[str, float]]:
    """Return for each time the chairs that come, each with since when [s].

    A chair comes while it has not passed the line, and will have done so in `next_s`.

    Parameters
    ----------
    table_text, messages_text
        The volume and the messages of its feed, as JSON.
    line, next_s
        Two points of the line [m], and the time [s].
    t_s
        The times [s].
    """
    table, messages, line_m = json.loads(table_text), json.loads(messages_text), np.array(line)
    passes_s = [] if "feed" in table else list(_passes_s(table, line_m, t_s[-1] + next_s))
    found: list[dict[str, float]] = []
    for now in t_s:
        if "feed" in table:
            keys = set(_told_to_come(table, messages, line_m, next_s, now))
        else:
            keys = {f"{n}" for n, one in enumerate(passes_s) if now < one <= now + next_s}
        before = found[-1] if found else {}
        found.append({key: before.get(key, now) for key in keys})
    return found


def _passes_s(table: Table, line_m: Line, until_s: float) -> Iterator[float]:
    """Yield when each chair of a timetable passes the line [s]."""
    path_s = np.arange(0.0, table["path_s"][-1], 0.001)
    past = [one for one in path_s.tolist() if _past_m(line_m, _on_path_m(table, one)) > 0.0]
    if not past:
        return
    at_s = table.get("start_s", 0.0) + past[0]
    while at_s <= until_s:
        yield at_s
        if table.get("period_s") is None:
            return
        at_s += table["period_s"]


def _told_to_come(
    table: Table, messages: Sequence[Table], line_m: Line, next_s: float, t_s: float
) -> Iterator[str]:
    here = {one.key: one.middle_m for one in _told(messages, t_s, 0.0)}
    for one in _told(messages, t_s, next_s):
        if _past_m(line_m, one.middle_m) > 0.0 >= _past_m(line_m, here[one.key]):
            yield one.key


def _told(messages: Sequence[Table], t_s: float, ahead_s: float) -> Iterator[Chair]:
    """Yield where chairs will be if each goes straight on as it did by its last two messages."""
    known: dict[str, list[Table]] = {}
    for one in messages:
        if "volume" in one and one["t_s"] <= t_s:
            if one.get("gone"):
                known.pop(one["id"], None)
            else:
                known.setdefault(one["id"], []).append(one)
    for key, told in known.items():
        last_m, velocity = np.array(told[-1]["xy_m"], float), np.zeros(2)
        if len(told) > 1:
            way_m = last_m - np.array(told[-2]["xy_m"])
            velocity = way_m / (told[-1]["t_s"] - told[-2]["t_s"])
        heading_rad = math.radians(told[-1]["heading_deg"])
        ahead = np.array([math.cos(heading_rad), math.sin(heading_rad)])
        middle_m = last_m + (t_s + ahead_s - told[-1]["t_s"]) * velocity
        yield Chair(key, middle_m, ahead, t_s - told[0]["t_s"])


def _by_timetable(table: Table, t_s: float) -> Iterator[Chair]:
    """Yield the chairs of a timetable that are under way."""
    start_s, period_s = table.get("start_s", 0.0), table.get("period_s")
    path_m, path_s = np.array(table["path_m"], float), table["path_s"]
    newest = 0 if period_s is None else math.floor((t_s - start_s) / period_s)
    for number in range(max(newest - 100, 0), newest + 1):
        since_s = t_s - start_s - number * (period_s or 0.0)
        if 0.0 <= since_s <= path_s[-1]:
            part = min(max(int(np.searchsorted(path_s, since_s)), 1), len(path_s) - 1)
            way_m = path_m[part] - path_m[part - 1]
            ahead = way_m / np.hypot(*way_m)
            yield Chair(f"{number}", _on_path_m(table, since_s), ahead, since_s)


def _on_path_m(table: Table, since_s: float) -> Float64[np.ndarray, " 2"]:
    path_m = np.array(table["path_m"], float)
    return np.array([np.interp(since_s, table["path_s"], path_m[:, axis]) for axis in (0, 1)])


def _past_m(line_m: Line, middle_m: Float64[np.ndarray, " 2"]) -> float:
    return float(left_of_m(line_m, middle_m[None])[0])


def is_on_a_chair_past(
    table: Table,
    messages: Sequence[Table],
    line_m: Line,
    t_s: float,
    xyz_m: Float64[np.ndarray, "joint 3"],
) -> bool:
    """Tell whether a joint is inside a chair whose middle has passed the line."""
    return any(
        _past_m(line_m, chair.middle_m) > 0.0 and _is_in(table, chair, xyz_m)
        for chair in _under_way(table, messages, t_s)
    )


def is_at_a_box(
    table: Table,
    messages: Sequence[Table],
    t_s: float,
    xyz_m: Float64[np.ndarray, "joint 3"],
    *,
    margin_m: float = 0.0,
    after_s: float = 0.0,
) -> bool:
    """Tell whether a joint is inside a box that has gone for so long, or as near as a margin."""
    return any(
        chair.since_s >= after_s and _is_in(table, chair, xyz_m, margin_m)
        for chair in _under_way(table, messages, t_s)
    )


def _under_way(table: Table, messages: Sequence[Table], t_s: float) -> Iterator[Chair]:
    return _told(messages, t_s, 0.0) if "feed" in table else _by_timetable(table, t_s)


def _is_in(
    table: Table, chair: Chair, xyz_m: Float64[np.ndarray, "joint 3"], margin_m: float = 0.0
) -> bool:
    length_m, width_m, height_m = table["size_m"]
    low_m = table.get("bottom_m", 0.0)
    away_m = xyz_m[:, :2] - chair.middle_m
    along_m = np.abs(away_m @ chair.ahead)
    across_m = np.abs(away_m @ np.array([-chair.ahead[1], chair.ahead[0]]))
    inside = (along_m <= length_m / 2 + margin_m) & (across_m <= width_m / 2 + margin_m)
    return bool((inside & (xyz_m[:, 2] >= low_m) & (xyz_m[:, 2] <= low_m + height_m)).any())
