"""The command `trecsim simulate`."""

import json
import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest

from trecsim.lab.simulation import BUILT_IN, read_scene, scene_file

Run = Callable[..., tuple[int, str, str]]


def test_a_built_in_scene_becomes_files_with_its_rules_and_true_events(
    trecsim: Run, tmp_path: Path
) -> None:
    out = tmp_path / "made"
    code, told, err = trecsim("simulate", "crossing-50cm", "--out", out, "--seconds", 2)
    assert (code, err) == (0, "")
    assert told == f"{out}: 80 images of 2 cameras, 2 people, 2 s, seed 0, 9 true events\n"
    assert sorted(path.name for path in out.iterdir()) == [
        "poses.jsonl", "rig.toml", "site.toml", "truth-events.jsonl", "truth.npz",
    ]  # fmt: skip
    code, told, err = trecsim("simulate", "crossing-50cm", "--out", out)
    assert (code, told) == (2, "")
    assert "is not empty" in err


def test_true_events_may_be_those_of_other_rules(trecsim: Run, tmp_path: Path) -> None:
    site, out = tmp_path / "site.toml", tmp_path / "made"
    text = 'format = "trecsim.site/1"\nname = "mine"\n[[rules]]\nid = "a"\nkind = "speed.running"\n'
    site.write_text(text + "speed_mps = 0.5\n")
    asked = ("simulate", "one-person", "--seconds", 5, "--json", "--site", site, "--out", out)
    code, told, err = trecsim(*asked)
    assert (code, err, json.loads(told)["events"]) == (0, "", 1)
    assert (out / "site.toml").read_text() == site.read_text()
    site.write_text(text + "cooldown_s = 2.0\n")
    code, told, err = trecsim(*asked[:-1], tmp_path / "other")
    assert (code, json.loads(told)["events"]) == (0, 0)
    assert "there is no truth for the rules a" in err
    site.write_text(text + "speed = 1.0\n")
    code, told, err = trecsim(*asked[:-1], tmp_path / "wrong")
    assert (code, told) == (2, "")
    assert "speed_mps" in err
    assert not (tmp_path / "wrong").exists()


def test_the_seed_and_the_length_may_be_given(trecsim: Run, tmp_path: Path) -> None:
    asked = ("simulate", "one-person", "--seconds", 1.5, "--seed", 9, "--json", "--out")
    code, told, err = trecsim(*asked, tmp_path)
    facts = json.loads(told)
    assert (code, err) == (0, "")
    assert (facts["seed"], facts["seconds"], facts["scene"]) == (9, 1.5, "one-person")
    assert (facts["cameras"], facts["people"], facts["images"]) == (2, 1, 60)


def test_the_detector_may_be_given_by_its_preset(trecsim: Run, tmp_path: Path) -> None:
    key_points = {}
    for preset in ("real", "clothed", "perfect"):
        asked = ("simulate", "one-person", "--seconds", 1, "--detector", preset)
        assert trecsim(*asked, "--out", tmp_path / preset)[0] == 0
        key_points[preset] = (tmp_path / preset / "poses.jsonl").read_text()
    assert trecsim("simulate", "one-person", "--seconds", 1, "--out", tmp_path / "own")[0] == 0
    assert (tmp_path / "own" / "poses.jsonl").read_text() == key_points["real"]
    assert len(set(key_points.values())) == 3
    code, _, err = trecsim("simulate", "one-person", "--detector", "good")
    assert code == 2
    assert "clothed" in err


def test_without_a_directory_the_scene_names_it(
    trecsim: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert trecsim("simulate", "one-person", "--seconds", 1)[0] == 0
    assert (tmp_path / "simulated" / "one-person" / "truth.npz").exists()


def test_a_shown_scene_can_be_simulated_as_ones_own(trecsim: Run, tmp_path: Path) -> None:
    code, told, _ = trecsim("simulate", "--show", "camera-knocked")
    assert code == 0
    assert tomllib.loads(told)["cameras"]["cam3"]["knock"]["t_s"] > 0
    (tmp_path / "mine.toml").write_text(told)
    code, told, _ = trecsim(
        "simulate", tmp_path / "mine.toml", "--seconds", 1, "--out", tmp_path / "a"
    )
    assert code == 0
    assert "100 images of 4 cameras" in told


def test_the_list_has_a_line_and_a_picture_of_each_scene(
    trecsim: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    chapters = dict([*scene_file.CHAPTERS.items()][1::3])  # all of them take long
    monkeypatch.setattr(scene_file, "CHAPTERS", chapters)
    names = [name for some in chapters.values() for name in some]
    code, told, err = trecsim("simulate", "--list")
    assert (code, err) == (0, "")
    places = [told.index(f"  {name}: {len(read_scene(name).rig)} cameras") for name in names]
    assert places == sorted(places)
    for name, here, following in zip(names, places, [*places[1:], len(told)], strict=True):
        part = told[here:following]
        assert read_scene(name).about in part
        assert any("⠀" < character <= "⣿" or character == "o" for character in part), name


def test_names_are_a_line_for_each_scene(trecsim: Run) -> None:
    code, told, err = trecsim("simulate", "--names")
    assert (code, err) == (0, "")
    lines = told.splitlines()
    assert [line.split()[0] for line in lines if line.startswith("  ")] == list(BUILT_IN)
    assert len(lines) < 45
    assert "  gate               " in told


def test_the_list_is_whole_as_json(trecsim: Run) -> None:
    code, told, err = trecsim("simulate", "--list", "--json")
    assert (code, err) == (0, "")
    assert [scene["name"] for scene in json.loads(told)["scenes"]] == list(BUILT_IN)


def test_a_scene_can_be_drawn(trecsim: Run, tmp_path: Path) -> None:
    code, told, _ = trecsim("simulate", "gate", "--pictures", tmp_path / "plans")
    assert (code, told) == (0, f"{tmp_path / 'plans' / 'gate.png'}\n")
    assert (tmp_path / "plans" / "gate.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((), "expected one of: a SCENE to simulate"),
        (("hall", "--list"), "expected one of"),
        (("--list", "--show", "hall"), "expected one of"),
        (("hal",), "did you mean 'hall'?"),
        (("--show", "hal"), "did you mean 'hall'?"),
        (("hall", "--seconds", "-1"), "a scene needs a positive length"),
        (("hall", "--seconds", "nan"), "a scene needs a positive length"),
        (("hall", "--seconds", "20000"), "make the scene shorter"),
        (("hall", "--seed=-1"), "a seed is a whole number from 0"),
    ],
)
def test_what_cannot_be_is_one_line(
    trecsim: Run, tmp_path: Path, arguments: tuple[str, ...], message: str
) -> None:
    out = ("--out", tmp_path / "made") if arguments[:1] == ("hall",) else ()
    code, told, err = trecsim("simulate", *arguments, *out)
    assert (code, told) == (2, "")
    assert message in err
    assert err.count("\n") == 1
    assert not (tmp_path / "made").exists()
