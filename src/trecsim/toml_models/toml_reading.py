"""Validate a TOML file by its model; all faults are in one message, with line numbers."""

from collections.abc import Iterable, Mapping, Sequence
from difflib import get_close_matches
from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from trecsim.errors import ConfigError
from trecsim.redaction import redacted
from trecsim.toml_models import bounded_toml
from trecsim.toml_models.lines import KeyPath, key_lines, line_of
from trecsim.toml_models.table import Table

Model = TypeVar("Model", bound=Table)
Fault = tuple[KeyPath, str]

ALIKE = 0.65  # share of letters in order: "fsp" is "fps" (0.67), "zones" is not "poses" (0.6)
_LARGEST_BYTES = 1 << 20
_MOST_FAULTS = 20
_LONGEST_KEY = 64  # letters of a key in a message
_EXPECTED = {
    "path_type": "a path",
    "model_type": "a table",
    "dict_type": "a table",
    "dataclass_type": "a table",
    "tuple_type": "an array",
    "string_pattern_mismatch": "1 to 64 letters, digits, '-' and '_'",
    "too_short": "more values",
    "too_long": "fewer values",
}


def read_text(path: Path, kind: str) -> str:
    """Return the text of a file that was written by hand.

    Parameters
    ----------
    path
        The file.
    kind
        What it should be, as in "site file", for messages.

    Raises
    ------
    ConfigError
        When it cannot be read, is no text, or too large for what people write.
    """
    try:
        with path.open("rb") as file:
            data = file.read(_LARGEST_BYTES + 1)
    except IsADirectoryError:
        inside = ", ".join(str(one) for one in sorted(path.glob("*.toml"))[:3])
        there = f"; there is {inside}" if inside else ""
        raise ConfigError(f"{path} is a folder: expected the {kind} itself{there}") from None
    except (OSError, ValueError) as error:  # ValueError: a null character in the name
        reason = error.strerror if isinstance(error, OSError) else error
        raise ConfigError(f"cannot read the {kind} {path}: {reason}") from None
    if len(data) > _LARGEST_BYTES:
        raise ConfigError(f"{path} is larger than 1 MiB: it is no {kind}")
    try:
        return data.decode("utf-8-sig").replace("\r\n", "\n")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise ConfigError(f"{path}: line {line}: expected UTF-8 text") from None


def parsed(path: Path, text: str, kind: str) -> dict[str, Any]:
    """Return what a TOML text says.

    Parameters
    ----------
    path, text
        The file and its content.
    kind
        What it should be, for messages.

    Raises
    ------
    ConfigError
        When the text is not TOML.
    """
    try:
        return bounded_toml.loads(text)
    except ValueError as error:
        raise ConfigError(f"{path} is not TOML: {error}") from None


def validated(
    model: type[Model], path: Path, text: str, kind: str, context: Mapping[str, Any] | None = None
) -> Model:
    """Return what a text says, as its model takes it.

    Parameters
    ----------
    model
        The outermost table.
    path, text
        The file and its content.
    kind
        What it should be, for messages.
    context
        Handed to the validators of the model.

    Raises
    ------
    ConfigError
        When anything in it is wrong; the text lists all faults.
    """
    value, faults = examined(model, parsed(path, text, kind), context)
    if value is None:
        raise file_faults(path, text, faults)
    return value


def examined(
    model: type[Model], data: Mapping[str, Any], context: Mapping[str, Any] | None = None
) -> tuple[Model | None, list[Fault]]:
    """Return what parsed TOML says, as its model takes it; or None, and all that is wrong.

    Parameters
    ----------
    model
        The outermost table.
    data
        The parsed text.
    context
        Handed to the validators of the model.
    """
    try:
        return model.model_validate(data, context=dict(context or {})), []
    except ValidationError as error:
        schema = schema_of(model)
        return None, [_plain_fault(fault, schema, model.not_yet) for fault in error.errors()]


def schema_of(model: type[Table]) -> dict[str, Any]:
    """Return the JSON schema of a file, from which editors complete and check it."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **model.model_json_schema(),
    }


def file_faults(path: Path, text: str, faults: Sequence[Fault]) -> ConfigError:
    """Return one error with all faults of a file, in the order of their lines.

    Parameters
    ----------
    path, text
        The file and its content.
    faults
        What is wrong, by the keys that lead there.
    """
    lines = key_lines(text)
    listed = [
        f"line {line}: {f'{name}: ' if name else ''}{fault}"
        for line, name, fault in sorted(
            (line_of(lines, key), ".".join(map(_short, key)), fault) for key, fault in faults
        )
    ]
    if len(listed) == 1:
        return ConfigError(f"{path}: {listed[0]}")
    if len(listed) > _MOST_FAULTS:
        listed[_MOST_FAULTS:] = [f"and {len(listed) - _MOST_FAULTS} more"]
    return ConfigError("\n  ".join([f"{path}: {len(faults)} faults", *listed]))


def _short(part: str | int) -> str:
    text = str(part)
    return text if len(text) <= _LONGEST_KEY else f"{text[:_LONGEST_KEY]}..."


def _plain_fault(fault: Any, schema: Mapping[str, Any], not_yet: Mapping[str, str]) -> Fault:
    key, beside = _followed(fault["loc"], schema)
    match fault["type"]:
        case "extra_forbidden" | "unexpected_keyword_argument":
            return key, not_yet.get(str(key[-1])) or (
                f"unknown key; {nearest(str(key[-1]), beside)}"
            )
        case "missing" | "union_tag_not_found":
            tag = fault.get("ctx", {}).get("discriminator", "").strip("'")
            return ((*key, tag) if tag else key), "is missing"
        case "union_tag_invalid":
            context = fault["ctx"]
            known = context["expected_tags"].replace("'", "").split(", ")
            tag = str(context["tag"])
            return (*key, context["discriminator"].strip("'")), (
                f"there is no {redacted(tag)[:40]!r}; {nearest(tag, known)}"
            )
        case "value_error":
            return key, str(fault["msg"]).removeprefix("Value error, ")
        case kind:
            expected = _EXPECTED.get(kind) or fault["msg"].removeprefix("Input should be ")
            return key, f"expected {expected}, found {redacted(repr(fault['input'])):.60}"


def nearest(name: str, known: Iterable[str]) -> str:
    """Return a hint for a name that is not among the known ones."""
    known = sorted(known)
    near = get_close_matches(name[:_LONGEST_KEY], known, n=1, cutoff=ALIKE)
    return f"did you mean {near[0]!r}?" if near else f"known: {', '.join(known)}"


def _followed(loc: Sequence[str | int], schema: Mapping[str, Any]) -> tuple[KeyPath, list[str]]:
    """Return the keys that lead to a fault, and those that its table may have.

    Pydantic puts more into a place than keys: which kind of table it took, and "[key]".
    """
    key: list[str | int] = []
    node: Mapping[str, Any] = schema
    beside: Mapping[str, Any] = schema
    for part in loc:
        node = _resolved(schema, node)
        kinds = node.get("discriminator", {}).get("mapping", {})
        if part in kinds:
            node = {"$ref": kinds[part]}
        elif part != "[key]":
            key.append(part)
            beside = node
            node = _inside(node, part)
    return tuple(key), sorted(beside.get("properties", {}))


def _inside(node: Mapping[str, Any], part: str | int) -> Mapping[str, Any]:
    for option in (node, *node.get("anyOf", ())):
        any_key = next(iter(option.get("patternProperties", {}).values()), None)
        inner = option.get("properties", {}).get(part) or any_key
        inner = inner or option.get("additionalProperties") or option.get("items")
        if isinstance(inner, Mapping):
            return inner
    return {}


def _resolved(schema: Mapping[str, Any], node: Mapping[str, Any]) -> Mapping[str, Any]:
    for option in (node, *node.get("anyOf", ())):
        if "$ref" in option:
            target: Mapping[str, Any] = schema["$defs"][option["$ref"].rsplit("/", 1)[-1]]
            return target
    return node
