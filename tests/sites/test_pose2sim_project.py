"""Projects of Pose2Sim run as they are."""

import shutil
from pathlib import Path

import pytest

from made_rigs import ring
from made_videos import numbered, write_video
from trecsim.calibration import write_rig
from trecsim.errors import ConfigError
from trecsim.sites.check import check_site
from trecsim.sites.pose2sim_project import is_project, site_of_project

CONFIG = """
[project]
multi_person = true
frame_rate = 25
frame_range = [10, 300]
[pose]
vid_img_extension = 'mp4'
[synchronization]
"""


def project(folder: Path, *, calibrated: Path | None = None) -> Path:
    """Make a project with a calibration in `calibrated`, without poses and videos."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "Config.toml").write_text(CONFIG)
    place = (calibrated or folder) / "calibration"
    place.mkdir(exist_ok=True)
    write_rig(ring(3), place / "Calib_scene.toml", format="pose2sim")
    return folder / "Config.toml"


def with_videos(config: Path) -> Path:
    (config.parent / "videos").mkdir()
    for number in range(3):
        images = numbered(4, (1920, 1080))
        write_video(config.parent / "videos" / f"cam{number}.mp4", images, fps=25)
    return config


def test_a_project_is_told_from_a_site(tmp_path: Path) -> None:
    config = project(tmp_path)
    assert is_project(config)
    other = tmp_path / "site.toml"
    other.write_text(CONFIG)
    assert not is_project(other)
    config.write_text('format = "trecsim.site/1"\n')
    assert not is_project(config)


def test_the_videos_of_a_trial_run_with_the_calibration_of_its_session(tmp_path: Path) -> None:
    config = with_videos(project(tmp_path / "S01" / "P01" / "T00", calibrated=tmp_path / "S01"))
    told: list[str] = []
    site = site_of_project(config, told.append)
    checked = check_site(site)
    assert [source.video.name for source in checked.file.site.sources.values()] == [
        "cam0.mp4", "cam1.mp4", "cam2.mp4",
    ]  # fmt: skip
    assert any("frame_range is not used" in text for text in told)
    assert any("taken as synchronous" in text for text in told)
    assert site_of_project(config, told.append) == site
    assert "is used" in told[-1]


def test_synchronised_poses_are_taken_before_others(shared_data: Path, tmp_path: Path) -> None:
    source = shared_data / "foreign_input" / "pose2sim-pose-sync"
    folder = tmp_path / "trial"
    shutil.copytree(source / "project", folder)
    (folder / "Config.toml").write_text(CONFIG)
    (folder / "calibration").mkdir()
    shutil.copy(source / "rig.toml", folder / "calibration" / "Calib_rig.toml")
    site = site_of_project(folder / "Config.toml", lambda text: None)
    checked = check_site(site)
    assert checked.file.site.poses is not None
    assert checked.file.site.poses.file.name == "pose-sync"
    assert checked.file.site.poses.fps == 25.0


def test_what_a_project_lacks_is_told(tmp_path: Path) -> None:
    config = project(tmp_path / "trial")
    with pytest.raises(ConfigError, match=r"expected 2D poses in .* or videos in"):
        site_of_project(config, lambda text: None)
    shutil.rmtree(config.parent / "calibration")
    with pytest.raises(ConfigError, match="expected a calibration"):
        site_of_project(config, lambda text: None)
    assert not (config.parent / "site.toml").exists()
