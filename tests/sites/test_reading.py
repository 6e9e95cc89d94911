"""Site files: what is read, and what is said about a wrong one."""

import re
from dataclasses import fields
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from often import often
from trecsim.errors import ConfigError
from trecsim.fusion import FusionSettings
from trecsim.sites import fusion_settings, read_site, site_schema
from trecsim.toml_models.described import descriptions

GOOD = """\
#:schema trecsim-site.schema.json
format = "trecsim.site/1"
name = "yard"
rig = "rig.toml"

[sources.north]
video = "north.mp4"
[sources.south]
video = "/videos/south.mp4"

[estimator]
name = "movenet"
long_side = 384

[fusion]
death_s = 2

[output]
lag_s = 0.2
"""


def site_file(folder: Path, text: str | bytes) -> Path:
    path = folder / "site.toml"
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return path


def faults(folder: Path, text: str | bytes) -> list[str]:
    with pytest.raises(ConfigError) as caught:
        read_site(site_file(folder, text))
    message = str(caught.value)
    assert "site.toml" in message
    return re.findall(r"(line \d+: [^\n]*)", message) or [message]


def test_a_good_file_is_read(tmp_path: Path) -> None:
    site = read_site(site_file(tmp_path, GOOD)).site
    assert site.rig.file == tmp_path / "rig.toml"
    assert site.sources["north"].video == tmp_path / "north.mp4"
    assert site.sources["south"].video == Path("/videos/south.mp4")
    assert site.estimator.settings() == {"long_side": 384}
    assert fusion_settings(site.fusion) == FusionSettings(death_s=2.0)
    assert site.output.lag_s == 0.2


def test_the_rig_may_be_a_table(tmp_path: Path) -> None:
    table = '{ file = "calib.yml", unit_m = 0.001, floor = { up = "y" } }'
    site = read_site(site_file(tmp_path, GOOD.replace('"rig.toml"', table))).site
    assert site.rig.unit_m == 0.001
    assert site.rig.floor is not None
    assert site.rig.floor.floor().up == "y"


def test_settings_by_their_earlier_names_are_read_unless_both_names_are_given(
    tmp_path: Path,
) -> None:
    old = GOOD.replace("death_s = 2", "doubt_s = 4\nquick_share = 0.5")
    site = read_site(site_file(tmp_path, old)).site
    taken = FusionSettings(single_view_death_s=4.0, white_share=0.5)
    assert fusion_settings(site.fusion) == taken
    both = GOOD.replace("death_s = 2", "doubt_s = 4\nsingle_view_death_s = 3")
    (told,) = faults(tmp_path, both)
    assert told.startswith("line 16: fusion.doubt_s: unknown key")


@pytest.mark.parametrize(
    ("name", "taken"),
    [
        ("onnx:models/pose.onnx", "onnx:{folder}/models/pose.onnx"),
        ("onnx:/models/pose.onnx", "onnx:/models/pose.onnx"),
        ("onnx:", "onnx:"),
        ("rtmlib:rtmo-m", "rtmlib:rtmo-m"),
        ("movenet", "movenet"),
    ],
)
def test_the_file_of_an_estimator_is_relative_to_the_site_file(
    tmp_path: Path, name: str, taken: str
) -> None:
    text = GOOD.replace('"movenet"', f'"{name}"')
    site = read_site(site_file(tmp_path, text)).site
    assert site.estimator.name == taken.format(folder=tmp_path)


def test_all_faults_are_told_at_once_by_line_with_the_nearest_name(tmp_path: Path) -> None:
    text = (
        GOOD.replace("[sources.south]\nvideo", "[sources.south]\nvidoe")
        .replace("death_s", "deaths_s")
        .replace("lag_s = 0.2", 'lag_s = "long"')
        .replace('"yard"', '"back yard"')
        .replace("[estimator]", "[estimatr]")
    )
    told = faults(tmp_path, text)
    expected = [
        r"line 3: name: expected .*letters, .*found 'back yard'",
        r"line 9: sources\.south\.vidoe: unknown key; did you mean 'video'\?",
        r"line 11: estimatr: unknown key; did you mean 'estimator'\?",
        r"line 16: fusion\.deaths_s: unknown key; did you mean 'death_s'\?",
        r"line 19: output\.lag_s: expected a valid number, found 'long'",
    ]
    assert len(told) == len(expected)
    for line, pattern in zip(told, expected, strict=True):
        assert re.match(pattern, line), line


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('name = "yard"\n', "", "line 1: name: is missing"),
        ("site/1", "site/9", "line 2: format: expected 'trecsim.site/1', found 'trecsim.site/9'"),
        ('"rig.toml"', "3", "line 4: rig: expected a table, found 3"),
        ('"rig.toml"', '{ fil = "r" }', "line 4: rig.fil: unknown key; did you mean 'file'?"),
        ('"rig.toml"', '"rig.toml"\nabcdef = 1', "abcdef: unknown key; known: edges, estimator"),
        ("north.mp4", "rtsp://a:b@c/d", "line 7: sources.north.video: expected a file, found rtsp"),
        ('"yard"', '"rtsp://admin:' + "x" * 60 + '@c/d"', "found 'rtsp://***@c/d'"),
        ("lag_s = 0.2", "lag_s = -1", "line 19: output.lag_s: expected greater than or equal"),
        ("lag_s = 0.2", "lag_s = nan", "line 19: output.lag_s: expected a finite number"),
        ("lag_s = 0.2", "lag_s = true", "line 19: output.lag_s: expected a valid number"),
        ("death_s = 2", "flip_share = 1", "line 16: fusion.flip_share: expected less than 1"),
        ("death_s = 2", "window_s = 0.01", "line 15: fusion: window_s must span at least"),
        ("[output]", 'poses = "p.jsonl"\n[output]', "fusion.poses: unknown key"),
        ('"rig.toml"', '"r"\nposes = "p"', "line 1: expected either [sources.CAMERA] or poses"),
    ],
)
def test_a_fault_is_told_with_its_line(tmp_path: Path, old: str, new: str, message: str) -> None:
    assert old in GOOD
    assert any(message in line for line in faults(tmp_path, GOOD.replace(old, new)))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "line 1: format: is missing"),
        (b"name = \n", "is not TOML: Invalid value"),
        (b"a = 1\na = 2\n", "is not TOML: Cannot overwrite"),
        (b"a = 1\nb = '\xff'\n", "line 2: expected UTF-8 text"),
        (b"a = " + b"[" * 100_000, "nested too deeply"),
        (b"a = " + b"9" * 5000, "is not TOML"),
        (b"#" * (1 << 20) + b"\n", "larger than 1 MiB"),
        (b"name = 1e999\n", "name: expected a valid string, found inf"),
    ],
)
def test_what_is_no_site_file_is_told(tmp_path: Path, content: bytes, message: str) -> None:
    assert any(message in line for line in faults(tmp_path, content))


def test_of_a_folder_the_files_in_it_are_named(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"is a folder: expected the site file itself$"):
        read_site(tmp_path)
    (tmp_path / "Config.toml").touch()
    with pytest.raises(ConfigError, match=r"itself; there is .*Config\.toml$"):
        read_site(tmp_path)


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"cannot read the site file .*gone\.toml: No such file"):
        read_site(tmp_path / "gone.toml")


@given(st.integers(0, len(GOOD)), st.integers(0, 40), st.text(max_size=20))
@settings(max_examples=often(200))
def test_a_mangled_file_never_gives_anything_but_a_clear_error(
    tmp_path_factory: pytest.TempPathFactory, start: int, length: int, put: str
) -> None:
    text = GOOD[:start] + put + GOOD[start + length :]
    path = site_file(tmp_path_factory.getbasetemp(), text.encode("utf-8", "surrogatepass"))
    try:
        site = read_site(path).site
    except ConfigError as error:
        assert str(path) in str(error)  # noqa: PT017
    else:
        assert site.format == "trecsim.site/1"


def test_the_limits_of_the_file_are_those_of_the_fusion() -> None:
    table = site_schema()["$defs"]["FusionTable"]["properties"]
    assert list(table) == [field.name for field in fields(FusionSettings)]
    for name, schema in table.items():
        assert schema["default"] == getattr(FusionSettings(), name)
        kind = type(schema["default"])
        for limit in {schema["exclusiveMinimum"], schema.get("exclusiveMaximum", 0.0)}:
            with pytest.raises(ConfigError, match=name):
                FusionSettings(**{name: kind(limit)})


def test_every_key_is_described() -> None:
    schema = site_schema()
    tables = [schema, *schema["$defs"].values()]
    missing = [
        f"{table.get('title')}.{key}"
        for table in tables
        for key, value in table["properties"].items()
        if not (value.get("description") or "$ref" in value)
    ]
    assert missing == []
    assert set(descriptions(FusionSettings)) == {field.name for field in fields(FusionSettings)}
