"""Episodes of alerts, folded from events, and how the rules did."""

import statistics
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from typing import Any

from trecsim.safety.rule import SEVERITIES

Reason = str


@dataclass(frozen=True, slots=True)
class Alert:
    """One happening, from its first event to its last.

    Attributes
    ----------
    id, rule, kind, place
        The episode, the rule that fired, its kind, and where.
    severity
        The highest that it had.
    start_s, detect_s, end_s
        When the condition began, when that was decided, and when it ended; None while it holds [s].
    ack_s
        When somebody acknowledged it first [s]; None if nobody did, or it is not known when.
    reason, note
        Why it was closed, and what was written; None while it is open.
    lead_s
        How long before the beginning a warning came [s]; None without one.
    """

    id: str
    rule: str
    kind: str
    place: str | None
    severity: str
    start_s: float
    detect_s: float
    end_s: float | None = None
    ack_s: float | None = None
    reason: Reason | None = None
    note: str | None = None
    lead_s: float | None = None


def alerts_of(events: Iterable[Mapping[str, Any]]) -> list[Alert]:
    """Return the episodes of events, in order of their beginning.

    Parameters
    ----------
    events
        CloudEvents as in ``events.jsonl`` and the ledger, in their order.
    """
    found: dict[str, Alert] = {}
    for event in events:
        data = event["data"]
        known = found.get(data["event"]) or _begun(data)
        found[data["event"]] = _told(known, data, _time_s(event))
    return sorted(found.values(), key=lambda one: (one.start_s, one.id))


def _begun(data: Mapping[str, Any]) -> Alert:
    rule = data.get("rule") or {}
    detect_s = float(data.get("t_detect_s") or data.get("t_start_s") or 0.0)
    places = (data.get(key) for key in ("zone", "line", "edge", "camera"))
    return Alert(
        id=data["event"],
        rule=str(rule.get("id", "")),
        kind=str(rule.get("kind", "")),
        place=next((place for place in places if place), None),
        severity=str(data.get("severity", "warning")),
        start_s=float(data.get("t_start_s") or detect_s),
        detect_s=detect_s,
    )


def _time_s(event: Mapping[str, Any]) -> float | None:
    """Return when an event was made [s]; None where only the time since some start is known."""
    text = event.get("time")
    return None if text is None else datetime.fromisoformat(str(text)).timestamp()


def _told(alert: Alert, data: Mapping[str, Any], made_s: float | None) -> Alert:
    phase = data.get("phase")
    if phase in ("new", "update", "end"):
        severity = max(alert.severity, data.get("severity", "info"), key=_rank)
        start_s, lead_s = data.get("t_start_s"), data.get("lead_s")
        alert = replace(
            alert,
            severity=severity,
            start_s=alert.start_s if start_s is None else float(start_s),
            end_s=data.get("t_end_s"),
            lead_s=alert.lead_s if lead_s is None else float(lead_s),
        )
    elif phase == "ack" and alert.ack_s is None:
        alert = replace(alert, ack_s=made_s)
    elif phase == "close":
        alert = replace(alert, reason=data.get("reason"), note=data.get("note"))
    elif phase == "reopen":
        alert = replace(alert, reason=None, note=None)
    return alert


def _rank(severity: str) -> int:
    return SEVERITIES.index(severity) if severity in SEVERITIES else 0


@dataclass(frozen=True, slots=True)
class RuleDay:
    """How one rule did on a day.

    Attributes
    ----------
    rule, kind
        The rule.
    alerts
        How many there were.
    reasons
        How many were closed with each reason.
    open
        How many nobody has closed.
    false_per_camera_day
        Alerts closed as false, for each camera and 24 hours that were watched; NaN where nothing
        was.
    ack_median_s, ack_worst_s
        From the decision to the acknowledgement [s]; None where nothing was acknowledged.
    """

    rule: str
    kind: str
    alerts: int
    reasons: Mapping[Reason, int]
    open: int
    false_per_camera_day: float
    ack_median_s: float | None
    ack_worst_s: float | None


def rule_days(
    alerts: Sequence[Alert], camera_days: float, rules: Mapping[str, str]
) -> list[RuleDay]:
    """Return how each rule did; rules without an alert are there, too.

    Parameters
    ----------
    alerts
        Those of the day.
    camera_days
        How many cameras watched, times for how many days.
    rules
        Kinds of the rules of the site, by their names.
    """
    kinds = {**rules, **{one.rule: one.kind for one in alerts}}
    return [
        _rule_day(rule, kind, [one for one in alerts if one.rule == rule], camera_days)
        for rule, kind in kinds.items()
    ]


def _rule_day(rule: str, kind: str, alerts: Sequence[Alert], camera_days: float) -> RuleDay:
    closed = [one.reason for one in alerts if one.reason is not None]
    waits_s = [one.ack_s - one.detect_s for one in alerts if one.ack_s is not None]
    false = closed.count("false")
    return RuleDay(
        rule=rule,
        kind=kind,
        alerts=len(alerts),
        reasons={reason: closed.count(reason) for reason in ("true", "false", "test", "expected")},
        open=len(alerts) - len(closed),
        false_per_camera_day=false / camera_days if camera_days > 0.0 else float("nan"),
        ack_median_s=statistics.median(waits_s) if waits_s else None,
        ack_worst_s=max(waits_s, default=None),
    )
