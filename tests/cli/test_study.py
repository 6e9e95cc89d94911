"""The command `trecsim study`."""

import json
import re
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from trecsim.lab.study import running
from trecsim.lab.study.running import Job

Command = Callable[..., tuple[int, str, str]]


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch, blank_figures: None) -> None:
    """Let runs and figures take no time; the error falls with joint_sigma_m."""

    def run(job: Job) -> dict[str, float]:
        error_m = 0.05 - job.settings.joint_sigma_m + 1e-5 * ((job.seed or 0) % 7)
        return {
            "mean_m": error_m, "recall_15cm": 0.9, "switches": 0.0, "missed": 2.0, "ghosts": 0.0,
            "person_frames": 100.0, "fusion_ms": 2.5,
        }  # fmt: skip

    monkeypatch.setattr(running, "run_one", run)
    monkeypatch.setattr(running, "prepare", lambda choice, seed, out: out)
    monkeypatch.setattr(running, "code_changed", lambda: False)


def test_a_study_in_a_few_words(trecsim: Command, quick: None, tmp_path: Path) -> None:
    out = tmp_path / "study"
    code, said, told = trecsim(
        "study", "--set", "joint_sigma_m=0.01,0.02,0.03", "--set", "min_joints=4,5",
        "--scene", "room:people=1", "--seeds", "1-6", "--out", out, "--jobs", 1, "--json",
    )  # fmt: skip
    summary = json.loads(said)
    assert (code, told) == (0, "")
    assert (summary["runs"], summary["points"], summary["failed"]) == (36, 6, 0)
    assert summary["matter"]["error_cm"] == ["joint_sigma_m"]
    assert summary["default"]["error_cm"]["gain"] == pytest.approx(1.0)
    assert summary["seeds"] == [1, 2, 3, 4, 5, 6]
    assert not summary["reporting"]
    assert Path(summary["report"]).read_text().startswith("<!doctype html>")
    code, said, told = trecsim("study", "--out", out, "--jobs", 1)
    assert code == 0
    assert "36 runs are already there, 0 are missing" in told
    assert "joint_sigma_m" in said
    (out / "report.html").unlink()
    assert trecsim("study", "--out", out, "--report-only")[0] == 0
    assert (out / "report.html").exists()


def test_reporting_seeds_are_refused_unless_asked_for(
    trecsim: Command, quick: None, tmp_path: Path
) -> None:
    arguments = (
        "study", "--set", "joint_sigma_m=0.01,0.02", "--seeds", "1000-1005", "--jobs", 1,
        "--out", tmp_path,
    )  # fmt: skip
    code, said, told = trecsim(*arguments)
    assert (code, said) == (2, "")
    assert "seed 1000 is kept for reporting" in told
    assert list(tmp_path.iterdir()) == []
    code, said, _ = trecsim(*arguments, "--reporting", "--json")
    assert code == 0
    assert json.loads(said)["reporting"]
    assert "for reporting: nothing was chosen by them" in (tmp_path / "report.html").read_text()


BAD = {
    "nothing to try": ([], "give a study file, or settings to vary"),
    "a file that is not there": (["none.toml"], "none.toml"),
    "a setting that is not there": (["--set", "knots=1,2"], "knots.*did you mean"),
    "a value that cannot be": (["--set", "knot_s=0.1,-1"], "knot_s = -1.0: knot_s must be"),
    "both a file and options": (["a.toml", "--set", "knot_s=0.1,0.2"], "not both"),
    "options without settings": (["--seeds", "1"], "--seeds belongs to"),
    "a room that cannot be": (
        ["--set", "knot_s=0.1,0.2", "--scene", "room:people=none"], "people.*'none'",
    ),
    "a key that a room has not": (
        ["--set", "knot_s=0.1,0.2", "--scene", "room:persons=3"],
        "unknown key 'persons'; did you mean 'people'\\?",
    ),
    "a misspelt key of a room": (
        ["--set", "knot_s=0.1,0.2", "--scene", "room:camera=3"], "did you mean 'cameras'",
    ),
    "a scene nobody knows": (["--set", "knot_s=0.1,0.2", "--scene", "moon"], "moon"),
    "no processes": (["--set", "knot_s=0.1,0.2", "--jobs", "0"], "--jobs 0"),
    "no runs to report on": (["--set", "knot_s=0.1,0.2", "--report-only"], "no finished runs"),
}  # fmt: skip


@pytest.mark.parametrize(("arguments", "message"), BAD.values(), ids=BAD.keys())
def test_what_cannot_be_is_told_before_anything_runs(
    trecsim: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    arguments: list[str], message: str,
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    code, said, told = trecsim("study", *arguments)
    assert (code, said) == (2, "")
    assert told.startswith("trecsim: ")
    assert re.search(message, told), told
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("package", ["matplotlib", "jinja2"])
def test_a_report_that_cannot_be_written_is_told_before_any_run(
    trecsim: Command, quick: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, package: str
) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    code, said, told = trecsim("study", "--set", "knot_s=0.1,0.2", "--out", tmp_path, "--jobs", 1)
    assert (code, said) == (1, "")
    assert "[report]" in told
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("seeds", "warned"), [("1-2", True), ("1-5", False)])
def test_few_seeds_are_warned_of_in_terminal_and_report(
    trecsim: Command, quick: None, tmp_path: Path, seeds: str, warned: bool
) -> None:
    code, said, _ = trecsim(
        "study", "--set", "joint_sigma_m=0.01,0.02", "--seeds", seeds, "--out", tmp_path,
        "--jobs", 1,
    )  # fmt: skip
    assert code == 0
    assert "rank of the default" in said.splitlines()[0]
    for text in (said, (tmp_path / "report.html").read_text()):
        assert ("only 2 seeds: use at least 5" in text) == warned


def test_ctrl_c_says_how_to_go_on(
    trecsim: Command, quick: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stop(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(running, "_outcome", stop)
    code, said, told = trecsim(
        "study", "--set", "knot_s=0.1,0.2", "--seeds", "1", "--out", tmp_path, "--jobs", 1
    )
    assert (code, said) == (1, "")
    assert "the same command continues" in told
