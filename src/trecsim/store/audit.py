"""The chain of hashes that shows whether an audit log was changed.

Each entry carries the hash of the one before, so changing, adding or removing one breaks the chain
from there on. Removing the newest entries does not; compare the number of entries and the last
hash with an earlier report for that.
"""

import hashlib
import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

FIRST_HASH = "0" * 64
"""What the first entry carries in place of an earlier hash."""


@dataclass(frozen=True, slots=True)
class AuditEntry:
    """Something that was done to a site or its data.

    Attributes
    ----------
    number
        Its place in the log, from 1.
    t_s
        When it was done, Unix time [s].
    who
        Name of the user, or of the command.
    act
        What was done, as "login" or "erase".
    details
        More about it.
    hash
        Of this entry and the one before.
    """

    number: int
    t_s: float
    who: str
    act: str
    details: Mapping[str, Any]
    hash: str


@dataclass(frozen=True, slots=True)
class AuditVerdict:
    """Whether an audit log is as it was written.

    Attributes
    ----------
    entries
        Number of entries.
    broken_at
        The first entry that does not fit the one before; None where all do.
    last_hash
        Hash of the last entry. Keep it elsewhere to notice later that entries were cut off.
    """

    entries: int
    broken_at: int | None
    last_hash: str

    @property
    def is_whole(self) -> bool:
        """Whether no entry was changed, added or removed in between."""
        return self.broken_at is None


def next_hash(
    before: str, number: int, t_s: float, who: str, act: str, details: Mapping[str, Any]
) -> str:
    """Return the hash of an entry that follows the one with the hash `before`."""
    facts = json.dumps(
        [before, number, t_s, who, act, details],
        ensure_ascii=False, sort_keys=True, separators=(",", ":"), allow_nan=False,
    )  # fmt: skip
    return hashlib.sha256(facts.encode()).hexdigest()


def details_in(text: object) -> Mapping[str, Any]:
    """Return the details of an entry from their JSON text.

    A text that is none was changed after it was written; it is kept so that the hash tells.

    Examples
    --------
    >>> details_in('{"user": "kim"}'), details_in('{"user')
    ({'user': 'kim'}, {'unreadable': '{"user'})
    """
    try:
        details = json.loads(text) if isinstance(text, str) else None
    except (ValueError, RecursionError):
        details = None
    return details if isinstance(details, dict) else {"unreadable": str(text)}


def verified(entries: Iterable[AuditEntry]) -> AuditVerdict:
    """Follow the chain through all entries of a log."""
    before, count, broken = FIRST_HASH, 0, None
    for count, entry in enumerate(entries, start=1):
        try:
            expected = next_hash(before, count, entry.t_s, entry.who, entry.act, entry.details)
        except (TypeError, ValueError, RecursionError):  # of values that no entry was written with
            expected = ""
        if broken is None and (entry.number, entry.hash) != (count, expected):
            broken = count
        before = entry.hash
    return AuditVerdict(count, broken, before)
