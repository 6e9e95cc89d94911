import dataclasses
import json
import shlex
import subprocess
import sys

import numpy as np
import pytest

from made_rigs import ring
from trecsim.calibration import read_rig, write_rig
from trecsim.geometry.rig import Rig


@pytest.fixture
def command(trecsim):
    """Return a function that runs a command on rigs and gives exit code, output and messages."""
    return lambda *words: trecsim("rig", *words)


@pytest.fixture
def rig_file(tmp_path):
    write_rig(ring(3, "brown"), tmp_path / "rig.toml")
    return tmp_path / "rig.toml"


def test_show_lists_every_camera_with_its_height(command, rig_file):
    code, out, err = command("show", rig_file)
    assert (code, err) == (0, "")
    for name, height in (("cam0", "2.50"), ("cam1", "2.70"), ("cam2", "2.90")):
        line = next(line for line in out.splitlines() if name in line)
        assert "1920 x 1080" in line
        assert height in line
        assert "brown -0.28" in line
    assert "height m" in out
    assert "-0 " not in out


def test_show_gives_the_same_facts_as_json(command, rig_file):
    code, out, _ = command("show", rig_file, "--json")
    assert code == 0
    summary = json.loads(out)
    first = summary["cameras"][0]
    assert [camera["name"] for camera in summary["cameras"]] == ["cam0", "cam1", "cam2"]
    np.testing.assert_allclose(first["position_m"], [5.0, 0.0, 2.5], atol=1e-9)
    assert first["azimuth_deg"] == pytest.approx(180.0)
    assert first["down_deg"] == pytest.approx(np.rad2deg(np.arctan2(1.5, 5.0)))
    assert first["whole_view_usable"] is True
    assert 80 < first["horizontal_view_deg"] < 110


def test_show_draws_the_picture(command, rig_file, tmp_path):
    code, out, _ = command("show", rig_file, "--out", tmp_path / "rig.png")
    assert code == 0
    assert "rig.png: the cameras from above" in out
    assert (tmp_path / "rig.png").read_bytes().startswith(b"\x89PNG")


def test_a_name_with_markup_is_shown_as_it_is(command, tmp_path):
    odd = Rig((dataclasses.replace(ring(2).cameras[0], name="[red]x[/]"),))
    write_rig(odd, tmp_path / "rig.toml")
    assert "[red]x[/]" in command("show", tmp_path / "rig.toml")[1]


def test_convert_writes_what_is_read_back(command, rig_file, tmp_path):
    code, out, _ = command("convert", rig_file, tmp_path / "Calib.toml", "--json")
    assert code == 0
    assert json.loads(out) == {
        "out": str(tmp_path / "Calib.toml"),
        "format": "pose2sim",
        "cameras": ["cam0", "cam1", "cam2"],
    }
    for mine, theirs in zip(ring(3), read_rig(tmp_path / "Calib.toml"), strict=True):
        np.testing.assert_allclose(theirs.position_m, mine.position_m, atol=1e-9)


def test_what_mc_calib_cannot_hold_is_told_and_reads_back_with_the_options_told(
    command, rig_file, tmp_path
):
    path = tmp_path / "calibrated_cameras_data.yml"
    code, _, err = command("convert", rig_file, path, "--out-unit-m", "0.01")
    assert code == 0
    told = next(line for line in err.splitlines() if "to read it back: " in line)
    options = shlex.split(told.partition("to read it back: ")[2])
    code, out, err = command("show", path, *options, "--json")
    assert (code, err) == (0, "")
    positions = [camera["position_m"] for camera in json.loads(out)["cameras"]]
    np.testing.assert_allclose(positions, [c.position_m for c in ring(3)], atol=1e-9)


def test_the_thesis_room_stands_on_its_floor(command, shared_data):
    words = "--unit-m 0.01 --floor-rotation-deg 146.12 1.79 -1.2 --floor-translation-m 0 2.3 0"
    code, out, err = command("show", shared_data / "mc_calib", *words.split(), "--json")
    assert code == 0
    assert "about the y axis" in err
    heights = [camera["position_m"][2] for camera in json.loads(out)["cameras"]]
    np.testing.assert_allclose(heights, [2.3, 2.3], atol=0.001)


def test_the_up_axis_may_begin_with_a_minus(command, shared_data):
    code, _, err = command("show", shared_data / "mc_calib", "--unit-m", "0.01", "--floor-up", "-y")
    assert code == 0
    assert "stand upright" not in err


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ("show missing.toml", "cannot read the rig missing.toml: No such file"),
        ("show {rig} --in-format mc-calib", "is not MC-Calib's"),
        ("show {rig} --unit-m 0.01", "in metres always"),
        ("show {rig} --unit-m 0", "the unit of a rig must be"),
        ("show {rig} --floor-up x", "floor-up"),
        ("show {rig} --floor-rotation-deg 1 2", "floor-rotation-deg"),
        ("show {rig} --floor-rotation-deg 1 2 nan", "rotation must be three finite numbers"),
        ("show {rig} --size-px 0 5", "--size-px must be a width and a height"),
        ("show {rig} --out rig.bmp", "ends in .png"),
        ("show {rig} --out nowhere/rig.png", "cannot write nowhere/rig.png"),
        ("convert {rig} rig.xyz", "cannot tell from the name"),
        ("convert {rig} rig.json --format panoptic", "does not write it"),
        ("convert {rig} nowhere/rig.toml", "cannot write nowhere/rig.toml"),
    ],
)
def test_wrong_input_gives_one_message_and_exit_code_2(
    words, says, command, rig_file, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    code, out, err = command(*words.format(rig=rig_file.name).split())
    assert code == 2
    assert out == ""
    assert says in err
    assert "Traceback" not in err
    assert [file.name for file in tmp_path.iterdir()] == ["rig.toml"]


def test_help_of_the_rig_commands_loads_no_numpy():
    program = (
        "import sys; from trecsim.cli import main\n"
        "try: main(['rig', 'show', '--help'])\n"
        "except SystemExit: pass\n"
        "assert 'numpy' not in sys.modules and 'matplotlib' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", program], check=True, capture_output=True)


def test_clocks_that_are_corrected_are_shown(command, rig_file):
    text = rig_file.read_text().replace("time_offset_s = 0.0", "time_drift_ppm = 12.5", 1)
    rig_file.write_text(text)
    code, out, _ = command("show", rig_file)
    assert code == 0
    assert "0, 12.5 ppm" in out
