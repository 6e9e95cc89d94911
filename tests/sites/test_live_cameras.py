"""Live cameras in a site file: what is wrong or lacking is told, with its line."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

from made_rigs import ring
from made_site import make_site
from trecsim.calibration import read_rig, write_rig
from trecsim.errors import ConfigError
from trecsim.geometry import Rig
from trecsim.sites.check import check_site
from trecsim.sites.live_cameras import clock_remarks
from trecsim.sites.live_sources import image_sources, poses_source
from trecsim.sites.site_reading import read_site
from trecsim.sources.streams import StreamSource

HEAD = 'format = "trecsim.site/1"\nname = "live"\nrig = "rig.toml"\n'
GOOD = """\
secrets = "secrets.toml"
[sources.cam0]
url = "rtsp://cam0/1"
credentials = "gate"
transport = "udp"
[sources.cam1]
url = "http://cam1/mjpeg"
[sources.cam2]
device = 0
"""


class Small:
    """An estimator that looks at small images."""

    skeleton = "coco17"
    image_limit_px = (32, 32)

    def __call__(self, frame):
        raise NotImplementedError


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a folder with a rig and a file of secrets."""
    rig = Rig(tuple(replace(camera, size_px=(64, 48)) for camera in ring(3)))
    write_rig(rig, tmp_path / "rig.toml")
    (tmp_path / "secrets.toml").write_text('gate = "me:s3cret"\n')
    (tmp_path / "secrets.toml").chmod(0o600)
    return tmp_path


def site(folder: Path, text: str) -> Path:
    path = folder / "site.toml"
    path.write_text(HEAD + text)
    return path


def faults(path: Path) -> list[str]:
    with pytest.raises(ConfigError) as caught:
        check_site(path)
    assert "s3cret" not in str(caught.value)
    return re.findall(r"line \d+: [^\n]*", str(caught.value))


def test_cameras_are_not_connected_by_a_check(folder: Path) -> None:
    checked = check_site(site(folder, GOOD))
    assert checked.file.site.is_live
    assert checked.videos == {}
    assert checked.remarks == ("cam2: there is no camera /dev/video0 at this machine now",)


def test_each_camera_becomes_a_source_of_images_as_large_as_the_estimator_looks_at(
    folder: Path,
) -> None:
    sources = image_sources(check_site(site(folder, GOOD)), Small())
    assert [source.camera for source in sources] == ["cam0", "cam1", "cam2"]
    assert all(isinstance(source, StreamSource) for source in sources)
    assert "s3cret" not in repr(sources)
    assert [repr(one) for one in sources][2] == "<StreamSource of 'cam2': /dev/video0>"


def test_credentials_that_are_missing_are_a_remark_of_a_check_and_an_error_of_a_run(
    folder: Path,
) -> None:
    checked = check_site(site(folder, GOOD.replace('"gate"', '"yard"')))
    assert "cam0: there are no credentials 'yard': add a line" in checked.remarks[0]
    with pytest.raises(ConfigError, match=r"line 7: sources\.cam0\.credentials: .*'yard'"):
        image_sources(checked, Small())


def test_two_cameras_that_show_the_same_stream_are_remarked(folder: Path) -> None:
    text = GOOD.replace("http://cam1/mjpeg", "rtsp://cam0/1")
    remarks = check_site(site(folder, text)).remarks
    assert "cam0 and cam1 show the same stream: rtsp://cam0/1" in remarks


@pytest.mark.parametrize(
    ("clock", "told"),
    [
        ({"time_offset_s": 1.84}, ["cam1 (+1.84 s)"]),
        ({"time_offset_s": -0.4}, ["cam1 (-0.4 s)"]),
        ({"time_drift_ppm": -10.0}, ["cam1 (-1.8e+04 s)"]),  # since the origin of the recording
        ({"time_offset_s": 0.3}, []),
    ],
)
def test_clocks_of_recordings_are_remarked_where_cameras_are_live(
    folder: Path, clock: dict[str, float], told: list[str]
) -> None:
    rig = read_rig(folder / "rig.toml")
    cameras = [replace(one, **clock) if one.name == "cam1" else one for one in rig]
    rig = Rig(tuple(cameras))
    live = check_site(site(folder, GOOD)).file.site
    found = list(clock_remarks(live, rig, 1.8e9))
    assert [re.findall(r"cam\d \([^)]*\)", one) for one in found] == ([told] if told else [])


def test_clocks_of_recordings_are_right_for_recordings(folder: Path) -> None:
    text = '[sources.cam0]\nvideo = "cam0.mp4"\n[sources.cam1]\nurl = "rtsp://cam1/1"\n'
    late = Rig(tuple(replace(one, time_offset_s=1.84) for one in read_rig(folder / "rig.toml")))
    (told,) = clock_remarks(read_site(site(folder, text)).site, late, 1.8e9)
    assert "cam1 (+1.84 s)" in told
    assert "cam0" not in told


def test_a_check_of_a_live_site_tells_of_the_clocks_of_its_rig(folder: Path) -> None:
    rig = read_rig(folder / "rig.toml")
    write_rig(Rig(tuple(replace(one, time_offset_s=2.0) for one in rig)), folder / "rig.toml")
    (told,) = [one for one in check_site(site(folder, GOOD)).remarks if "clocks" in one]
    assert told.startswith(f"{folder / 'rig.toml'} shifts the times of live cameras")
    assert told.endswith("delete time_offset_s, time_drift_ppm and time_ref_s there")


def test_2d_poses_that_no_limit_deletes_are_remarked_where_cameras_are_live(folder: Path) -> None:
    kept = "[output]\nposes = true\n"
    told = [one for one in check_site(site(folder, GOOD + kept)).remarks if "poses" in one]
    assert [one.partition(":")[0] for one in told] == ["output.poses"]
    (folder / "played").mkdir()
    assert check_site(make_site(folder / "played", 2, kept)).remarks == ()


def test_secrets_that_everybody_can_read_are_a_fault(folder: Path) -> None:
    (folder / "secrets.toml").chmod(0o644)
    (told,) = faults(site(folder, GOOD))
    assert told.startswith("line 4: secrets: every user of this machine can read the secrets")


@pytest.mark.parametrize(
    ("table", "told"),
    [
        ("", "line 4: sources.cam0: expected one of video, url and device, found none"),
        (
            'url = "rtsp://a/1"\ndevice = 0',
            "line 4: sources.cam0: expected one of video, url and device, found url and device",
        ),
        ('device = 0\ncredentials = "gate"', "line 4: sources.cam0: credentials: only a camera"),
        ('device = 0\ntransport = "udp"', "line 4: sources.cam0: transport: only a camera with a"),
        (
            'url = "rtsp://me:s3cret@a/1"',
            "line 5: sources.cam0.url: user and password do not belong into the URL",
        ),
        ('url = "rstp://a/1"', "line 5: sources.cam0.url: expected a URL that begins with one of"),
        ('url = "rtsp://a/{password}"', "line 4: sources.cam0: a url with {user} and {password}"),
        (
            'url = "rtsp://a/1"\ntransport = "both"',
            "line 6: sources.cam0.transport: expected 'tcp'",
        ),
        ('device = "video0"', "line 5: sources.cam0.device: expected a device like"),
        ("device = true", "line 5: sources.cam0.device: expected a device like"),
        ('url = "rtsp://a/1"\nreconnect_s = 3', "line 6: sources.cam0.reconnect_s: a lost camera"),
        ('video = "rtsp://a/1"', "line 5: sources.cam0.video: expected a file, found rtsp://a/1;"),
    ],
)
def test_what_is_wrong_with_a_camera_is_told_with_its_line(
    folder: Path, table: str, told: str
) -> None:
    found = faults(site(folder, f"[sources.cam0]\n{table}\n"))
    assert any(line.startswith(told) for line in found), found


def test_poses_are_played_as_if_they_were_live(tmp_path: Path) -> None:
    source = poses_source(check_site(make_site(tmp_path, 2)))
    poses = list(source)
    assert len(poses) == 6
    assert [one.camera for one in source.readings] == ["cam0", "cam1", "cam2"]
    assert poses[-1].t_s - poses[0].t_s == pytest.approx(0.04)
