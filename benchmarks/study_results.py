"""The findings of a study, read from its CSV files, as tables for a document."""

import csv
import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from trecsim.errors import InputError
from trecsim.lab.study.analysis import MEASURES
from trecsim.lab.study.formatting import figure_text, interval_text, strength_text
from trecsim.lab.study.results import DEFAULT, RESULTS

_COLUMNS = {
    RESULTS: {"measure", "setting", "value", "default", "mean", "spread", "chance"},
    DEFAULT: {"measure", "default", "rank", "points", "best", "best_settings"},
}


def read_results(path: Path) -> list[dict[str, str]]:
    """Return the rows of a `results.csv` or `default.csv`.

    Raises
    ------
    InputError
        It is not one.
    """
    try:
        rows = list(csv.DictReader(path.read_text("utf-8").splitlines()))
    except (UnicodeDecodeError, csv.Error):
        rows = []
    wanted = _COLUMNS.get(path.name, _COLUMNS[RESULTS])
    if not rows or any(
        None in row or None in row.values() or not wanted <= set(row) for row in rows
    ):
        raise InputError(f"{path} is not the {path.name} of a study")
    return rows


def markdown(rows: Sequence[Mapping[str, str]]) -> str:
    """Return the main effects as a table for a document: settings down, measures across.

    Parameters
    ----------
    rows
        As :func:`read_results` returns them.
    """
    measures = [m for m in MEASURES if any(row["measure"] == m.name for row in rows)]
    settings = list(dict.fromkeys(row["setting"] for row in rows))
    head = ["setting", "tried", "default", *(_heading(m.title, m.unit) for m in measures)]
    lines = [_line(head), _line(["---"] * len(head))]
    for setting in settings:
        own = [row for row in rows if row["setting"] == setting]
        tried = list(dict.fromkeys(row["value"] for row in own))
        cells = [f"`{setting}`", f"{tried[0]} to {tried[-1]}", own[0]["default"]]
        for measure in measures:
            first = next(row for row in own if row["measure"] == measure.name)
            spread, chance = float(first["spread"]), float(first["chance"] or "nan")
            text = figure_text(measure, spread).removesuffix(measure.unit).strip()
            strength = spread / chance if chance else math.inf
            cells.append(f"**{text}** ({strength_text(strength)})" if spread > chance else text)
        lines.append(_line(cells))
    return "\n".join(lines) + "\n"


def default_rank_markdown(rows: Sequence[Mapping[str, str]]) -> str:
    """Return where the default stands as a table for a document.

    Parameters
    ----------
    rows
        Of `default.csv`, as :func:`read_results` returns them.
    """
    head = ["measure", "default", "rank", "best tried", "its settings", "gain on other seeds"]
    lines = [_line(head), _line(["---"] * len(head))]
    measures = {measure.name: measure for measure in MEASURES}
    for row in rows:
        measure = measures[row["measure"]]
        ends = ("", "_low", "_high")
        gain = [float(row[f"gain_on_other_seeds{end}"] or "nan") for end in ends]
        cells = [
            measure.title,
            figure_text(measure, float(row["default"])),
            f"{row['rank']} of {row['points']}",
            figure_text(measure, float(row["best"])),
            row["best_settings"] if float(row["gain"]) else "the default",
            interval_text(measure, gain[0], gain[1], gain[2]),
        ]
        lines.append(_line(cells))
    return "\n".join(lines) + "\n"


def _heading(title: str, unit: str) -> str:
    return f"{title} [{unit}]" if unit else title


def _line(cells: Iterable[str]) -> str:
    return "| " + " | ".join(cells) + " |"
