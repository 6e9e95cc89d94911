"""Fills texts: parts of other pages, tables, and single numbers of the stored results.

::

    <!-- include: model.md | Curves | Position (M step) -->     sections of a page of the docs
    <!-- table: accuracy -->                                    a table, as in the docs
    [[accuracy | 4 cameras, 4 people / newest / mean error | .1f]]
"""

import re
from collections.abc import Callable, Mapping

from harness.figures import Result, find
from harness.machine import ROOT

DOCS = ROOT / "docs"
_INCLUDE = re.compile(r"<!-- include: (\S+) \| (.*?) -->")
_TABLE = re.compile(r"<!-- table: ([\w-]+) -->")
_VALUE = re.compile(r"\[\[([^|\]]+)\|([^|\]]+)\|([^|\]]+)\]\]")
_DEEPER = "##"  # sections of a page stand two levels below the chapters of a report


def filled(
    text: str, results: Mapping[str, Result], tables: Mapping[str, Callable[[], str]]
) -> str:
    """Return a text with everything filled in.

    Raises
    ------
    KeyError
        When a section, table or figure that the text names is not there.
    """
    text = _INCLUDE.sub(lambda found: _sections(found[1], found[2].split(" | ")), text)
    text = _TABLE.sub(lambda found: f"\n{tables[found[1]]()}\n", text)
    return _VALUE.sub(lambda found: value(found[1], found[2], found[3], results), text)


def value(name: str, path: str, form: str, results: Mapping[str, Result]) -> str:
    """Return one stored number as text."""
    name, parts = name.strip(), tuple(part.strip() for part in path.split(" / "))
    figure = find(results[name].figures, parts) if name in results else None
    if figure is None:
        raise KeyError(f"benchmarks/results/{name}.json has no figure {' / '.join(parts)}")
    return format(figure.value, form.strip())


def _sections(page: str, headings: list[str]) -> str:
    """Return sections of a page of the docs, deeper by two levels."""
    text = (DOCS / page).read_text(encoding="utf-8")
    parts = re.split(r"^## (.+)$", text, flags=re.MULTILINE)
    sections = dict(zip(parts[1::2], parts[2::2], strict=True))
    chosen = []
    for heading in headings:
        if heading not in sections:
            raise KeyError(f"docs/{page} has no section {heading!r}")
        body = re.sub(r"^(#+ )", rf"{_DEEPER}\1", sections[heading], flags=re.MULTILINE)
        chosen.append(f"{_DEEPER}## {heading}\n{body.strip()}\n")
    return "\n".join(chosen)
