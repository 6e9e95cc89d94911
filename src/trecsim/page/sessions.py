"""Who is signed in: sessions are kept here, browsers hold only a random name of theirs."""

import hashlib
import secrets
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, replace
from time import monotonic

IDLE_S = 12 * 3600.0  # a session that is not used for so long ends
LONGEST_S = 7 * 24 * 3600.0  # every session ends after so long
KEPT = 1000  # sessions at most; the one that was used longest ago ends first


@dataclass(frozen=True, slots=True)
class Session:
    """A user who is signed in.

    Attributes
    ----------
    user
        Name of the user.
    password
        Hash of the password at that time; a new password ends the session.
    csrf
        What the page sends with everything that changes something.
    began_s, used_s
        When it began and was last used [s], on the clock of `Sessions`.
    """

    user: str
    password: str
    csrf: str
    began_s: float
    used_s: float


class Sessions:
    """Keeps sessions by the hash of their name, so that no copy of the memory holds a key.

    Parameters
    ----------
    clock
        Tells the time [s].
    """

    def __init__(self, clock: Callable[[], float] = monotonic) -> None:
        self._clock = clock
        self._sessions: OrderedDict[str, Session] = OrderedDict()

    def begin(self, user: str, password: str) -> tuple[str, Session]:
        """Begin a session; return the key that the browser keeps, and the session."""
        key, now_s = secrets.token_urlsafe(32), self._clock()
        session = Session(user, password, secrets.token_urlsafe(32), now_s, now_s)
        self._sessions[_digest(key)] = session
        if len(self._sessions) > KEPT:
            self._sessions.popitem(last=False)
        return key, session

    def find(self, key: str) -> Session | None:
        """Return the session of a key, and count it as used; None where it has ended."""
        digest = _digest(key)
        session = self._sessions.pop(digest, None)
        if session is None:
            return None
        now_s = self._clock()
        if now_s - session.used_s > IDLE_S or now_s - session.began_s > LONGEST_S:
            return None
        self._sessions[digest] = replace(session, used_s=now_s)
        return session

    def end(self, key: str) -> None:
        """End a session."""
        self._sessions.pop(_digest(key), None)


def _digest(key: str) -> str:
    return hashlib.sha256(key.encode(errors="replace")).hexdigest()
