"""A site file with other zones, lines and edges; everything else in it stays as it is."""

import json
import re
import tomllib
from collections.abc import Mapping
from typing import Any

from trecsim.errors import InputError

PLACES = ("zones", "lines", "edges")
_KEY = r"""(?:[A-Za-z0-9_-]+|"[^"]*"|'[^']*')"""
# The whole line: a row of an array over several lines begins with a bracket, too.
_HEADER = re.compile(rf"\s*\[\[?\s*([A-Za-z0-9_-]+)\s*(?:\.\s*{_KEY}\s*)*\]\]?\s*(?:#.*)?$")

Places = Mapping[str, Mapping[str, Mapping[str, Any]]]
"""Tables by kind (`PLACES`) and name."""


def with_places(text: str, places: Places) -> str:
    """Return the text of a site file with other places.

    Parameters
    ----------
    text
        A TOML document.
    places
        All zones, lines and edges from now on.

    Raises
    ------
    InputError
        The file holds its places in a way that this cannot replace, as inline tables.
    """
    kept = "\n".join(_without_places(text.splitlines())).rstrip()
    tables = [
        f"[{kind}.{name}]\n" + "".join(f"{key} = {json.dumps(value[key])}\n" for key in value)
        for kind in PLACES
        for name, value in places.get(kind, {}).items()
    ]
    changed = "\n".join([f"{kept}\n", *tables])
    if not _is_right(text, changed, places):
        raise InputError(
            "zones, lines and edges of this site file cannot be changed from the page: expected "
            "them as tables, as [zones.NAME]; change the file by hand"
        )
    return changed


def _without_places(lines: list[str]) -> list[str]:
    """Leave out tables of places; comments before the next table stay."""
    kept: list[str] = []
    held: list[str] = []  # comments and empty lines at the end of a table that is left out
    inside = False
    for line in lines:
        header = _HEADER.match(line)
        if header is not None:
            was_inside, inside = inside, header[1] in PLACES
            if was_inside and not inside:
                kept += held
            held = []
        if not inside:
            kept.append(line)
        elif not line.strip() or line.lstrip().startswith("#"):
            held.append(line)
        else:
            held = []
    return [*kept, *held]


def _is_right(before: str, after: str, places: Places) -> bool:
    """Tell whether nothing but the places has changed, and these as they should."""
    try:
        old, new = tomllib.loads(before), tomllib.loads(after)
    except ValueError:
        return False
    wanted = {kind: dict(places[kind]) for kind in PLACES if places.get(kind)}
    others = {key: value for key, value in old.items() if key not in PLACES}
    return json.dumps(new, sort_keys=True, default=str) == json.dumps(
        {**others, **wanted}, sort_keys=True, default=str
    )
