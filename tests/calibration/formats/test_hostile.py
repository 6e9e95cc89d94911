"""Damaged files give a rig or one clear message, never anything else."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from made_rigs import ring
from often import often
from trecsim.calibration import read_rig, write_rig
from trecsim.errors import CalibrationError

QUALISYS = """<calibration><cameras><camera model="none" serial="north">
<fov_video bottom="1079" left="0" right="1919" top="0"/>
<transform x="1" y="2" z="3" r11="1" r12="0" r13="0" r21="0" r22="0" r23="1" r31="0" r32="-1"
 r33="0"/>
<intrinsic focalLengthU="70400" focalLengthV="64000" centerPointU="64000" centerPointV="32000"/>
</camera></cameras></calibration>"""
PANOPTIC = """{"cameras": [{"name": "a", "resolution": [640, 480], "distCoef": [0, 0, 0, 0, 0],
"K": [[500, 0, 320], [0, 500, 240], [0, 0, 1]], "R": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
"t": [[1], [2], [3]]}]}"""
TABLE = """{"cameras": {"a": {"width": 640, "height": 480, "dist": [0, 0, 0, 0, 0],
"K": [[500, 0, 320], [0, 500, 240], [0, 0, 1]], "R": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
"t": [1, 2, 3]}}}"""
NASTY = ["", "-", "9", "nan", "1e999", "null", "[", "]", "{", "}", "\n", '"', "true", ".", "é", " "]


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole")
    write_rig(ring(2, "brown"), folder / "rig.toml")
    write_rig(ring(2, "brown"), folder / "rig.yml", remark=lambda text: None)
    write_rig(ring(2, "brown"), folder / "Calib.toml")
    write_rig(ring(2, "brown"), folder / "anipose.toml", format="anipose")
    write_rig(ring(2, "brown"), folder / "pair")
    for name, text in (("q.txt", QUALISYS), ("p.json", PANOPTIC), ("t.json", TABLE)):
        (folder / name).write_text(text)
    return folder


EACH = ("rig.toml", "rig.yml", "Calib.toml", "anipose.toml", "pair/intri.yml", "q.txt", "p.json")


def attempt(path):
    """Return the rig in a file, or the message that says why there is none."""
    try:
        return read_rig(path, remark=lambda text: None), ""
    except CalibrationError as error:
        return None, str(error)


@pytest.mark.parametrize("name", [*EACH, "t.json"])
@given(seed=st.integers(0, 2**32 - 1), count=st.integers(1, 4))
@settings(max_examples=often(60))
def test_a_damaged_file_gives_a_rig_or_a_clear_message(name, seed, count, files):
    rng = np.random.default_rng(seed)
    whole = (files / name).read_text()
    for _ in range(count):
        start = int(rng.integers(len(whole)))
        end = start + int(rng.integers(0, 12))
        whole = whole[:start] + str(rng.choice(NASTY)) + whole[end:]
    damaged = (files / name).with_name("damaged" + (files / name).suffix)
    damaged.write_text(whole)
    rig, message = attempt(damaged)
    if rig is None:
        assert 10 < len(message) < 6000
    else:
        assert all(np.isfinite(camera.P).all() for camera in rig)
