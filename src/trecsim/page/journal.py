"""Events, what people do to them, and the audit log, as the page uses them.

With a folder all of it is in the ledger of the site; without one, in memory until the page ends.
"""

import asyncio
import logging
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from time import time
from typing import Any, TypeVar

from trecsim.errors import Error, InputError, SetupError
from trecsim.page.event_log import EVENTS_KEPT, EventLog
from trecsim.store.ledger import Ledger
from trecsim.store.ledger_events import act_event, check_act

logger = logging.getLogger(__name__)

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

    """

    def __init__(self, folder: Path | None, log: EventLog) -> None:
        self._log = log
        self._ledger = None if folder is None else _opened(folder)
        self._reviewed: dict[str, dict[str, None]] = {}
        if self._ledger is not None:
            for kept in self._ledger.events(limit=EVENTS_KEPT, newest=True):
                log.append(kept.event)

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

    async def keep(self, event: Event) -> None:
        """Keep an event that the tracking process tells, if it has not done so itself.

        A full disk is logged and stops nobody: viewers get the event all the same.
        """
        if self._ledger is None:
            return
        try:
            await _apart(partial(self._ledger.append_event, event))
        except Error as error:
            logger.error("not in the ledger: event %s: %s", event.get("id"), error)  # noqa: TRY400

    async def act(self, episode: str, phase: str, by: str, said: Mapping[str, Any]) -> Event:
        """Keep what somebody does to an event, and show it to all viewers; return its event.

        Raises
        ------
        InputError
            There is no such event, or the act is not complete.
        """
        if self._ledger is not None:
            event = (await _apart(partial(self._ledger.act, episode, phase, by, **said))).event
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
        if self._ledger is not None:
            number = 0 if after is None else await _apart(partial(self._ledger.number_of, after))
            find = partial(
                self._ledger.events, number or 0, episode=episode, from_s=from_s, until_s=until_s,
                limit=limit, newest=number in (0, None),
            )  # fmt: skip
            return [kept.event for kept in await _apart(find)]
        kept = self._log.since(0 if after is None else self._log.after(after))
        found = [
            one.event for one in kept if _is_wanted(_data(one.event), episode, from_s, until_s)
        ]
        return found[:limit] if after is not None else found[-limit:]

    async def missed(self, last_event_id: str) -> Sequence[Event]:
        """Return the next events after one that is no longer in memory."""
        if (
            self._ledger is None
            or await _apart(partial(self._ledger.number_of, last_event_id)) is None
        ):
            return []
        return await self.events(after=last_event_id)

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

    async def reviewed(self, who: str) -> Sequence[str]:
        """Return the events that a user has reviewed."""
        if self._ledger is not None:
            return await _apart(partial(self._ledger.reviewed, who))
        return list(self._reviewed.get(who, {}))

    def _acted_in_memory(
        self, episode: str, phase: str, by: str, said: Mapping[str, Any]
    ) -> dict[str, Any]:
        check_act(phase, said.get("until_s"), said.get("reason"))
        earlier = [
            dict(one.event)
            for one in self._log.since(0)
            if _data(one.event).get("event") == episode
        ]
        if not earlier:
            raise InputError(f"there is no event {episode!r}")
        return act_event(earlier, phase, {"by": by, **said}, time())


def _data(event: Event) -> Mapping[str, Any]:
    data = event.get("data")
    return data if isinstance(data, Mapping) else {}


def _is_wanted(
    data: Mapping[str, Any], episode: str | None, from_s: float | None, until_s: float | None
) -> bool:
    t_s = data.get("t_detect_s") or data.get("t_start_s") or 0.0
    return (
        (episode is None or data.get("event") == episode)
        and (from_s is None or t_s >= from_s)
        and (until_s is None or t_s <= until_s)
    )


def _opened(folder: Path) -> Ledger | None:
    """Return the ledger of a folder; None where it cannot be used, which is logged.

    The tracking process, which owns the folder, repairs it.
    """
    try:
        return Ledger(folder, repair=False)
    except Error as error:
        logger.error("the page keeps events in memory only: %s", error)  # noqa: TRY400
        return None


async def _apart(work: Callable[[], Result]) -> Result:
    """Do something with the disk in a thread: the page answers others meanwhile."""
    return await asyncio.to_thread(work)
