"""Tables of what each part of the fusion's model is worth."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from harness.comparing import Change, compare
from harness.figures import Figure, Figures, Result, find, leaves, summed
from harness.markdown import NOTHING, fixed, number, plain, table

Results = Mapping[str, Result]

FULL = "the full model"
SAME = "·"
RECORDED = ("Shelf", "real video", "thesis")
SWITCHES = ("all of these", "switches")


@dataclass(frozen=True, slots=True)
class Column:
    """A column of the table: title, group and name of the figure, and decimal places."""

    title: str
    group: str
    figure: str
    places: int = 2


COLUMNS = (
    Column("4 cameras: error [cm]", "4 cameras", "error"),
    Column("log-likelihood", "4 cameras", "log-likelihood"),
    Column("2 cameras: error [cm]", "2 cameras", "error"),
    Column("log-likelihood", "2 cameras", "log-likelihood"),
    Column("built-in scenes: error [cm]", "built-in scenes", "error"),
    Column("missed [%]", "built-in scenes", "missed, provisional people counted"),
    Column("ghosts [%]", "built-in scenes", "ghosts"),
    Column("switches, all of these", *SWITCHES, 0),
    Column("time a step [%]", "time a step", "of the full model's", 0),
)
"""What every part changes elsewhere."""


def ablation(results: Results) -> str:
    """Return the table: what each part is for, and what differs beyond noise without it."""
    result = results["ablation"]
    rows, group = [_absolute(result)], ""
    for name, figures in _rows(result):
        about = result.about["parts"][name]
        if about["group"] != group:
            group = about["group"]
            rows.append([f"*{group}*", *[""] * (len(COLUMNS) + 1)])
        changes = {c.path: c for c in _changes(result, name)}
        title = name if _comparable(result, name) else f"{name} (an older version)"
        aims = [_aim(aim, changes) for aim in map(tuple, about["aims"])]
        rows.append(
            [title, "<br>".join(aims), *(_cell(figures, column, changes) for column in COLUMNS)]
        )
    titles = (column.title for column in COLUMNS)
    made = table(["without", "what it is for: with it → without it", *titles], rows)
    missing = result.about.get("missing", ())
    return f"{made}\n\nNot measured yet: {', '.join(missing)}." if missing else made


def _aim(aim: tuple[str, ...], changes: Mapping[tuple[str, ...], Change]) -> str:
    """Return a figure that a part is for, with the part and without it."""
    change = changes.get(aim)
    if change is None:
        return f"{', '.join(aim)}: {NOTHING}"
    now = f"**{plain(change.now)}**" if change.verdict == "worse" else plain(change.now)
    mark = f" {SAME}" if change.verdict == "as before" else ""
    return f"{', '.join(aim)}: {plain(change.before)} → {now} {change.unit}".rstrip() + mark


def instead(results: Results) -> str:
    """Return the table of how each part was switched off."""
    parts = results["ablation"].about["parts"]
    return table(
        ["part", "without it"],
        [[name, about["instead"]] for name, about in parts.items() if name != FULL],
    )


def idle(results: Results) -> str:
    """Return which parts could be left out without anything getting worse beyond noise."""
    result = results["ablation"]
    lines = []
    for name, _ in _rows(result):
        if not _comparable(result, name):
            continue
        changes = _changes(result, name)
        if any(c.verdict == "worse" for c in changes):
            continue
        better = [c for c in changes if c.verdict == "better"]
        if all(c.now == c.before for c in changes):
            end = "not one figure differs"
        elif better:
            end = "better without it: " + "; ".join(map(_told, better))
        else:
            end = "nothing beyond noise"
        lines.append(f"- **{name}**: {end}.")
    return "\n".join(lines) or "None: without any of the parts something is worse."


def _rows(result: Result) -> Iterator[tuple[str, Figures]]:
    for name, figures in result.figures.items():
        assert not isinstance(figures, Figure)
        if name != FULL:
            yield name, figures


def _comparable(result: Result, name: str) -> bool:
    """Tell whether a row was made with the same version of the code as the full model's."""
    rows = result.about["rows"]
    return FULL in rows and rows[name]["code"] == rows[FULL]["code"]


def _with_switches(figures: Figures) -> dict[str, Figure | Figures]:
    """Return the figures of a row and the sum of all switches on what every row is tracked on."""
    common = {column.group for column in COLUMNS}
    every = [f for path, f in leaves(figures) if path[-1] == "switches" and path[0] in common]
    total = summed({"all": sum(f.value for f in every)})
    return {**figures, SWITCHES[0]: {SWITCHES[1]: total}}


def _recorded_once(figures: Mapping[str, Figure | Figures]) -> Figures:
    """Return the figures of a row, those of recordings without a spread: they have no seeds."""
    out: dict[str, Figure | Figures] = {}
    for name, inside in figures.items():
        if isinstance(inside, Figure) or not name.startswith(RECORDED):
            out[name] = inside
        else:
            out[name] = {
                score: replace(figure, kind="once", runs={})
                for score, figure in inside.items() if isinstance(figure, Figure)
            }  # fmt: skip
    return out


def _changes(result: Result, name: str) -> list[Change]:
    rows = []
    for which in (name, FULL):
        figures = result.figures[which]
        assert not isinstance(figures, Figure)
        rows.append(replace(result, figures=_recorded_once(_with_switches(figures))))
    return compare(*rows)


def _absolute(result: Result) -> list[str]:
    figures = result.figures[FULL]
    assert not isinstance(figures, Figure)
    return [FULL, "", *(fixed(_value(figures, column), column.places) for column in COLUMNS)]


def _value(figures: Figures, column: Column) -> float:
    figure = find(_with_switches(figures), (column.group, column.figure))
    return figure.value if figure else math.nan


def _cell(figures: Figures, column: Column, changes: Mapping[tuple[str, ...], Change]) -> str:
    change = changes.get((column.group, column.figure))
    if change is None or not math.isfinite(_value(figures, column)):
        return NOTHING
    if change.verdict == "as before":
        return SAME
    difference = f"{change.now - change.before:+.{column.places}f}".replace("-", "−")
    return f"**{difference}**" if change.verdict == "worse" else difference


def _told(change: Change) -> str:
    difference = (
        f"{'−' if change.now < change.before else '+'}{number(abs(change.now - change.before), 2)}"
    )
    return f"{', '.join(change.path)} {difference} {change.unit}".rstrip()
