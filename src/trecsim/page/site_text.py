"""A site file with other places and rules; everything else in it stays as it is.

The text is cut into its tables. A table that does not change stays to the letter; in one that
changes, comments and the order of the keys stay. A comment directly above a table belongs to it.
"""

import json
import re
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from trecsim.errors import InputError

PLACES = ("zones", "lines", "edges", "exclusions", "portals")
RULES = "rules"
_KEY = r"""(?:[A-Za-z0-9_-]+|"[^"]*"|'[^']*')"""
# The whole line: a row of an array over several lines begins with a bracket, too.
_HEADER = re.compile(rf"\s*\[\[?\s*([A-Za-z0-9_-]+)\s*((?:\.\s*{_KEY}\s*)*)\]\]?\s*(?:#.*)?$")

Places = Mapping[str, Mapping[str, Mapping[str, Any]]]
"""Tables by kind (`PLACES`) and name."""
Rules = Sequence[Mapping[str, Any]]
"""Tables `[[rules]]`."""


@dataclass(slots=True)
class _Block:
    """A table of the file, as lines.

    Attributes
    ----------
    kind
        First key of its header; empty for what stands before the first table.
    lead
        Comments directly above the header.
    lines
        The header and what follows.
    """

    kind: str
    lead: list[str] = field(default_factory=list)
    lines: list[str] = field(default_factory=list)

    @property
    def text(self) -> str:
        """The table without its lead."""
        return "\n".join(self.lines) + "\n"


def with_parts(text: str, places: Places, rules: Rules | None = None) -> str:
    """Return the text of a site file with other places and rules.

    Parameters
    ----------
    text
        A TOML document.
    places
        All places of some kinds from now on; those of other kinds stay as they are.
    rules
        All rules from now on; None to leave them as they are.

    Raises
    ------
    InputError
        The file holds them in a way that this cannot replace, as inline tables.
    """
    try:
        blocks = _blocks(text)
        for kind, tables in places.items():
            blocks = _with_tables(blocks, kind, list(tables.items()))
        if rules is not None:
            blocks = _with_tables(blocks, RULES, [(str(rule.get("id")), rule) for rule in rules])
    except ValueError:  # a table of its own is no TOML: a header within a text
        blocks = []
    changed = "\n".join(line for block in blocks for line in (*block.lead, *block.lines)) + "\n"
    if not _is_right(text, changed, places, rules):
        raise InputError(
            "places and rules of this site file cannot be changed from the page: "
            "expected them as tables, as [zones.NAME] and [[rules]]; change the file by hand"
        )
    return changed


def parts_of(text: str) -> dict[str, Any]:
    """Return places and rules of a site file as it writes them, without defaults."""
    data = tomllib.loads(text)
    parts: dict[str, Any] = {kind: data.get(kind, {}) for kind in PLACES}
    return {**parts, RULES: data.get(RULES, [])}


def _blocks(text: str) -> list[_Block]:
    blocks = [_Block("")]
    for line in text.splitlines():
        header = _HEADER.match(line)
        if header is not None:
            before = blocks[-1].lines
            at = len(before)
            while at and before[at - 1].lstrip().startswith("#"):
                at -= 1
            lead, before[at:] = before[at:], []
            blocks.append(_Block(header[1], lead))
        blocks[-1].lines.append(line)
    while blocks[-1].lines and not blocks[-1].lines[-1].strip():
        blocks[-1].lines.pop()
    return blocks


def _with_tables(
    blocks: list[_Block], kind: str, wanted: list[tuple[str, Mapping[str, Any]]]
) -> list[_Block]:
    """Return the tables of a file, those of a kind replaced: they keep their places in order."""
    olds = {_name(block, kind): block for block in blocks if block.kind == kind}
    news = [_table(kind, name, table, olds.get(name)) for name, table in wanted]
    if kind != RULES:  # tables by name: who stays keeps its place
        order = {name: n for n, name in enumerate(olds)}
        ranks = [order.get(name, len(order)) for name, _ in wanted]
        news = [new for _, new in sorted(zip(ranks, news, strict=True), key=lambda one: one[0])]
    slots = [n for n, block in enumerate(blocks) if block.kind == kind]
    kept = [block for block in blocks if block.kind != kind]
    made: list[_Block] = []
    for n, block in enumerate(blocks):
        if block.kind != kind:
            made.append(block)
        elif news:
            made.append(news.pop(0))
        if slots and n == slots[-1]:
            made += _apart(news, made)
            news = []
    return made + _apart(news, made) if kept or news else made


def _apart(news: Iterable[_Block], before: Sequence[_Block]) -> list[_Block]:
    """Return new tables with an empty line between each and what stands before it."""
    made: list[_Block] = []
    last = before[-1] if before else None
    for new in news:
        if last is not None and last.lines and last.lines[-1].strip():
            last.lines.append("")
        made.append(new)
        last = new
    return made


def _name(block: _Block, kind: str) -> str:
    data = tomllib.loads(block.text)[kind]
    if kind == RULES:
        return str(data[0].get("id"))
    return str(next(iter(data)))


def _table(kind: str, name: str, table: Mapping[str, Any], old: _Block | None) -> _Block:
    """Return a table as it shall be, made of the old one where there is one."""
    if old is None:
        header = f"[[{kind}]]" if kind == RULES else f"[{kind}.{name}]"
        return _Block(kind, [], [header, *(f"{key} = {_toml(table[key])}" for key in table)])
    import tomlkit

    document = tomlkit.parse(old.text)
    found: Any = document[kind]
    inside = found[0] if kind == RULES else found[name]
    for key in [key for key in inside if key not in table]:
        del inside[key]
    for key, value in table.items():
        if key not in inside or _plain(inside[key]) != value:
            inside[key] = tomlkit.parse(f"x = {_toml(value)}")["x"]
    return _Block(kind, old.lead, tomlkit.dumps(document).splitlines())


def _toml(value: Any) -> str:
    """Return a value as TOML: JSON writes numbers, texts and arrays alike."""
    return json.dumps(value, ensure_ascii=False)


def _plain(value: Any) -> Any:
    return value.unwrap() if hasattr(value, "unwrap") else value


def _is_right(before: str, after: str, places: Places, rules: Rules | None) -> bool:
    """Tell whether nothing but places and rules has changed, and these as they should."""
    try:
        old, new = tomllib.loads(before), tomllib.loads(after)
    except ValueError:
        return False
    now = {kind: places.get(kind, old.get(kind)) for kind in PLACES}
    wanted: dict[str, Any] = {kind: dict(tables) for kind, tables in now.items() if tables}
    if rules is None:
        rules = old.get(RULES, [])
    if rules:
        wanted[RULES] = [dict(rule) for rule in rules]
    others = {key: value for key, value in old.items() if key not in (*PLACES, RULES)}
    return new == {**others, **wanted}  # 2 and 2.0 are the same: browsers write the first
