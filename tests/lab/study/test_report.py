"""What a study's report and tables say of made runs with known effects."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from study_results import markdown, read_results
from trecsim.errors import InputError
from trecsim.lab.study.analysis import findings
from trecsim.lab.study.cli_table import scenes_table, settings_table
from trecsim.lab.study.code_digest import code_digest
from trecsim.lab.study.plan import Study, planned
from trecsim.lab.study.results import RESULTS, settings_that_matter, write_results  # fmt: skip
from trecsim.lab.study.running import jobs_of
from trecsim.lab.study.runs_file import NAME, Run, opened
from trecsim.lab.study.settings_file_table import StudyTable
from trecsim.lab.study.study_report import REPORT, report_study

SETTINGS = ("knot_s=0.08,0.1,0.15", "joint_sigma_m=0.01,0.02,0.04", "min_joints=4,5")


def study_of(design: str = "grid", points: int | None = None, seeds: str = "1-8") -> Study:
    data = {
        "format": "trecsim.study/1", "design": design, "points": points, "seeds": seeds,
        "settings": settings_table(SETTINGS), "scenes": scenes_table(["room:people=1,seconds=1"]),
    }  # fmt: skip
    return planned(StudyTable.model_validate(data), "the study")


def made_runs(study: Study, out: Path, *, code: str = "", planted: float = 0.0) -> list[Run]:
    """Return runs where joint_sigma_m matters most, knot_s less and min_joints not at all."""
    rng = np.random.default_rng(0)
    hard = dict(zip(study.seeds, 0.02 * rng.random(len(study.seeds)), strict=True))
    luck: dict[tuple[object, ...], float] = {}  # min_joints has no part in it
    runs = []
    for job in jobs_of(study, out):
        knot_s, sigma_m = job.settings.knot_s, job.settings.joint_sigma_m
        drawn = luck.setdefault((job.seed, knot_s, sigma_m), rng.standard_normal())
        error_m = 0.03 + 0.01 * np.log2(sigma_m / 0.02) ** 2 + 0.02 * abs(knot_s - 0.1)
        error_m += planted * (knot_s == 0.15 and sigma_m == 0.04)
        figures = {
            "mean_m": error_m + hard[job.seed or 0] + 1e-4 * drawn,
            "recall_15cm": 0.95, "switches": float(drawn > 1), "missed": 3.0,
            "ghosts": 1.0, "person_frames": 100.0, "fusion_ms": 2.0 + 0.1 * drawn,
        }  # fmt: skip
        runs.append(Run(job.key, code or code_digest(), "room", job.seed, job.values, figures))
    return runs


def written(study: Study, out: Path, runs: list[Run]) -> Path:
    with opened(out / NAME) as ledger:
        for run in runs:
            ledger.append(run)
    return out


def test_the_report_says_what_was_planted(tmp_path: Path) -> None:
    study = study_of()
    found = report_study(study, written(study, tmp_path, made_runs(study, tmp_path)))
    matter = settings_that_matter(found)
    assert matter["error_cm"] == ["joint_sigma_m", "knot_s"]
    assert matter["recall_percent"] == []
    stands = found.findings[0].default_rank
    assert stands is not None
    assert stands.rank <= 2  # min_joints changes nothing
    assert found.remarks == ()
    text = (tmp_path / REPORT).read_text()
    assert "joint_sigma_m, knot_s matter, strongest first" in text
    assert "No pair of settings has a significant interaction" in text
    assert "The same at every point: 95.00 %" in text
    assert "for tuning" in text
    assert "://" not in text


def test_a_planted_interaction_is_in_the_report(tmp_path: Path) -> None:
    study = study_of()
    runs = made_runs(study, tmp_path, planted=0.01)
    report_study(study, written(study, tmp_path, runs))
    text = (tmp_path / REPORT).read_text()
    assert "knot_s and joint_sigma_m" in text
    assert "pairs-error_cm" in text
    rows = (tmp_path / "pairs.csv").read_text().splitlines()
    assert rows[0] == "measure,setting,with,spread,chance,share"
    assert rows[1].startswith("error_cm,knot_s,joint_sigma_m,")


@pytest.mark.parametrize(("design", "points"), [("one-at-a-time", None), ("random", 24)])
@pytest.mark.usefixtures("blank_figures")
def test_other_designs_find_the_strongest_setting_too(
    tmp_path: Path, design: str, points: int | None
) -> None:
    study = study_of(design, points)
    found = report_study(study, written(study, tmp_path, made_runs(study, tmp_path)))
    assert settings_that_matter(found)["error_cm"][0] == "joint_sigma_m"
    assert ("settings show no interactions" in (tmp_path / REPORT).read_text()) == (
        design == "one-at-a-time"
    )


@pytest.mark.usefixtures("blank_figures")
def test_the_table_of_a_document_is_made_from_the_results(tmp_path: Path) -> None:
    study = study_of()
    write_results(findings(study, made_runs(study, tmp_path), code_digest()), tmp_path)
    rows = read_results(tmp_path / RESULTS)
    default = [r for r in rows if r["measure"] == "error_cm" and r["value"] == r["default"]]
    assert [row["difference"] for row in default] == ["0", "0", "0"]
    table = markdown(rows).splitlines()
    assert len(table) == 2 + len(SETTINGS)
    assert table[3].startswith("| `joint_sigma_m` | 0.01 to 0.04 | 0.02 | **1.00** (")
    assert "**" not in table[4]


@pytest.mark.usefixtures("blank_figures")
def test_an_effect_without_any_chance_stands_in_the_table(tmp_path: Path) -> None:
    study = study_of()
    write_results(findings(study, made_runs(study, tmp_path), code_digest()), tmp_path)
    rows = [{**row, "spread": "2", "chance": "0"} for row in read_results(tmp_path / RESULTS)]
    assert "(> 100 ×)" in markdown(rows)


@pytest.mark.usefixtures("blank_figures")
def test_incomplete_and_failed_runs_are_told_and_left_out(tmp_path: Path) -> None:
    study = study_of()
    runs = made_runs(study, tmp_path)[
        :-20
    ]  # the last seed is not there, nor half of the one before
    runs[5] = Run(runs[5].key, runs[5].code, "room", runs[5].seed, runs[5].values, {}, "no luck")
    found = findings(study, runs, code_digest())
    assert found.failed == {"no luck": 1}
    told = "\n".join(found.remarks)
    assert "20 of 144 runs are not done yet" in told
    assert "1 of 8 scenes and seeds are incomplete" in told
    assert "points are excluded because a run failed" in told
    assert math.isfinite(found.findings[0].analysis.effects[0].spread)


@pytest.mark.usefixtures("blank_figures")
def test_few_seeds_are_warned_of(tmp_path: Path) -> None:
    study = study_of(seeds="1-2")
    found = findings(study, made_runs(study, tmp_path), code_digest())
    assert found.remarks[0] == "only 2 seeds: use at least 5"


@pytest.mark.usefixtures("blank_figures")
def test_runs_of_a_former_study_are_not_counted(tmp_path: Path) -> None:
    study = study_of()
    runs = made_runs(study, tmp_path)
    former = [replace(run, key=f"former {n}", figures={}, fault="x") for n, run in enumerate(runs)]
    found = findings(study, [*runs, *former], code_digest())
    assert (found.runs, found.wanted, found.failed) == (study.runs, study.runs, {})
    fewer = study_of(seeds="1-6")
    assert findings(fewer, runs, code_digest()).runs == fewer.runs < len(runs)
    older = [replace(run, code="older") for run in [*runs, *runs]]
    assert findings(study, older, "older").runs == study.runs


def test_too_few_runs_say_nothing(tmp_path: Path) -> None:
    study = study_of()
    with pytest.raises(InputError, match="no finished runs"):
        report_study(study, tmp_path)
    with pytest.raises(InputError, match="too few finished runs"):
        findings(study, made_runs(study, tmp_path)[:1], code_digest())


@pytest.mark.usefixtures("blank_figures")
def test_runs_of_an_older_version_are_reported_by_its_name(tmp_path: Path) -> None:
    study = study_of()
    written(study, tmp_path, made_runs(study, tmp_path, code="older"))
    told: list[str] = []
    assert report_study(study, tmp_path, remark=told.append).code == "older"
    assert told == ["the runs were made with another version of the code, older"]


@pytest.mark.parametrize("content", [b"", b"a,b\n1,2\n", b"\xff\xfe", b"measure\n"])
def test_what_is_no_table_of_results_is_refused(tmp_path: Path, content: bytes) -> None:
    (tmp_path / RESULTS).write_bytes(content)
    with pytest.raises(InputError, match=r"is not the results\.csv of a study"):
        read_results(tmp_path / RESULTS)
