import json
import os

import pytest

from made_rigs import ring
from trecsim.calibration import FORMATS, read_rig, write_rig
from trecsim.errors import CalibrationError


def put(path, content):
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ("", "it has nothing in it"),
        ("a = 1\nb = 2\n", "no rig that trecsim can read .as TOML it has 'a', 'b'"),
        ("{}", "as JSON it has nothing"),
        ("[1, 2]", "as TOML"),
        ('{"cameras": 3}', "as JSON it has 'cameras'"),
        ("<a><b/></a>", "as XML"),
        ("<a>", "as XML"),
        ("%YAML:1.0\n---\na: 1\n", "as YAML it has 'a'"),
        ("hello, I am a letter", "as TOML"),
        (b"\x89PNG\r\n\x1a\n\x00\x00", "expected UTF-8 text, found the byte 0x89 at 0"),
        (b"\xff\xfea", "expected UTF-8 text"),
        ("\x00" * 1000, "as TOML"),
        ("[" * 100_000, "as TOML"),
        ("a = " + "[" * 100_000, "as TOML"),
        ('{"a":' * 100_000, "as JSON, it is nested too deeply"),
        ('{"a":' + "[" * 100_000, "as JSON, it is nested too deeply"),
        ("<a>" * 100_000, "as XML"),
        ("a = " + "9" * 10_000, "as TOML"),
        ('{"cameras": ' + "9" * 10_000 + "}", "as JSON"),
        (" " * (17 * 2**20), "more than 16 MiB"),
    ],
)
def test_what_is_no_rig_is_told_in_one_message(content, says, tmp_path):
    path = put(tmp_path / "rig.toml", content)
    with pytest.raises(CalibrationError, match=says) as caught:
        read_rig(path)
    assert len(str(caught.value)) < 1500


def test_values_nested_as_deep_as_the_parsers_allow_are_told_too(tmp_path):
    for depth in range(300, 1100, 50):
        data = f'{{"cameras": {{"a": {{"K": {"[" * depth}{"]" * depth}}}}}}}'
        with pytest.raises(CalibrationError):
            read_rig(put(tmp_path / "rig.json", data))


def test_a_missing_or_odd_path_is_told(tmp_path):
    with pytest.raises(CalibrationError, match=r"rig\.toml: No such file"):
        read_rig(tmp_path / "rig.toml")
    with pytest.raises(CalibrationError, match="null"):
        read_rig(tmp_path / "rig\0.toml")
    os.mkfifo(tmp_path / "pipe.toml")
    with pytest.raises(CalibrationError, match="is not a file"):
        read_rig(tmp_path / "pipe.toml")


def test_a_directory_gives_the_one_rig_in_it(tmp_path):
    write_rig(ring(2), tmp_path / "rig.toml")
    put(tmp_path / "Config.toml", "[project]\nframe_rate = 60\n")
    put(tmp_path / "notes.txt", "bought on Monday")
    put(tmp_path / "poses.json", json.dumps({"people": []}))
    put(tmp_path / "movie.mp4", b"\xff\xff")
    (tmp_path / "folder.toml").mkdir()
    assert read_rig(tmp_path).names == ("cam0", "cam1")


def test_a_directory_with_several_rigs_lists_them_unless_the_format_tells(tmp_path):
    write_rig(ring(2), tmp_path / "rig.toml")
    write_rig(ring(3), tmp_path / "Calib.toml")
    with pytest.raises(CalibrationError) as caught:
        read_rig(tmp_path)
    assert str(caught.value).splitlines()[1:] == [
        "  Calib.toml: Pose2Sim's Calib*.toml",
        "  rig.toml: trecsim's rig.toml",
    ]
    assert len(read_rig(tmp_path, format="pose2sim")) == 3


def test_a_directory_without_a_rig_says_what_it_looked_into(tmp_path):
    with pytest.raises(CalibrationError, match="it has no such file"):
        read_rig(tmp_path)
    put(tmp_path / "Config.toml", "a = 1")
    with pytest.raises(CalibrationError, match=r"Config\.toml: no rig"):
        read_rig(tmp_path)


def test_a_directory_full_of_other_files_is_not_searched(tmp_path):
    for index in range(201):
        put(tmp_path / f"frame_{index}.json", "{}")
    with pytest.raises(CalibrationError, match="201 files that could be a rig"):
        read_rig(tmp_path)


def test_a_format_that_is_named_must_be_right(tmp_path):
    write_rig(ring(2), tmp_path / "rig.toml")
    assert len(read_rig(tmp_path / "rig.toml", format="trecsim")) == 2
    with pytest.raises(CalibrationError, match="is not MC-Calib's"):
        read_rig(tmp_path / "rig.toml", format="mc-calib")
    with pytest.raises(CalibrationError, match="did you mean 'mc-calib'"):
        read_rig(tmp_path / "rig.toml", format="mccalib")


def test_the_formats_exclude_each_other(tmp_path):
    for entry in FORMATS:
        if entry.write:
            path = tmp_path / entry.name / ("" if entry.name == "easymocap" else "rig.toml")
            path.parent.mkdir(exist_ok=True)
            path = path.with_suffix(".yml") if entry.name == "mc-calib" else path
            write_rig(ring(2), path, format=entry.name, remark=lambda text: None)
            for other in FORMATS:
                if other.name != entry.name:
                    with pytest.raises(CalibrationError):
                        read_rig(path, format=other.name, remark=lambda text: None)
