"""Tables between markers in Markdown pages.

``<!-- table: NAME -->`` and ``<!-- end -->`` stand on lines of their own; what lies between belongs
to the machine.
"""

import re
from collections.abc import Callable, Mapping
from pathlib import Path

from harness.machine import ROOT

PAGES = (
    ROOT / "README.md",
    ROOT / "docs" / "benchmarks.md",
    ROOT / "docs" / "ablation.md",
    ROOT / "docs" / "forecasts.md",
    ROOT / "docs" / "reference" / "fusion-settings.md",
    ROOT / "docs" / "reference" / "simulated-detector.md",
)

_BETWEEN = re.compile(r"(?m)^<!-- table: ([a-z0-9-]+) -->\n(.*?)^<!-- end -->$", re.DOTALL)
_OPENING = re.compile(r"<!-- table:")


def filled(text: str, tables: Mapping[str, Callable[[], str]]) -> str:
    """Return a page with every table made anew.

    Parameters
    ----------
    text
        The page.
    tables
        What makes each, by name.

    Raises
    ------
    ValueError
        A marker names no table, or one has no end.
    """
    names = [match[1] for match in _BETWEEN.finditer(text)]
    if len(names) != len(_OPENING.findall(text)):
        raise ValueError("a table's marker has no end, or does not stand on a line of its own")
    if unknown := sorted(set(names) - set(tables)):
        raise ValueError(
            f"no table is called {', '.join(unknown)}; there are {', '.join(sorted(tables))}"
        )
    return _BETWEEN.sub(
        lambda match: f"<!-- table: {match[1]} -->\n\n{tables[match[1]]().strip()}\n\n<!-- end -->",
        text,
    )


def fill(page: Path, tables: Mapping[str, Callable[[], str]]) -> bool:
    """Make every table of a page anew; return whether that changed it."""
    text = page.read_text(encoding="utf-8")
    new = filled(text, tables)
    if new != text:
        page.write_text(new, encoding="utf-8")
    return new != text
