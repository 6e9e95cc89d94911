"""The study that the documentation shows is the one whose results are kept."""

import tomllib
from pathlib import Path

import pytest

from study_results import default_rank_markdown, markdown, read_results
from trecsim.lab.study.plan import check_seeds, planned
from trecsim.lab.study.results import DEFAULT, RESULTS
from trecsim.lab.study.settings_file_table import read_study_table

ROOT = Path(__file__).parents[3]
FILE = ROOT / "benchmarks" / "study_three.toml"
KEPT = ROOT / "benchmarks" / "results" / "study_three"


def between(name: str) -> str:
    text = (ROOT / "docs" / "parameter-study.md").read_text()
    return text.partition(f"<!-- table: {name} -->\n")[2].partition("<!-- end -->")[0].strip()


@pytest.mark.parametrize(
    ("name", "file", "made"),
    [("study-three", RESULTS, markdown), ("study-three-default", DEFAULT, default_rank_markdown)],
)
def test_the_tables_of_the_documentation_are_those_of_the_results(name, file, made) -> None:
    assert between(name) == made(read_results(KEPT / file)).strip()


def test_the_study_of_the_documentation_can_be_run_and_tunes() -> None:
    study = planned(read_study_table(FILE), str(FILE))
    check_seeds(study, reporting=False)
    assert len(study.design.factors) == 3
    tried = {row["setting"] for row in read_results(KEPT / RESULTS)}
    assert tried == set(tomllib.loads(FILE.read_text())["settings"])
