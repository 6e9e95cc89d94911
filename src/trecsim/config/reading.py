"""Read a site file; all that is wrong with it comes in one message, with line numbers."""

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from trecsim.config.lines import KeyPath, key_lines, line_of
from trecsim.config.site import Site
from trecsim.errors import ConfigError

_LARGEST_BYTES = 1 << 20
_MOST_FAULTS = 20
_EXPECTED = {
    "path_type": "a path",
    "model_type": "a table",
    "dict_type": "a table",
    "tuple_type": "an array",
    "string_pattern_mismatch": "1 to 64 letters, digits, '-' and '_'",
    "too_short": "more values",
    "too_long": "fewer values",
}


@dataclass(frozen=True, slots=True)
class SiteFile:
    """A site file that was read.

    Attributes
    ----------
    path
        The file.
    text
        Its content.
    site
        What it says.
    """

    path: Path
    text: str
    site: Site


def read_site(path: Path) -> SiteFile:
    """Read a site file.

    Parameters
    ----------
    path
        A TOML file with the keys of :class:`Site`.

    Raises
    ------
    ConfigError
        When it cannot be read or anything in it is wrong; the text lists all faults.
    """
    text = _text(path)
    data = _parsed(path, text)
    try:
        site = Site.model_validate(data, context={"folder": path.parent})
    except ValidationError as error:
        raise site_faults(path, text, [_plain_fault(fault) for fault in error.errors()]) from None
    return SiteFile(path, text, site)


def site_schema() -> dict[str, Any]:
    """Return the JSON schema of site files, from which editors complete and check them."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **Site.model_json_schema(),
    }


def site_faults(path: Path, text: str, faults: Sequence[tuple[KeyPath, str]]) -> ConfigError:
    """Return one error that tells all faults of a site file, in the order of their lines.

    Parameters
    ----------
    path, text
        The file and its content.
    faults
        What is wrong, by the keys that lead there.
    """
    lines = key_lines(text)
    told = [
        f"line {line}: {f'{name}: ' if name else ''}{fault}"
        for line, name, fault in sorted(
            (line_of(lines, key), ".".join(map(str, key)), fault) for key, fault in faults
        )
    ]
    if len(told) == 1:
        return ConfigError(f"{path}: {told[0]}")
    if len(told) > _MOST_FAULTS:
        told[_MOST_FAULTS:] = [f"and {len(told) - _MOST_FAULTS} more"]
    return ConfigError("\n  ".join([f"{path}: {len(faults)} faults", *told]))


def _text(path: Path) -> str:
    try:
        with path.open("rb") as file:
            data = file.read(_LARGEST_BYTES + 1)
    except (OSError, ValueError) as error:  # ValueError: a null character in the name
        reason = error.strerror if isinstance(error, OSError) else error
        raise ConfigError(f"cannot read the site file {path}: {reason}") from None
    if len(data) > _LARGEST_BYTES:
        raise ConfigError(f"{path} is larger than 1 MiB: it is no site file")
    try:
        return data.decode("utf-8-sig").replace("\r\n", "\n")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise ConfigError(f"{path}: line {line}: expected UTF-8 text") from None


def _parsed(path: Path, text: str) -> dict[str, Any]:
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise ConfigError(f"{path} is no site file: it is nested too deeply") from None
    except ValueError as error:
        raise ConfigError(f"{path} is not TOML: {error}") from None


def _plain_fault(fault: Any) -> tuple[KeyPath, str]:
    key = tuple(part for part in fault["loc"] if part != "[key]")
    match fault["type"]:
        case "extra_forbidden":
            return key, _unknown(key)
        case "missing":
            return key, "is missing"
        case "value_error":
            return key, str(fault["msg"]).removeprefix("Value error, ")
        case kind:
            expected = _EXPECTED.get(kind) or fault["msg"].removeprefix("Input should be ")
            return key, f"expected {expected}, found {fault['input']!r:.60}"


def _unknown(key: KeyPath) -> str:
    known = _known_beside(key)
    near = get_close_matches(str(key[-1]), known, n=1)
    hint = f"did you mean {near[0]!r}?" if near else f"known: {', '.join(known)}"
    return f"unknown key; {hint}"


def _known_beside(key: KeyPath) -> list[str]:
    """Return the keys that the table which holds `key` may have."""
    schema = site_schema()
    node: Mapping[str, Any] = schema
    for part in key[:-1]:
        node = _resolved(schema, node)
        node = node.get("properties", {}).get(part) or node.get("additionalProperties") or {}
    return sorted(_resolved(schema, node).get("properties", {}))


def _resolved(schema: Mapping[str, Any], node: Mapping[str, Any]) -> Mapping[str, Any]:
    for option in (node, *node.get("anyOf", ())):
        if "$ref" in option:
            target: Mapping[str, Any] = schema["$defs"][option["$ref"].rsplit("/", 1)[-1]]
            return target
    return node
