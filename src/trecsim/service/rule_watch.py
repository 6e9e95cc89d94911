"""Judges the rules of a site while it runs, as one of the sinks of the pipeline."""

import logging
import time
from collections.abc import Callable, Iterable, Mapping
from threading import Lock
from typing import Any

from trecsim.assessing import RuleEvents, RuleSet
from trecsim.cloud_events import event_of
from trecsim.health import RulesHealth
from trecsim.safety.kinds import KINDS
from trecsim.safety.modes import Overrides
from trecsim.safety.signals import SignalSource
from trecsim.safety.vehicle import PlacedVehicle
from trecsim.store.ledger_events import without_act
from trecsim.values import Snapshot

logger = logging.getLogger(__name__)

Event = dict[str, Any]

TYPES = tuple(f"trecsim.{kind}.v1" for kind in KINDS)
"""Types of the events of rules."""


class RuleWatch:
    """Judges the rules of a site on the snapshots that its recording gets, too.

    A rule that fails stops neither the tracking nor the recording: that is a fault of the site,
    which its health tells.

    Parameters
    ----------
    rules
        The rules.
    put
        Takes each event.
    signals
        The messages of feeds.
    """

    def __init__(
        self,
        rules: RuleSet,
        put: Callable[[Event], None],
        signals: SignalSource = lambda t_s: (),
    ) -> None:
        self._rules, self._put = rules, put
        self._events = RuleEvents(rules, signals=signals)
        self._lock = Lock()
        self._next: RuleSet | None = None
        self._overrides: Overrides | None = None
        self._fault: str | None = None
        self._failing: set[str] = set()

    def write(self, snapshot: Snapshot, /) -> None:
        """Judge one moment."""
        try:
            for event in self._step(snapshot):
                self._put(event)
        except Exception as error:  # the boundary: people are tracked and recorded all the same
            if self._fault is None:
                logger.exception("the rules fail; people are tracked all the same")
            self._fault = f"{type(error).__name__}: {error}"
        else:
            self._note(self._events.faults)

    def _note(self, faults: Mapping[str, str]) -> None:
        """Take note of rules that cannot judge; the others are judged all the same."""
        for rule, fault in faults.items():
            if rule not in self._failing:
                logger.error("rule %s cannot judge, the others go on: %s", rule, fault)
        for rule in self._failing - set(faults):
            logger.warning("rule %s judges again", rule)
        self._failing = set(faults)
        said = [f"{rule}: {fault}" for rule, fault in sorted(faults.items())]
        self._fault = "; ".join(said) or None

    def change(self, rules: RuleSet) -> None:
        """Take other rules from the next moment on; may be called in any thread."""
        with self._lock:
            self._next = rules

    def override(self, overrides: Overrides) -> None:
        """Take what people have put in place of the modes; may be called in any thread."""
        with self._lock:
            self._overrides = overrides

    def vehicles(self, t_s: float) -> list[PlacedVehicle]:
        """Return where the vehicles are at a time [s] whose positions come from feeds.

        Only for the thread that writes snapshots.
        """
        return self._events.vehicles(t_s)

    def health(self, now_s: float) -> RulesHealth:
        """Return how many rules there are and are armed at a Unix time [s], and what is wrong."""
        armed = self._events.armed(now_s)
        mode = self._events.mode(now_s)
        return RulesHealth(armed, len(self._rules.rules), self._fault, mode)

    def _step(self, snapshot: Snapshot) -> list[Event]:
        with self._lock:
            rules, self._next = self._next, None
            overrides, self._overrides = self._overrides, None
        if overrides is not None:
            self._events.override(overrides)
        changed: list[Event] = []
        if rules is not None:
            changed = self._events.change(rules, snapshot.t_s)
            self._rules = rules
        return [*changed, *self._events.step(snapshot)]


def ends_of(
    site: str, open_events: Iterable[Mapping[str, Any]], now: Callable[[], float] = time.time
) -> list[Event]:
    """Return the ends of episodes that were open when a site ran last.

    Where the people were meanwhile is not known, and nobody of today is one of them for sure. Such
    an episode ends when it was last told.

    Parameters
    ----------
    site
        Name of the site.
    open_events
        Newest event of each episode that was not ended.
    now
        Returns the Unix time [s].
    """
    ends = []
    for event in open_events:
        data = without_act(event["data"])
        if data["t_end_s"] is None:
            last_s = max(data["t_detect_s"], data["t_start_s"])
            facts = {"phase": "end", "t_detect_s": round(now(), 3), "t_end_s": last_s}
            ends.append(event_of(site, {**data, **facts, "ended_by": "restarted"}, now()))
    return ends
