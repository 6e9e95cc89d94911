"""The page about the Python interface lists what there is, and the examples use only that."""

import ast
import re
from importlib import import_module
from pathlib import Path

import pytest

import trecsim

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "reference" / "api.md").read_text()
NAMES = dict(re.findall(r"^\| \{py:\w+\}`(\w+) <([\w.]+)>` \|", PAGE, re.MULTILINE))
MODULES = re.findall(r"^   (trecsim\.[\w.]+)$", PAGE, re.MULTILINE)
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))


def python_of(path: Path) -> list[str]:
    return re.findall(r"```python\n(.*?)```", path.read_text(), re.DOTALL)


def test_the_page_lists_exactly_the_public_names() -> None:
    assert sorted(NAMES) == list(trecsim.__all__)


@pytest.mark.parametrize("name", NAMES)
def test_a_listed_name_is_what_its_link_says(name: str) -> None:
    module, _, attribute = NAMES[name].rpartition(".")
    assert getattr(import_module(module), attribute) is getattr(trecsim, name)


@pytest.mark.parametrize("module", MODULES)
def test_a_listed_module_exists_and_is_documented(module: str) -> None:
    assert import_module(module).__doc__


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_imports_only_what_the_page_lists(example: Path) -> None:
    found = [node for node in ast.walk(ast.parse(example.read_text())) if _of_trecsim(node)]
    modules = {node.module for node in found if isinstance(node, ast.ImportFrom)}
    assert modules <= {"trecsim", *MODULES}


def _of_trecsim(node: ast.AST) -> bool:
    return isinstance(node, ast.ImportFrom) and (node.module or "").startswith("trecsim")


def test_the_first_example_is_the_same_everywhere() -> None:
    readme = python_of(ROOT / "README.md")[0]
    assert python_of(ROOT / "docs" / "index.md")[0] == readme
    assert python_of(ROOT / "docs" / "reference" / "api.md")[0] == readme
