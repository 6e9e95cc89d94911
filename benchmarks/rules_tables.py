"""Tables of rules."""

from collections.abc import Mapping

from harness.figures import Figure, Result
from harness.markdown import fixed, table, value_of
from ruled.alarm_figures import BORDERS

Results = Mapping[str, Result]


def rules(results: Results) -> str:
    """Return how well each kind of rule tells its episodes."""
    figures = results["rules"].figures["episodes"]
    head = ["rule", "episodes", "F1", "missed / invented", "onset off by, 95 % [s]",
            "told after, median [s]"]  # fmt: skip
    rows = []
    for kind, group in figures.items():
        if isinstance(group, Figure) or "F1" not in group:
            continue
        rows.append(
            [
                f"`{kind}`",
                fixed(value_of(group, "episodes"), 0),
                fixed(value_of(group, "F1"), 3),
                f"{value_of(group, 'missed'):.0f} / {value_of(group, 'invented'):.0f}",
                fixed(value_of(group, "onset off by, 95 %"), 2),
                fixed(value_of(group, "told after, median"), 2),
            ]
        )
    of_all = [fixed(value_of(figures, "all", "episodes"), 0),
              fixed(value_of(figures, "all", "macro F1"), 3)]  # fmt: skip
    return table(head, [*rows, ["all, mean", *of_all, "", "", ""]])


def falls(results: Results) -> str:
    """Return how many falls are told, and which other motions are told as falls."""
    figures = results["rules"].figures.get("falls", {})
    head = ["cameras", "falls", "told", "other motions", "told as falls", "which"]
    rows = []
    for name, group in figures.items():
        false = group["told as falls"]
        rows.append(
            [
                name,
                *(fixed(value_of(group, key), 0)
                  for key in ("falls", "of these told", "other motions", "of these told as falls")),
                ", ".join(f"{one} ({figure.value:.0f})" for one, figure in false.items()),
            ]
        )  # fmt: skip
    return table(head, rows)


def traffic(results: Results) -> str:
    """Return false alarms and early warnings, among episodes and in normal traffic."""
    figures = results["rules"].figures
    calm = figures["normal traffic"]
    rows = [
        [name, fixed(value_of(calm, name), places)]
        for name, places in (
            ("length", 2), ("borders: true episodes", 0), ("borders: missed", 0),
            ("borders: invented", 0), ("other rules: true episodes", 0), ("missed", 0),
            ("false alarms", 0), ("false alarms per camera-day", 2),
            ("surely below, per camera-day", 2), ("alarms of falls and people down", 0),
        )
    ]  # fmt: skip
    for where in ("normal traffic", "episodes"):
        group = figures[where]["early warnings"]
        rows += [
            [f"early warnings, {where}: {name}", fixed(value_of(group, name), 2)] for name in group
        ]
    return table(["", ""], rows)


def days(results: Results) -> str:
    """Return false alarms and early warnings of normal days."""
    figures = results["normal_days"].figures
    by_rule, warned = figures["false alarms by rule"], figures["early warnings"]
    rows = [
        [name, fixed(value_of(figures, name), places)]
        for name, places in (
            ("camera-days", 2), ("hours of people", 1), ("borders: true episodes", 0),
            ("borders: missed", 0), ("borders: invented", 0), ("other rules: true episodes", 0),
            ("missed", 0), ("false alarms", 0), ("false alarms per camera-day", 2),
            ("surely below, per camera-day", 2), ("alarms of falls and people down", 0),
        )
    ]  # fmt: skip
    rows += [
        [f"false alarms: `{kind}`", fixed(value_of(by_rule, kind), 0)]
        for kind in by_rule
        if kind not in BORDERS
    ]
    rows += [[f"early warnings: {name}", fixed(value_of(warned, name), 2)] for name in warned]
    return table(["", ""], rows)
