"""Events, what people do to them, and the audit log, as the page uses them.

With a folder all of it is in the ledger of the site; without one, in memory until the page ends.
"""

import asyncio
import logging
import math
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from itertools import takewhile
from pathlib import Path
from threading import Lock
from time import monotonic, time
from typing import Any, TypeVar

from trecsim.errors import Error, InputError, SetupError
from trecsim.page.event_log import EVENTS_KEPT, EventLog
from trecsim.safety.modes import Overrides
from trecsim.store.ledger import MOST_REVIEWED, Ledger
from trecsim.store.ledger_events import act_event, checked_act
from trecsim.store.names import OVERRIDES

logger = logging.getLogger(__name__)

RETRY_S = 10.0  # so often it is tried again to open a ledger that cannot be used yet
MISSED_AT_ONCE = 100  # events that wait for a viewer who catches up slowly

Result = TypeVar("Result")
Event = Mapping[str, Any]


class Journal:
    """Keeps and finds events, acts and audit entries.

    Parameters
    ----------
    folder
        The folder of the ledger; None for memory only.
    log
        The newest events, for the stream.
    clock
        A steady clock [s].
    """

    def __init__(
        self, folder: Path | None, log: EventLog, *, clock: Callable[[], float] = monotonic
    ) -> None:
        self._folder, self._log, self._clock = folder, log, clock
        self._opened: Ledger | None = None
        self._tried_s = -math.inf
        self._lock = Lock()
        self._waiting: deque[Event] = deque(maxlen=EVENTS_KEPT)  # the ledger has them later
        self._reviewed: dict[str, dict[str, None]] = {}
        self._overrides = Overrides()
        if self._ledger is not None:
            for kept in self._ledger.events(limit=EVENTS_KEPT, newest=True):
                log.append(kept.event)

    @property
    def _ledger(self) -> Ledger | None:
        """The ledger; None without a folder, and while it cannot be used.

        The tracking process, which owns the folder, repairs it; so it is tried again.
        """
        now_s = self._clock()
        if self._opened is None and self._folder and now_s - self._tried_s >= RETRY_S:
            is_first, self._tried_s = math.isinf(self._tried_s), now_s
            self._opened = _opened(self._folder, tell=is_first)
            if self._opened is not None and not is_first:
                logger.warning("the page keeps events and audit again")
        return self._opened

    @property
    def is_kept(self) -> bool:
        """Whether events and audit outlive the page."""
        return self._ledger is not None

    async def audit(self, who: str, act: str, details: Mapping[str, Any]) -> None:
        """Keep that somebody did something; a full disk is logged and stops nobody."""
        if self._ledger is None:
            return
        try:
            await _apart(partial(self._ledger.append_audit, who, act, details))
        except SetupError as error:
            logger.error("not in the audit log: %s by %s: %s", act, who, error)  # noqa: TRY400

    def waits(self, event: Event) -> None:
        """Take an event that the tracking process shows before the ledger has it."""
        if self._ledger is not None:
            with self._lock:
                self._waiting.append(event)

    async def act(self, episode: str, phase: str, by: str, said: Mapping[str, Any]) -> Event:
        """Keep what somebody does to an event, and show it to all viewers; return its event.

        Raises
        ------
        InputError
            There is no such event, or the act is not complete.
        """
        if self._ledger is not None:
            event = await _apart(partial(self._act, self._ledger, episode, phase, by, said))
        else:
            event = self._acted_in_memory(episode, phase, by, said)
        self._log.append(event)
        return event

    async def events(
        self,
        *,
        after: str | None = None,
        episode: str | None = None,
        from_s: float | None = None,
        until_s: float | None = None,
        limit: int = 1000,
    ) -> Sequence[Event]:
        """Return events in their order: the oldest `after` one, else the newest."""
        wanted = _Wanted(episode, from_s, until_s)
        if self._ledger is not None:
            return await _apart(partial(self._listed, self._ledger, after, wanted, limit))
        kept = self._log.since(0 if after is None else self._log.after(after))
        found = [one.event for one in kept if wanted.holds(one.event)]
        return found[:limit] if after is not None else found[-limit:]

    async def missed(self, last_event_id: str) -> Sequence[Event]:
        """Return the next events after one that is no longer in memory."""
        if (
            self._ledger is None
            or await _apart(partial(self._ledger.number_of, last_event_id)) is None
        ):
            return []
        return await self.events(after=last_event_id, limit=MISSED_AT_ONCE)

    async def mark_reviewed(self, who: str, episodes: Sequence[str], reviewed: bool) -> None:
        """Keep which events a user has reviewed, or has not after all."""
        if self._ledger is not None:
            await _apart(partial(self._ledger.mark_reviewed, who, episodes, reviewed))
            return
        mine = self._reviewed.setdefault(who, {})
        for episode in episodes:
            mine[episode] = None
            if not reviewed:
                del mine[episode]
        for oldest in list(mine)[: max(len(mine) - MOST_REVIEWED, 0)]:
            del mine[oldest]

    async def reviewed(self, who: str) -> Sequence[str]:
        """Return the events that a user has reviewed."""
        if self._ledger is not None:
            return await _apart(partial(self._ledger.reviewed, who))
        return list(self._reviewed.get(who, {}))

    async def overrides(self) -> Overrides:
        """Return what people have put in place of the modes of the site."""
        if self._ledger is not None:
            return Overrides.of(await _apart(partial(self._ledger.setting, OVERRIDES)))
        return self._overrides

    async def keep_overrides(
        self, who: str, overrides: Overrides, details: Mapping[str, Any]
    ) -> None:
        """Keep what people put in place of the modes, in the audit log too."""
        if self._ledger is not None:
            keep = self._ledger.keep_setting
            await _apart(partial(keep, OVERRIDES, overrides.to_json(), who, details))
        self._overrides = overrides

    def _act(
        self, ledger: Ledger, episode: str, phase: str, by: str, said: Mapping[str, Any]
    ) -> Event:
        """Keep an act, after what it is about."""
        for event in self._still_waiting(ledger):
            if _data(event).get("event") == episode:
                ledger.append_event(event)
        return ledger.act(episode, phase, by, **said).event

    def _listed(
        self, ledger: Ledger, after: str | None, wanted: "_Wanted", limit: int
    ) -> list[Event]:
        """Return events of the ledger, and after them those that it does not have yet."""
        waiting = self._still_waiting(ledger)
        ids = [event.get("id") for event in waiting]
        shown = [event for event in waiting if wanted.holds(event)]
        if after in ids:
            later = waiting[ids.index(after) + 1 :]
            return [event for event in later if wanted.holds(event)][:limit]
        number = (0 if after is None else ledger.number_of(after)) or 0
        found = ledger.events(number, **asdict(wanted), limit=limit, newest=number == 0)
        both = [*(one.event for one in found if one.event["id"] not in ids), *shown]
        return both[:limit] if number else both[-limit:]

    def _still_waiting(self, ledger: Ledger) -> list[Event]:
        """Return the events that the ledger does not have yet."""
        with self._lock:
            waiting = list(self._waiting)
        kept = list(takewhile(lambda one: ledger.number_of(str(one.get("id"))), waiting))
        with self._lock:
            while self._waiting and any(self._waiting[0] is one for one in kept):
                self._waiting.popleft()
        return waiting[len(kept) :]

    def _acted_in_memory(
        self, episode: str, phase: str, by: str, said: Mapping[str, Any]
    ) -> dict[str, Any]:
        now_s = time()
        said = checked_act(phase, {"by": by, **said}, now_s)
        earlier = [
            dict(one.event)
            for one in self._log.since(0)
            if _data(one.event).get("event") == episode
        ]
        if not earlier:
            raise InputError(f"there is no event {episode!r}")
        return act_event(earlier, phase, said, now_s)


def _data(event: Event) -> Mapping[str, Any]:
    data = event.get("data")
    return data if isinstance(data, Mapping) else {}


@dataclass(frozen=True, slots=True)
class _Wanted:
    """Which events are asked for; see `Ledger.events`."""

    episode: str | None
    from_s: float | None
    until_s: float | None

    def holds(self, event: Event) -> bool:
        """Tell whether an event is one of them."""
        data = _data(event)
        t_s = data.get("t_detect_s") or data.get("t_start_s") or 0.0
        return (
            (self.episode is None or data.get("event") == self.episode)
            and (self.from_s is None or t_s >= self.from_s)
            and (self.until_s is None or t_s <= self.until_s)
        )


def _opened(folder: Path, *, tell: bool) -> Ledger | None:
    """Return the ledger of a folder; None where it cannot be used, which is logged if asked."""
    try:
        return Ledger(folder, repair=False)
    except Error as error:
        if tell:
            logger.error(  # noqa: TRY400
                "the page keeps events in memory only until this is mended: %s", error
            )
        return None


async def _apart(work: Callable[[], Result]) -> Result:
    """Do something with the disk in a thread: the page answers others meanwhile."""
    return await asyncio.to_thread(work)
