"""Files of events, put together to episodes: what happened when, to whom."""

import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from trecsim.errors import InputError
from trecsim.store.atomic import opened_for_reading

LONGEST_LINE = 1 << 20  # bytes
LATEST_S = 1e11
"""No event is later [s]."""


@dataclass(frozen=True, slots=True)
class EpisodeTold:
    """One episode, as the events of a file tell it.

    Attributes
    ----------
    rule, kind
        Which rule it is of.
    direction
        Of a crossing.
    start_s, detect_s, end_s
        When it began, when that was decided, and when it ended [s]; `end_s` is None where that is
        not told.
    floor_m
        Where the first person stood when it was told [m].
    is_warning
        Whether it was only predicted, and did not happen.
    worse_s
        In the truth: when the worse thing began, of which early warnings warn [s].
    """

    rule: str
    kind: str
    direction: str | None
    start_s: float
    detect_s: float
    end_s: float | None
    floor_m: tuple[float, float] | None
    is_warning: bool = False
    worse_s: float | None = None


def read_episodes(path: Path) -> list[EpisodeTold]:
    """Read a file of events, and put its episodes together, in the order of their first events.

    What people did to an event is left out.

    Parameters
    ----------
    path
        ``*.jsonl`` with one CloudEvent a line.

    Raises
    ------
    InputError
        When it cannot be read, or a line is no event; the message names the line.
    """
    episodes: dict[str, EpisodeTold] = {}
    for number, data in event_data_of(path):
        try:
            _take(episodes, data)
        except (LookupError, TypeError, ValueError, AttributeError) as error:
            what = f"{error} is missing" if isinstance(error, KeyError) else str(error)
            raise InputError(
                f"{path}: line {number}: expected the event of a rule, as in events.jsonl: {what}"
            ) from None
    return list(episodes.values())


def episodes_of(events: Iterable[Mapping[str, Any]]) -> list[EpisodeTold]:
    """Return the episodes of events, in the order of their first events; see `read_episodes`."""
    episodes: dict[str, EpisodeTold] = {}
    for event in events:
        _take(episodes, event["data"])
    return list(episodes.values())


def event_data_of(path: Path) -> Iterator[tuple[int, Mapping[str, Any]]]:
    """Yield number and `data` of each line of a file of events; see `read_episodes`."""
    with opened_for_reading(path) as file:
        number = 0
        while line := file.readline(LONGEST_LINE + 1):
            number += 1
            if len(line) > LONGEST_LINE:
                raise InputError(f"{path}: line {number} is longer than 1 MiB: it is no event")
            if not line.strip():
                continue
            try:
                event = json.loads(line)
            except (ValueError, RecursionError):
                raise InputError(
                    f"{path}: line {number}: expected one JSON object, found {line[:40]!r}"
                ) from None
            if not isinstance(event, dict) or not isinstance(event.get("data"), dict):
                raise InputError(f"{path}: line {number}: expected an event with data")
            yield number, event["data"]


def _take(episodes: dict[str, EpisodeTold], data: Mapping[str, Any]) -> None:
    phase, identity = str(data["phase"]), str(data["event"])
    if phase not in ("new", "update", "end"):
        return
    if phase == "new" or identity not in episodes:
        episodes[identity] = _begun(data)
        return
    known = episodes[identity]
    if phase == "update" and known.is_warning and not data.get("predicted", False):
        episodes[identity] = _begun(data)  # what was predicted has begun
    elif phase == "end":
        episodes[identity] = replace(known, end_s=_time_s(data, "t_end_s"))


def _begun(data: Mapping[str, Any]) -> EpisodeTold:
    rule = data["rule"]
    start_s = _time_s(data, "t_start_s")
    if start_s is None:
        raise ValueError("expected t_start_s as a time in seconds, found null")
    detect_s = _time_s({"t_detect_s": None, **data}, "t_detect_s")
    direction = data.get("direction")
    if not isinstance(direction, str | None):
        raise TypeError(f"expected direction as text, found {direction!r:.40}")
    return EpisodeTold(
        rule=str(rule["id"]),
        kind=str(rule["kind"]),
        direction=direction,
        start_s=start_s,
        detect_s=start_s if detect_s is None else detect_s,
        end_s=_time_s({"t_end_s": None, **data}, "t_end_s"),
        floor_m=_floor_m(data.get("people") or []),
        is_warning=bool(data.get("predicted", False)),
        worse_s=_time_s({"worse_s": None, **(data.get("measures") or {})}, "worse_s"),
    )


def _floor_m(people: Any) -> tuple[float, float] | None:
    xy_m = people[0].get("floor_m") if people else None
    if xy_m is None or None in xy_m:
        return None
    return float(xy_m[0]), float(xy_m[1])


def _time_s(data: Mapping[str, Any], key: str) -> float | None:
    value = data[key]
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) <= LATEST_S:
        raise ValueError(f"expected {key} as a time in seconds, found {value!r:.40}")
    return float(value)
