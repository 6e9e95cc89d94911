"""Figures as text and as tables of Markdown."""

import math
from collections.abc import Iterable, Sequence

from harness.figures import Figure, Figures, Result, find, leaves
from harness.machine import busy_with

NOTHING = "–"


def number(value: float, digits: int = 3) -> str:
    """Return a number with so many significant digits, and no exponent.

    Examples
    --------
    >>> [number(value) for value in (0.12345, 2.0, 12.345, 1234.5, 0.0, float("nan"))]
    ['0.123', '2.00', '12.3', '1234', '0', '–']
    """
    if not math.isfinite(value):
        return NOTHING
    if value == 0:
        return "0"
    places = max(0, digits - 1 - math.floor(math.log10(abs(value))))
    return f"{value:.{places}f}"


def plain(value: float) -> str:
    """Return a number with three significant digits, a whole one without decimal places.

    Examples
    --------
    >>> plain(2.0), plain(2.345), plain(1234.0)
    ('2', '2.35', '1234')
    """
    return f"{value:.0f}" if math.isfinite(value) and value == round(value) else number(value)


def fixed(value: float, places: int) -> str:
    """Return a number with so many decimal places.

    Examples
    --------
    >>> fixed(0.9876, 3), fixed(float("nan"), 1)
    ('0.988', '–')
    """
    return f"{value:.{places}f}" if math.isfinite(value) else NOTHING


def value_of(figures: Figures, *path: str) -> float:
    """Return the value at a path of names; NaN where there is none."""
    figure = find(figures, path)
    return figure.value if figure else math.nan


def with_spread(figure: Figure | None, places: int = 2) -> str:
    """Return value and standard deviation over the seeds."""
    if figure is None:
        return NOTHING
    text = fixed(figure.value, places)
    return f"{text} ± {fixed(figure.spread, places)}" if math.isfinite(figure.spread) else text


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table.

    Examples
    --------
    >>> print(table(["a", "b"], [["1", "2"]]))
    | a | b |
    |---|---|
    | 1 | 2 |
    """
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    lines += ["| " + " | ".join(row) + " |" for row in rows]
    return "\n".join(lines)


def listed(result: Result) -> str:
    """Return all figures of a result as one table."""
    rows = []
    for path, figure in leaves(result.figures):
        spread = number(figure.spread) if math.isfinite(figure.spread) else ""
        rows.append([" / ".join(path), plain(figure.value), figure.unit, spread])
    return table(["figure", "value", "unit", "spread"], rows)


def machine_of(result: Result) -> str:
    """Return the processor that something was measured on, with its vector instructions."""
    machine = result.about["machine"]
    instructions = machine.get("instructions")
    told = "not recorded" if instructions is None else " ".join(instructions) or "none of note"
    return f"{machine['cores']} cores of {machine['processor']} (vector instructions: {told})"


def measured_on(result: Result) -> str:
    """Return one line on where and when something was measured."""
    about = result.about
    machine, versions = about["machine"], about["versions"]
    some = ", ".join(
        f"{name} {versions[name]}" for name in ("python", "numpy", "numba") if versions.get(name)
    )
    used = machine.get("cores_used_by_others")
    others = f" ({used:.1f} of them used by others)" if used is not None else ""
    instructions = machine.get("instructions")
    told = f" with {' '.join(instructions)}" if instructions is not None else ""
    return (
        f"{about['date'][:10]}, commit {about['commit']}, {machine['cores']} cores of "
        f"{machine['processor']}{told}{others}, {some}"
    )


def busy(result: Result) -> str:
    """Return a warning where a machine had too much to do for its times to be quoted."""
    others = busy_with(result.about)
    if others is None:
        return ""
    cores = result.about["machine"]["cores"]
    return f"\n\n*Other programs used {others:.1f} of {cores} cores meanwhile: times are too long.*"
