import json
from collections.abc import Callable
from pathlib import Path

import pytest

from trecsim.lab import sample

Command = Callable[..., tuple[int, str, str]]


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[Path]:
    """Return the folders asked for; nothing is fetched."""
    folders: list[Path] = []

    def fetch_sample(folder: Path, progress: object) -> list[Path]:
        folders.append(folder)
        return [folder / "MultiPerson" / "site.toml"]

    monkeypatch.setattr(sample, "fetch_sample", fetch_sample)
    return folders


def test_it_says_whose_the_recording_is_and_how_to_go_on(
    trecsim: Command, asked: list[Path]
) -> None:
    code, out, _ = trecsim("sample", "--out", "there")
    assert code == 0
    assert asked == [Path("there")]
    assert "BSD 3-Clause" in out
    assert "trecsim run there/MultiPerson/site.toml --out multi\n" in out
    assert "trecsim render multi multi.mp4 --site there/MultiPerson/site.toml" in out


def test_the_summary_is_one_json_object(trecsim: Command, asked: list[Path]) -> None:
    summary = json.loads(trecsim("sample", "--json")[1])
    assert summary["sites"] == ["sample/MultiPerson/site.toml"]
    assert "perfanalytics" in summary["notice"]


def test_a_file_in_the_way(trecsim: Command, tmp_path: Path) -> None:
    (tmp_path / "s").write_text("")
    code, _, err = trecsim("sample", "--out", tmp_path / "s")
    assert code == 2
    assert "is a file" in err
