"""The state of each rule, from the events that were delivered: what is active now."""

from collections.abc import Iterable, Mapping
from typing import Any

from trecsim.outputs.base import Event

_SEVERITIES = ("info", "warning", "alarm", "critical")


class RuleStates:
    """Follows the episodes of rules.

    Parameters
    ----------
    rules
        All rules of the site, by `id`. Events may tell of others: of faults.
    open_events
        The newest event of each episode that is open.
    """

    def __init__(self, rules: Iterable[str] = (), open_events: Iterable[Event] = ()) -> None:
        self._open: dict[str, dict[str, Mapping[str, Any]]] = {rule: {} for rule in rules}
        for event in open_events:
            self.take(event)

    @property
    def rules(self) -> tuple[str, ...]:
        """All rules."""
        return tuple(self._open)

    def take(self, event: Event) -> str:
        """Take the next event; return the rule that it is about."""
        data = event["data"]
        rule, episode = str(data["rule"]["id"]), str(data["event"])
        active = self._open.setdefault(rule, {})
        if data.get("t_end_s") is not None:
            active.pop(episode, None)
        else:
            active[episode] = data
        return rule

    def of(self, rule: str) -> dict[str, Any]:
        """Return the state of a rule, as it is published.

        Examples
        --------
        >>> RuleStates(["strip"]).of("strip")
        {'rule': 'strip', 'state': 'clear', 'count': 0, 'severity': None, 'since_s': None}
        """
        active = list(self._open.get(rule, {}).values())
        state = "clear"
        if active:
            state = "predicted" if all(one.get("predicted") for one in active) else "active"
        ranks = [_SEVERITIES.index(one["severity"]) for one in active]
        return {
            "rule": rule,
            "state": state,
            "count": len(active),
            "severity": _SEVERITIES[max(ranks)] if ranks else None,
            "since_s": min((one["t_start_s"] for one in active), default=None),
        }
