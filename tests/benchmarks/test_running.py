"""Benchmarks run in processes of their own; none takes another down."""

from pathlib import Path

import pytest

from harness import figures, running
from harness.options import Options, parse_override
from made_results import result
from trecsim.errors import ConfigError

GOOD = """
import sys
from harness.command import alone
from harness.figures import Skipped, once

def measure(options):
    "Measure nothing."
    {body}
    return {{"group": {{"figure": once({value}, "cm")}}}}

sys.exit(alone(__file__, measure))
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("PYTHONPATH", str(running.FOLDER))
    for name, body, value in (
        ("good", "pass", 1.0),
        ("worse", "pass", 2.0),
        ("broken", "raise RuntimeError('broken')", 1.0),
        ("absent", "raise Skipped('no data here')", 1.0),
        ("stopped", "raise KeyboardInterrupt", 1.0),
    ):
        (tmp_path / f"{name}.py").write_text(GOOD.format(body=body, value=value))
    return tmp_path


def test_one_that_breaks_does_not_lose_the_others(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = result({"group": {"figure": figures.once(1.0, "cm")}}, "worse")
    figures.store(before, folder / "results" / "worse.json")
    outcome = running.run_all(["broken", "absent", "worse", "good"], [], store=True, folder=folder)
    assert [done.name for done in outcome.done] == ["worse", "good"]
    assert outcome.failed == ["broken"]
    assert outcome.skipped == {"absent": "no data here"}
    (line,) = outcome.worse
    assert line.startswith("worse: group / figure: 1 -> 2 cm")
    assert {path.stem for path in (folder / "results").iterdir()} == {"good", "worse"}
    out = capsys.readouterr().out
    assert "FAILED" in out
    assert "skipped: no data here" in out


def test_after_an_interrupt_what_was_done_is_kept_and_nothing_more_is_begun(folder: Path) -> None:
    outcome = running.run_all(["good", "stopped", "worse"], [], store=True, folder=folder)
    assert outcome.interrupted
    assert [done.name for done in outcome.done] == ["good"]
    assert [path.stem for path in (folder / "results").iterdir()] == ["good"]


def test_a_setting_is_read_as_what_it_is() -> None:
    assert parse_override("knot_s=0.2") == ("knot_s", 0.2)
    assert parse_override("min_joints=7") == ("min_joints", 7)
    assert Options(overrides={"knot_s": 0.2}).settings().knot_s == 0.2


def test_unknown_settings_and_wrong_values_are_refused() -> None:
    with pytest.raises(ValueError, match=r"the settings are .*knot_s"):
        parse_override("nots_s=0.2")
    with pytest.raises(ValueError, match="knot_s"):
        parse_override("knot_s")
    with pytest.raises(ConfigError, match="knot_s"):
        Options(overrides={"knot_s": -1.0}).settings()


def test_quick_seeds_are_among_those_of_the_whole_and_none_is_for_tuning() -> None:
    whole, quick = Options().seeds(20, 5), Options(quick=True).seeds(20, 5)
    assert (len(whole), len(quick)) == (20, 5)
    assert set(quick) < set(whole)
    assert min(whole) >= 1000
