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

Texts = Annotated[Sequence[str], Parameter(negative=())]


def study(
    file: Path | None = None,
    /,
    *,
    out: Path = Path("study"),
    set_: Annotated[Sequence[str], Parameter(name="--set", negative=())] = (),
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
    """Try settings of the fusion on scenes with known truth; report which of them matter.

    Every finished run is kept in the directory of the study. After Ctrl-C, a crash or a change of
    the study the same command does only what is missing.

    Parameters
    ----------
    file
        The study file. Without it the options say what to try; without them either, the study in
        the directory goes on.
    out
        Directory of the study; gets `report.html`, `results.csv` and the runs.
    set_
        A setting with the values to try: `knot_s=0.1,0.15`, `joint_sigma_m=0.01:0.04:5` for five
        equal steps, `0.01:0.04:5log` for equal factors. May be given several times.
    scene
        `room`, `room:people=8,cameras=6,seconds=10`, the name of a built-in scene, a scene file, or
        the folder of a made scene; `NAME=` before it names it. May be given several times; a room
        with four people if not given.
    seeds
        Of simulated scenes, `100-109,120`; 100-109 if not given. Below 1000 they are for choosing
        settings, from 1000 on for reporting.
    design
        `grid` tries every combination, `one-at-a-time` changes one setting of the default, `random`
        spreads `--points` points evenly.
    points
        How many points the random design has.
    lag_s
        Report this much later than the newest image [s].
    jobs
        Processes at once; all cores, if not given.
    reporting
        Take seeds from 1000 on, which no setting was chosen by.
    report_only
        Make no runs; write the report of those that are there.
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
        return planned(_quick_table(settings, scenes, options), "the study")
    path = file or out / STUDY
    if said:
        raise ConfigError(
            f"{', '.join(said)} belongs to a study without a file, which begins with --set; in a "
            "file these are keys"
        )
    if file is None and not path.exists():
        raise ConfigError(
            "give a study file, or what to try: trecsim study --set knot_s=0.08,0.1,0.15 "
            f"--out {out}"
        )
    return planned(read_study_table(path), str(path))


def _quick_table(
    settings: Sequence[str], scenes: Sequence[str], options: dict[str, Any]
) -> "StudyTable":
    from pydantic import ValidationError

    from trecsim.lab.study.quick import scenes_table, settings_table
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
    from trecsim.lab.study.ledger import NAME
    from trecsim.lab.study.plan import check_seeds
    from trecsim.lab.study.running import run_study

    check_seeds(plan, reporting=reporting)
    try:
        with progress_bar("runs", plan.runs, quiet=quiet, time_left=True) as bar:
            done = run_study(plan, out, workers=jobs, progress=bar, remark=note)
    except KeyboardInterrupt:
        raise KeyboardInterrupt(
            f"stopped by Ctrl-C; all finished runs are in {out / NAME}, and the same command goes "
            "on"
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
        "default": {f.measure.name: f.standing for f in found.findings if f.standing is not None},
        "remarks": found.remarks,
    }


def _told(plan: "Study", found: "Findings", out: Path) -> str:
    from trecsim.lab.study.analysis import few_seeds
    from trecsim.lab.study.results import settings_that_matter
    from trecsim.lab.study.study_report import REPORT
    from trecsim.lab.study.words import figure_text

    matter = settings_that_matter(found)
    lines = [f"  {'measure':<28}{'what matters, strongest first':<44}where the default stands"]
    for finding in found.findings:
        names = ", ".join(matter[finding.measure.name]) or "nothing beyond noise"
        stands = finding.standing
        rank = ""
        if stands is not None:
            default = figure_text(finding.measure, stands.default)
            rank = f"default {default}, rank {stands.rank} of {stands.points}"
        lines.append(f"  {finding.measure.title:<28}{names:<44}{rank}".rstrip())
    few = few_seeds(plan)
    return "\n".join([*lines, "", *[few] * bool(few), f"report: {out / REPORT}"])
