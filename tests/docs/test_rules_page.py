"""The page about rules names every kind with its numbers, and its examples are right."""

import re
import sys
import types
from pathlib import Path

import pytest

from trecsim.own_rules import Kind, check_kind
from trecsim.safety.kinds import KINDS
from trecsim.sites.recorded_site import read_recorded_site

PAGE = (Path(__file__).parents[2] / "docs" / "rules.md").read_text()


@pytest.mark.parametrize("name", KINDS)
def test_the_table_says_of_each_kind_what_it_needs_and_its_numbers(name: str) -> None:
    kind = KINDS[name]
    (row,) = re.findall(rf"^\| `{re.escape(name)}` \|.*$", PAGE, re.MULTILINE)
    needs, fires, _, delays = (cell.strip() for cell in row.split("|")[2:6])
    needed = [key.name for key in kind.keys if key.default is ...]
    needed += [kind.place] if kind.place and not kind.place_is_optional else []
    assert sorted(re.findall(r"`(\w+)`", needs)) == sorted(needed)
    on, off = delays.split(", ")
    assert float(on) == kind.on_delay_s
    assert off == "-" if kind.at_once else float(off) == kind.off_delay_s
    for key in kind.keys:
        if isinstance(key.default, float) and key.name != "depth_m":
            assert f"`{key.name}` ({key.default:g})" in fires


def test_the_example_is_a_site_file(tmp_path: Path) -> None:
    example = PAGE.partition("```toml\n")[2].partition("```")[0]
    (tmp_path / "site.toml").write_text(f'format = "trecsim.site/1"\nname = "hall"\n{example}')
    site, _ = read_recorded_site(tmp_path / "site.toml")
    assert [rule.id for rule in site.rules] == ["strip-at-night"]


def test_it_says_that_rules_are_advisory() -> None:
    assert "**Rules are advisory.** trecsim is no certified safety function" in PAGE


def test_the_rule_of_your_own_passes_the_checks() -> None:
    (code,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    made: dict[str, object] = {"__name__": "crouching"}
    sys.modules["crouching"] = types.ModuleType("crouching")  # dataclasses look it up
    exec(compile(code, "rules.md", "exec"), made)
    kind = made["CROUCH"]
    assert isinstance(kind, Kind)
    check_kind(kind)
