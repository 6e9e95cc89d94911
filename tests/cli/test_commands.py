"""The commands around a run, from the outside."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from made_site import make_site
from trecsim.cli import run_command
from trecsim.sites import site_schema
from trecsim.store.tracks import read_tracks

Command = Callable[..., tuple[int, str, str]]


@pytest.fixture
def site(tmp_path: Path) -> Path:
    return make_site(tmp_path)


@pytest.fixture
def without_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Draw nothing, which takes longer than all the rest."""
    monkeypatch.setattr(run_command, "_draw_paths", lambda *_: None)


def test_run_tells_what_it_kept_and_where(trecsim: Command, site: Path, tmp_path: Path) -> None:
    code, out, err = trecsim("run", site, "--out", tmp_path / "out", "--json")
    summary = json.loads(out)
    assert (code, err) == (0, "")
    assert (summary["frame_sets"], summary["people"], summary["ended"]) == (40, 1, "complete")
    assert Path(summary["out"]) == tmp_path / "out"
    assert set(summary["fusion_ms"]) == {"median", "p95", "max", "mean"}


@pytest.mark.usefixtures("without_pictures")
def test_run_says_it_in_words_too(trecsim: Command, site: Path, tmp_path: Path) -> None:
    code, out, err = trecsim("run", site, "--out", tmp_path / "out")
    assert (code, err) == (0, "")
    assert "1 person in 40 frame sets of 120 images" in out


@pytest.mark.usefixtures("without_pictures")
def test_a_run_can_be_exported(trecsim: Command, site: Path, tmp_path: Path) -> None:
    trecsim("run", site, "--out", tmp_path / "out")
    code, out, _ = trecsim("export", tmp_path / "out", tmp_path / "t.csv", "--json")
    summary = json.loads(out)
    assert code == 0
    assert summary["moments"] == len(list(read_tracks(tmp_path / "t.csv")))
    assert summary["rows"] == 17 * summary["moments"]


def test_a_good_site_is_called_good(trecsim: Command, site: Path) -> None:
    code, out, err = trecsim("site", "check", site)
    assert (code, err) == (0, "")
    assert "site.toml: good (3 cameras" in out
    code, out, _ = trecsim("site", "check", site, "--json")
    assert json.loads(out)["cameras"] == ["cam0", "cam1", "cam2"]


@pytest.mark.parametrize("option", [[], ["--json"]])
def test_the_schema_is_json(trecsim: Command, option: list[str]) -> None:
    code, out, _ = trecsim("site", "schema", *option)
    assert code == 0
    assert json.loads(out) == json.loads(json.dumps(site_schema()))
    assert (out.count("\n") == 1) is bool(option)
