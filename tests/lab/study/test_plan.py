"""Study files and options: what can be run, and one clear message for what cannot."""

import re
from pathlib import Path

import pytest

from trecsim.errors import ConfigError
from trecsim.fusion import FusionSettings
from trecsim.lab.simulation.scene_file import built_in_text
from trecsim.lab.study.cli_table import scenes_table, settings_table
from trecsim.lab.study.plan import Study, check_seeds, parse_seeds, planned, settings_of
from trecsim.lab.study.settings_file_table import StudyTable, read_study_table, toml_of

GOOD = """
format = "trecsim.study/1"
design = "grid"
lag_s = 0.2
seeds = "100-102,110"
[settings]
knot_s = [0.08, 0.1]
joint_sigma_m = { low = 0.01, high = 0.04, steps = 3, log = true }
min_joints = [4, 5]
[scenes]
small = { people = 1, cameras = 2, seconds = 1.5 }
narrow = { scene = "crossing-30cm" }
"""


def study_of(tmp_path: Path, text: str = GOOD) -> Study:
    path = tmp_path / "study.toml"
    path.write_text(text)
    return planned(read_study_table(path), str(path))


def test_a_study_file_says_what_is_run(tmp_path: Path) -> None:
    study = study_of(tmp_path)
    assert study.seeds == (100, 101, 102, 110)
    assert len(study.design.points) == 12
    assert study.runs == 12 * 4 * 2
    assert (0.08, 0.02, 5) in study.design.points
    assert settings_of(study.design, (0.08, 0.02, 4)) == FusionSettings(knot_s=0.08, min_joints=4)


def test_scene_files_and_folders_lie_beside_the_study_file(tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_text(built_in_text("one-person"))
    text = GOOD.replace("crossing-30cm", "mine.toml")
    assert study_of(tmp_path, text).scenes[1].source == str(tmp_path / "mine.toml")


def test_a_scene_is_another_one_when_a_clip_that_it_plays_is(tmp_path: Path) -> None:
    scene = """
format = "trecsim.scene/1"
seconds = 2
rig.pattern = "corners"
[[people]]
start_m = [0, 0]
actions = [{ do = "clip", path = "walk.npz" }]
"""
    (tmp_path / "mine.toml").write_text(scene)
    facts = []
    for content in (b"one", b"other", b"one"):
        (tmp_path / "walk.npz").write_bytes(content)
        facts.append(_scene_of(study_of(tmp_path, GOOD.replace("crossing-30cm", "mine.toml"))))
    assert facts[0] == facts[2] != facts[1]
    (tmp_path / "walk.npz").unlink()
    with pytest.raises(ConfigError, match=r"cannot read .*walk\.npz"):
        study_of(tmp_path, GOOD.replace("crossing-30cm", "mine.toml"))


def _scene_of(study: Study) -> object:
    return study.scenes[1].facts["scene"]


def test_a_study_written_down_is_the_same_study(tmp_path: Path) -> None:
    study = study_of(tmp_path)
    assert study_of(tmp_path, toml_of(study.table)).table == study.table


def test_the_command_line_says_the_same_as_a_file(tmp_path: Path) -> None:
    given = StudyTable.model_validate({
        "format": "trecsim.study/1",
        "lag_s": 0.2,
        "seeds": "100-102,110",
        "settings": settings_table(
            ["knot_s=0.08,0.1", "joint_sigma_m=0.01:0.04:3log", "min_joints=4,5"]
        ),
        "scenes": scenes_table(
            ["small=room:people=1,cameras=2,seconds=1.5", "narrow=crossing-30cm"]
        ),
    })  # fmt: skip
    assert planned(given, "x").design == study_of(tmp_path).design
    assert given == study_of(tmp_path).table


HOSTILE = {
    "no setting of that name": ("knot_s", "knots_s", r"knots_s.*did you mean 'knot_s'"),
    "a value that cannot be": (r"\[0.08, 0.1\]", "[0.1, -1.0]", r"knot_s = -1.0: knot_s must be"),
    "values that do not fit together": (
        r"\[0.08, 0.1\]", "[0.1, 0.3]", r"knot_s = 0.3: window_s must span at least two knots",
    ),
    "text for a number": (r"\[0.08, 0.1\]", '["0.1", 0.2]', r"knot_s.*numbers, found '0.1'"),
    "a fraction for a whole number": (r"\[4, 5\]", "[4.5, 5]", r"min_joints.*whole.*4\.5"),
    "a truth for a number": (r"\[0.08, 0.1\]", "[true, 0.1]", r"knot_s.*found True"),
    "one value": (r"\[0.08, 0.1\]", "[0.1]", r"line 7.*knot_s.*more values"),
    "one value twice": (r"\[0.08, 0.1\]", "[0.1, 0.1]", r"knot_s.*two different values"),
    "not a number": (r"\[0.08, 0.1\]", "[0.1, nan]", r"knot_s = nan"),
    "infinity": (r"\[0.08, 0.1\]", "[0.1, inf]", r"knot_s = inf"),
    "a huge number": (r"\[0.08, 0.1\]", f"[0.1, {'9' * 400}]", r"knot_s = inf"),
    "no steps": (r"steps = 3, ", "", r"joint_sigma_m: steps is missing"),
    "too many steps": (r"steps = 3", "steps = 1000000", r"line 8.*steps"),
    "a range upside down": (r"low = 0.01", "low = 0.5", r"low must lie below high"),
    "factors from below nothing": (r"low = 0.01", "low = -0.01", r"above 0, found -0.01"),
    "too many runs": (r"100-102,110", "0-9999", r"runs, more than|seeds"),
    "seeds that are none": (r"100-102,110", "ten", r"seeds.*'ten'"),
    "seeds backwards": (r"100-102,110", "9-3", r"seeds.*'9-3'"),
    "seeds without end": (r"100-102,110", "0-99999999999", r"at most 10000 seeds"),
    "negative seeds": (r"100-102,110", "-5", r"seeds.*'-5'"),
    "another format": (r"study/1", "study/9", r"line 2.*format"),
    "another design": (r'"grid"', '"magic"', r"line 3.*grid"),
    "a design without points": (r'"grid"', '"random"', r"points: the random design needs"),
    "an earlier name": (r"knot_s", "doubt_s", r"doubt_s: renamed to single_view_death_s"),
    "an unknown key": (r"lag_s = 0.2", "lags = 0.2", r"lags.*did you mean 'lag_s'"),
    "a lag that is none": (r"lag_s = 0.2", "lag_s = nan", r"line 4.*lag_s"),
    "an unknown scene": (r"crossing-30cm", "crossing-3cm", r"scenes\.narrow.*crossing-3cm"),
    "a scene of two kinds": (
        r'scene = "cross', 'people = 2, scene = "cross', r"scenes\.narrow.*one of",
    ),
    "a name that leads elsewhere": (r"small =", '"../small" =', r"scenes"),
    "too many people": (r"people = 1", "people = 100000", r"scenes\.small\.people"),
    "more cameras than a scene file": (r"cameras = 2", "cameras = 29", r"scenes\.small\.cameras"),
    "fewer cameras than a scene file": (r"cameras = 2", "cameras = 1", r"scenes\.small\.cameras"),
    "a scene without end": (r"seconds = 1.5", "seconds = 1e9", r"scenes\.small\.seconds"),
    "a folder that is not there": (
        r'scene = "crossing-30cm"', 'folder = "nowhere"', r"scenes\.narrow.*nowhere",
    ),
    "no settings": (r"(?s)\[settings\].*\[scenes\]", "[settings]\n[scenes]", r"settings"),
    "not TOML": (r"\[settings\]", "[[settings", r"TOML"),
}  # fmt: skip


@pytest.mark.parametrize(("pattern", "by", "message"), HOSTILE.values(), ids=HOSTILE.keys())
def test_a_hostile_study_file(tmp_path: Path, pattern: str, by: str, message: str) -> None:
    text = re.sub(pattern, by, GOOD, count=1)
    assert text != GOOD
    with pytest.raises(ConfigError, match=message) as told:
        study_of(tmp_path, text)
    assert str(told.value).startswith(str(tmp_path / "study.toml"))
    assert len(str(told.value)) < 1500


def test_all_wrong_settings_are_told_at_once(tmp_path: Path) -> None:
    text = GOOD.replace("knot_s", "knots").replace("[4, 5]", "[4.5, 5]")
    with pytest.raises(ConfigError, match=r"2 faults\n.*knots.*\n.*min_joints"):
        study_of(tmp_path, text)


@pytest.mark.parametrize(
    "given", ["knot_s", "=3", "knot_s=", "knot_s=1:2:3:4", "knot_s=a:b:3", "knot_s=0.1:0.2:x"]
)
def test_what_set_cannot_read_is_told(given: str) -> None:
    with pytest.raises(ConfigError, match=r"--set .*expected"):
        settings_table([given])


def test_one_name_cannot_stand_for_two_things() -> None:
    with pytest.raises(ConfigError, match="twice"):
        settings_table(["knot_s=1,2", "knot_s=3,4"])
    with pytest.raises(ConfigError, match="--scene other=room"):
        scenes_table(["room:people=1", "room:people=2"])


def test_seeds_are_read_once_each_in_order() -> None:
    assert parse_seeds("5, 1-3,2", "x") == (1, 2, 3, 5)


def test_tuning_does_not_touch_the_seeds_for_reporting(tmp_path: Path) -> None:
    check_seeds(study_of(tmp_path), reporting=False)
    late = study_of(tmp_path, GOOD.replace("110", "1000"))
    with pytest.raises(ConfigError, match=r"seed 1000 is kept for reporting.*--reporting"):
        check_seeds(late, reporting=False)
    with pytest.raises(ConfigError, match="seed 100 may have been tuned on"):
        check_seeds(late, reporting=True)
    check_seeds(study_of(tmp_path, GOOD.replace("100-102,110", "1000-1001")), reporting=True)
