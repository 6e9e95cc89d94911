"""The ledger of a site: events, what people did to them, who reviewed them, and the audit log.

It is one SQLite file that several processes read and write at the same time. What was written
survives the end of the program at any moment (SIGKILL too). A power failure may take what was
written in the last moments, never what was written before it (``synchronous = NORMAL``).
"""

import json
import sqlite3
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Self

from trecsim.cloud_events import event_text, numbered
from trecsim.errors import InputError, SetupError
from trecsim.store.audit import FIRST_HASH, next_hash
from trecsim.store.ledger_events import (
    act_event,
    check_changes,
    checked_act,
    event_in,
    event_row,
    next_seq,
    without_people,
)
from trecsim.store.ledger_file import NAME, open_ledger, sqlite_faults, transaction
from trecsim.store.ledger_reading import LedgerEvent, LedgerReading

MOST_REVIEWED = 10_000
"""So many events are kept as reviewed by a user: whoever may look must not fill the disk."""


class Ledger(LedgerReading):
    """Events, what people did to them, who reviewed them, and the audit log of a site.

    Threads may share a ledger; each process opens its own.

    Parameters
    ----------
    folder
        The folder that holds it; made if it is missing.
    repair
        Whether a damaged file is moved aside and a new one begun.
    now
        Returns the Unix time [s].

    Raises
    ------
    InputError
        When the file is of a newer version or of another program, or damaged without `repair`.
    SetupError
        When the disk has no room or does not work.

    Examples
    --------
    >>> with Ledger(getfixture("tmp_path")) as ledger:
    ...     number = ledger.append_event(
    ...         {"id": "a", "data": {"event": "e", "phase": "new", "t_detect_s": 7.0}}
    ...     )
    ...     acked = ledger.act("e", "ack", "kim")
    ...     [one.event["data"]["phase"] for one in ledger.events()]
    ['new', 'ack']
    """

    def __init__(
        self, folder: Path, *, repair: bool = True, now: Callable[[], float] = time.time
    ) -> None:
        super().__init__(folder / NAME, open_ledger(folder, repair=repair))
        self._now = now

    def append_event(self, event: Mapping[str, Any]) -> int:
        """Keep an event and return its number; one that is there already is not kept twice.

        Raises
        ------
        InputError
            When it is no event: without `id` or `data`, or with numbers that are not finite.
        SetupError
            When it cannot be written.
        """
        row = event_row(event)
        with self._writing() as connection:
            return _insert_event(connection, row)

    def append_next(self, event: Mapping[str, Any]) -> LedgerEvent:
        """Keep the next event of an episode; its `seq` follows all that is there, as does its `id`.

        Raises
        ------
        InputError
            When it is no event, or has numbers that are not finite.
        SetupError
            When it cannot be written.
        """
        with self._writing() as connection:
            made = numbered(event, next_seq(_episode(connection, event["data"]["event"])))
            return LedgerEvent(_insert_event(connection, event_row(made)), made)

    def act(
        self,
        event: str,
        phase: str,
        by: str,
        *,
        until_s: float | None = None,
        reason: str | None = None,
        note: str | None = None,
    ) -> LedgerEvent:
        """Keep what a person does to an event, in the audit log too; return the event of it.

        Parameters
        ----------
        event
            The episode (`data.event`).
        phase
            What is done: ack, shelve, unshelve, close or reopen.
        by
            The user.
        until_s
            To "shelve": how long, Unix time [s]; 8 h at most.
        reason
            To "close": true, false, test or expected.
        note
            What the user wrote.

        Raises
        ------
        InputError
            When there is no such event, or the act is not complete or changes nothing.
        SetupError
            When it cannot be written.
        """
        given = {"by": by, "until_s": until_s, "reason": reason, "note": note}
        said = checked_act(phase, given, self._now())
        with self._writing() as connection:
            earlier = _episode(connection, event)
            if not earlier:
                raise InputError(f"there is no event {event!r}")
            check_changes(earlier, phase, self._now())
            made = act_event(earlier, phase, said, self._now())
            number = _insert_event(connection, event_row(made))
            details = {"event": event, **{k: v for k, v in said.items() if k != "by"}}
            _insert_audit(connection, self._now(), by, phase, details)
        return LedgerEvent(number, made)

    def mark_reviewed(self, who: str, episodes: Iterable[str], reviewed: bool = True) -> None:
        """Keep which events a user has reviewed, or has not; at most `MOST_REVIEWED`."""
        with self._writing() as connection:
            for episode in episodes:
                if reviewed:
                    connection.execute(
                        "INSERT OR IGNORE INTO reviewed VALUES (?, ?, ?)",
                        [who, episode, self._now()],
                    )
                else:
                    connection.execute(
                        "DELETE FROM reviewed WHERE who = ? AND episode = ?", [who, episode]
                    )
            connection.execute(
                "DELETE FROM reviewed WHERE who = ?1 AND episode NOT IN (SELECT episode FROM "
                "reviewed WHERE who = ?1 ORDER BY t_s DESC, episode LIMIT ?2)",
                [who, MOST_REVIEWED],
            )

    def cursor(self, output: str) -> int:
        """Return the number of the last event that an output is done with.

        An output that is new here begins with the events that come from now on.
        """
        found = self._rows("SELECT number FROM delivered WHERE output = ?", [output])
        if found:
            return int(found[0][0])
        with self._writing() as connection:
            connection.execute(
                "INSERT OR IGNORE INTO delivered SELECT ?, coalesce(max(number), 0) FROM event",
                [output],
            )
        return self.cursor(output)

    def advance(self, output: str, number: int) -> None:
        """Note that an output is done with all events up to a number."""
        with self._writing() as connection:
            connection.execute("INSERT OR REPLACE INTO delivered VALUES (?, ?)", [output, number])

    def forget_cursors(self, but: Iterable[str]) -> None:
        """Forget the cursors of all outputs but these."""
        kept = list(but)
        with self._writing() as connection:
            connection.execute(
                f"DELETE FROM delivered WHERE output NOT IN ({', '.join('?' * len(kept))})", kept
            )

    def keep_setting(
        self, name: str, body: Mapping[str, Any], who: str, details: Mapping[str, Any]
    ) -> None:
        """Keep something that outlives the program, in place of what has this name.

        Parameters
        ----------
        name
            What it is called, also in the audit log.
        body
            What is kept.
        who, details
            Who has changed what, for the audit log.
        """
        text = json.dumps(body, ensure_ascii=False, sort_keys=True, allow_nan=False)
        with self._writing() as connection:
            connection.execute("INSERT OR REPLACE INTO setting VALUES (?, ?)", [name, text])
            _insert_audit(connection, self._now(), who, name, details)

    def append_audit(self, who: str, act: str, details: Mapping[str, Any] | None = None) -> int:
        """Add an entry to the audit log and return its number.

        Raises
        ------
        SetupError
            When it cannot be written.
        """
        with self._writing() as connection:
            return _insert_audit(connection, self._now(), who, act, details or {})

    def forget_events(self, before_s: float) -> int:
        """Delete the episodes whose last event is older; return the number of events deleted."""
        old = "SELECT episode FROM event GROUP BY episode HAVING max(t_s) < ?"
        with self._writing() as connection:
            connection.execute(f"DELETE FROM reviewed WHERE episode IN ({old})", [before_s])
            found = connection.execute(f"DELETE FROM event WHERE episode IN ({old})", [before_s])
            return int(found.rowcount)

    def erase_people(self, from_s: float, to_s: float, person: int | None = None) -> int:
        """Take people out of the events of a time; return the number of events changed.

        Parameters
        ----------
        from_s, to_s
            The time, both included [s].
        person
            The identity; None for everybody.
        """
        changed, after = 0, 0
        with self._lock, sqlite_faults(self.path):
            self._connection.execute("PRAGMA secure_delete = ON")  # nothing stays in free pages
        while found := self.events(after):
            after = found[-1].number
            made = [(one.number, without_people(one.event, from_s, to_s, person)) for one in found]
            rows = [(event_text(event), number) for number, event in made if event is not None]
            with self._writing() as connection:
                connection.executemany("UPDATE event SET body = ? WHERE number = ?", rows)
            changed += len(rows)
        with self._lock, sqlite_faults(self.path):
            self._connection.execute("PRAGMA wal_checkpoint(TRUNCATE)").fetchall()
        return changed

    def close(self) -> None:
        """Close the file."""
        with self._lock:
            self._connection.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *ending: object) -> None:
        self.close()

    @contextmanager
    def _writing(self) -> Iterator[sqlite3.Connection]:
        if self.fault is not None:
            raise SetupError(self.fault)
        with self._lock, sqlite_faults(self.path), transaction(self._connection) as connection:
            yield connection


def _episode(connection: sqlite3.Connection, episode: str) -> list[dict[str, Any]]:
    """Return the events of an episode in their order."""
    rows = connection.execute(
        "SELECT body FROM event WHERE episode = ? ORDER BY number", [episode]
    ).fetchall()
    return [event for (body,) in rows if (event := event_in(body)) is not None]


def _insert_event(connection: sqlite3.Connection, row: tuple[Any, ...]) -> int:
    made = connection.execute(
        "INSERT OR IGNORE INTO event (id, episode, phase, t_s, from_s, to_s, body) "
        "VALUES (?, ?, ?, ?, ?, ?, ?)",
        row,
    )
    if made.rowcount:
        return int(made.lastrowid or 0)
    found = connection.execute("SELECT number FROM event WHERE id = ?", [row[0]])
    return int(found.fetchone()[0])


def _insert_audit(
    connection: sqlite3.Connection, t_s: float, who: str, act: str, details: Mapping[str, Any]
) -> int:
    last = connection.execute(
        "SELECT number, hash FROM audit ORDER BY number DESC LIMIT 1"
    ).fetchone()
    number, before = (last[0] + 1, last[1]) if last else (1, FIRST_HASH)
    text = json.dumps(details, ensure_ascii=False, sort_keys=True, allow_nan=False)
    made = next_hash(before, number, t_s, who, act, json.loads(text))
    connection.execute(
        "INSERT INTO audit VALUES (?, ?, ?, ?, ?, ?)", [number, t_s, who, act, text, made]
    )
    return int(number)
