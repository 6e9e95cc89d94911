"""The commands `trecsim users add`, `list`, `role` and `remove`."""

import sys
from collections.abc import Mapping
from getpass import getpass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from trecsim.cli.terminal import finish
from trecsim.errors import InputError

if TYPE_CHECKING:
    from trecsim.page.users_file import User

Role = Literal["viewer", "operator", "admin"]
USERS = Path("users.toml")


def add(name: str, /, *, role: Role | None = None, file: Path = USERS, json: bool = False) -> None:
    """Add a user of the page, or give one a new password.

    In a terminal the password is asked for twice; otherwise it is the first line of stdin. Only a
    hash of it is kept (argon2id), in a file that only its owner can read. A page that runs sees
    the change at once; a new password ends the sessions of that user.

    Parameters
    ----------
    name
        Up to 64 letters, digits and . _ @ -.
    role
        viewer: look. operator: also act on alerts. admin: also change the site. Needed for a new
        user.
    file
        The file that the site file names: `users` under `[page]`.
    json
        Print the summary as one JSON object.
    """
    from trecsim.page.passwords import hashed
    from trecsim.page.users_file import User, check_name, read_users, write_users

    check_name(name)
    users = read_users(file) if file.exists() else {}
    before = users.get(name)
    found = role or (before.role if before else None)
    if found is None:
        raise InputError(f"{name} is new: expected --role viewer, operator or admin, found none")
    users[name] = User(name, found, hashed(_password()))
    write_users(file, users)
    said = "has a new password" if before else "may sign in"
    finish({"file": file, "user": name, "role": found}, json, f"{file}: {name} ({found}) {said}")


def list_(*, file: Path = USERS, json: bool = False) -> None:
    """List the users of the page.

    Parameters
    ----------
    file
        The file that the site file names: `users` under `[page]`.
    json
        Print the summary as one JSON object.
    """
    users = sorted(_known(file).values(), key=lambda user: user.name)
    lines = "\n".join(f"{user.role:<9} {user.name}" for user in users)
    roles = {user.name: user.role for user in users}
    finish({"file": file, "users": roles}, json, lines or f"{file}: nobody")


def role(name: str, role: Role, /, *, file: Path = USERS, json: bool = False) -> None:
    """Give a user of the page another role.

    Parameters
    ----------
    name
        The user.
    role
        viewer, operator or admin.
    file
        The file that the site file names: `users` under `[page]`.
    json
        Print the summary as one JSON object.
    """
    from dataclasses import replace

    from trecsim.page.users_file import write_users

    users = _known(file)
    _check_known(name, users, file)
    users[name] = replace(users[name], role=role)
    write_users(file, users)
    finish({"file": file, "user": name, "role": role}, json, f"{file}: {name} is {role} now")


def remove(name: str, /, *, file: Path = USERS, json: bool = False) -> None:
    """Remove a user of the page.

    Parameters
    ----------
    name
        The user; the sessions of that user end.
    file
        The file that the site file names: `users` under `[page]`.
    json
        Print the summary as one JSON object.
    """
    from trecsim.page.users_file import write_users

    users = _known(file)
    _check_known(name, users, file)
    del users[name]
    write_users(file, users)
    finish({"file": file, "user": name}, json, f"{file}: {name} is removed")


def _known(file: Path) -> "dict[str, User]":
    from trecsim.page.users_file import read_users

    if not file.exists():
        raise InputError(
            f"there is no {file}: expected a file of users; trecsim users add NAME --role admin "
            "makes one, --file names another"
        )
    return read_users(file)


def _check_known(name: str, users: Mapping[str, object], file: Path) -> None:
    if name not in users:
        known = ", ".join(sorted(users)) or "nobody"
        raise InputError(f"{file} has no user {name!r}; it has: {known}")


def _password() -> str:
    if not sys.stdin.isatty():
        return sys.stdin.readline().rstrip("\r\n")
    first = getpass("password: ")
    if getpass("again: ") != first:
        raise InputError("the two passwords differ; nothing is changed")
    return first
