"""The file of the users who may sign in: names, roles and hashes of passwords."""

import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, get_args

from trecsim.errors import InputError
from trecsim.store.atomic import atomic_write, opened_for_reading

Role = Literal["viewer", "operator", "admin"]
ROLES: tuple[Role, ...] = get_args(Role)
"""What users may do, each more than the one before: look; act on alerts; change the site."""

FORMAT = "trecsim.users/1"
NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._@-]{0,63}")
RESERVED = ("local", "token", "trecsim")  # stand in the audit log for what is no user
LARGEST_BYTES = 1_000_000
_HASH = re.compile(r"\$argon2id\$[A-Za-z0-9+/=,$]{20,300}")


@dataclass(frozen=True, slots=True)
class User:
    """Somebody who may sign in.

    Attributes
    ----------
    name
        Letters, digits and ``. _ @ -``.
    role
        One of `ROLES`.
    password
        Hash of the password, argon2id.
    """

    name: str
    role: Role
    password: str


def read_users(path: Path) -> dict[str, User]:
    """Read a file of users.

    Raises
    ------
    InputError
        It cannot be read, or something in it is wrong; no message holds a hash.
    """
    with opened_for_reading(path) as file:
        content = file.read(LARGEST_BYTES + 1)
    if len(content) > LARGEST_BYTES:
        raise InputError(f"{path}: expected at most {LARGEST_BYTES} bytes")
    try:
        data = tomllib.loads(content.decode())
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path} is no file of users: {error}") from None
    if data.get("format") != FORMAT:
        raise InputError(f'{path}: expected format = "{FORMAT}", found {data.get("format")!r}')
    users = data.get("users", {})
    if not isinstance(users, dict) or set(data) - {"format", "users"}:
        raise InputError(f"{path}: expected format and tables [users.NAME], and nothing else")
    return {name: _user(path, name, entry) for name, entry in users.items()}


def write_users(path: Path, users: Mapping[str, User]) -> None:
    """Write a file of users, readable by its owner only.

    Raises
    ------
    InputError
        It cannot be written there.
    SetupError
        The disk has no room.
    """
    lines = [f'format = "{FORMAT}"']
    for user in sorted(users.values(), key=lambda user: user.name):
        lines += [
            "",
            f'[users."{user.name}"]',
            f'role = "{user.role}"',
            f'password = "{user.password}"',
        ]
    with atomic_write(path, private=True) as file:
        file.write("\n".join(lines) + "\n")


def check_name(name: str) -> None:
    """Check the name of a new user.

    Raises
    ------
    InputError
        It cannot be one.
    """
    if not NAME.fullmatch(name):
        raise InputError(
            "user names have up to 64 letters, digits and . _ @ -, and begin with a letter or "
            f"digit; found {name!r}"
        )
    if name in RESERVED:
        raise InputError(f"the name {name!r} is reserved; expected another one")


def _user(path: Path, name: str, entry: Any) -> User:
    where = f"{path}: users.{name}"
    check_name(name)
    if not isinstance(entry, dict) or set(entry) != {"role", "password"}:
        raise InputError(f"{where}: expected role and password, and nothing else")
    role, password = entry["role"], entry["password"]
    if role not in ROLES:
        raise InputError(f"{where}.role: expected one of {', '.join(ROLES)}, found {role!r}")
    if not isinstance(password, str) or not _HASH.fullmatch(password):
        raise InputError(
            f"{where}.password: expected the hash of a password (argon2id), found something else; "
            "make it with: trecsim users add"
        )
    return User(name, role, password)
