"""Secrets: from the environment or from a file, never from the site file."""

import os
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import quote

from trecsim.errors import ConfigError
from trecsim.toml_models import bounded_toml

VARIABLE = "TRECSIM_CREDENTIALS_"
LONGEST = 120  # letters of both together, escaped: FFmpeg cuts what is longer than 127
_FORM = '"user:password"'
_LARGEST_BYTES = 1 << 16


@dataclass(frozen=True, slots=True)
class Login:
    """User and password; no text of it shows them.

    Attributes
    ----------
    user, password
        As the camera knows them.
    """

    user: str = field(repr=False)
    password: str = field(repr=False)


def variable(name: str) -> str:
    """Return the name of the environment variable that holds credentials.

    Examples
    --------
    >>> variable("north-gate")
    'TRECSIM_CREDENTIALS_NORTH_GATE'
    """
    return VARIABLE + name.upper().replace("-", "_")


def find_login(
    name: str, secrets: Path | None = None, environment: Mapping[str, str] = os.environ
) -> Login:
    """Return the credentials called `name`.

    Parameters
    ----------
    name
        As the site file names them.
    secrets
        A file with a line `name = "user:password"` for each (TOML); the environment goes first.
    environment
        Of this process.

    Raises
    ------
    ConfigError
        When there are none, or they are not of the form user:password. The text never shows them.
    """
    return _login(*_found(name, secrets, environment, _FORM))


def find_key(
    name: str, secrets: Path | None = None, environment: Mapping[str, str] = os.environ
) -> str:
    """Return the key called `name`, as a webhook is signed with: all of the value.

    Parameters
    ----------
    name, secrets, environment
        See `find_login`.

    Raises
    ------
    ConfigError
        When there is none, or it is empty. The text never shows it.
    """
    key, where = _found(name, secrets, environment, '"KEY"')
    if not key:
        raise ConfigError(f"{where}: expected a key, found nothing")
    return key


def _found(
    name: str, secrets: Path | None, environment: Mapping[str, str], form: str
) -> tuple[str, str]:
    """Return a secret, and where it stands."""
    value = environment.get(variable(name))
    if value is not None:
        return value, f"the environment variable {variable(name)}"
    if secrets is None:
        raise ConfigError(
            f"there are no credentials {name!r}: set the environment variable {variable(name)} to "
            f"{form}, or name a file with a line {name} = {form} as `secrets`"
        )
    kept = read_secrets(secrets)
    if name not in kept:
        raise ConfigError(
            f"there are no credentials {name!r}: add a line {name} = {form} to {secrets}, or set "
            f"the environment variable {variable(name)}"
        )
    return kept[name], f"{name!r} in {secrets}"


def read_secrets(path: Path) -> dict[str, str]:
    """Return the secrets in a file, by name.

    Parameters
    ----------
    path
        A TOML file with a line `name = "user:password"`, or of a key `name = "key"`, for each; only
        its owner and group may be able to read it.

    Raises
    ------
    ConfigError
        When it cannot be read, anybody may read it, or a line is wrong. The text shows none of it.
    """
    try:
        mode = path.stat().st_mode
        text = _text(path)
    except OSError as error:
        raise ConfigError(f"cannot read the secrets in {path}: {error.strerror}") from None
    if os.name == "posix" and mode & 0o004:
        raise ConfigError(
            f"every user of this machine can read the secrets in {path}; forbid it: "
            f"chmod 600 {path}"
        )
    try:
        lines = bounded_toml.loads(text)
    except ValueError as error:
        line = re.search(r"line \d+", str(error))
        where = f"{line.group()}: " if line else ""
        # Not the parser's own words: they may quote what stands there.
        raise ConfigError(f"{path}: {where}expected lines like north = {_FORM} (TOML)") from None
    for name, value in lines.items():
        if not isinstance(value, str):
            raise ConfigError(f"{name!r} in {path}: expected {_FORM}, found something else")
    return lines


def _text(path: Path) -> str:
    with path.open("rb") as file:
        data = file.read(_LARGEST_BYTES + 1)
    if len(data) > _LARGEST_BYTES:
        raise ConfigError(f"{path} is larger than 64 KiB: it is no file of secrets")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise ConfigError(f"{path}: expected UTF-8 text") from None


def _login(value: object, where: str) -> Login:
    user, colon, password = value.partition(":") if isinstance(value, str) else ("", "", "")
    if not user or not colon:
        raise ConfigError(f"{where}: expected {_FORM}, found something else")
    if len(quote(user + password, safe="")) > LONGEST:
        raise ConfigError(
            f"{where}: user and password are longer than what can be sent to a camera"
        )
    return Login(user, password)
