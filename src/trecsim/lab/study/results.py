"""The findings of a study as CSV, and the table that documents show of them."""

import csv
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path

from trecsim.errors import InputError
from trecsim.lab.study.analysis import MEASURES, Finding, Findings, named
from trecsim.lab.study.words import figure_text, interval_text, strength_text
from trecsim.store.atomic import atomic_write, opened_for_reading

RESULTS, PAIRS, DEFAULT = "results.csv", "pairs.csv", "default.csv"
_LARGEST_BYTES = 1 << 24

_COLUMNS = {
    RESULTS: {"measure", "setting", "value", "default", "mean", "spread", "chance"},
    DEFAULT: {"measure", "default", "rank", "points", "best", "best_settings"},
}

Row = dict[str, object]


def write_results(findings: Findings, out: Path) -> None:
    """Write `results.csv`, `pairs.csv` and `default.csv`.

    Parameters
    ----------
    findings
        What the study says.
    out
        Folder of the study.

    Raises
    ------
    SetupError
        The disk has no room.
    """
    for name, rows_of in ((RESULTS, _effects), (PAIRS, _pairs), (DEFAULT, _standing)):
        rows = [row for finding in findings.findings for row in rows_of(findings, finding)]
        with atomic_write(out / name) as file:
            if rows:
                writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
                writer.writeheader()
                writer.writerows({key: _cell(value) for key, value in row.items()} for row in rows)


def _effects(findings: Findings, finding: Finding) -> Iterator[Row]:
    for f, (factor, effect) in enumerate(
        zip(findings.factors, finding.analysis.effects, strict=True)
    ):
        for n, value in enumerate(finding.levels[f]):
            yield {
                "measure": finding.measure.name,
                "setting": factor.name,
                "value": value,
                "default": factor.default,
                "mean": effect.mean[n],
                "difference": effect.difference[n],
                "low": effect.low[n],
                "high": effect.high[n],
                "spread": effect.spread,
                "chance": effect.chance,
                "share": effect.share,
            }


def _pairs(findings: Findings, finding: Finding) -> Iterator[Row]:
    for (f, g), effect in finding.analysis.pairs.items():
        yield {
            "measure": finding.measure.name,
            "setting": findings.factors[f].name,
            "with": findings.factors[g].name,
            "spread": effect.spread,
            "chance": effect.chance,
            "share": effect.share,
        }


def _standing(findings: Findings, finding: Finding) -> Iterator[Row]:
    stands = finding.standing
    if stands is not None:
        yield {
            "measure": finding.measure.name,
            "default": stands.default,
            "rank": stands.rank,
            "points": stands.points,
            "best": stands.best,
            "best_settings": named(findings.factors, finding.points[stands.best_point]),
            "gain": stands.gain,
            "gain_low": stands.gain_low,
            "gain_high": stands.gain_high,
            "gain_on_other_seeds": stands.honest,
            "gain_on_other_seeds_low": stands.honest_low,
            "gain_on_other_seeds_high": stands.honest_high,
        }


def _cell(value: object) -> object:
    if isinstance(value, float):
        return f"{value:.6g}" if math.isfinite(value) else ""
    return str(value).lower() if isinstance(value, bool) else value


def read_results(path: Path) -> list[dict[str, str]]:
    """Return the rows of a `results.csv` or `default.csv`.

    Raises
    ------
    InputError
        It is not one.
    """
    with opened_for_reading(path) as file:
        data = file.read(_LARGEST_BYTES)
    try:
        rows = list(csv.DictReader(data.decode("utf-8").splitlines()))
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


def standing_markdown(rows: Sequence[Mapping[str, str]]) -> str:
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


def settings_that_matter(findings: Findings) -> dict[str, list[str]]:
    """Return for each measure the settings that move it more than chance, strongest first."""
    return {
        finding.measure.name: [
            factor.name
            for factor, effect in sorted(
                zip(findings.factors, finding.analysis.effects, strict=True),
                key=lambda pair: -pair[1].strength,
            )
            if effect.matters
        ]
        for finding in findings.findings
    }
