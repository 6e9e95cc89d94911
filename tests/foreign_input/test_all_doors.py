"""Any file given at any door gives a value or one clear message, never anything else."""

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from made_site import make_site
from often import often
from trecsim.calibration import read_rig
from trecsim.errors import InputError
from trecsim.sites.check import check_site
from trecsim.sites.new_site import write_site
from trecsim.sources import probe, read_poses

DEEP = 100_000
CONTENTS = {
    "empty": b"",
    "blank": b" \n\t",
    "zeros": bytes(5000),
    "noise": np.random.default_rng(0).bytes(5000),
    "utf-16": "format = 'trecsim.rig/1'".encode("utf-16"),
    "a long line": b"x" * 200_000,
    "deep toml": b"a." * 50_000 + b"a = 1",
    "deep toml array": b"a = " + b"[" * DEEP,
    "deep json": b"[" * DEEP,
    "deep json object": b'{"a":' * DEEP,
    "deep json instances": b'[{"frame_id": 0, "instances": ' + b"[" * DEEP,
    "deep yaml": b"%YAML:1.0\n---\na: " + b"[" * DEEP,
    "deep xml": b"<a>" * DEEP,
    "commas": b"[" + b"," * 500_000,
    "a huge number": b"[" + b"9" * 100_000 + b"]",
    "laughing yaml": b"a: &a [ x, x ]\nb: &b [ *a, *a ]\nc: [ *b, *b ]\n",
    "an annotation file": b'{"info": {}, "images": [], "annotations": []}',
    "a list of nothing": b"[null, [], {}, 3]",
}
SUFFIXES = (".toml", ".yml", ".json", ".txt", ".jsonl", ".poses.jsonl", ".mp4", "")
DOORS = {
    "rig": lambda path: read_rig(path, remark=lambda text: None),
    "poses": lambda path: list(read_poses(path, fps=25)),
    "site": check_site,
    "video": probe,
    "new site": lambda path: write_site(
        path.parent / "new.toml", path, poses=path, remark=lambda text: None
    ),
}


@pytest.mark.parametrize("content", CONTENTS.values(), ids=CONTENTS)
@pytest.mark.parametrize("door", DOORS.values(), ids=DOORS)
def test_what_no_door_takes_is_refused_in_a_short_message(content, door, tmp_path):
    if door is probe:
        pytest.importorskip("av")
    for suffix in SUFFIXES:
        path = tmp_path / f"given{suffix}"
        path.write_bytes(content)
        with pytest.raises(InputError) as caught:
            door(path)
        assert "given" in str(caught.value)
        assert len(str(caught.value)) < 3000


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    folder = tmp_path_factory.mktemp("site")
    more = "[estimator]\nlong_side = 384\n[fusion]\ndeath_s = 2\n[output]\nlag_s = 0\n"
    return make_site(folder, more=more)


PIECES = [
    *("", "-", "9", "nan", '"', "[", "]", "{", "}", "\n", ".", "=", "#", "true", "é", "1e999"),
    *(
        "rtsp://a:pa55word@b/c",
        "[zones.x]\n",
        "'''",
        "../",
        "\\u0000",
        "rig.toml",
        "poses",
        "fps = 0\n",
    ),
]


@given(start=st.integers(0, 400), length=st.integers(0, 30), piece=st.sampled_from(PIECES))
@settings(max_examples=often(150))
def test_a_mangled_site_file_is_checked_or_refused_without_its_secrets(start, length, piece, site):
    whole = site.read_text()
    mangled = site.with_name("mangled.toml")
    mangled.write_text(whole[:start] + piece + whole[start + length :])
    try:
        assert check_site(mangled).rig.names == ("cam0", "cam1", "cam2")
    except InputError as error:
        assert "mangled.toml" in str(error)  # noqa: PT017
        assert "pa55word" not in str(error)  # noqa: PT017


def test_the_whole_site_file_is_good(site):
    assert check_site(site).remarks == ()


def test_a_rig_of_very_many_cameras_is_read(tmp_path):
    camera = {"K": np.eye(3).tolist(), "R": np.eye(3).tolist()}
    cameras = [
        camera | {"name": f"cam{i}", "resolution": [640, 480], "distCoef": [0] * 5, "t": [i, 0, 0]}
        for i in range(1000)
    ]
    (tmp_path / "panoptic.json").write_text(json.dumps({"cameras": cameras}))
    assert len(read_rig(tmp_path / "panoptic.json", remark=lambda text: None)) == 1000
