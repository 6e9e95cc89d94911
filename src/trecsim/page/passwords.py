"""Passwords: hashed with argon2id, never kept."""

import asyncio
from contextlib import suppress
from functools import cache

from argon2 import PasswordHasher
from argon2.exceptions import InvalidHashError, VerificationError

from trecsim.errors import Error, InputError

SHORTEST, LONGEST = 10, 1000  # characters of a password
AT_ONCE = 2  # hashes computed at the same time: each takes 64 MiB and a quarter of a second
WAITING = 8  # more logins than these are refused

# One lane: a login shall not take all cores from the tracking.
_HASHER = PasswordHasher(time_cost=3, memory_cost=65536, parallelism=1)


class TooManyLoginsError(Error):
    """More people sign in at the same moment than are served."""


def hashed(password: str) -> str:
    """Return the hash of a new password.

    Raises
    ------
    InputError
        The password is too short or too long.
    """
    if not SHORTEST <= len(password) <= LONGEST:
        raise InputError(
            f"expected a password of {SHORTEST} to {LONGEST} characters, found {len(password)}"
        )
    return _HASHER.hash(password)


def fits(password: str, known_hash: str | None) -> bool:
    """Tell whether a password is the one of a hash.

    It takes as long when there is no hash, so that nobody learns which users exist.
    """
    if len(password) > LONGEST:
        return False
    with suppress(VerificationError, InvalidHashError):
        _HASHER.verify(_of_nobody() if known_hash is None else known_hash, password)
        return known_hash is not None
    return False


@cache
def _of_nobody() -> str:
    return _HASHER.hash("the password of nobody")


class PasswordCheck:
    """Checks passwords in threads, a few at once."""

    def __init__(self) -> None:
        self._turns = asyncio.Semaphore(AT_ONCE)
        self._waiting = 0

    async def fits(self, password: str, known_hash: str | None) -> bool:
        """Tell whether a password is the one of a hash.

        Raises
        ------
        TooManyLoginsError
            Too many wait already.
        """
        if self._waiting >= WAITING:
            raise TooManyLoginsError("too many people sign in; try again in a few seconds")
        self._waiting += 1
        try:
            async with self._turns:
                return await asyncio.to_thread(fits, password, known_hash)
        finally:
            self._waiting -= 1
