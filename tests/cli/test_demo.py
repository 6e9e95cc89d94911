"""The command `trecsim demo`."""

import json
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from trecsim.cli import demo_command
from trecsim.lab.evaluation.ground_truth import compare
from trecsim.lab.packs.pack_files import PACKS
from trecsim.values import Snapshot


def test_the_command_tells_what_came_of_it(
    trecsim: Callable[..., tuple[int, str, str]], tmp_path: Path
) -> None:
    small = ("--seconds", 1, "--people", 1, "--cameras", 2)
    code, out, _ = trecsim("demo", "--out", tmp_path / "a room", *small)
    assert code == 0
    assert out.startswith("page: http://127.0.0.1:")
    assert f"picture: {tmp_path / 'a room' / 'paths.png'}" in out
    assert f"picture: {tmp_path / 'a room' / 'moment.png'}" in out
    assert f"trecsim run '{tmp_path / 'a room' / 'site.toml'}'" in out
    code, out, err = trecsim("demo", "--out", tmp_path / "a room", *small, "--json")
    assert code == 0
    assert err.startswith("page: http://127.0.0.1:")
    facts = json.loads(out)
    assert abs(facts["frame_sets"] - facts["truth"]["frames"]) < 5
    assert facts["frame_sets"] > 20
    assert facts["fusion_ms"]["median"] > 0
    code, out, err = trecsim("demo", "--out", tmp_path, *small)
    assert code == 2
    assert out == ""
    assert "has not made" in err


def test_the_demo_advises_only_what_the_installed_extras_can_do(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def advised(*extras: str) -> str:
        monkeypatch.setattr(demo_command, "has_extra", lambda extra: extra in extras)
        return " ".join(demo_command._next_commands(Path("room")))

    assert "report" not in advised()
    assert "sample" not in advised("report")
    assert "trecsim report room" in advised("report", "video")
    assert "trecsim sample" in advised("report", "video")
    assert "trecsim render room/run room/film.mp4" in advised("render")
    assert "render" not in advised("report", "video")


def test_without_matplotlib_and_opencv_the_demo_says_how_to_get_a_picture(
    trecsim: Callable[..., tuple[int, str, str]],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    monkeypatch.setitem(sys.modules, "cv2", None)
    small = ("--seconds", 1, "--people", 1, "--cameras", 2)
    code, out, _ = trecsim("demo", "--out", tmp_path / "room", *small)
    assert code == 0
    assert "no picture of the paths: it needs Matplotlib: " in out
    assert "[plot]" in out
    assert not list((tmp_path / "room").glob("*.png"))


def test_the_scenario_packs_are_listed_with_what_happens(
    trecsim: Callable[..., tuple[int, str, str]],
) -> None:
    code, out, err = trecsim("demo", "--list")
    assert (code, err) == (0, "")
    assert [line.split()[0] for line in out.splitlines()[:-1]] == list(PACKS)
    code, out, _ = trecsim("demo", "--list", "--json")
    assert [one["name"] for one in json.loads(out)["packs"]] == list(PACKS)


def test_a_demo_of_a_pack_is_a_site_with_its_rules(
    trecsim: Callable[..., tuple[int, str, str]], tmp_path: Path
) -> None:
    code, out, _ = trecsim("demo", "lift", "--out", tmp_path / "lift", "--seconds", 1, "--json")
    assert code == 0
    assert json.loads(out)["people_simulated"] == 9
    site = (tmp_path / "lift" / "site.toml").read_text()
    assert site.startswith("# Made by trecsim demo.")
    assert 'id = "fall-in-strip"' in site
    code, out, _ = trecsim("site", "check", tmp_path / "lift" / "site.toml")
    assert code == 0


def test_a_demo_in_which_nobody_is_tracked_says_so() -> None:
    nobody = np.empty((0, 17, 3))
    empty = Snapshot(0.5, np.empty(0, int), nobody, np.empty((0, 17, 3, 3)), np.empty((0, 17), int))
    truth = compare([empty], np.array([0.0, 1.0]), np.zeros((1, 2, 17, 3)))
    error, *others = demo_command._against_truth(truth)
    assert error == ("joint error", "unknown: nobody was tracked near the truth")
    assert not any("nan" in text for _, text in others)
