"""The map of the code in CONTRIBUTING names everything that is there, and nothing else."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "src" / "trecsim"
MAP = re.search(r"^src/trecsim/.*?^tests/", (ROOT / "CONTRIBUTING.md").read_text(), re.M | re.S)


def named(indent: int) -> list[str]:
    assert MAP is not None
    return re.findall(rf"^ {{{indent}}}(\w+(?:\.py|/))", MAP.group(), re.MULTILINE)


@pytest.mark.parametrize(("folder", "indent"), [(PACKAGE, 2), (PACKAGE / "lab", 4)])
def test_the_map_names_every_room_once(folder: Path, indent: int) -> None:
    there = [
        path.name + "/" * path.is_dir()
        for path in folder.iterdir()
        if not path.name.startswith(("_", ".")) and (path.is_dir() or path.suffix == ".py")
    ]
    assert sorted(named(indent)) == sorted(there)
