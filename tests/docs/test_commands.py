"""Every command has its help, its `--json`, and its place in the documentation."""

import re
import tomllib
from pathlib import Path

import pytest
from cyclopts import App

from trecsim.cli import COMMANDS, GROUPS, command_line
from trecsim.sites import site_schema
from trecsim.sites.site_reading import read_site

DOCS = Path(__file__).parents[2] / "docs" / "reference"

NAMES = [
    *((name,) for name in COMMANDS),
    *((group, name) for group, (_, commands) in GROUPS.items() for name in commands),
]


def resolved(name: tuple[str, ...]) -> App:
    """Import one command as a call would."""
    app = command_line(name)
    for part in name:
        app = app[part]
    return app


def options(name: tuple[str, ...]) -> dict[str, str]:
    """Return the help of each option and positional argument, without that of `--json`."""
    arguments = resolved(name).assemble_argument_collection(parse_docstring=True)
    return {
        option: argument.parameter.help or ""
        for argument in arguments
        for option in argument.names
        if argument.show and not option.startswith(("--no-", "--empty-"))
    }


def listed_help(name: tuple[str, ...]) -> str:
    return COMMANDS[name[0]] if len(name) == 1 else GROUPS[name[0]][1][name[1]]


def section(name: tuple[str, ...]) -> str:
    """Return what the documentation says about a command."""
    text = (DOCS / "commands.md").read_text()
    heading = f"## trecsim {' '.join(name)}\n"
    assert text.count(heading) == 1, f"no heading for {name} in docs/reference/commands.md"
    return text.partition(heading)[2].partition("\n## ")[0]


@pytest.mark.parametrize("name", NAMES, ids=" ".join)
def test_the_list_of_commands_says_what_the_command_says_of_itself(name: tuple[str, ...]) -> None:
    function = resolved(name).default_command
    assert function is not None
    assert (function.__doc__ or "").splitlines()[0] == listed_help(name)


@pytest.mark.parametrize("name", NAMES, ids=" ".join)
def test_every_option_has_help_and_json_is_among_them(name: tuple[str, ...]) -> None:
    found = options(name)
    assert "--json" in found
    assert all(found.values()), found


@pytest.mark.parametrize("name", NAMES, ids=" ".join)
def test_every_command_and_option_is_in_the_documentation(name: tuple[str, ...]) -> None:
    about = section(name)
    named = [option for option in options(name) if option.startswith("--") and option != "--json"]
    assert [option for option in named if not re.search(rf"{option}(?![\w-])", about)] == []


def test_the_documentation_names_no_command_that_does_not_exist() -> None:
    text = (DOCS / "commands.md").read_text()
    headings = re.findall(r"^## trecsim (.*)$", text, re.MULTILINE)
    assert sorted(headings) == sorted(" ".join(name) for name in NAMES)


def test_every_key_of_the_site_file_is_in_the_documentation() -> None:
    text = (DOCS / "site-file.md").read_text()
    schema = site_schema()
    tables = [schema, *(t for name, t in schema["$defs"].items() if name != "FusionTable")]
    for table in tables:
        for key in table["properties"]:
            assert re.search(rf"`{key}`|\[{key}[\].]|\b{key} =", text), key


def test_the_site_file_of_the_documentation_is_right(tmp_path: Path) -> None:
    text = (DOCS / "site-file.md").read_text().partition("```toml\n")[2].partition("```")[0]
    tomllib.loads(text)
    (tmp_path / "site.toml").write_text(text)
    assert read_site(tmp_path / "site.toml").site.name == "entrance-hall"
