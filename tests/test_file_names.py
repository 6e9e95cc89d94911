"""A name of a module means one file."""

import sys
from collections import Counter
from pathlib import Path

SRC = Path(__file__).parents[1] / "src" / "trecsim"

# The Protocol of a room stands in its `base`, its numbers in `tuning`; Python runs `__main__`.
ROOMS = {"base", "tuning", "__main__"}


def names() -> Counter[str]:
    return Counter(path.stem for path in SRC.rglob("*.py") if path.stem != "__init__")


def test_no_two_modules_have_the_same_name() -> None:
    assert {name for name, count in names().items() if count > 1} - ROOMS == set()


def test_no_module_has_the_name_of_one_of_the_standard_library() -> None:
    assert set(names()) & sys.stdlib_module_names == set()
