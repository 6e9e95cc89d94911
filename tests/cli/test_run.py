"""What `trecsim run` says while it runs."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from made_site import make_site
from trecsim import run_watch

Command = Callable[..., tuple[int, str, str]]
LINE = (
    r"trecsim: \d+ images, (1 person|0 people) so far; fusion: median \d+\.\d\d ms per frame set, "
    r"95th percentile \d+\.\d\d ms$"
)


@pytest.fixture(autouse=True)
def _at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(run_watch, "TELL_EVERY_S", 0.0)


def test_without_a_terminal_it_says_now_and_then_how_far_it_is(
    trecsim: Command, tmp_path: Path
) -> None:
    code, out, err = trecsim("run", make_site(tmp_path), "--out", tmp_path / "out")
    assert code == 0
    lines = err.splitlines()
    assert len(lines) >= 120  # a line an image, and some while kernels are compiled
    begun = next(number for number, line in enumerate(lines) if "no frame set yet" not in line)
    assert begun < len(lines) - 10
    assert all(re.match(LINE, line) for line in lines[begun:]), lines[:3]
    told, film = out.splitlines()
    assert "1 person in 40 frame sets" in told
    assert film.startswith("a film: trecsim render ")


def test_with_json_it_says_nothing_but_the_summary(trecsim: Command, tmp_path: Path) -> None:
    code, out, err = trecsim("run", make_site(tmp_path), "--out", tmp_path / "out", "--json")
    assert (code, err) == (0, "")
    assert out.startswith("{")


def test_it_draws_the_paths(trecsim: Command, tmp_path: Path) -> None:
    assert trecsim("run", make_site(tmp_path), "--out", tmp_path / "out")[0] == 0
    assert (tmp_path / "out" / "paths.png").stat().st_size > 10_000


def test_without_matplotlib_there_is_no_picture_and_a_remark(
    trecsim: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(__import__("sys").modules, "matplotlib", None)
    code, _, err = trecsim("run", make_site(tmp_path), "--out", tmp_path / "out")
    assert code == 0
    assert "[plot]" in err
    assert not (tmp_path / "out" / "paths.png").exists()
