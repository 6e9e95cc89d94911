"""The command `trecsim study`."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from trecsim.cli.terminal import finish, note, progress_bar
from trecsim.errors import ConfigError, InputError

if TYPE_CHECKING:
    from trecsim.lab.study.analysis import Findings
    from trecsim.lab.study.plan import Study
    from trecsim.lab.study.settings_file_table import StudyTable

Texts = Annotated[Sequence[str], Parameter(negative=(), show_default=False)]


def study(
    file: Path | None = None,
    /,
    *,
    out: Path = Path("study"),
    set_: Annotated[Texts, Parameter(name="--set")] = (),
    scene: Texts = (),
    seeds: str | None = None,
    design: Literal["grid", "one-at-a-time", "random"] | None = None,
    points: int | None = None,
    lag_s: float | None = None,
    jobs: int | None = None,
    reporting: bool = False,
    report_only: bool = False,
    json: bool = False,
) -> None:
    """Vary settings of the fusion on synthetic scenes; report which of them matter.

    Every finished run is kept in the directory of the study. After Ctrl-C, a crash or a change of
    the study, the same command computes only the missing runs.

    Parameters
    ----------
    file
        The study file. Without a file the options define the study; without options the study in
        the directory is continued.
    out
        Directory of the study, for `report.html`, `results.csv` and the runs.
    set_
        A setting with its values: `knot_s=0.1,0.15`, `joint_sigma_m=0.01:0.04:5` for five
        equal steps, `0.01:0.04:5log` for equal factors. Can be repeated.
    scene
        `room`, `room:people=8,cameras=6,seconds=10`, the name of a built-in scene, a scene file, or
        the directory of a simulated scene; `NAME=` before it names it. Can be repeated (default: a
        room with four people).
    seeds
        Seeds of the simulated scenes: `100-109,120` (default: 100-109). Seeds below 1000 are for
        choosing settings, seeds from 1000 on for reporting.
    design
        `grid` runs every combination, `one-at-a-time` changes one setting from its default,
        `random` spreads `--points` points evenly.
    points
        Number of points of the random design.
    lag_s
        Report each state this long after the newest image [s].
    jobs
        Number of processes (default: all cores).
    reporting
        Use seeds from 1000 on, by which no setting was chosen.
    report_only
        Compute no runs; write the report of the finished ones.
    json
        Print the summary as one JSON object.
    """
    if jobs is not None and jobs < 1:
        raise InputError(f"--jobs {jobs}: expected at least 1")
    options = {"design": design, "points": points, "lag_s": lag_s, "seeds": seeds}
    given = {name: value for name, value in options.items() if value is not None}
    plan = _plan(file, out, set_, scene, given)
    from trecsim.lab.study.study_report import need_report, report_study

    need_report()
    if not report_only:
        _run(plan, out, jobs, reporting=reporting, quiet=json)
    found = report_study(plan, out, remark=note)
    finish(_summary(plan, found, out), json, _told(plan, found, out))


def _plan(
    file: Path | None,
    out: Path,
    settings: Sequence[str],
    scenes: Sequence[str],
    options: dict[str, Any],
) -> "Study":
    from trecsim.lab.study.folder import STUDY
    from trecsim.lab.study.plan import planned
    from trecsim.lab.study.settings_file_table import read_study_table

    said = [f"--{name.replace('_', '-')}" for name in options]
    said += ["--set"] * bool(settings) + ["--scene"] * bool(scenes)
    if settings:
        if file is not None:
            raise ConfigError(f"give either a study file or {', '.join(said)}, not both")
        return planned(_cli_table(settings, scenes, options), "the study")
    path = file or out / STUDY
    if said:
        raise ConfigError(
            f"{', '.join(said)} belongs to a study without a file, which begins with --set; in a "
            "file these are keys"
        )
    if file is None and not path.exists():
        raise ConfigError(
            "give a study file, or settings to vary: trecsim study --set knot_s=0.08,0.1,0.15 "
            f"--out {out}"
        )
    return planned(read_study_table(path), str(path))


def _cli_table(
    settings: Sequence[str], scenes: Sequence[str], options: dict[str, Any]
) -> "StudyTable":
    from pydantic import ValidationError

    from trecsim.lab.study.cli_table import scenes_table, settings_table
    from trecsim.lab.study.settings_file_table import FORMAT, StudyTable

    data = {
        "format": FORMAT,
        "seeds": "100-109",
        **options,
        "settings": settings_table(settings),
        "scenes": scenes_table(scenes or ["room"]),
    }
    try:
        return StudyTable.model_validate(data)
    except ValidationError as error:
        faults = [
            f"{'.'.join(map(str, fault['loc']))}: "
            f"{fault['msg'].removeprefix('Value error, ')}, found {fault['input']!r:.60}"
            for fault in error.errors()[:8]
        ]
        raise ConfigError("the study: " + "; ".join(faults)) from None


def _run(plan: "Study", out: Path, jobs: int | None, *, reporting: bool, quiet: bool) -> None:
    from trecsim.lab.study.plan import check_seeds
    from trecsim.lab.study.running import run_study
    from trecsim.lab.study.runs_file import NAME

    check_seeds(plan, reporting=reporting)
    try:
        with progress_bar("runs", plan.runs, quiet=quiet, time_left=True) as bar:
            done = run_study(plan, out, workers=jobs, progress=bar, remark=note)
    except KeyboardInterrupt:
        raise KeyboardInterrupt(
            f"stopped; all finished runs are in {out / NAME}; the same command continues"
        ) from None
    if done.failed:
        note(f"{done.failed} of {done.made} runs failed; the report says why")


def _summary(plan: "Study", found: "Findings", out: Path) -> dict[str, Any]:
    from trecsim.lab.study.plan import FIRST_REPORTING_SEED
    from trecsim.lab.study.results import RESULTS, settings_that_matter
    from trecsim.lab.study.study_report import REPORT

    return {
        "report": out / REPORT,
        "results": out / RESULTS,
        "runs": found.runs,
        "wanted": found.wanted,
        "failed": sum(found.failed.values()),
        "points": len(plan.design.points),
        "seeds": plan.seeds,
        "reporting": plan.seeds[0] >= FIRST_REPORTING_SEED,
        "code": found.code,
        "matter": settings_that_matter(found),
        "default": {
            f.measure.name: f.default_rank.row()
            for f in found.findings
            if f.default_rank is not None
        },
        "remarks": found.remarks,
    }


def _told(plan: "Study", found: "Findings", out: Path) -> str:
    from trecsim.lab.study.analysis import few_seeds
    from trecsim.lab.study.formatting import figure_text
    from trecsim.lab.study.results import settings_that_matter
    from trecsim.lab.study.study_report import REPORT

    matter = settings_that_matter(found)
    lines = [
        f"  {'measure':<28}{'settings with an effect, strongest first':<44}rank of the default"
    ]
    for finding in found.findings:
        names = ", ".join(matter[finding.measure.name]) or "no significant effect"
        stands = finding.default_rank
        rank = ""
        if stands is not None:
            default = figure_text(finding.measure, stands.default)
            rank = f"default {default}, rank {stands.rank} of {stands.points}"
        lines.append(f"  {finding.measure.title:<28}{names:<44}{rank}".rstrip())
    few = few_seeds(plan)
    return "\n".join([*lines, "", *[few] * bool(few), f"report: {out / REPORT}"])
