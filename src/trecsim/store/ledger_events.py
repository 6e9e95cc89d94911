"""What a ledger keeps of an event, and the event of what a person does to one."""

import json
import math
from collections.abc import Iterable, Mapping
from typing import Any

from trecsim.cloud_events import derived_id, event_text, rfc3339
from trecsim.errors import InputError

ACTS = ("ack", "shelve", "unshelve", "close", "reopen")
"""What a person can do to an event."""
LONGEST_SHELVED_S = 8.0 * 3600.0
REASONS = ("true", "false", "test", "expected")
"""Reasons to close an event."""
_SAID = ("by", "until_s", "reason", "note")
_SEVERITIES = ("info", "warning", "alarm", "critical")


def event_row(event: Mapping[str, Any]) -> tuple[Any, ...]:
    """Return the columns of an event: id, episode, phase, time, evidence, and its JSON text.

    Raises
    ------
    InputError
        When it is no event, or holds numbers that are not finite.
    """
    data = event.get("data")
    if not isinstance(event.get("id"), str) or not isinstance(data, Mapping):
        raise InputError(f"expected an event with id and data, found {str(event)[:200]}")
    evidence = data.get("evidence") or {}
    try:
        text = event_text(event)
    except (TypeError, ValueError) as error:
        raise InputError(f"event {event['id']!r} cannot be written as JSON: {error}") from None
    times = [data.get(key) for key in ("t_detect_s", "t_start_s", "t_end_s")]
    return (
        event["id"],
        str(data.get("event", event["id"])),
        str(data.get("phase", "new")),
        next((float(t_s) for t_s in times if t_s is not None), 0.0),
        evidence.get("t_from_s"),
        evidence.get("t_to_s"),
        text,
    )


def event_in(text: object) -> dict[str, Any] | None:
    """Return the event that a ledger holds as JSON text; None where the text is damaged.

    Examples
    --------
    >>> event_in('{"id": "a", "data": {"event": "e"}}')["id"], event_in('{"id": "a", "da')
    ('a', None)
    """
    try:
        event = json.loads(text) if isinstance(text, str) else None
    except (ValueError, RecursionError):
        return None
    if not isinstance(event, dict) or not isinstance(event.get("id"), str):
        return None
    return event if isinstance(event.get("data"), dict) else None


def without_people(
    event: Mapping[str, Any], from_s: float, to_s: float, person: int | None
) -> dict[str, Any] | None:
    """Return an event without the people whom it lists; None where none of them is to go.

    What happened, where the rule is, and when stays; who was there, and where, does not.

    Parameters
    ----------
    event
        The event.
    from_s, to_s
        The time that is erased; an event counts from its beginning to its end [s].
    person
        The identity; None for everybody.
    """
    data = event["data"]
    times = [data.get(key) for key in ("t_start_s", "t_detect_s", "t_end_s")]
    known = [float(t_s) for t_s in times if t_s is not None]
    if not known or min(known) > to_s or max(known) < from_s:
        return None
    people = data.get("people") or []
    kept = [one for one in people if person is not None and one.get("person") != person]
    if len(kept) == len(people):
        return None
    return {**event, "data": {**data, "people": kept, "erased": True}}


def checked_act(phase: str, said: Mapping[str, Any], now_s: float) -> dict[str, Any]:
    """Return what somebody says with an act, without what is None; refuse it if not complete.

    Parameters
    ----------
    phase
        What is done.
    said
        By whom, and `until_s`, `reason` and `note` if given.
    now_s
        Unix time [s]. An event is shelved for `LONGEST_SHELVED_S` at most: whatever is put aside
        comes back within the same shift.

    Raises
    ------
    InputError
        When it is not complete.
    """
    until_s, reason = said.get("until_s"), said.get("reason")
    if phase not in ACTS:
        raise InputError(f"expected one of {', '.join(ACTS)}, found {phase!r}")
    if (phase == "shelve") != (until_s is not None):
        raise InputError("shelving, and nothing else, needs until_s: how long the event is shelved")
    if phase == "close" and reason not in REASONS:
        raise InputError(f"closing needs a reason, one of {', '.join(REASONS)}; found {reason!r}")
    if phase != "close" and reason is not None:
        raise InputError(f"only closing has a reason; {phase} has none")
    if until_s is not None:
        if until_s <= now_s:
            raise InputError("an event is shelved until a time to come; until_s has passed")
        said = {**said, "until_s": min(until_s, now_s + LONGEST_SHELVED_S)}
    return {key: value for key, value in said.items() if value is not None}


def check_changes(earlier: Iterable[Mapping[str, Any]], phase: str, now_s: float) -> None:
    """Refuse an act that changes nothing: to acknowledge twice, or unshelve what is not shelved.

    An event of higher severity ends both an acknowledgement and shelving.

    Raises
    ------
    InputError
        When the event is acknowledged already, or is not shelved.
    """
    acked_by, shelved_until_s, severity = None, -math.inf, -1
    for event in earlier:
        data = event["data"]
        rank = _rank(data.get("severity"))
        if rank > severity >= 0:
            acked_by, shelved_until_s = None, -math.inf
        severity = max(severity, rank)
        if data.get("phase") == "ack":
            acked_by = str(data.get("by"))
        elif data.get("phase") in ("shelve", "unshelve"):
            shelved_until_s = float(data.get("until_s") or -math.inf)
    if phase == "ack" and acked_by is not None:
        raise InputError(f"the event was acknowledged before, by {acked_by}")
    if phase == "unshelve" and not shelved_until_s > now_s:
        raise InputError("the event is not shelved")


def _rank(severity: object) -> int:
    return _SEVERITIES.index(severity) if severity in _SEVERITIES else -1


def act_event(
    earlier: list[dict[str, Any]], phase: str, said: Mapping[str, Any], now_s: float
) -> dict[str, Any]:
    """Return the event of what a person did: the newest facts, with who did what."""
    newest = earlier[-1]
    data = without_act(newest["data"])
    sequence = next_seq(earlier)
    made = {**newest, "id": derived_id(data["event"], sequence, phase, said, now_s)}
    if "time" in made:
        made["time"] = rfc3339(now_s)
    return {**made, "data": {**data, "phase": phase, "seq": sequence, **said}}


def next_seq(earlier: Iterable[Mapping[str, Any]]) -> int:
    """Return the `seq` of the event that follows the others of its episode.

    Examples
    --------
    >>> next_seq([]), next_seq([{"data": {"seq": 0}}, {"data": {"seq": 3}}])
    (0, 4)
    """
    return 1 + max((int(one["data"].get("seq", 0)) for one in earlier), default=-1)


def without_act(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return what an event tells, without what a person did."""
    return {key: value for key, value in data.items() if key not in _SAID}
