"""Makes episodes of faults: each begins once, and ends when the part has worked for a while."""

import time
from collections import deque
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from trecsim.health import Health
from trecsim.service.fault_event import begun, ended, worse
from trecsim.service.site_parts import PartState, parts_of
from trecsim.store.ledger_events import without_act

OFF_S = 5.0  # a part must work for so long before its fault counts as ended,
OFF_MOST_S = 300.0  # twice as long with each fault of the last minutes, up to this
RECENT_S = 600.0
_WORST = ("down", "stalled", "failing")  # states that do not get worse

_Key = tuple[str, str]
_Event = dict[str, Any]


@dataclass(frozen=True, slots=True)
class _Episode:
    """A fault that has not ended.

    Attributes
    ----------
    data
        Of its last event.
    off_s
        For how long the part must work before this counts as ended [s].
    well_s
        Since when the part works again, by a steady clock and as Unix time [s]; None while it does
        not.
    """

    data: Mapping[str, Any]
    off_s: float = OFF_S
    well_s: tuple[float, float] | None = None

    @property
    def key(self) -> _Key:
        return self.data["rule"]["kind"], self.data.get("camera") or self.data.get("output") or ""


@dataclass(slots=True)
class _Memory:
    """What is known of one part.

    Attributes
    ----------
    open
        Its fault.
    begun_s
        When its last faults began, by a steady clock [s].
    """

    open: _Episode | None = None
    begun_s: deque[float] = field(default_factory=deque)

    def begin(self, data: Mapping[str, Any], now_s: float) -> None:
        """Open an episode."""
        while self.begun_s and now_s - self.begun_s[0] > RECENT_S:
            self.begun_s.popleft()
        self.open = _Episode(data, min(OFF_S * 2.0 ** len(self.begun_s), OFF_MOST_S))
        self.begun_s.append(now_s)


class FaultWatch:
    """Tells when faults begin, get worse and end: at most one open episode for each part.

    A part that fails again and again has one long episode in place of many: the more often it
    failed in the last ten minutes, the longer it must work before its fault counts as ended.

    Parameters
    ----------
    site
        Name of the site.
    open_events
        Newest event of each episode that was open when the site ran last, the oldest first. They
        go on, or end when their fault has gone.
    people
        Tells who is at the site, as events list people.
    clock
        A steady clock [s].
    """

    def __init__(
        self,
        site: str,
        open_events: Iterable[Mapping[str, Any]] = (),
        *,
        people: Callable[[], list[dict[str, Any]]] = list,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._site, self._people, self._clock = site, people, clock
        self._parts: dict[_Key, _Memory] = {}
        self._superseded: list[_Episode] = []
        for event in open_events:
            self._continue(_Episode(without_act(event["data"])))

    def _continue(self, episode: _Episode) -> None:
        memory = self._parts.setdefault(episode.key, _Memory())
        if memory.open is not None:
            self._superseded.append(memory.open)
        memory.begin(episode.data, self._clock())

    def step(self, parts: Iterable[PartState], t_s: float) -> list[_Event]:
        """Return the events that follow from how the parts of the site work now.

        Parameters
        ----------
        parts
            All parts of the site. An open episode of another one ends at once.
        t_s
            Now, Unix time [s].
        """
        events = [ended(self._site, one.data, t_s, t_s) for one in self._superseded]
        self._superseded = []
        known = {part.key: part for part in parts}
        for key in [key for key in self._parts if key not in known]:
            gone = self._parts.pop(key).open
            events += [] if gone is None else [ended(self._site, gone.data, t_s, t_s)]
        for part in known.values():
            events += self._judged(part, t_s)
        return events

    def _judged(self, part: PartState, t_s: float) -> list[_Event]:
        memory = self._parts.setdefault(part.key, _Memory())
        if memory.open is None:
            return [self._begin(memory, part, t_s)] if part.verdict == "faulty" else []
        if part.verdict == "well":
            return self._works(memory, memory.open, t_s)
        memory.open = replace(memory.open, well_s=None)
        before = memory.open.data
        if part.verdict == "faulty" and _is_worse(part.state, before.get("state")):
            event = worse(self._site, before, part, t_s)
            memory.open = replace(memory.open, data=event["data"])
            return [event]
        return []

    def _begin(self, memory: _Memory, part: PartState, t_s: float) -> _Event:
        event = begun(self._site, part, t_s, self._people())
        memory.begin(event["data"], self._clock())
        return event

    def _works(self, memory: _Memory, episode: _Episode, t_s: float) -> list[_Event]:
        now_s = self._clock()
        since_s, since_unix_s = episode.well_s or (now_s, t_s)
        if now_s - since_s < episode.off_s:
            memory.open = replace(episode, well_s=(since_s, since_unix_s))
            return []
        memory.open = None
        return [ended(self._site, episode.data, since_unix_s, t_s)]


class FaultEvents:
    """Judges the parts of a site as often as its health is told, and puts events of their faults.

    Nothing is judged before its cameras are read, nor after.

    Parameters
    ----------
    watch
        Makes the events.
    put
        Takes them.
    is_read
        Tells whether the cameras are read now.
    """

    def __init__(
        self, watch: FaultWatch, put: Callable[[_Event], None], is_read: Callable[[], bool]
    ) -> None:
        self._watch, self._put, self._is_read = watch, put, is_read
        self._read_since_s: float | None = None

    def __call__(self, health: Health) -> None:
        """Take how well the site works now."""
        if not self._is_read():
            return
        if self._read_since_s is None:
            self._read_since_s = health.t_s
        for event in self._watch.step(parts_of(health, self._read_since_s), health.t_s):
            self._put(event)


def _is_worse(state: str, before: object) -> bool:
    return state in _WORST and before not in _WORST
