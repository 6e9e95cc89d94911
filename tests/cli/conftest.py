"""Fixtures for tests of commands."""

from collections.abc import Callable

import pytest

from trecsim import cli, doctor


@pytest.fixture(autouse=True)
def _compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let no command tell of a first run: whether it is one depends on the machine."""
    monkeypatch.setattr(doctor, "kernels_are_cached", lambda: True)


@pytest.fixture
def trecsim(capsys: pytest.CaptureFixture[str]) -> Callable[..., tuple[int, str, str]]:
    """Return a function that runs the command and returns exit code, stdout and stderr."""

    def run(*arguments: object) -> tuple[int, str, str]:
        with pytest.raises(SystemExit) as ended:
            cli.main([str(argument) for argument in arguments])
        output = capsys.readouterr()
        return int(str(ended.value.code)), output.out, output.err

    return run
