"""The page about scene files has every key with its meaning, and its example is right.

``python tests/docs/test_scene_file.py`` writes the tables of keys anew.
"""

import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from trecsim.lab.simulation import BUILT_IN, read_scene
from trecsim.lab.simulation.scene_file import scene_schema

PAGE = Path(__file__).parents[2] / "docs" / "reference" / "scene-file.md"
SCHEMA = scene_schema()
TABLES = {"Scene": SCHEMA, **SCHEMA["$defs"]}
BLOCK = re.compile(r"<!-- keys of (\w+) -->\n(.*?)<!-- end -->", re.DOTALL)


def value_of(node: Mapping[str, Any]) -> str:
    """Return what a key takes, in a few words."""
    kinds = [kind for kind in node.get("anyOf", [node]) if kind.get("type") != "null"]
    return " or ".join(dict.fromkeys(map(one_value, kinds)))


def one_value(node: Mapping[str, Any]) -> str:
    if "$ref" in node:
        return "table"
    if "const" in node or "enum" in node:
        return ", ".join(f'`"{value}"`' for value in node.get("enum", [node.get("const")]))
    kind = str(node.get("type"))
    if node.get("minimum") == -node.get("maximum", np.inf):  # only to keep nonsense out
        node = {"type": kind}
    if kind == "array" and "prefixItems" in node:
        return f"{len(node['prefixItems'])} numbers"
    if kind == "array":
        many = value_of(node["items"])
        words = {"number": "numbers", "2 numbers": "a point x, y, or several"}
        return "tables" if "$ref" in str(node["items"]) else words[many]
    limits = [
        f"{sign} {node[name]:g}"
        for name, sign in (
            ("exclusiveMinimum", ">"),
            ("minimum", "≥"),
            ("maximum", "≤"),
        )
        if name in node and abs(node[name]) < 1e9
    ]
    named = {"number": "number", "integer": "whole number", "object": "tables", "string": "text"}
    return " ".join([named.get(kind, "true or false"), ", ".join(limits)]).strip()


def default_of(node: Mapping[str, Any], required: bool) -> str:
    default = node.get("default")
    if required:
        return "needed"
    if default is None or isinstance(default, dict) or default == [] or len(str(default)) > 40:
        return ""
    return f"`{json.dumps(default)}`"


def keys(name: str) -> str:
    """Return the keys of one table, as they stand on the page."""
    table = TABLES[name]
    rows = ["| key | takes | default | |", "|---|---|---|---|"]
    for key, node in table["properties"].items():
        if key == "do":
            continue
        about = node.get("description") or TABLES[node["$ref"].rsplit("/")[-1]]["description"]
        about = " ".join(about.split())
        default = default_of(node, key in table.get("required", ()))
        rows.append(f"| `{key}` | {value_of(node)} | {default} | {about} |")
    return "\n".join(rows) + "\n"


def test_every_table_has_its_keys_on_the_page() -> None:
    found = dict(BLOCK.findall(PAGE.read_text()))
    bare = {name for name, table in TABLES.items() if set(table["properties"]) == {"do"}}
    assert set(found) == set(TABLES) - bare
    for name, text in found.items():
        assert text == keys(name), f"{name}: run python tests/docs/test_scene_file.py"


def test_every_action_has_its_name_on_the_page() -> None:
    for name, table in TABLES.items():
        if "do" in table["properties"]:
            assert f'do = "{table["properties"]["do"]["const"]}"' in PAGE.read_text(), name


def test_every_built_in_scene_is_on_the_page_with_its_line() -> None:
    text = PAGE.read_text()
    for name in BUILT_IN:
        assert f"| `{name}` | {read_scene(name).about} |" in text, name


@pytest.mark.parametrize("number", [0, 1])
def test_the_examples_of_the_page_are_right(number: int, tmp_path: Path) -> None:
    example = re.findall(r"```toml\n(.*?)```", PAGE.read_text(), re.DOTALL)[number]
    (tmp_path / "scene.toml").write_text(example)
    assert read_scene(tmp_path / "scene.toml").people.count > 0


if __name__ == "__main__":
    PAGE.write_text(
        BLOCK.sub(
            lambda found: f"<!-- keys of {found[1]} -->\n{keys(found[1])}<!-- end -->",
            PAGE.read_text(),
        )
    )
