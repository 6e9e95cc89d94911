"""Scene files: what is read, and what is said about a wrong one."""

import re
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

from trecsim.errors import ConfigError, InputError
from trecsim.lab.simulation import BUILT_IN, read_scene, simulate
from trecsim.lab.simulation.actions import Stand, Turn, Walk
from trecsim.lab.simulation.detector_errors import PERFECT, Detector
from trecsim.lab.simulation.people import PeopleGroups, ScriptedPeople, Wanderers
from trecsim.lab.simulation.scene import Scene
from trecsim.lab.simulation.scene_file import scene_schema
from trecsim.lab.simulation.walkers import poses

GOOD = """\
format = "trecsim.scene/1"
about = "A test."
seconds = 5
seed = 7
[rig]
pattern = "ring"
cameras = 3
lens = "brown"
[clock]
fps = 10
start_spread_s = 0.1
[cameras.cam2]
dies_s = 3.0
clock = { fps = 5, dropped = 0.5 }
[cameras.extra]
position_m = [0, 0, 4]
look_at_m = [0, 0, 0]
lens = "pinhole"
knock = { t_s = 1.0, turn_deg = [0, 5, 0] }
[detector]
preset = "perfect"
sigma = 0.01
[[people]]
start_m = [-1, 0]
stature_m = 1.9
actions = [
  { do = "walk", to_m = [1, 0], speed_mps = 1.0 },
  { do = "turn", by_deg = 90 },
]
[[people]]
start_m = [0, 2]
copies = 2
every_s = 1.5
shift_m = [0, 0.5]
actions = [{ do = "stand" }]
[[wanderers]]
people = 2
width_m = 3
depth_m = 3
centre_m = [8, 0]
[[obstacles]]
low_m = [0, -3, 0]
high_m = [1, -2, 2]
"""


def scene_file(folder: Path, text: str | bytes) -> Path:
    path = folder / "test.toml"
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return path


def read(folder: Path, text: str) -> Scene:
    return read_scene(scene_file(folder, text))


def faults(folder: Path, text: str | bytes) -> list[str]:
    with pytest.raises(ConfigError) as caught:
        read_scene(scene_file(folder, text))
    message = str(caught.value)
    assert "test.toml" in message
    return re.findall(r"(line \d+: [^\n]*)", message) or [message]


def test_a_good_file_is_read(tmp_path: Path) -> None:
    scene = read(tmp_path, GOOD)
    assert (scene.name, scene.about, scene.seconds, scene.seed) == ("test", "A test.", 5.0, 7)
    assert scene.rig.names == ("cam1", "cam2", "cam3", "extra")
    assert [camera.distortion_model for camera in scene.rig] == ["brown"] * 3 + ["none"]
    assert [clock.fps for clock in scene.clocks] == [10.0, 5.0, 10.0, 10.0]
    starts_s = [clock.start_s for clock in scene.clocks]
    assert len(set(starts_s)) == 4
    assert max(starts_s) < 0.1
    assert scene.outages[0].camera == "cam2"
    assert scene.knocks[0].turn_deg == (0.0, 5.0, 0.0)
    assert scene.detector.sigma == (0.01,) * 17
    assert scene.detector.missing_person == PERFECT.missing_person
    assert scene.obstacles[0].high_m == (1.0, -2.0, 2.0)


def test_people_are_read_with_what_they_do(tmp_path: Path) -> None:
    people = read(tmp_path, GOOD).people
    assert isinstance(people, PeopleGroups)
    assert people.count == 5
    players, wanderers = people.groups
    assert isinstance(players, ScriptedPeople)
    assert wanderers == Wanderers(2, 3.0, 3.0, (8.0, 0.0))
    first, second, third = players.roles
    walk, turn = first.visits[0].actions
    assert walk == Walk(((1.0, 0.0),), 1.0)
    assert isinstance(turn, Turn)
    assert turn.by_deg == 90
    assert first.stature_m == 1.9
    assert second.visits[0].actions == (Stand(),)
    assert (third.visits[0].enter_s, third.visits[0].start_m) == (1.5, (0.0, 2.5))


def test_what_the_file_says_happens(tmp_path: Path) -> None:
    made = simulate(read(tmp_path, GOOD))
    assert made.truth_xyz_m.shape == (5, 251, 17, 3)
    place_m = made.truth_xyz_m[:, :, 11:13, :2].mean(axis=2)
    assert np.isfinite(place_m[:3, -1]).all()  # nobody leaves
    np.testing.assert_allclose(place_m[0, 0], [-1.0, 0.0], atol=0.05)
    np.testing.assert_allclose(place_m[0, -1], [1.0, 0.0], atol=0.15)
    assert np.isnan(place_m[2, made.truth_t_s < 1.5]).all()
    np.testing.assert_allclose(np.nanmean(place_m[3:], axis=(0, 1)), [8.0, 0.0], atol=1.5)
    counts = {name: sum(one.camera == name for one in made.poses) for name in made.rig.names}
    assert counts["cam1"] == 50
    assert counts["cam2"] < 15


def test_who_leaves_is_gone_and_may_come_again(tmp_path: Path) -> None:
    again = (
        "[[people]]\nstart_m = [-1, 0]\nleaves = true\n"
        'actions = [{ do = "walk", to_m = [1, 0] }]\n'
        "[[people.again]]\nstart_m = [0, 1]\nenter_s = 3.5\n"
    )
    scene = read(tmp_path, GOOD.partition("[[people]]")[0] + again)
    (person,) = scene.people(scene.seconds, np.random.default_rng(0))
    t_s = np.array([0.5, 3.0, 4.0, 4.9])
    xyz_m = poses([person.motion], t_s)[0]
    assert np.isnan(xyz_m[:, 0, 0]).tolist() == [False, True, False, False]
    np.testing.assert_allclose(xyz_m[2, 11:13, :2].mean(axis=0), [0.0, 1.0], atol=0.05)


def test_all_faults_are_told_at_once_by_line_with_the_nearest_name(tmp_path: Path) -> None:
    text = (
        GOOD.replace("seconds = 5", "seconds = nan")
        .replace('"ring"', '"rings"')
        .replace("fps = 10", "fpss = 10")
        .replace('"walk"', '"wlak"')
        .replace("by_deg", "by_degs")
        .replace("people = 2", "people = 1000000000")
        .replace("high_m = [1, -2, 2]", "high_m = [1, -4, 2]")
    )
    expected = [
        r"line 3: seconds: expected a finite number, found nan",
        r"line 6: rig\.pattern: expected 'corners', 'ring', .* found 'rings'",
        r"line 10: clock\.fpss: unknown key; did you mean 'fps'\?",
        r"line 27: people\.0\.actions\.0\.do: there is no 'wlak'; did you mean 'walk'\?",
        r"line 28: people\.0\.actions\.1\.by_degs: unknown key; did you mean 'by_deg'\?",
        r"line 37: wanderers\.0\.people: expected less than or equal to 200",
        r"line 41: obstacles\.0: an obstacle's high_m must be larger",
    ]
    told = faults(tmp_path, text)
    assert len(told) == len(expected)
    for line, pattern in zip(told, expected, strict=True):
        assert re.match(pattern, line), line


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("seconds = 5", "seconds = -5", "line 3: seconds: expected greater than 0, found -5"),
        ("seconds = 5", "seconds = 1e300", "line 3: seconds: expected less than or equal to 86400"),
        ("seconds = 5\n", "", "line 1: seconds: is missing"),
        ("seed = 7", "seed = -1", "line 4: seed: expected greater than or equal to 0"),
        ("scene/1", "scene/2", "line 1: format: expected 'trecsim.scene/1'"),
        ("cameras = 3", "cameras = 99", "line 7: rig.cameras: expected less than or equal to 28"),
        ("cameras = 3", "width_m = inf", "line 7: rig.width_m: expected a finite number"),
        ('"brown"', '"brown"\nview_deg = 170', "does not reach"),
        ('"brown"', '"brown"\ndistortion = [9e9, 0, 0, 0]', "line 5: rig: camera 'cam1': dist"),
        ("fps = 10", "fps = 1e9", "line 10: clock.fps: expected less than or equal to 1000"),
        ("fps = 10", 'fps = "10"', "line 10: clock.fps: expected a valid number, found '10'"),
        ("[cameras.cam2]", "[cameras.cma2]", "line 12: cameras.cma2: it is not a camera of the p"),
        ("dies_s = 3.0", "returns_s = 3.0", "line 12: cameras.cam2: returns_s needs dies_s"),
        (
            "dies_s = 3.0",
            "dies_s = 3\nreturns_s = 2",
            "line 12: cameras.cam2: camera 'it': an outage must",
        ),
        ("look_at_m = [0, 0, 0]", "look_at_m = [0, 0, 4]", "line 15: cameras.extra: a camera m"),
        ("look_at_m = [0, 0, 0]\n", "", "line 15: cameras.extra: position_m and look_at_m belo"),
        (
            "t_s = 1.0",
            "t_s = 1.0, turn_dg = 3",
            "cameras.extra.knock.turn_dg: unknown key; did you",
        ),
        ('"perfect"', '"best"', "line 21: detector.preset: expected 'real', "),
        ("sigma = 0.01", "sigma = [1, 2]", "line 22: detector.sigma: expected more values"),
        (
            "sigma = 0.01",
            "sigma = -1",
            "line 22: detector.sigma.0: expected greater than or equal to 0",
        ),
        ("sigma = 0.01", "sigmma = 1", "line 22: detector.sigmma: unknown key; did you mean 's"),
        ("start_m = [-1, 0]", "start_m = [-1, 0, 3]", "line 24: people.0.start_m: expected fe"),
        ("start_m = [-1, 0]", "start_m = [-1, 1e9]", "people.0.start_m.1: expected less than"),
        ("stature_m = 1.9", "stature_m = 190", "people.0.stature_m: expected less than or"),
        ("to_m = [1, 0]", 'to_m = [1, "x"]', "line 27: people.0.actions.0.to_m.0.1: expected"),
        ("to_m = [1, 0]", "to_m = []", "line 27: people.0.actions.0.to_m: expected more values"),
        (
            "speed_mps = 1.0",
            "speed_mps = 50",
            "people.0.actions.0.speed_mps: expected less than or equal to 2",
        ),
        (
            "by_deg = 90",
            "by_deg = 1e9",
            "by_deg: expected less than or equal to 57296, found 1000000000",
        ),
        ('do = "stand"', "seconds = 1", "people.1.actions.0.do: is missing"),
        ("copies = 2", "copies = 199", "line 1: expected at most 200 people, found 202"),
        ("copies = 2", "again = [{ start_m = [0, 0] }]", "a further visit must begin later"),
    ],
)
def test_a_fault_is_told_with_its_line(tmp_path: Path, old: str, new: str, message: str) -> None:
    assert old in GOOD
    told = faults(tmp_path, GOOD.replace(old, new, 1))
    assert any(message in line for line in told), told


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "format: is missing"),
        (b"a = \n", "is not TOML"),
        (b"a = '\xff'\n", "expected UTF-8 text"),
        (b"a = " + b"[" * 5000, "nested too deeply|is not TOML"),
        (b"#" * (1 << 21), "larger than 1 MiB"),
        (b'format = "trecsim.scene/1"\nseconds = 1\n', "expected 2 to 28 cameras, found 0"),
    ],
    ids=["empty", "broken", "latin", "deep", "huge", "no cameras"],
)
def test_what_is_no_scene_file_is_refused(tmp_path: Path, content: bytes, message: str) -> None:
    assert re.search(message, faults(tmp_path, content)[0])


@pytest.mark.parametrize(
    ("source", "message"),
    [
        ("crossing-50", "did you mean 'crossing-50cm'"),
        ("zzz", "known: arms-up, "),
        ("nowhere/room.toml", "cannot read the scene file nowhere/room.toml"),
    ],
)
def test_a_scene_that_is_not_there_is_told_with_the_nearest(source: str, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        read_scene(source)


def test_actions_that_last_for_days_cost_no_more_than_the_scene(tmp_path: Path) -> None:
    days = ", ".join(
        '{ do = "stand", seconds = 86400 }, { do = "walk", to_m = [9000, 0], speed_mps = 0.2 }'
        for _ in range(50)
    )
    text = GOOD.replace('{ do = "stand" }', days)
    made = simulate(read(tmp_path, text))
    assert np.isfinite(made.truth_xyz_m[1, :, 0, 0]).all()


def test_a_scene_for_which_there_is_no_memory_is_refused_before_it_is_made(tmp_path: Path) -> None:
    text = GOOD.replace("seconds = 5", "seconds = 80000").replace("people = 2", "people = 150")
    with pytest.raises(InputError, match="make the scene shorter"):
        simulate(read(tmp_path, text))


def test_the_schema_describes_every_key() -> None:
    schema = scene_schema()
    assert set(schema["$defs"]["Detector"]["properties"]) == {f.name for f in fields(Detector)}
    for name, table in {"scene": schema, **schema["$defs"]}.items():
        for key, value in table.get("properties", {}).items():
            described = schema["$defs"][value["$ref"].rsplit("/")[-1]] if "$ref" in value else value
            assert described.get("description"), f"{name}.{key}"


def test_the_built_in_scenes_are_those_in_the_folder() -> None:
    folder = Path(__file__).parents[3] / "src" / "trecsim" / "lab" / "simulation" / "scenes"
    assert sorted(BUILT_IN) == sorted(path.stem for path in folder.glob("*.toml"))
    assert len(BUILT_IN) == len(set(BUILT_IN)) >= 22


def hostile_values() -> list[str]:
    return ["nan", "-inf", "1e308", "-1", "10**9", '"x"', "[]", "{}", "[[[1]]]", "true", "9" * 400]


@pytest.mark.parametrize("value", hostile_values())
def test_no_value_anywhere_breaks_the_reader(value: str, tmp_path: Path) -> None:
    lines = GOOD.splitlines()
    for number, line in enumerate(lines):
        if " = " not in line:
            continue
        key = line.partition(" = ")[0]
        changed = [*lines[:number], f"{key} = {value}", *lines[number + 1 :]]
        try:
            read_scene(scene_file(tmp_path, "\n".join(changed)))
        except ConfigError as error:
            assert "test.toml" in str(error)  # noqa: PT017  many of them are fine
