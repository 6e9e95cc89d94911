"""What commands print, and where."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from trecsim.cli.terminal import finish, note, plain, progress_bar


@dataclass(frozen=True, slots=True)
class Door:
    width_m: float
    place: Path


def test_results_become_plain_json() -> None:
    summary = {
        "array": np.array([1.5, np.nan]),
        "scalar": np.int64(3),
        "door": Door(float("inf"), Path("a/b")),
        1: (True, None, "x"),
        "set": {2},
    }
    assert plain(summary) == {
        "array": [1.5, None],
        "scalar": 3,
        "door": {"width_m": None, "place": str(Path("a/b"))},
        "1": [True, None, "x"],
        "set": [2],
    }


def test_json_is_one_object_on_stdout(capsys: pytest.CaptureFixture[str]) -> None:
    note("on the way")
    finish({"people": 2, "error_m": float("nan")}, True, "two people")
    output = capsys.readouterr()
    assert json.loads(output.out) == {"people": 2, "error_m": None}
    assert output.err == "trecsim: on the way\n"


def test_without_json_the_text_is_on_stdout(capsys: pytest.CaptureFixture[str]) -> None:
    finish({"people": 2}, False, "two people")
    assert capsys.readouterr().out == "two people\n"


def test_a_bar_is_silent_where_stderr_is_no_terminal(capsys: pytest.CaptureFixture[str]) -> None:
    with progress_bar("images", 10) as bar:
        bar.advance(3)
        bar(5, 10)
    assert capsys.readouterr() == ("", "")


@pytest.mark.parametrize("quiet", [False, True])
def test_a_bar_goes_to_a_terminal_unless_it_shall_be_quiet(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, quiet: bool
) -> None:
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    with progress_bar("images", 4, quiet=quiet) as bar:
        bar(2, 4)
        bar.advance(2)
    output = capsys.readouterr()
    assert output.out == ""
    assert ("4/4" in output.err) is not quiet
