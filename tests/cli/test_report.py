"""The command `trecsim report`."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from made_recording import make_recording
from trecsim.store.rows import COLUMNS

Command = Callable[..., tuple[int, str, str]]


@pytest.fixture
def walk(tmp_path: Path, blank_figures: None) -> Path:
    return make_recording(tmp_path / "walk", 12)


def test_the_command_writes_a_page_and_sums_it_up(trecsim: Command, walk: Path) -> None:
    code, out, err = trecsim("report", walk, "--out", walk / "r.html", "--json")
    assert (code, err) == (0, "")
    facts = json.loads(out)
    assert facts["out"] == str(walk / "r.html")
    assert facts["bytes"] == (walk / "r.html").stat().st_size
    assert facts["identities"] == 1
    assert facts["sections"][0] == "Summary"


def test_the_page_lies_with_the_recording_unless_told(trecsim: Command, walk: Path) -> None:
    code, out, _ = trecsim("report", walk / "tracks.csv")
    assert code == 0
    assert (walk / "report.html").is_file()
    assert out.startswith(str(walk / "report.html"))


def test_warnings_are_told_on_the_terminal_too(trecsim: Command, walk: Path) -> None:
    (walk / "tracks.csv").write_text(",".join(COLUMNS) + "\n")
    (walk / "summary.json").write_text('{"ended": "stopped"}')
    code, out, _ = trecsim("report", walk, "--out", walk / "r.html")
    assert code == 0
    assert "warning: The run was stopped before its end" in out
    assert "warning: Nobody was tracked" in out


HOSTILE = {
    "tracks.csv": (b"\0\xff" * 1000, "tracks.csv"),
    "rig.toml": (b"[cameras", "rig.toml"),
    "poses.jsonl": (b"{]\n", "poses.jsonl"),
    "truth.npz": (b"PK\3\4 no archive", "truth.npz"),
    "timing.csv": (b"t_s,people\n1,2\n", "timing.csv"),
    "summary.json": (b"[" * 100_000, "summary.json"),
}


@pytest.mark.parametrize(("name", "told"), [(k, v[1]) for k, v in HOSTILE.items()])
def test_a_broken_piece_is_named_in_one_message(
    trecsim: Command, walk: Path, name: str, told: str
) -> None:
    (walk / name).write_bytes(HOSTILE[name][0])
    code, out, err = trecsim("report", walk, "--out", walk / "r.html")
    assert (code, out) == (2, "")
    assert err.startswith("trecsim: ")
    assert err.count("\n") == 1
    assert told in err
    assert not (walk / "r.html").exists()


@pytest.mark.parametrize(
    "arguments",
    [
        ["report", "nothing"],
        ["report", "walk", "--lengths", "nothing.toml"],
        ["report", "walk", "--from-s", "9", "--to-s", "3"],
        ["report", "walk", "--out", "no/such/place.html"],
    ],
)
def test_wrong_arguments_are_told(
    trecsim: Command, walk: Path, arguments: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(walk.parent)
    code, out, err = trecsim(*arguments)
    assert (code, out) == (2, "")
    assert err.count("\n") == 1
