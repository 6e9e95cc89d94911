"""The kinds of rules as a form shows them: their keys, defaults and limits."""

from typing import Any

from trecsim.sites.rule_tables import TABLES

COMMON = ("on_delay_s", "off_delay_s", "cooldown_s", "p_on", "p_off", "early_s")
"""Numbers that rules of all kinds have."""
_PLACES = ("zone", "line", "edge", "volume")
_LIMITS = {"minimum": "least", "maximum": "most", "exclusiveMinimum": "above",
           "exclusiveMaximum": "below"}  # fmt: skip


def rule_kinds() -> list[dict[str, Any]]:
    """Return what a form for rules needs to know of each kind.

    Each has `name`, `about`, `place` ("zone", "line", "edge", "volume" or None),
    `place_is_optional`, `keys`, its own, and `common`, the numbers that all kinds have. A key has
    `name`, `about`, `type` ("number", "integer", "choice", "flag", "text"), `default` (None where
    it must be given), `required`, and, where there are any, `choices` and the limits `least`,
    `most`, `above` and `below`.
    """
    return [_kind(table.model_json_schema()) for table in TABLES]


def _kind(schema: dict[str, Any]) -> dict[str, Any]:
    properties, required = schema["properties"], schema.get("required", [])
    name = properties["kind"]["const"]
    place = next((one for one in _PLACES if one in properties), None)
    shared = {"id", "kind", "severity", "schedule", *COMMON, *_PLACES}
    return {
        "name": name,
        "about": schema.get("description", ""),
        "place": place,
        "place_is_optional": place is not None and place not in required,
        "keys": [
            _key(key, given, required) for key, given in properties.items() if key not in shared
        ],
        "common": [_key(key, properties[key], required) for key in COMMON if key in properties],
    }


def _key(name: str, given: dict[str, Any], required: list[str]) -> dict[str, Any]:
    options = [one for one in given.get("anyOf", [given]) if one.get("type") != "null"]
    only: dict[str, Any] = {**given, **(options[0] if len(options) == 1 else {})}
    key = {
        "name": name,
        "about": given.get("description", ""),
        "type": _type(only),
        "default": given.get("default"),
        "required": name in required,
    }
    if "enum" in only:
        key["choices"] = only["enum"]
    return {**key, **{short: only[long] for long, short in _LIMITS.items() if long in only}}


def _type(schema: dict[str, Any]) -> str:
    if "enum" in schema or "const" in schema:
        return "choice"
    known = {"number": "number", "integer": "integer", "boolean": "flag"}
    return known.get(schema.get("type", ""), "text")
