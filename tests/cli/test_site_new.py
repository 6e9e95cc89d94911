"""The command that writes a site file."""

import json
from pathlib import Path

import pytest

from made_site import make_site
from made_videos import numbered, write_video
from trecsim.cli import main
from trecsim.sites.check import check_site


@pytest.fixture
def folder(tmp_path, monkeypatch):
    make_site(tmp_path).unlink()
    monkeypatch.chdir(tmp_path)
    return tmp_path


def run(*arguments):
    with pytest.raises(SystemExit) as caught:
        main(["site", "new", *arguments])
    return caught.value.code


def test_poses_and_a_rig_give_a_site_that_runs(folder, capsys):
    assert run("walk.poses.jsonl", "--rig", "rig.toml", "--json") == 0
    out, err = capsys.readouterr()
    assert json.loads(out) == {
        "out": "site.toml", "sources": {}, "poses": "walk.poses.jsonl", "faults": None,
    }  # fmt: skip
    assert err == ""
    assert 'poses = "walk.poses.jsonl"' in Path("site.toml").read_text()


def test_videos_of_another_size_than_calibrated_are_told_and_the_file_kept(folder, capsys):
    Path("videos").mkdir()
    for name in ("cam0", "cam1", "a_cam2"):
        write_video(folder / "videos" / f"{name}.mp4", numbered(3))
    assert run("videos", "--rig", "rig.toml", "--out", "hall.toml", "--name", "hall") == 0
    out, err = capsys.readouterr()
    assert out == "hall.toml: cam0, cam1, cam2\n"
    assert "videos/a_cam2.mp4 is taken for the camera 'cam2'" in err
    assert "the file is written, but: hall.toml: 3 faults" in err
    assert 'name = "hall"' in Path("hall.toml").read_text()
    assert 'video = "videos/a_cam2.mp4"' in Path("hall.toml").read_text()


def test_live_cameras_give_a_site_with_a_page_that_names_where_passwords_go(folder, capsys):
    cameras = ["cam0=rtsp://10.0.0.10/s?x=1&y=2", "cam1=/dev/video7", "cam2=http://10.0.0.12/mjpg"]
    assert run(*cameras, "--rig", "rig.toml", "--out", "hall.toml") == 0
    assert capsys.readouterr().out == "hall.toml: cam0, cam1, cam2\n"

    text = Path("hall.toml").read_text()
    site = check_site(Path("hall.toml")).file.site
    assert site.is_live
    assert site.sources["cam0"].url == "rtsp://10.0.0.10/s?x=1&y=2"
    assert site.sources["cam1"].device == "/dev/video7"
    assert site.page is not None
    assert "TRECSIM_CREDENTIALS_CAM2 holds user:password" in text


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ((), "no camera is given; expected: trecsim site new NAME=rtsp://ADDRESS..."),
        (("walk.poses.jsonl", "--rig", "gone.toml"), "cannot read the rig gone.toml"),
        (("gone.poses.jsonl",), "gone.poses.jsonl: no such file or folder"),
        (("GOPR0001.mp4",), "GOPR0001.mp4 belongs to no camera of the rig"),
        (("cam0=rtsp://kim:secret@10.0.0.1/x",), "cam0: leave user and password out of rtsp://***"),
        (("cam9=rtsp://10.0.0.1/x",), "there is no camera 'cam9' in the rig (it has cam0, "),
        (("/dev/video0",), "expected each camera of a live site once, as NAME=rtsp://ADDRESS"),
        (("cam0=rtsp://10.0.0.1/x", "cam0=rtsp://10.0.0.2/x"), "each camera of a live site once"),
        (("cam0=rtsp://10.0.0.1/x", "cam1.mp4"), "expected each camera of a live site once"),
    ],
)
def test_what_is_wrong_is_told_in_one_message(arguments, told, folder, capsys):
    given = arguments if "--rig" in arguments else (*arguments, "--rig", "rig.toml")
    assert run(*given) == 2
    assert told in capsys.readouterr().err
    assert not Path("site.toml").exists()
