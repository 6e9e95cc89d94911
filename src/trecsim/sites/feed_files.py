"""Messages of feeds as lines of JSON: read one, read the file of a feed, read those of a recording.

A line is an object with `t_s`, the time of what it reports [s], and at most one of `grant` (the
name of a line), `closed` (the name of a line) and `volume` (the name of a volume). With none of
them it only says that the feed works. A `grant` may have `people`, a `volume` has `xy_m` or
`gone`, and may have `id` and `heading_deg`.
"""

import json
import math
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from itertools import chain
from pathlib import Path
from typing import Any, BinaryIO

from trecsim.errors import InputError
from trecsim.safety.signals import Signal
from trecsim.sites.feed_tables import FeedTable
from trecsim.store.names import SIGNALS, SIGNALS_S

LONGEST_LINE = 4096
"""A longer line is no message [bytes]."""
_KEYS: Mapping[str, frozenset[str]] = {
    "alive": frozenset({"t_s"}),
    "grant": frozenset({"t_s", "grant", "people"}),
    "closed": frozenset({"t_s", "closed"}),
    "volume": frozenset({"t_s", "volume", "id", "xy_m", "heading_deg", "gone"}),
}
_LONGEST_NAME = 64
_MOST_PEOPLE = 1000
_FURTHEST_M = 1e4
_LATEST_S = 1e11


class _WrongMessageError(Exception):
    """What is wrong with a message."""


def signal_of(feed: str, line: bytes | str, known_s: float = 0.0) -> Signal:
    """Read one message; one that cannot be read is "unreadable", with the reason in `note`.

    Parameters
    ----------
    feed
        Name of the feed.
    line
        The message.
    known_s
        Stands for the time of a message that has none [s].

    Examples
    --------
    >>> signal_of("tickets", '{"t_s": 3.5, "grant": "left"}').what
    'grant'
    >>> signal_of("tickets", '{"t_s": 3.5, "grnat": "left"}').note
    "unknown key 'grnat' in a message"
    """
    try:
        return _signal(feed, _parsed(line))
    except _WrongMessageError as wrong:
        return Signal(feed, known_s, "unreadable", note=str(wrong))


def _parsed(line: bytes | str) -> Mapping[str, Any]:
    if len(line) > LONGEST_LINE:
        raise _WrongMessageError(f"a message is longer than {LONGEST_LINE} bytes")
    try:
        given = json.loads(line)
    except (ValueError, RecursionError):
        raise _WrongMessageError("a message is no JSON") from None
    if not isinstance(given, dict):
        raise _WrongMessageError("a message is no object")
    return given


def _signal(feed: str, given: Mapping[str, Any]) -> Signal:
    kinds = [what for what in ("grant", "closed", "volume") if what in given]
    if len(kinds) > 1:
        raise _WrongMessageError(
            f"expected one of grant, closed and volume, found {' and '.join(kinds)}"
        )
    what = kinds[0] if kinds else "alive"
    unknown = sorted(given.keys() - _KEYS[what])
    if unknown:
        raise _WrongMessageError(f"unknown key {unknown[0]!r:.40} in a message")
    t_s = _number(given, "t_s", _LATEST_S)
    if what == "grant":
        return Signal(feed, t_s, "grant", _name(given, what), people=_people(given))
    if what == "closed":
        return Signal(feed, t_s, "closed", _name(given, what))
    if what == "volume":
        return _vehicle(feed, t_s, given)
    return Signal(feed, t_s)


def _vehicle(feed: str, t_s: float, given: Mapping[str, Any]) -> Signal:
    name, vehicle = _name(given, "volume"), _vehicle_name(given.get("id", ""))
    gone = given.get("gone", False)
    if not isinstance(gone, bool):
        raise _WrongMessageError(f"expected gone as true or false, found {gone!r:.40}")
    if gone:
        return Signal(feed, t_s, "gone", name, vehicle=vehicle)
    xy_m = given.get("xy_m")
    if not isinstance(xy_m, list) or len(xy_m) != 2:
        raise _WrongMessageError("expected xy_m = [x, y] of a volume")
    x, y = (_number({"xy_m": one}, "xy_m", _FURTHEST_M) for one in xy_m)
    heading_rad = None
    if given.get("heading_deg") is not None:
        heading_rad = math.radians(_number(given, "heading_deg", 360.0))
    return Signal(feed, t_s, "volume", name, vehicle=vehicle, xy_m=(x, y), heading_rad=heading_rad)


def _number(given: Mapping[str, Any], key: str, most: float) -> float:
    value = given.get(key)
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) <= most:
        raise _WrongMessageError(
            f"expected {key} as a number of at most {most:g}, found {value!r:.40}"
        )
    return float(value)


def _name(given: Mapping[str, Any], key: str) -> str:
    name = given[key]
    if not isinstance(name, str) or len(name) > _LONGEST_NAME or not name.isprintable():
        raise _WrongMessageError(f"expected {key} as the name of a place, found {name!r:.40}")
    return name


def _vehicle_name(given: object) -> str:
    """Return the name of a vehicle: messages and logs quote it, recordings keep it."""
    name = str(given) if type(given) is int else given
    if not isinstance(name, str) or len(name) > _LONGEST_NAME or not name.isprintable():
        raise _WrongMessageError(
            f"expected id as a number or up to {_LONGEST_NAME} letters, found {given!r:.40}"
        )
    return name


def _people(given: Mapping[str, Any]) -> int:
    people = given.get("people", 1)
    if isinstance(people, bool) or not isinstance(people, int) or not 1 <= people <= _MOST_PEOPLE:
        raise _WrongMessageError(f"expected people from 1 to {_MOST_PEOPLE}, found {people!r:.40}")
    return people


def line_of(signal: Signal) -> str:
    """Return a message as a line of a recording, with the feed and the time of its arrival."""
    facts: dict[str, Any] = {"feed": signal.feed, "taken_s": signal.taken_s, "t_s": signal.t_s}
    if signal.what in ("grant", "closed"):
        facts[signal.what] = signal.about
        if signal.people != 1:
            facts["people"] = signal.people
    elif signal.what in ("volume", "gone"):
        facts |= {"volume": signal.about, "id": signal.vehicle}
        if signal.xy_m is not None:
            facts["xy_m"] = list(signal.xy_m)
        if signal.heading_rad is not None:
            facts["heading_deg"] = _degrees(signal.heading_rad)
        if signal.what == "gone":
            facts["gone"] = True
    elif signal.what == "unreadable":
        facts["unreadable"] = signal.note
    return json.dumps(facts)


def _degrees(angle_rad: float) -> float:
    """Return an angle in degrees that is read as the same angle again, to the last bit."""
    near = math.degrees(angle_rad)
    above, below = math.nextafter(near, math.inf), math.nextafter(near, -math.inf)
    return next((one for one in (near, above, below) if math.radians(one) == angle_rad), near)


def recorded_signal(line: bytes) -> Signal:
    """Read a line that `line_of` wrote."""
    facts = dict(_parsed(line))
    feed, taken_s = str(facts.pop("feed", "")), _number(facts, "taken_s", _LATEST_S)
    del facts["taken_s"]
    if "unreadable" in facts:
        t_s = _number(facts, "t_s", _LATEST_S)
        return Signal(feed, t_s, "unreadable", taken_s=taken_s, note=str(facts["unreadable"]))
    return replace(_signal(feed, facts), taken_s=taken_s)


def read_feed(name: str, path: Path) -> list[Signal]:
    """Read the file of a feed.

    Raises
    ------
    InputError
        When it cannot be read.
    """
    found: list[Signal] = []
    known_s = 0.0
    for line in _lines(path):
        one = signal_of(name, line, known_s)
        known_s = one.t_s
        found.append(one)
    return found


def kept_signals(recording: Path) -> list[Signal]:
    """Return the messages that the recording of a live site has kept; see `kept_between`."""
    return list(kept_between(recording))


def kept_between(
    recording: Path, from_s: float = -math.inf, to_s: float = math.inf
) -> Iterator[Signal]:
    """Yield the messages of a part of a recording in the order in which the rules got them.

    Parameters
    ----------
    recording
        Its folder.
    from_s, to_s
        First and last `taken_s`, both included [s].

    Raises
    ------
    InputError
        When a file cannot be read.
    """
    for path in sorted(recording.glob(SIGNALS.format("*"))) if recording.is_dir() else []:
        hour = _hour_of(path)
        if hour is None or (hour * SIGNALS_S <= to_s and from_s < (hour + 1) * SIGNALS_S):
            yield from (one for one in _kept(path) if from_s <= one.taken_s <= to_s)


def _hour_of(path: Path) -> int | None:
    """Return which hour of messages a file holds; None where its name does not say so."""
    before, after = SIGNALS.split("{}")
    with suppress(ValueError):
        return int(path.name.removeprefix(before).removesuffix(after))
    return None


def signals_of(feeds: Mapping[str, FeedTable], tracks: Path | None = None) -> list[Signal]:
    """Return the messages of feeds for a recording: those that it has kept, else of the files.

    What came by HTTP or MQTT is only known where the recording has kept it. That of a live site
    with feeds has kept all that the rules got, even where that is nothing.

    Parameters
    ----------
    feeds
        The feeds of the site file.
    tracks
        The recording: its folder, or a file in it.

    Raises
    ------
    InputError
        When a file cannot be read.
    """
    if not feeds:
        return []
    folder = tracks if tracks is None or tracks.is_dir() else tracks.parent
    if folder is not None and any(folder.glob(SIGNALS.format("*"))):
        return kept_signals(folder)
    files = ((name, feed.file) for name, feed in feeds.items() if feed.file is not None)
    return list(chain.from_iterable(read_feed(*one) for one in files))


def _kept(path: Path) -> Iterator[Signal]:
    for number, line in enumerate(_lines(path, ended=True), 1):
        try:
            yield recorded_signal(line)
        except (_WrongMessageError, KeyError) as wrong:
            raise InputError(
                f"{path}: message {number}, which a live site has kept, is damaged: {wrong}; "
                "restore the file, or delete that line"
            ) from None


def _bounded(file: BinaryIO) -> Iterator[bytes]:
    """Yield the lines of a file; of one that is too long the beginning, too long as well."""
    while line := file.readline(LONGEST_LINE + 2):
        rest = line
        while len(rest) > LONGEST_LINE + 1 and not rest.endswith(b"\n"):
            rest = file.readline(LONGEST_LINE + 2)
        yield line


def _lines(path: Path, *, ended: bool = False) -> Iterator[bytes]:
    """Yield the lines of a file; if they have to be ended, not one that is still being written."""
    try:
        with path.open("rb") as file:
            for line in _bounded(file):
                if line.strip() and (not ended or line.endswith(b"\n")):
                    yield line.strip()
    except OSError as error:
        raise InputError(
            f"{path}: the messages of a feed cannot be read: {error.strerror}"
        ) from None
