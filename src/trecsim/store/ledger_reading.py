"""What a ledger holds: events, who reviewed them, and the audit log, as they are read."""

import json
import logging
import sqlite3
import threading
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from trecsim.store.audit import AuditEntry, AuditVerdict, details_in, verified
from trecsim.store.ledger_events import event_in
from trecsim.store.ledger_file import InPlace, sqlite_faults

logger = logging.getLogger(__name__)

MOST_AT_ONCE = 1000


@dataclass(frozen=True, slots=True)
class LedgerEvent:
    """An event with its place in the ledger.

    Attributes
    ----------
    number
        Grows with every event; never used again.
    event
        The CloudEvents object, as in ``events.jsonl``.
    """

    number: int
    event: Mapping[str, Any]


class LedgerReading:
    """The questions that a ledger answers.

    Parameters
    ----------
    path
        The file.
    connection
        To it.
    """

    def __init__(self, path: Path, connection: sqlite3.Connection) -> None:
        self.path = path
        self._lock = threading.RLock()
        self._connection = connection
        self._place = InPlace(path)

    @property
    def fault(self) -> str | None:
        """Why nothing can be kept any more, as the file was removed; None where it is there."""
        return self._place.fault

    def events(
        self,
        after: int = 0,
        *,
        episode: str | None = None,
        from_s: float | None = None,
        until_s: float | None = None,
        limit: int = MOST_AT_ONCE,
        newest: bool = False,
    ) -> list[LedgerEvent]:
        """Return events in the order in which they were kept.

        Parameters
        ----------
        after
            Only those with a larger number.
        episode
            Only those of one episode (`data.event`).
        from_s, until_s
            Only those that were detected between these times, both included [s].
        limit
            At most so many.
        newest
            Whether `limit` keeps the newest in place of the oldest.
        """
        wanted: list[tuple[str, object]] = [("number > ?", after)]
        if episode is not None:
            wanted.append(("episode = ?", episode))
        if from_s is not None:
            wanted.append(("t_s >= ?", from_s))
        if until_s is not None:
            wanted.append(("t_s <= ?", until_s))
        where = " AND ".join(text for text, _ in wanted)
        rows = self._rows(
            f"SELECT number, body FROM event WHERE {where} "
            f"ORDER BY number {'DESC' if newest else 'ASC'} LIMIT ?",
            [*(value for _, value in wanted), limit],
        )
        found = self._readable(rows)
        return found[::-1] if newest else found

    def open_events(self, types: Iterable[str]) -> list[LedgerEvent]:
        """Return the newest event of each episode that has not ended, the oldest first.

        Parameters
        ----------
        types
            Only episodes whose events are of one of these types, as "trecsim.camera.health.v1".
        """
        wanted = list(types)
        rows = self._rows(
            "SELECT number, body FROM event WHERE number IN (SELECT max(number) FROM event "
            "GROUP BY episode HAVING sum(phase = 'end') = 0) "
            "AND CASE WHEN json_valid(body) THEN json_extract(body, '$.type') END "
            f"IN ({', '.join('?' * len(wanted))}) ORDER BY number",
            wanted,
        )
        return self._readable(rows)

    def count_events(self) -> int:
        """Return the number of events."""
        return int(self._rows("SELECT count(*) FROM event", [])[0][0])

    def number_of(self, event_id: str) -> int | None:
        """Return the number of the event with an `id`; None if it is not there."""
        rows = self._rows("SELECT number FROM event WHERE id = ?", [event_id])
        return int(rows[0][0]) if rows else None

    def reviewed(self, who: str) -> list[str]:
        """Return the events (`data.event`) that a user has reviewed, the oldest first."""
        rows = self._rows("SELECT episode FROM reviewed WHERE who = ? ORDER BY t_s, episode", [who])
        return [episode for (episode,) in rows]

    def evidence(self) -> list[tuple[float, float]]:
        """Return the times that events point to (`evidence`), each from and to [s], in order."""
        rows = self._rows(
            "SELECT min(from_s), max(to_s) FROM event WHERE from_s IS NOT NULL AND to_s IS NOT "
            "NULL GROUP BY episode ORDER BY 1",
            [],
        )
        return [(float(low), float(high)) for low, high in rows]

    def waiting(self, output: str) -> int:
        """Return how many events an output is not done with."""
        rows = self._rows(
            "SELECT count(*) FROM event WHERE number > "
            "coalesce((SELECT number FROM delivered WHERE output = ?), 0)",
            [output],
        )
        return int(rows[0][0])

    def setting(self, name: str) -> dict[str, Any] | None:
        """Return what was kept under a name; None where there is nothing, or it is damaged."""
        rows = self._rows("SELECT body FROM setting WHERE name = ?", [name])
        with suppress(ValueError, RecursionError):
            found = json.loads(rows[0][0]) if rows else None
            return found if isinstance(found, dict) else None
        return None

    def audit(self, after: int = 0, *, limit: int = MOST_AT_ONCE) -> list[AuditEntry]:
        """Return entries of the audit log in their order."""
        rows = self._rows(
            "SELECT number, t_s, who, act, details, hash FROM audit WHERE number > ? "
            "ORDER BY number LIMIT ?",
            [after, limit],
        )
        return [
            AuditEntry(number, t_s, str(who), str(act), details_in(details), str(made))
            for number, t_s, who, act, details, made in rows
        ]

    def verify_audit(self) -> AuditVerdict:
        """Return whether the audit log is as it was written."""
        return verified(self._whole_audit())

    def _whole_audit(self) -> Iterator[AuditEntry]:
        after = 0
        while entries := self.audit(after):
            yield from entries
            after = entries[-1].number

    def _readable(self, rows: Iterable[tuple[Any, ...]]) -> list[LedgerEvent]:
        """Return events; leave out, with a remark, those whose text is damaged."""
        found = []
        for number, body in rows:
            event = event_in(body)
            if event is None:
                logger.warning("%s: event number %d is damaged and is left out", self.path, number)
            else:
                found.append(LedgerEvent(number, event))
        return found

    def _rows(self, query: str, values: list[Any]) -> list[tuple[Any, ...]]:
        with self._lock, sqlite_faults(self.path):
            return self._connection.execute(query, values).fetchall()
