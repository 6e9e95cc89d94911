"""The doctor finds what is missing and never stumbles over it."""

import importlib
import json
from collections.abc import Callable, Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from trecsim import cli, doctor
from trecsim.doctor import Finding, examine


@pytest.fixture
def without(monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """Return a function that makes packages impossible to import."""
    real = importlib.import_module

    def hide(*packages: str) -> None:
        def importing(name: str, *rest: Any) -> ModuleType:
            if name.partition(".")[0] in packages:
                raise ImportError(f"No module named {name!r}")
            return real(name, *rest)

        monkeypatch.setattr(doctor, "import_module", importing)

    return hide


def by_name() -> Mapping[str, Finding]:
    return {found.name: found for found in examine()}


def test_a_machine_that_runs_the_tests_is_healthy() -> None:
    essential = [found for found in examine() if found.essential]
    assert len(essential) >= 5
    assert {found.state for found in essential} == {"ok"}


def test_whatever_is_not_well_comes_with_a_remedy(without: Callable[..., None]) -> None:
    without("av", "openvino", "pyarrow", "trecsim")
    found = by_name()
    assert found["video (PyAV)"].state == "missing"
    assert "[video]" in found["video (PyAV)"].remedy
    assert found["default estimator (OpenVINO)"].state == "missing"
    assert found["compiled kernels"].state == "broken"
    assert all(one.remedy for one in found.values() if one.state != "ok")


def test_the_exit_code_is_1_only_when_something_essential_is_broken(
    without: Callable[..., None], capsys: pytest.CaptureFixture[str]
) -> None:
    without("av")
    with pytest.raises(SystemExit, match="0"):
        cli.main(["doctor", "--json"])
    assert json.loads(capsys.readouterr().out)["healthy"] is True
    without("pyarrow")
    with pytest.raises(SystemExit, match="1"):
        cli.main(["doctor", "--json"])
    output = capsys.readouterr()
    assert json.loads(output.out)["healthy"] is False
    assert output.err == "trecsim: trecsim cannot work without: pyarrow\n"


def test_a_model_that_is_not_here_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TRECSIM_MODELS", str(tmp_path))
    assert "trecsim models pull movenet" in by_name()["model movenet"].remedy


def test_a_processor_without_a_list_of_features_is_no_fault(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def missing(*_: object, **__: object) -> str:
        raise FileNotFoundError

    monkeypatch.setattr(Path, "read_text", missing)
    assert "features not known" in doctor._processor().text


def test_a_nearly_full_disk_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doctor, "_LEAST_FREE_BYTES", 10**18)
    assert by_name()["disk"].state == "broken"
