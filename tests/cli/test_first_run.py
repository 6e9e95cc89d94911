"""The first run on a machine tells that kernels are compiled, and how far that is."""

from collections.abc import Callable

import pytest

from trecsim import doctor
from trecsim.cli import first_run
from trecsim.fusion import warmup


@pytest.fixture
def cold(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doctor, "kernels_are_cached", lambda: False)

    def warm_up(progress: Callable[[int, int | None], None]) -> None:
        for done in range(1, 9):
            progress(done, 8)

    monkeypatch.setattr(warmup, "warm_up", warm_up)


@pytest.mark.usefixtures("cold")
def test_a_cold_cache_is_told_with_progress_in_four_lines(
    capsys: pytest.CaptureFixture[str],
) -> None:
    first_run.compile_first(quiet=False)
    first, *lines = capsys.readouterr().err.splitlines()
    assert first.startswith("trecsim: first run on this machine")
    assert lines == [f"trecsim: compiling kernels: {done} of 8" for done in (2, 4, 6, 8)]


@pytest.mark.usefixtures("cold")
def test_json_is_told_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    first_run.compile_first(quiet=True)
    assert capsys.readouterr().err == ""


def test_a_warm_cache_is_told_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    first_run.compile_first(quiet=False)
    assert capsys.readouterr().err == ""
