"""Signing in and out."""

from typing import Annotated

import msgspec
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from trecsim.page.access import Access, Answer, Identity
from trecsim.page.bodies import body_of
from trecsim.page.caller import Caller, caller_of
from trecsim.page.journal import Journal
from trecsim.page.passwords import PasswordCheck, TooManyLoginsError
from trecsim.page.rates import Rates
from trecsim.page.sessions import LONGEST_S

TRIES_PER_S = 0.1  # in the long run,
TRIES_OF_ADDRESS, TRIES_OF_USER = 10.0, 20.0  # and so many at once
REFUSED = "the name or the password is wrong"

_Text = Annotated[str, msgspec.Meta(max_length=1000)]


class Login(msgspec.Struct, frozen=True):
    """Who wants to sign in."""

    user: _Text
    password: _Text


def login_routes(access: Access, journal: Journal) -> list[Route]:
    """Return the routes for signing in and out.

    Parameters
    ----------
    access
        Keeps the sessions.
    journal
        Gets what happens.
    """
    desk = _Desk(access, journal)
    return [
        Route("/api/login", desk.login, methods=["POST"]),
        Route("/api/logout", access.needs("viewer", desk.logout), methods=["POST"]),
        Route("/api/me", _me(access)),
    ]


class _Desk:
    """Lets people in and out."""

    def __init__(self, access: Access, journal: Journal) -> None:
        self._access = access
        self._journal = journal
        self._passwords = PasswordCheck()
        self._by_address = Rates(TRIES_PER_S, TRIES_OF_ADDRESS)
        self._by_user = Rates(TRIES_PER_S, TRIES_OF_USER)

    async def login(self, request: Request) -> Response:
        """Sign somebody in: a new session, whatever the browser had before."""
        caller = caller_of(request.scope, self._access.address)
        if self._access.address.users_file is None:
            raise HTTPException(409, "this page has no users")
        if not caller.is_private:
            raise HTTPException(
                403, "passwords need TLS: give tls_cert and tls_key, or trusted_proxy, under [page]"
            )
        given = await body_of(request, Login)
        self._slow_down(caller.address, given.user)
        user = self._access.users.get(given.user)
        known_hash = None if user is None else user.password
        try:
            right = await self._passwords.fits(given.password, known_hash)
        except TooManyLoginsError as error:
            raise HTTPException(503, str(error), {"Retry-After": "3"}) from None
        who = "unknown" if user is None else user.name  # a name may be a password typed too early
        if user is None or not right:
            await self._journal.audit(who, "login failed", {"address": caller.address})
            raise HTTPException(401, REFUSED)
        self._forget(request)
        key, session = self._access.sessions.begin(user.name, user.password)
        await self._journal.audit(who, "login", {"address": caller.address})
        answer = _told(Identity(user.name, user.role, user.name, session.csrf))
        self._give(answer, key, caller)
        return answer

    async def logout(self, request: Request) -> Response:
        """End the session."""
        identity: Identity = request.state.identity
        self._forget(request)
        await self._journal.audit(identity.by, "logout", {})
        answer = Response(status_code=204)
        answer.delete_cookie(self._access.cookie, path="/", httponly=True, samesite="strict")
        return answer

    def _slow_down(self, address: str, user: str) -> None:
        if not (self._by_address.allows(address) and self._by_user.allows(user)):
            raise HTTPException(
                429, "too many tries; wait a minute, then try again", {"Retry-After": "60"}
            )

    def _forget(self, request: Request) -> None:
        key = request.cookies.get(self._access.cookie)
        if key is not None:
            self._access.sessions.end(key)

    def _give(self, answer: Response, key: str, caller: Caller) -> None:
        answer.set_cookie(
            self._access.cookie, key, max_age=int(LONGEST_S), path="/", httponly=True,
            secure=caller.is_encrypted, samesite="strict",
        )  # fmt: skip


def _me(access: Access) -> Answer:
    async def me(request: Request) -> Response:
        return _told(access.checked(request, "viewer"))

    return me


def _told(identity: Identity) -> JSONResponse:
    return JSONResponse({"user": identity.user, "role": identity.role, "csrf": identity.csrf})
