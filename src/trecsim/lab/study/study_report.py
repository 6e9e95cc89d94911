"""The report of a study as one page."""

import math
from collections.abc import Iterator
from pathlib import Path

from trecsim.callbacks import Remark
from trecsim.errors import InputError
from trecsim.lab.evaluation.assignment import need_scipy
from trecsim.lab.report.page import Block, Fact, Facts, Section, Table, Text, page
from trecsim.lab.report.style import need_matplotlib
from trecsim.lab.study.analysis import Finding, Findings, findings
from trecsim.lab.study.code_digest import code_digest
from trecsim.lab.study.default_rank import DefaultRank
from trecsim.lab.study.formatting import figure_text, interval_text
from trecsim.lab.study.plan import FIRST_REPORTING_SEED, Study
from trecsim.lab.study.results import settings_that_matter, write_results
from trecsim.lab.study.runs_file import NAME, read_runs
from trecsim.lab.study.sections import default_blocks, measure_blocks, pair_blocks, setting_blocks
from trecsim.store.atomic import atomic_write

REPORT = "report.html"


def need_report() -> None:
    """Fail early if the report cannot be written.

    Raises
    ------
    SetupError
        SciPy, Jinja or Matplotlib is not installed.
    """
    need_scipy()
    need_matplotlib()
    page("", ())  # needs Jinja


def report_study(study: Study, out: Path, *, remark: Remark | None = None) -> Findings:
    """Write `report.html`, `results.csv`, `pairs.csv` and `default.csv` of the finished runs.

    Raises
    ------
    InputError
        There are too few runs.
    SetupError
        A package is missing, or the disk is full.
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
    """Return the report of a study as HTML."""
    sections = [
        Section("In short", tuple(_short(study, found))),
        Section(
            "Which settings matter",
            tuple(setting_blocks(found)),
            lead="Difference between the best and the worst value of each setting, and its ratio "
            "to the noise between seeds. Ratios up to 1 × are not significant.",
        ),
        *(
            Section(finding.measure.title.capitalize(), tuple(measure_blocks(found, finding)))
            for finding in found.findings
        ),
        Section(
            "Which settings interact",
            tuple(pair_blocks(found, study.design.kind)),
            lead="Two settings interact when the best value of one depends on the other.",
        ),
        Section(
            "Rank of the default",
            tuple(default_blocks(found)),
            lead="Rank of the default among all points, for each measure.",
        ),
        Section("How it was done", tuple(_method(study, found))),
    ]
    names = ", ".join(factor.name for factor in found.factors[:6])
    more = f" and {len(found.factors) - 6} more" if len(found.factors) > 6 else ""
    return page("Parameter study", sections, subtitle=f"{names}{more}")


def _short(study: Study, found: Findings) -> Iterator[Block]:
    first = found.findings[0]
    stands = first.default_rank
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
                _gain(first, stands),
                _gain_detail(first, stands),
            ),
        ]
    yield Facts(facts)
    matter = settings_that_matter(found)
    for finding in found.findings:
        names = matter[finding.measure.name]
        if not any(math.isfinite(effect.noise_spread) for effect in finding.analysis.effects):
            continue
        rest = len(found.factors) - len(names)
        told = ", ".join(names) if names else "none of the settings"
        tail = f"; the {_settings_word(rest)} no significant effect" if names and rest else ""
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


def _gain(finding: Finding, stands: DefaultRank) -> str:
    sure = stands.gain_on_other_seeds_low > 0 and stands.best_point != 0
    return figure_text(finding.measure, stands.gain_on_other_seeds) if sure else "nothing sure"


def _gain_detail(finding: Finding, stands: DefaultRank) -> str:
    if stands.best_point == 0:
        return "the default is the best of all"
    if not math.isfinite(stands.gain_on_other_seeds_low):
        return "one seed only: the noise is unknown"
    text = interval_text(
        finding.measure,
        stands.gain_on_other_seeds,
        stands.gain_on_other_seeds_low,
        stands.gain_on_other_seeds_high,
    )
    return f"{text} on other seeds"


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
        "Every point was run on the same scenes and seeds and is compared only within them. Main "
        "effects come from an additive model fitted by least squares, interactions from its "
        "residuals. Intervals come from a bootstrap over the seeds of each scene, widened by "
        "Student's t for few seeds. Noise is the spread that differences between seeds alone "
        "exceed in 1 of 20 cases."
    )
    yield Text(
        "The error counts only joints of matched people: a setting that loses difficult people can "
        "seem more accurate, so read it together with the joints within 15 cm and the missed "
        "people. Times are medians per run of processes that share the machine; compare them only "
        "within this study."
    )
    if study.design.kind == "random":
        yield Text(
            "The points of a random design are not balanced: the residual of the model counts as "
            "noise. Values drawn from a range are shown in bins of equal count."
        )
