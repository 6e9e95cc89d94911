"""What `trecsim run` says while it runs."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from made_site import make_site
from trecsim import pipeline

Command = Callable[..., tuple[int, str, str]]
LINE = r"trecsim: \d+ frame sets, (1 person|0 people) so far; fusion (\d+\.\d\d|nan) ms per set"


@pytest.fixture(autouse=True)
def _at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pipeline, "TELL_EVERY_S", 0.0)


def test_without_a_terminal_it_says_now_and_then_how_far_it_is(
    trecsim: Command, tmp_path: Path
) -> None:
    code, out, err = trecsim("run", make_site(tmp_path), "--out", tmp_path / "out")
    assert code == 0
    lines = err.splitlines()
    assert len(lines) == 120
    assert all(re.match(LINE, line) for line in lines), lines[:3]
    assert out.count("\n") == 1


def test_with_json_it_says_nothing_but_the_summary(trecsim: Command, tmp_path: Path) -> None:
    code, out, err = trecsim("run", make_site(tmp_path), "--out", tmp_path / "out", "--json")
    assert (code, err) == (0, "")
    assert out.startswith("{")
