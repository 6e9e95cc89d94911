"""The findings of a study as CSV."""

import csv
import math
from collections.abc import Iterator
from pathlib import Path

from trecsim.lab.study.analysis import Finding, Findings, named
from trecsim.store.atomic import atomic_write

RESULTS, PAIRS, DEFAULT = "results.csv", "pairs.csv", "default.csv"
Row = dict[str, object]


def write_results(findings: Findings, out: Path) -> None:
    """Write `results.csv`, `pairs.csv` and `default.csv`.

    Raises
    ------
    SetupError
        The disk is full.
    """
    for name, rows_of in ((RESULTS, _effects), (PAIRS, _pairs), (DEFAULT, _default_rank)):
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
                "chance": effect.noise_spread,
                "share": effect.share,
            }


def _pairs(findings: Findings, finding: Finding) -> Iterator[Row]:
    for (f, g), effect in finding.analysis.pairs.items():
        yield {
            "measure": finding.measure.name,
            "setting": findings.factors[f].name,
            "with": findings.factors[g].name,
            "spread": effect.spread,
            "chance": effect.noise_spread,
            "share": effect.share,
        }


def _default_rank(findings: Findings, finding: Finding) -> Iterator[Row]:
    stands = finding.default_rank
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
            "gain_on_other_seeds": stands.gain_on_other_seeds,
            "gain_on_other_seeds_low": stands.gain_on_other_seeds_low,
            "gain_on_other_seeds_high": stands.gain_on_other_seeds_high,
        }


def _cell(value: object) -> object:
    if isinstance(value, float):
        return f"{value:.6g}" if math.isfinite(value) else ""
    return str(value).lower() if isinstance(value, bool) else value


def settings_that_matter(findings: Findings) -> dict[str, list[str]]:
    """Return for each measure the settings with a significant effect, strongest first."""
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
