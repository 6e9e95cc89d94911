"""The command that installs an optional extra is the right one for this installation."""

import json
import sys
import tomllib
from importlib.metadata import PackageNotFoundError
from pathlib import Path

import pytest

from trecsim import extras
from trecsim.extras import EXTRAS, has_extra, install_command


class Installed:
    def __init__(self, direct_url: str | None) -> None:
        self.direct_url = direct_url

    def read_text(self, name: str) -> str | None:
        return self.direct_url if name == "direct_url.json" else None


def direct_url(folder: Path, *, editable: bool) -> str:
    return json.dumps({"url": folder.as_uri(), "dir_info": {"editable": editable}})


@pytest.fixture
def pip_on_the_path(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(extras, "which", lambda name: str(Path(sys.executable).parent / name))


@pytest.mark.usefixtures("pip_on_the_path")
def test_each_kind_of_installation_has_its_command(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    clone = tmp_path / "my clone"
    clone.mkdir()
    for text, command in (
        (None, "pip install 'mc3d-trecsim[plot]'"),
        (direct_url(clone, editable=True), f"pip install -e '{clone}[plot]'"),
        (direct_url(clone, editable=False), f"pip install '{clone}[plot]'"),
        (direct_url(tmp_path / "gone", editable=True), "pip install 'mc3d-trecsim[plot]'"),
        ('{"url": "https://example.org/a.whl"}', "pip install 'mc3d-trecsim[plot]'"),
    ):
        monkeypatch.setattr(extras, "distribution", lambda _, text=text: Installed(text))
        assert install_command("plot") == command


@pytest.mark.usefixtures("pip_on_the_path")
def test_sources_that_are_not_installed_name_the_package(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(name: str) -> None:
        raise PackageNotFoundError(name)

    monkeypatch.setattr(extras, "distribution", missing)
    assert install_command("video") == "pip install 'mc3d-trecsim[video]'"


@pytest.mark.parametrize("found", [None, "/usr/bin/pip"])
def test_the_pip_of_another_python_is_not_advised(
    found: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(extras, "which", lambda name: found)
    assert install_command("plot").startswith(f"{sys.executable} -m pip install ")


def test_an_extra_counts_only_when_all_of_its_modules_are_installed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(extras, "find_spec", lambda name: None if name == "jinja2" else object())
    assert has_extra("plot")
    assert not has_extra("report")


def test_the_extras_are_those_of_the_package() -> None:
    project = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text())["project"]
    for_users = set(project["optional-dependencies"]) - {"all", "test", "check", "docs"}
    assert for_users >= set(EXTRAS)
