"""The file of finished runs survives what happens to files."""

import json
import math
from pathlib import Path

import pytest

from trecsim.errors import InputError
from trecsim.lab.study.runs_file import Run, opened, read_runs

FIGURES = {
    "mean_m": 0.03, "recall_15cm": 0.9, "switches": 1.0, "missed": 2.0, "ghosts": 0.0,
    "person_frames": 100.0, "fusion_ms": 2.5,
}  # fmt: skip


def run(key: str, **changed: object) -> Run:
    return Run(
        key, "code", "room", 100, {"knot_s": 0.1}, {**FIGURES, **changed},  # type: ignore[arg-type]
    )  # fmt: skip


def write(path: Path, *runs: Run) -> None:
    with opened(path) as ledger:
        for one in runs:
            ledger.append(one)


def test_what_was_written_is_read_again(tmp_path: Path) -> None:
    failed = Run("c", "code", "folder", None, {"knot_s": 9.0}, {}, "no people")
    write(tmp_path / "runs.jsonl", run("a"), run("b", mean_m=math.nan), failed)
    first, second, third = read_runs(tmp_path / "runs.jsonl")
    assert first == run("a")
    assert math.isnan(second.figures["mean_m"])
    assert third == failed


def test_no_file_has_no_runs(tmp_path: Path) -> None:
    assert read_runs(tmp_path / "runs.jsonl") == []


@pytest.mark.parametrize("kept", [1, 30, -1])
def test_a_torn_last_line_is_left_out_and_cut_off(tmp_path: Path, kept: int) -> None:
    path = tmp_path / "runs.jsonl"
    write(path, run("a"), run("b"))
    whole = path.read_bytes()
    start = whole.index(b"\n") + 1
    path.write_bytes(whole[:start] + whole[start:][:kept])
    assert read_runs(path) == [run("a")]
    write(path, run("c"))
    assert [one.key for one in read_runs(path)] == ["a", "c"]
    assert all(json.loads(line) for line in path.read_text().splitlines())


def test_a_torn_first_line_leaves_nothing(tmp_path: Path) -> None:
    path = tmp_path / "runs.jsonl"
    path.write_bytes(b"x" * 200_000)
    assert read_runs(path) == []
    write(path, run("a"))
    assert read_runs(path) == [run("a")]


def test_the_last_of_several_runs_of_one_key_counts(tmp_path: Path) -> None:
    path = tmp_path / "runs.jsonl"
    write(path, Run("a", "code", "room", 100, {}, {}, "disk"), run("b"), run("a"))
    assert read_runs(path) == [run("a"), run("b")]


DAMAGED = ["nonsense", "[]", "{}", "1", '{"key": 1}', "[" * 100_000, "\x00", '{"seed": "x"}']


@pytest.mark.parametrize("line", DAMAGED, ids=lambda line: line[:10])
def test_a_damaged_line_in_the_middle_is_told_with_its_number(tmp_path: Path, line: str) -> None:
    path = tmp_path / "runs.jsonl"
    write(path, run("a"))
    path.write_text(path.read_text() + line + "\n" + path.read_text())
    with pytest.raises(InputError, match="line 2 is not a run"):
        read_runs(path)


def test_two_studies_cannot_write_to_one_folder(tmp_path: Path) -> None:
    pytest.importorskip("fcntl")
    path = tmp_path / "runs.jsonl"
    with opened(path), pytest.raises(InputError, match="in use by another study"), opened(path):
        pass
