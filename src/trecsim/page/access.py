"""Who may do what."""

import hashlib
import hmac
import logging
from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from time import monotonic
from typing import Literal

from starlette.exceptions import HTTPException
from starlette.requests import HTTPConnection, Request
from starlette.responses import Response

from trecsim.errors import Error
from trecsim.page.address import PageAddress
from trecsim.page.caller import caller_of
from trecsim.page.rates import Rates
from trecsim.page.sessions import Sessions
from trecsim.page.users_file import ROLES, Role, User, read_users

logger = logging.getLogger(__name__)

SAFE = ("GET", "HEAD", "OPTIONS")
TOKEN_ROLE: Role = "operator"
Right = Role | Literal["feeds"]
"""What may be asked for: a role, or that messages of feeds are taken, which is part of no role but
that of admins: who may post them may not look at people, and the other way round."""
USERS_READ_S = 1.0  # how often it is looked whether the file of users has changed
CSRF_HEADER = "x-csrf-token"

Answer = Callable[[Request], Awaitable[Response]]


@dataclass(frozen=True, slots=True)
class Identity:
    """Who asks.

    Attributes
    ----------
    user
        Name of the user; None on a page without users.
    role
        What the user may do; "feeds": post messages of feeds, and nothing else.
    by
        What stands in events and audit: the name of the user, "token", "feeds token" or "local".
    csrf
        What has to come with everything that changes something; None where no cookie is involved.
    """

    user: str | None
    role: Right
    by: str
    csrf: str | None = None

    def may(self, right: Right) -> bool:
        """Tell whether the user has a right, or at least a role."""
        if right == "feeds" or self.role == "feeds":
            return right == "feeds" and self.role in ("feeds", "admin")
        return ROLES.index(self.role) >= ROLES.index(right)


LOCAL = Identity(None, "admin", "local")
"""Everybody on a page without users, which is reached from this machine alone."""


class KnownUsers:
    """The users of a file, read again when it has changed.

    Parameters
    ----------
    path
        The file; None for no users.
    changed
        Is told the users before and after a change.
    """

    def __init__(
        self,
        path: Path | None,
        changed: Callable[[Mapping[str, User], Mapping[str, User]], None],
    ) -> None:
        self._path = path
        self._changed = changed
        self._users: dict[str, User] = {}
        self._stamp: tuple[int, int] | None = None
        self._looked_s = -USERS_READ_S
        self._told: str | None = None  # what is wrong with the file, said once

    def get(self, name: str) -> User | None:
        """Return a user by name."""
        self._look()
        return self._users.get(name)

    def _look(self) -> None:
        if self._path is None or monotonic() - self._looked_s < USERS_READ_S:
            return
        self._looked_s = monotonic()
        try:
            facts = self._path.stat()
            stamp = facts.st_mtime_ns, facts.st_size
            if stamp == self._stamp:
                self._told = None
                return
            users = read_users(self._path)
        except (OSError, Error) as error:  # a file that is wrong lets nobody in who was not
            if str(error) != self._told:
                logger.error("the users are as before: %s", error)  # noqa: TRY400
            self._told = str(error)
            return
        self._told = None
        before, self._users = self._users, users
        first, self._stamp = self._stamp is None, stamp
        if not first:
            self._changed(before, users)


class Access:
    """Finds out who asks, and refuses what the role does not allow.

    Parameters
    ----------
    address
        What protects the page.
    port
        On which it listens: browsers send the cookies of all ports of a machine to each of them.
    changed
        Is told the users before and after a change of their file.
    """

    def __init__(
        self,
        address: PageAddress,
        port: int,
        changed: Callable[[Mapping[str, User], Mapping[str, User]], None] = lambda *_: None,
    ) -> None:
        self.address = address
        self.users = KnownUsers(address.users_file, changed)
        self.sessions = Sessions()
        token = address.token()
        self._token = None if token is None else _digest(token)
        feeds_token = address.feeds_token()
        self._feeds_token = None if feeds_token is None else _digest(feeds_token)
        self._wrong_tokens = Rates(0.2, 20.0)
        self.cookie = f"trecsim-{port}"

    def identity(self, connection: HTTPConnection) -> Identity | None:
        """Return who asks; None where nobody is signed in.

        Raises
        ------
        HTTPException
            A token that is wrong, or came over a line that others can read.
        """
        if self.address.is_open:
            return LOCAL
        scheme, _, token = connection.headers.get("authorization", "").partition(" ")
        if scheme.lower() == "bearer":
            return self._of_token(connection, token.strip())
        key = connection.cookies.get(self.cookie)
        session = None if key is None else self.sessions.find(key)
        user = None if session is None else self.users.get(session.user)
        if session is None or user is None or user.password != session.password:
            return None
        return Identity(user.name, user.role, user.name, session.csrf)

    def needs(self, right: Right, answer: Answer) -> Answer:
        """Return a route that only those with a right may use."""

        async def guarded(request: Request) -> Response:
            request.state.identity = self.checked(request, right)
            return await answer(request)

        return guarded

    def checked(self, connection: HTTPConnection, right: Right) -> Identity:
        """Return who asks, if the role is enough.

        Raises
        ------
        HTTPException
            It is not, nobody is signed in, or a change comes without the page's own mark.
        """
        identity = self.identity(connection)
        if identity is None:
            raise HTTPException(401, "sign in first", {"WWW-Authenticate": "Bearer"})
        if not identity.may(right):
            raise HTTPException(403, _lacks(right, identity))
        changes = connection.scope.get("method", "GET") not in SAFE
        if changes and identity.csrf is not None:
            given = connection.headers.get(CSRF_HEADER, "")
            if not hmac.compare_digest(given.encode(), identity.csrf.encode()):
                raise HTTPException(403, f"expected the header {CSRF_HEADER} that /api/me gives")
        return identity

    def _of_token(self, connection: HTTPConnection, token: str) -> Identity:
        caller = caller_of(connection.scope, self.address)
        if not caller.is_private:
            raise HTTPException(403, "tokens need TLS: this one was sent in the clear, replace it")
        given = _digest(token)
        if self._token is not None and hmac.compare_digest(given, self._token):
            return Identity("token", TOKEN_ROLE, "token")
        if self._feeds_token is not None and hmac.compare_digest(given, self._feeds_token):
            return Identity("feeds token", "feeds", "feeds token")
        if not self._wrong_tokens.allows(caller.address):
            raise HTTPException(429, "too many wrong tokens", {"Retry-After": "5"})
        raise HTTPException(401, "the token is wrong", {"WWW-Authenticate": "Bearer"})


def _lacks(right: Right, identity: Identity) -> str:
    """Return why somebody may not do something."""
    if identity.role == "feeds":
        return "this token may only post messages of feeds"
    if right == "feeds":
        return f"this needs the token of feeds_token_env, or an admin; you are {identity.role}"
    return f"this needs the role {right}; you are {identity.role}"


def _digest(text: str) -> bytes:
    return hashlib.sha256(text.encode(errors="replace")).digest()
