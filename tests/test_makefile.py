"""What the Makefile names is there: a rename would leave shapes or kernels unchecked in silence."""

import re
from importlib.util import find_spec
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
MAKEFILE = (ROOT / "Makefile").read_text(encoding="utf-8").replace("$\\\n", "").replace("\\\n", "")


def value_of(name: str) -> str:
    found = re.search(rf"^{name} := (.*)$", MAKEFILE, re.MULTILINE)
    assert found is not None
    return re.sub(r",\s+", ",", found[1])


@pytest.mark.parametrize("package", value_of("SHAPES").split(","))
def test_every_package_whose_shapes_are_checked_exists(package: str) -> None:
    assert find_spec(package) is not None


def test_every_test_that_runs_without_the_compiler_exists() -> None:
    value = value_of("TWINS")
    names = re.search(r"\.py,([^)]*)\)", value)
    assert names is not None
    files = [f"tests/fusion/test_{name}.py" for name in names[1].split()]
    files += re.findall(r"tests/lab/\S+\.py", value)
    assert len(files) > 10
    assert [file for file in files if not (ROOT / file).is_file()] == []
