"""A site file is written for what somebody has."""

from dataclasses import replace
from pathlib import Path

import pytest

from made_rigs import ring
from made_site import make_site
from made_videos import numbered, write_video
from trecsim.calibration import write_rig
from trecsim.errors import InputError
from trecsim.geometry import Rig
from trecsim.sites.check import check_site
from trecsim.sites.new_site import matched_cameras, write_site


@pytest.fixture
def rig(tmp_path: Path) -> Path:
    """Return the file of a rig with cameras cam0, cam1, cam2 of 64 x 48 px."""
    cameras = Rig(tuple(replace(camera, size_px=(64, 48)) for camera in ring(3)))
    write_rig(cameras, tmp_path / "rig.toml")
    return tmp_path / "rig.toml"


def nothing(text: str) -> None:
    pytest.fail(text)


def test_what_is_written_is_right_at_once(tmp_path: Path, rig: Path) -> None:
    videos = {
        name: write_video(tmp_path / f"{name}.mp4", numbered(5))
        for name in ("cam0", "cam1", "cam2")
    }
    out = tmp_path / "site.toml"
    assert write_site(out, rig, videos=videos, name="the hall", remark=nothing) == videos
    checked = check_site(out)
    assert checked.remarks == ()
    assert checked.file.site.name == "the-hall"
    assert checked.file.text.count("#") >= 5
    assert 'video = "cam1.mp4"' in checked.file.text


def test_poses_stand_in_place_of_videos(tmp_path: Path) -> None:
    make_site(tmp_path).unlink()
    out = tmp_path / "deeper" / "site.toml"
    out.parent.mkdir()
    poses = tmp_path / "walk.poses.jsonl"
    assert write_site(out, tmp_path / "rig.toml", poses=poses, fps=25.0, remark=nothing) == {}
    site = check_site(out).file.site
    assert site.poses is not None
    assert (site.poses.file, site.poses.fps, site.name) == (poses, 25.0, "deeper")


def test_a_site_file_is_never_overwritten(tmp_path: Path, rig: Path) -> None:
    (tmp_path / "site.toml").write_text("mine")
    with pytest.raises(InputError, match="is there already and is not overwritten"):
        write_site(tmp_path / "site.toml", rig, videos={}, remark=nothing)
    assert (tmp_path / "site.toml").read_text() == "mine"


def test_poses_of_other_cameras_are_refused_before_anything_is_written(tmp_path: Path) -> None:
    make_site(tmp_path).unlink()
    write_rig(Rig(ring(3).cameras[1:]), tmp_path / "rig.toml")
    poses = tmp_path / "walk.poses.jsonl"
    with pytest.raises(InputError, match="camera 'cam0' is not in the rig"):
        write_site(tmp_path / "site.toml", tmp_path / "rig.toml", poses=poses, remark=nothing)
    assert not (tmp_path / "site.toml").exists()


CAMERAS = ("cam1", "cam2", "cam12", "north")


@pytest.mark.parametrize(
    ("name", "camera"),
    [
        ("2024-01-31_Cam1_walk", "cam1"),
        ("cam12", "cam12"),
        ("CAM2", "cam2"),
        ("hall-north", "north"),
    ],
)
def test_a_video_belongs_to_the_camera_whose_name_is_in_its_name(name: str, camera: str) -> None:
    remarks: list[str] = []
    found = matched_cameras({name: Path(f"{name}.mp4")}, CAMERAS, remarks.append)
    assert found == {camera: Path(f"{name}.mp4")}
    assert len(remarks) == (name != camera)


@pytest.mark.parametrize(
    ("names", "told"),
    [
        (("GOPR0017",), "GOPR0017.mp4 belongs to no camera of the rig (it has cam1, cam2, cam12"),
        (("cam1_cam2",), "cam1_cam2.mp4 could be of cam1 or cam2"),
        (("cam1_a", "cam1_b"), "cam1_a.mp4 and cam1_b.mp4 are both of the camera 'cam1'"),
        (("a", "b"), "say which: NAME=b.mp4"),
    ],
)
def test_a_video_of_which_the_camera_is_not_clear_is_refused(
    names: tuple[str, ...], told: str
) -> None:
    with pytest.raises(InputError) as caught:
        matched_cameras({name: Path(f"{name}.mp4") for name in names}, CAMERAS, lambda text: None)
    assert told in str(caught.value)
