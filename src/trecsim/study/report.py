"""The report of a study as one page."""

import math
from collections.abc import Iterator
from pathlib import Path

from trecsim.errors import InputError
from trecsim.report.page import Block, Fact, Facts, Figure, Section, Table, Text, page
from trecsim.store.atomic import atomic_write
from trecsim.study.analysis import Finding, Findings, findings, named
from trecsim.study.charts import effects_svg, pairs_svg, standing_svg, strengths_svg
from trecsim.study.code import code_digest
from trecsim.study.ledger import NAME, read_runs
from trecsim.study.plan import FIRST_REPORTING_SEED, Study
from trecsim.study.results import settings_that_matter, write_results
from trecsim.study.running import Remark
from trecsim.study.statistics import Effect, Standing
from trecsim.study.words import effect_text, figure_text, interval_text, strength_text

REPORT = "report.html"
_MOST_PAIRS_SHOWN = 6
_MOST_PAIR_ROWS = 15
_TIME = "fusion_ms"


def report_study(study: Study, out: Path, *, remark: Remark | None = None) -> Findings:
    """Write `report.html`, `results.csv`, `pairs.csv` and `default.csv` of what is there.

    Parameters
    ----------
    study
        What was asked for.
    out
        Its folder, with the finished runs.
    remark
        Is called with what the user should know.

    Raises
    ------
    InputError
        There are no runs, or too few.
    SetupError
        A package is missing, or the disk has no room.
    """
    runs = read_runs(out / NAME)
    if not runs:
        raise InputError(f"{out}: there are no finished runs to report on")
    code = code_digest()
    if all(run.code != code for run in runs):
        code = runs[-1].code
        if remark is not None:
            remark(f"the runs were made with another version of the code, {code}")
    found = findings(study, runs, code)
    write_results(found, out)
    with atomic_write(out / REPORT) as file:
        file.write(study_page(study, found))
    return found


def study_page(study: Study, found: Findings) -> str:
    """Return the report of a study as HTML.

    Parameters
    ----------
    study
        What was asked for.
    found
        What it says.
    """
    sections = [
        Section("In short", tuple(_short(study, found))),
        Section(
            "Which settings matter",
            tuple(_settings(found)),
            lead="How far the worst of the tried values is from the best, and how often that is "
            "what other seeds alone bring about. Up to 1 × it is noise.",
        ),
        *(
            Section(finding.measure.title.capitalize(), tuple(_measure(found, finding)))
            for finding in found.findings
        ),
        Section(
            "Which settings interact",
            tuple(_interactions(study, found)),
            lead="Two settings interact when the best value of one depends on the other.",
        ),
        Section(
            "Where the default stands",
            tuple(_default(found)),
            lead="Among everything that was tried, for each measure by itself.",
        ),
        Section("How it was done", tuple(_method(study, found))),
    ]
    names = ", ".join(factor.name for factor in found.factors[:6])
    more = f" and {len(found.factors) - 6} more" if len(found.factors) > 6 else ""
    return page("Parameter study", sections, subtitle=f"{names}{more}")


def _short(study: Study, found: Findings) -> Iterator[Block]:
    first = found.findings[0]
    stands = first.standing
    facts = [
        Fact(
            "settings",
            str(len(found.factors)),
            f"{study.design.kind}, {len(study.design.points)} points",
        ),
        Fact("runs", str(found.runs), f"{len(study.blocks)} scenes and seeds"),
    ]
    if stands is not None:
        facts += [
            Fact(
                first.measure.title, figure_text(first.measure, stands.default), "with the default"
            ),
            Fact("rank of the default", f"{stands.rank} of {stands.points}", "by that error"),
            Fact(
                "the best would gain",
                figure_text(first.measure, stands.honest),
                _gain_detail(first, stands),
            ),
        ]
    yield Facts(facts)
    matter = settings_that_matter(found)
    for finding in found.findings:
        names = matter[finding.measure.name]
        if not any(math.isfinite(effect.chance) for effect in finding.analysis.effects):
            continue
        rest = len(found.factors) - len(names)
        told = ", ".join(names) if names else "nothing that was tried"
        tail = f"; the {_settings_word(rest)} not more than chance" if names and rest else ""
        yield Text(
            f"{finding.measure.title.capitalize()}: {told} matters{tail}."
            if len(names) < 2
            else f"{finding.measure.title.capitalize()}: {told} matter, strongest first{tail}."
        )
    for remark in found.remarks:
        yield Text(remark, "warning")
    for reason, count in sorted(found.failed.items(), key=lambda item: -item[1])[:5]:
        yield Text(f"{count} runs failed: {reason}", "warning")


def _settings_word(count: int) -> str:
    return "other one does" if count == 1 else f"other {count} do"


def _gain_detail(finding: Finding, stands: Standing) -> str:
    if stands.best_point == 0:
        return "the default is the best of all"
    if not math.isfinite(stands.honest_low):
        return "one seed only: nothing is known of chance"
    text = interval_text(finding.measure, stands.honest, stands.honest_low, stands.honest_high)
    return f"{text.partition(' ')[2].removeprefix(finding.measure.unit).strip()} on other seeds"


def _settings(found: Findings) -> Iterator[Block]:
    yield Figure(
        strengths_svg(found),
        "Spread in multiples of what chance brings about; in the grey it is noise. Among twenty "
        "settings without any effect, one is expected to look as if it had one.",
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
        ["setting", *(finding.measure.title for finding in found.findings)],
        rows,
        "From the best of the tried values to the worst, and in brackets how often that is what "
        "chance brings about.",
    )


def _measure(found: Findings, finding: Finding) -> Iterator[Block]:
    if all(effect.spread == 0 for effect in finding.analysis.effects):
        yield Text(
            f"The same at every point: {figure_text(finding.measure, float(finding.mean[0]))}. "
            "These scenes cannot tell the settings apart by it.",
            "missing",
        )
        return
    explained = finding.analysis.explained
    tail = (
        f" One by one the settings explain {100 * explained:.0f} % of what differs between points."
        if math.isfinite(explained) and finding.analysis.pairs
        else ""
    )
    if finding.measure.name == _TIME:
        tail += (
            " Measured with all processes at work, so good only for comparing points of this study."
        )
    yield Figure(
        effects_svg(found, finding),
        "Outcome over the value of each setting, strongest first. The band is the 95 % interval of "
        "the difference to the default (dashed; to the mean of all where the default was not "
        f"tried), paired over seeds.{tail}",
    )


def _interactions(study: Study, found: Findings) -> Iterator[Block]:
    if study.design.kind == "one-at-a-time":
        yield Text(
            "One at a time, settings cannot show how they work together; a grid or random "
            "points can.",
            "missing",
        )
        return
    if len(found.factors) < 2:
        yield Text("It takes two settings to interact.", "missing")
        return
    rows = sorted(_pair_rows(found), key=lambda row: -row[0])
    if not rows:
        yield Text("No pair of settings does more together than each alone, beyond noise.", "good")
        return
    yield Table(
        ["settings", "measure", "beyond the two alone", "multiples of chance"],
        [row[1] for row in rows[:_MOST_PAIR_ROWS]],
        "Largest departure of a pair's cells from what the two settings do one by one."
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
                f"{finding.measure.title.capitalize()}{unit} for each combination; the default is "
                "framed.",
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


def _default(found: Findings) -> Iterator[Block]:
    told = [finding for finding in found.findings if finding.standing is not None]
    if not told:
        yield Text("The default has no complete results.", "missing")
        return
    yield Figure(
        standing_svg(found), "Every point that was tried, from the best; the default is marked."
    )
    yield Table(
        ["measure", "default", "rank", "best tried", "gain", "gain on other seeds", ""],
        [_standing_row(finding, finding.standing) for finding in told if finding.standing],
        "What the best of the tried points gains over the default, with its 95 % interval. The "
        "best of many is partly luck; on other seeds: the best is chosen without the seed it is "
        "judged on.",
        align=("left", "right", "right", "right", "right", "right", "left"),
    )
    yield Table(
        ["measure", "settings of the best tried point"],
        [
            [f.measure.title, named(found.factors, f.points[f.standing.best_point])]
            for f in told
            if f.standing and f.standing.best_point
        ],
        align=("left", "left"),
    )


def _standing_row(finding: Finding, stands: Standing) -> list[str]:
    measure = finding.measure
    return [
        measure.title,
        figure_text(measure, stands.default),
        f"{stands.rank} of {stands.points}",
        figure_text(measure, stands.best),
        "–" if not stands.best_point else
        interval_text(measure, stands.gain, stands.gain_low, stands.gain_high),
        interval_text(measure, stands.honest, stands.honest_low, stands.honest_high),
        _verdict(stands),
    ]  # fmt: skip


def _verdict(stands: Standing) -> str:
    if stands.best_point == 0:
        return "nothing better was tried"
    if not math.isfinite(stands.honest_low):
        return "noise unknown"
    if stands.honest_low > 0:
        return "better than the default"
    return "within noise" if stands.honest_high >= 0 else "worse on other seeds"


def _method(study: Study, found: Findings) -> Iterator[Block]:
    reporting = bool(study.seeds) and study.seeds[0] >= FIRST_REPORTING_SEED
    seeds = study.table.seeds
    purpose = "for reporting: nothing was chosen by them" if reporting else "for tuning"
    yield Table(
        ["", ""],
        [
            ["scenes", ", ".join(scene.name for scene in study.scenes)],
            [
                "seeds",
                f"{seeds} ({purpose}; from {FIRST_REPORTING_SEED} on they are for reporting)",
            ],
            [
                "design",
                f"{study.design.kind}, {len(study.design.points)} points, the default among them",
            ],
            ["lag", f"{study.table.lag_s:g} s"],
            ["code", f"version {found.code}"],
        ],
        align=("left", "left"),
    )
    yield Text(
        "Every point was tried on the same scenes and seeds, and is compared only within them. "
        "Effects of settings come from a model that adds them up, by least squares; what pairs do "
        "beyond it from what it leaves over. Intervals come from drawing the seeds of each scene "
        "anew, widened as Student's t is for few. Chance is the spread that seeds alone exceed in "
        "one of twenty cases."
    )
    yield Text(
        "The error counts only joints of people who were found: a setting that loses difficult "
        "people can seem more exact, so look at it together with the joints within 15 cm and the "
        "missed people. Times are medians per run of processes that share the machine; they can be "
        "compared within this study and with nothing else."
    )
    if study.design.kind == "random":
        yield Text(
            "Points of a random design do not balance each other: what the model does not explain "
            "is counted as noise. Settings drawn from a range are shown in parts of equal count."
        )
