"""The file of a ledger: a SQLite database with a version, which several processes may open."""

import logging
import os
import sqlite3
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from pathlib import Path

from trecsim.errors import InputError, SetupError
from trecsim.store.atomic import PRIVATE_FILE, PRIVATE_FOLDER, disk_faults

logger = logging.getLogger(__name__)

NAME = "ledger.sqlite"
VERSION = 2

_APPLICATION = 0x74726563  # "trec", by which SQLite files of this program are known
_WAIT_S = 10.0  # for another process that writes
_BESIDE = ("-wal", "-shm")  # what SQLite keeps beside a database

_STEPS = (
    # to version 1
    """
    CREATE TABLE event (
        number INTEGER PRIMARY KEY AUTOINCREMENT,
        id TEXT NOT NULL UNIQUE,
        episode TEXT NOT NULL,
        phase TEXT NOT NULL,
        t_s REAL NOT NULL,
        from_s REAL,
        to_s REAL,
        body TEXT NOT NULL
    );
    CREATE INDEX event_episode ON event (episode, number);
    CREATE INDEX event_time ON event (t_s);
    CREATE TABLE audit (
        number INTEGER PRIMARY KEY,
        t_s REAL NOT NULL,
        who TEXT NOT NULL,
        act TEXT NOT NULL,
        details TEXT NOT NULL,
        hash TEXT NOT NULL
    );
    CREATE TABLE reviewed (
        who TEXT NOT NULL,
        episode TEXT NOT NULL,
        t_s REAL NOT NULL,
        PRIMARY KEY (who, episode)
    ) WITHOUT ROWID;
    """,
    # to version 2
    """
    CREATE TABLE delivered (
        output TEXT PRIMARY KEY,
        number INTEGER NOT NULL
    ) WITHOUT ROWID;
    CREATE TABLE setting (
        name TEXT PRIMARY KEY,
        body TEXT NOT NULL
    ) WITHOUT ROWID;
    """,
)
"""What leads from each version to the next."""


def open_ledger(folder: Path, *, repair: bool = True) -> sqlite3.Connection:
    """Open the ledger of a folder; make it if it is missing, migrate it if it is older.

    Parameters
    ----------
    folder
        Its folder.
    repair
        Whether a damaged file is moved aside and a new one begun. A process beside the one that
        owns the folder must not do that.

    Raises
    ------
    InputError
        When the file is of a newer version or of another program, or damaged without `repair`.
    SetupError
        When the disk has no room or does not work.
    """
    path = folder / NAME
    try:
        return _opened(path)
    except sqlite3.DatabaseError as error:
        if isinstance(error, sqlite3.OperationalError):
            raise SetupError(f"cannot open {path}: {error}") from error
        if not repair:
            raise InputError(f"{path} is damaged: {error}") from error
        aside = _moved_aside(path)
        logger.warning(
            "%s was damaged (%s) and is now %s; a new one is begun: earlier events, what people "
            "did to them, and the audit log are only there", path, error, aside.name,
        )  # fmt: skip
        return _opened(path)


def _opened(path: Path) -> sqlite3.Connection:
    with disk_faults(path):
        path.parent.mkdir(mode=PRIVATE_FOLDER, parents=True, exist_ok=True)
        os.close(os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, PRIVATE_FILE))
    connection = sqlite3.connect(
        path, timeout=_WAIT_S, isolation_level=None, check_same_thread=False
    )
    try:
        connection.execute("PRAGMA journal_mode = WAL")
        connection.execute("PRAGMA synchronous = NORMAL")
        _check(connection, path)
        _migrate(connection)
    except BaseException:
        connection.close()
        raise
    return connection


def _check(connection: sqlite3.Connection, path: Path) -> None:
    application = _number(connection, "application_id")
    version = _number(connection, "user_version")
    tables = connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]
    if application != _APPLICATION and (tables or application):
        raise InputError(f"{path}: expected a ledger of trecsim, found a database of another kind")
    if version > VERSION:
        raise InputError(
            f"{path} is of version {version}, made by a newer trecsim; this one reads up to "
            f"version {VERSION}: install the newer one"
        )
    found = connection.execute("PRAGMA quick_check(1)").fetchone()[0]
    if found != "ok":
        raise sqlite3.DatabaseError(" ".join(str(found).split())[:200])


def _number(connection: sqlite3.Connection, pragma: str) -> int:
    return int(connection.execute(f"PRAGMA {pragma}").fetchone()[0])


def _migrate(connection: sqlite3.Connection) -> None:
    if _number(connection, "user_version") == VERSION:
        return
    with transaction(connection):
        version = _number(connection, "user_version")  # another process may have been faster
        for number, step in enumerate(_STEPS[version:], start=version + 1):
            for statement in filter(None, map(str.strip, step.split(";"))):
                connection.execute(statement)
            connection.execute(f"PRAGMA user_version = {number}")
        connection.execute(f"PRAGMA application_id = {_APPLICATION}")


@contextmanager
def transaction(connection: sqlite3.Connection) -> Iterator[sqlite3.Connection]:
    """Run statements that write; all take effect or none does."""
    connection.execute("BEGIN IMMEDIATE")
    try:
        yield connection
        connection.execute("COMMIT")
    except BaseException:
        with suppress(sqlite3.Error):  # SQLite has ended it already after some errors
            connection.execute("ROLLBACK")
        raise


@contextmanager
def sqlite_faults(path: Path) -> Iterator[None]:
    """Turn errors of SQLite into our own.

    Raises
    ------
    SetupError
        When the disk has no room or does not work, another process holds the ledger too long, or
        it was damaged meanwhile.
    """
    try:
        yield
    except sqlite3.Error as error:
        raise SetupError(f"cannot use {path}: {error}") from error


class InPlace:
    """Tells whether the file of a ledger that is open is still the one at its place.

    SQLite goes on with a file that was removed, and all it then takes is lost with the program.

    Parameters
    ----------
    path
        The file; it is there.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._opened = path.stat()

    @property
    def fault(self) -> str | None:
        """What is wrong with the place; None where nothing is."""
        try:
            if os.path.samestat(self._path.stat(), self._opened):
                return None
            found = "another file took its place"
        except OSError as error:
            found = f"it is not there any more ({error.strerror})"
        return (
            f"cannot use {self._path}: {found} while it was in use; put the file back, or start "
            "the site again"
        )


def _moved_aside(path: Path) -> Path:
    stamp = time.strftime("%Y%m%dT%H%M%SZ", time.gmtime())
    aside = path.with_name(f"{path.name}.damaged-{stamp}")
    number = 1
    while aside.exists():
        number += 1
        aside = path.with_name(f"{path.name}.damaged-{stamp}-{number}")
    with disk_faults(path):
        for suffix in ("", *_BESIDE):
            with suppress(FileNotFoundError):
                path.with_name(path.name + suffix).replace(aside.with_name(aside.name + suffix))
    return aside


def copy_ledger(source: Path, target: Path) -> None:
    """Copy a ledger that may be in use; the copy is consistent.

    Raises
    ------
    SetupError
        When the disk has no room or does not work.
    """
    with (
        sqlite_faults(source),
        closing(sqlite3.connect(f"{source.resolve().as_uri()}?mode=ro", uri=True)) as here,
        closing(sqlite3.connect(target)) as there,
    ):
        here.backup(there, pages=256)
        there.execute("PRAGMA journal_mode = DELETE")  # one file


def discard_ledger(folder: Path) -> None:
    """Remove the ledger of a folder, with all events and the audit log.

    Raises
    ------
    OSError
        When it cannot be removed.
    """
    for suffix in ("", *_BESIDE):
        (folder / f"{NAME}{suffix}").unlink(missing_ok=True)
