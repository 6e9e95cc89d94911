"""Events of rules as a film shows them: which are open at a moment, and about whom."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from trecsim.errors import InputError
from trecsim.films.strokes import ALARM, WARNING, Colour

_SEVERITIES = ("info", "warning", "alarm", "critical")
_SHOWN_S = 3.0  # of what happens in a moment
_FORGOTTEN_S = 3600.0  # an event without an end is no longer shown after this long


@dataclass(frozen=True, slots=True)
class Alert:
    """One event."""

    from_s: float
    until_s: float
    severity: str
    text: str
    people: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Alerts:
    """What is open at one moment.

    Attributes
    ----------
    open
        The events.
    people
        The worst severity of those that are about each person.
    """

    open: tuple[Alert, ...] = ()
    people: Mapping[int, str] = field(default_factory=dict)

    def colour(self, person: int) -> Colour | None:
        """Return the colour that marks a person; None without an event, or for mere information."""
        return severity_colour(self.people[person]) if person in self.people else None


def open_at(alerts: list[Alert], t_s: float) -> Alerts:
    """Return the events that are open at a moment, and the worst severity for each person."""
    now = tuple(one for one in alerts if one.from_s <= t_s < one.until_s)
    by_severity = sorted(now, key=lambda one: _SEVERITIES.index(one.severity))
    return Alerts(now, {person: one.severity for one in by_severity for person in one.people})


def severity_colour(severity: str) -> Colour | None:
    """Return the colour of an event; None for mere information."""
    return {"info": None, "warning": WARNING}.get(severity, ALARM)


def read_alerts(path: Path) -> list[Alert]:
    """Read `events.jsonl`, as `trecsim assess` and live sites write it.

    Raises
    ------
    InputError
        When it cannot be read; the message names the line.
    """
    found: dict[str, Alert] = {}
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"cannot read events {path}: {error}") from None
    for number, line in enumerate(lines, 1):
        if not line.strip():
            continue
        try:
            _take(json.loads(line)["data"], found)
        except (ValueError, KeyError, TypeError) as error:
            raise InputError(
                f"{path}: line {number} is no event of trecsim ({error!r}); expected the file that "
                "trecsim assess writes"
            ) from None
    return sorted(found.values(), key=lambda one: one.from_s)


def _take(data: dict[str, Any], found: dict[str, Alert]) -> None:
    event, phase = str(data["event"]), data["phase"]
    if "rule" not in data:  # of a camera or the disk, not of people
        return
    before = found.get(event)
    if phase in ("new", "update"):
        from_s = before.from_s if before else float(data["t_detect_s"])
        people = tuple(int(one["person"]) for one in data.get("people") or ())
        ends = data.get("t_end_s")
        until_s = from_s + _FORGOTTEN_S
        if ends is not None:
            until_s = max(float(ends), from_s + _SHOWN_S)
        place = next((data[key] for key in ("zone", "line", "edge") if data.get(key)), None)
        text = f"{data['rule']['id']} ({place})" if place else str(data["rule"]["id"])
        if people:
            text += ": " + ", ".join(str(one) for one in people[:4])
        severity = _SEVERITIES[_SEVERITIES.index(str(data["severity"]))]
        found[event] = Alert(from_s, until_s, severity, text, people)
    elif phase in ("end", "close") and before is not None:
        ends = data.get("t_end_s")
        until_s = float(ends if ends is not None else data["t_detect_s"])
        found[event] = Alert(
            before.from_s, max(until_s, before.from_s + 1.0), before.severity, before.text,
            before.people,
        )  # fmt: skip
