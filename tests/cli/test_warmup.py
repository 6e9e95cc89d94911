"""`trecsim warmup` compiles the kernels and says where they are."""

import json
from pathlib import Path

import pytest

from trecsim import cli
from trecsim.cli import warmup_command
from trecsim.errors import SetupError
from trecsim.fusion.warmup import COUNT


def test_it_says_how_many_kernels_are_kept_and_where(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match="0"):
        cli.main(["warmup", "--json"])
    told = json.loads(capsys.readouterr().out)
    assert told["kernels"] == len(list(Path(told["folder"]).glob("*.nbc"))) >= COUNT


def test_it_fails_where_nothing_can_be_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("trecsim.compiler.cache_folder", lambda sources: None)
    with pytest.raises(SetupError, match="set NUMBA_CACHE_DIR"):
        warmup_command.warmup()


def test_it_says_that_the_compiler_is_off(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("numba.core.config.DISABLE_JIT", 1)
    with pytest.raises(SetupError, match="NUMBA_DISABLE_JIT is set"):
        warmup_command.warmup()
