"""Sections of a study report with its findings."""

import math
from collections.abc import Iterator

import numpy as np

from trecsim.lab.report.page import Block, Figure, Table, Text
from trecsim.lab.study.analysis import Finding, Findings, named
from trecsim.lab.study.charts import (
    default_rank_svg,
    effects_svg,
    pairs_svg,
    strengths_svg,
    strongest,
)
from trecsim.lab.study.default_rank import DefaultRank
from trecsim.lab.study.design import Value, value_text
from trecsim.lab.study.formatting import (
    effect_text,
    figure_text,
    interval_text,
    strength_text,
)
from trecsim.lab.study.inference import Effect

_MOST_PAIRS_SHOWN = 6
_MOST_PAIR_ROWS = 15
_TIME = "fusion_ms"


def setting_blocks(found: Findings) -> Iterator[Block]:
    """Yield the effect of each setting on each measure."""
    yield Figure(
        strengths_svg(found),
        "Spread as a multiple of the noise between seeds; inside the grey area it is not "
        "significant. Of twenty settings without effect, one is expected to exceed it.",
    )
    order = sorted(
        range(len(found.factors)), key=lambda f: -found.findings[0].analysis.effects[f].strength
    )
    rows = [
        [
            found.factors[f].name,
            *(effect_text(x.measure, x.analysis.effects[f]) for x in found.findings),
        ]
        for f in order
    ]
    yield Table(
        ["setting", *(finding.measure.short for finding in found.findings)],
        rows,
        "Difference between the best and the worst value, and in brackets its ratio to the noise.",
    )


def measure_blocks(found: Findings, finding: Finding) -> Iterator[Block]:
    """Yield the dependence of one measure on each setting."""
    if all(effect.spread == 0 for effect in finding.analysis.effects):
        yield Text(
            f"The same at every point: {figure_text(finding.measure, float(finding.mean[0]))}. "
            "In these scenes the settings have no effect on it.",
            "missing",
        )
        return
    explained = finding.analysis.explained
    tail = (
        f" The main effects explain {100 * explained:.0f} % of the variance between points."
        if math.isfinite(explained) and finding.analysis.pairs
        else ""
    )
    if finding.measure.name == _TIME:
        tail += " Measured with all processes busy, so comparable only within this study."
    drawn = len(strongest(finding))
    which = "each setting" if drawn == len(found.factors) else f"the {drawn} strongest settings"
    yield Figure(
        effects_svg(found, finding),
        f"Outcome over the value of {which}, strongest first. The band is the 95 % interval of "
        "the difference to the default (dashed), or to the mean of all where the default lies "
        f"outside, paired over seeds.{tail}",
    )


def pair_blocks(found: Findings, design: str) -> Iterator[Block]:
    """Yield the interactions of settings."""
    if design == "one-at-a-time":
        yield Text(
            "One at a time, settings show no interactions; use a grid or random points.",
            "missing",
        )
        return
    if len(found.factors) < 2:
        yield Text("An interaction needs two settings.", "missing")
        return
    rows = sorted(_pair_rows(found), key=lambda row: -row[0])
    if not rows:
        yield Text("No pair of settings has a significant interaction.", "good")
        return
    yield Table(
        ["settings", "measure", "beyond the two alone", "multiples of noise"],
        [row[1] for row in rows[:_MOST_PAIR_ROWS]],
        "Largest deviation of a pair's cells from the sum of both effects."
        + (
            f" The strongest {_MOST_PAIR_ROWS} of {len(rows)}."
            if len(rows) > _MOST_PAIR_ROWS
            else ""
        ),
        align=("left", "left", "right", "right"),
    )
    for finding in found.findings:
        strong = _strong_pairs(finding)
        if strong and finding.measure.name != _TIME:
            unit = f" [{finding.measure.unit}]" if finding.measure.unit else ""
            yield Figure(
                pairs_svg(found, finding, strong[:_MOST_PAIRS_SHOWN]),
                f"{finding.measure.title.capitalize()}{unit} for each combination, the darker the "
                "worse; the default is framed, where it was tried.",
            )


def _strong_pairs(finding: Finding) -> list[tuple[int, int]]:
    pairs = finding.analysis.pairs
    return sorted((p for p in pairs if pairs[p].matters), key=lambda p: -pairs[p].strength)


def _pair_rows(found: Findings) -> Iterator[tuple[float, list[str]]]:
    for finding in found.findings:
        for pair in _strong_pairs(finding):
            effect: Effect = finding.analysis.pairs[pair]
            yield (
                effect.strength,
                [
                    " and ".join(found.factors[k].name for k in pair),
                    finding.measure.title,
                    figure_text(finding.measure, effect.spread),
                    strength_text(effect.strength),
                ],
            )


def default_blocks(found: Findings) -> Iterator[Block]:
    """Yield the rank of the default, and the possible gain of each setting alone."""
    told = [finding for finding in found.findings if finding.default_rank is not None]
    if not told:
        yield Text("The default has no complete results.", "missing")
        return
    yield Figure(
        default_rank_svg(found), "All points from the best to the worst; the default is marked."
    )
    yield Table(
        ["measure", "default", "rank", "best tried", "gain", "gain on other seeds", ""],
        [_rank_row(finding, finding.default_rank) for finding in told if finding.default_rank],
        "Gain of the best point over the default, with its 95 % interval. The best of many points "
        "is partly luck; *on other seeds* chooses it without the seed on which it is judged.",
        align=("left", "right", "right", "right", "right", "right", "left"),
    )
    yield Table(
        ["measure", "settings of the best tried point"],
        [
            [f.measure.title, named(found.factors, f.points[f.default_rank.best_point])]
            for f in told
            if f.default_rank and f.default_rank.best_point
        ],
        align=("left", "left"),
    )
    yield from _one_by_one(found)


def _one_by_one(found: Findings) -> Iterator[Block]:
    """Yield the change by the best value of each setting alone."""
    first, *others = found.findings
    others = [finding for finding in others if finding.measure.name != _TIME]
    rows = []
    for f, factor in enumerate(found.factors):
        effect, values = first.analysis.effects[f], list(first.levels[f])
        sign = -1.0 if first.measure.more_is_better else 1.0
        best = values[int(np.argmin(sign * effect.mean))]
        changes = [_change(finding, f, best) for finding in (first, *others)]
        if best == factor.default:
            rows.append([factor.name, value_text(best), "the default", *["–"] * len(changes)])
        else:
            rows.append([factor.name, value_text(factor.default), value_text(best), *changes])
    heads = [finding.measure.short for finding in (first, *others)]
    yield Table(
        ["setting", "default", f"best by {first.measure.short}", *heads],
        rows,
        "Change when one setting alone takes its best value, from the default (or the mean of all "
        "values where the default lies outside), with 95 % intervals. An interval that contains "
        "zero is not significant.",
    )


def _change(finding: Finding, f: int, value: Value) -> str:
    if value not in finding.levels[f]:
        return "–"
    effect, n = finding.analysis.effects[f], list(finding.levels[f]).index(value)
    return interval_text(finding.measure, effect.difference[n], effect.low[n], effect.high[n])


def _rank_row(finding: Finding, stands: DefaultRank) -> list[str]:
    measure = finding.measure
    return [
        measure.title,
        figure_text(measure, stands.default),
        f"{stands.rank} of {stands.points}",
        figure_text(measure, stands.best),
        "–" if not stands.best_point else
        interval_text(measure, stands.gain, stands.gain_low, stands.gain_high),
        interval_text(
            measure,
            stands.gain_on_other_seeds,
            stands.gain_on_other_seeds_low,
            stands.gain_on_other_seeds_high,
        ),
        _verdict(stands),
    ]  # fmt: skip


def _verdict(stands: DefaultRank) -> str:
    if stands.best_point == 0:
        return "nothing better was tried"
    if not math.isfinite(stands.gain_on_other_seeds_low):
        return "noise unknown"
    if stands.gain_on_other_seeds_low > 0:
        return "better than the default"
    return "within noise" if stands.gain_on_other_seeds_high >= 0 else "worse on other seeds"
