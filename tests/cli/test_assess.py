"""`trecsim assess` as a user calls it."""

import json
from pathlib import Path
from typing import Any

import pytest

import trecsim
from made_paths import PLACES, bodies_on, line, moments, times
from trecsim.cli import main
from trecsim.store.tracks import tracks_writer

RULES = """
[[rules]]
id = "strip"
kind = "zone.enter"
zone = "room"
schedule = ["Mo-Su 22:00-06:00"]
[[rules]]
id = "count"
kind = "line.cross"
line = "gate"
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a folder with a site file, and the same tracks as CSV and as Parquet."""
    t_s = times(6.0)
    snapshots = moments([bodies_on(line((-2.0, 0.0), (1.2, 0.0)), t_s)], t_s)
    for name in ("tracks.csv", "tracks.parquet"):
        with tracks_writer(tmp_path / name) as writer:
            for one in snapshots:
                writer.write(one)
    (tmp_path / "site.toml").write_text(PLACES + RULES)
    return tmp_path


def called(*arguments: str | Path) -> int:
    with pytest.raises(SystemExit) as ended:
        main(["assess", *map(str, arguments)])
    return int(ended.value.code or 0)


def events_in(path: Path) -> list[dict[str, Any]]:
    return [json.loads(line) for line in path.read_text().splitlines()]


def test_tracks_in_csv_and_parquet_give_the_same_bytes_every_time(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    written = []
    for name in ("tracks.csv", "tracks.parquet", "tracks.csv"):
        out = folder / f"{len(written)}.jsonl"
        assert called(folder / name, folder / "site.toml", "--out", out, "--json") == 0
        written.append(out.read_bytes())
    assert written[0] == written[1] == written[2]
    summary = json.loads(capsys.readouterr().out.splitlines()[0])
    assert (summary["events"], summary["episodes"], summary["people"]) == (3, 2, 1)
    assert summary["by_rule"] == {"strip": 1, "count": 1}
    assert [one["data"]["phase"] for one in events_in(folder / "0.jsonl")] == ["new", "new", "end"]


def test_the_function_says_the_same_as_the_command(folder: Path) -> None:
    summary = trecsim.assess(folder / "tracks.csv", folder / "site.toml", folder / "a.jsonl")
    assert called(folder / "tracks.csv", folder / "site.toml", "--out", folder / "b.jsonl") == 0
    assert (folder / "a.jsonl").read_bytes() == (folder / "b.jsonl").read_bytes()
    assert summary["moments"] == 150


def test_a_date_makes_schedules_apply_and_without_one_that_is_said(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    given = (folder / "tracks.csv", folder / "site.toml", "--out", folder / "e.jsonl")
    assert called(*given) == 0
    assert "schedules do not apply and their rules are always armed (strip)" in (
        capsys.readouterr().err
    )
    assert called(*given, "--start", "2026-01-31T12:00") == 0
    assert capsys.readouterr().err == ""
    assert {one["subject"] for one in events_in(folder / "e.jsonl")} == {"rule/count"}
    assert called(*given, "--start", "2026-01-31T23:00") == 0
    assert len(events_in(folder / "e.jsonl")) == 3


def test_what_a_rule_asks_for_and_does_not_get_is_said(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "early.toml").write_text(PLACES + RULES + "early_s = 2.0\n")
    assert called(folder / "tracks.csv", folder / "early.toml", "--out", folder / "e.jsonl") == 0
    assert "rule count: early_s has no effect" in capsys.readouterr().err
    (folder / "none.toml").write_text(PLACES)
    assert called(folder / "tracks.csv", folder / "none.toml", "--out", folder / "e.jsonl") == 0
    assert "there are no [[rules]]" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("tracks.csv", "nothing.toml"), "cannot read the site file"),
        (("nothing.csv", "site.toml"), "there are no tracks at"),
        (("tracks.csv", "site.toml", "--start", "noon"), "expected a date and time"),
        (("tracks.csv", "wrong.toml"), "did you mean 'room'"),
        (("tracks.csv", "site.toml", "--out", "no/where/e.jsonl"), "no/where"),
    ],
)
def test_wrong_input_is_one_line_and_exit_code_2(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str],
    arguments: tuple[str, ...], said: str,
) -> None:  # fmt: skip
    monkeypatch.chdir(folder)
    (folder / "wrong.toml").write_text((PLACES + RULES).replace('"room"', '"roam"'))
    assert called(*arguments) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1
