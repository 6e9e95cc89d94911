"""Everything a site file names is looked at before anything runs."""

from dataclasses import replace
from pathlib import Path

import pytest

from made_rigs import ring
from made_site import make_site
from made_videos import numbered, write_tracks, write_video
from trecsim.calibration import write_rig
from trecsim.errors import ConfigError
from trecsim.geometry import Rig
from trecsim.sites.check import check_site


@pytest.fixture
def site(tmp_path: Path) -> Path:
    """Return a site with three cameras of 64 x 48 px, of which two have a video."""
    rig = Rig(tuple(replace(camera, size_px=(64, 48)) for camera in ring(3)))
    write_rig(rig, tmp_path / "rig.toml")
    for name in ("cam0", "cam1"):
        write_video(tmp_path / f"{name}.mp4", numbered(5))
    (tmp_path / "site.toml").write_text(
        'format = "trecsim.site/1"\nname = "small"\nrig = "rig.toml"\n'
        '[sources.cam0]\nvideo = "cam0.mp4"\n[sources.cam1]\nvideo = "cam1.mp4"\n'
    )
    return tmp_path / "site.toml"


def faults_of(site: Path, old: str, new: str) -> str:
    text = site.read_text()
    assert old in text
    site.write_text(text.replace(old, new))
    with pytest.raises(ConfigError) as caught:
        check_site(site)
    return str(caught.value)


def test_a_good_site_is_known_before_it_runs(site: Path) -> None:
    checked = check_site(site)
    assert checked.rig.names == ("cam0", "cam1", "cam2")
    assert checked.videos["cam1"].size_px == (64, 48)
    assert checked.remarks == ("cameras of the rig without a source: cam2",)


def test_one_camera_alone_is_remarked(site: Path) -> None:
    site.write_text(site.read_text().partition("[sources.cam1]")[0])
    assert "only one camera has a source" in check_site(site).remarks[-1]


def test_a_video_of_another_size_than_calibrated_is_refused(site: Path) -> None:
    write_video(site.parent / "cam1.mp4", numbered(5, (32, 24)))
    told = faults_of(site, "small", "tiny")
    assert "line 7: sources.cam1.video: expected images of 64 x 48 px" in told
    assert "found 32 x 24 px" in told


def test_several_video_tracks_are_remarked(site: Path) -> None:
    write_tracks(site.parent / "cam1.mp4", [(32, 24), (64, 48)])
    remark, _ = check_site(site).remarks
    assert "cam1.mp4 has several video tracks: the largest, 64 x 48 px, is read" in remark


def test_a_video_that_lacks_a_few_columns_is_taken_as_cut(site: Path) -> None:
    rig = Rig(tuple(replace(camera, size_px=(65, 48)) for camera in ring(3)))
    write_rig(rig, site.parent / "rig.toml")
    remarks = check_site(site).remarks
    assert "cam0: expected images of 65 x 48 px" in remarks[0]
    assert "assuming the image was cropped" in remarks[0]


def test_an_estimator_that_is_not_installed_is_told_with_the_nearest(site: Path) -> None:
    told = faults_of(site, "[sources.cam1]", '[estimator]\nname = "movnet"\n[sources.cam1]')
    assert "line 7: estimator.name: no estimator called 'movnet' is installed" in told
    assert "did you mean 'movenet'?" in told


def test_a_wrong_setting_of_the_estimator_is_told_with_its_line(site: Path) -> None:
    site.write_text(site.read_text() + '[estimator]\nname = "movenet"\nlong_sied = 300\n')
    with pytest.raises(ConfigError, match=r"site\.toml: line 8: .*did you mean 'long_side'"):
        check_site(site)


def test_the_faults_of_all_stages_are_told_at_once(site: Path) -> None:
    (site.parent / "cam1.mp4").unlink()
    text = site.read_text().replace('"small"', '"back yard"').replace("cam0]", "cam7]")
    site.write_text(
        text
        + '[sources.cam2]\nvideo = "rtsp://me:pw@10.0.0.12/1"\n[estimator]\nlong_side = 1\n'
        + "[fusion]\nmin_joints = 18\n[output]\nlag = 0.2\n[[rules]]\n"
    )
    told = faults_of(site, "small" if "small" in text else "back", "back")
    expected = [
        "line 2: name: expected 1 to 64 letters",
        "line 4: sources.cam7: camera 'cam7' is not in the rig; known: cam0, cam1, cam2",
        "line 7: sources.cam1.video: cannot read video",
        "line 9: sources.cam2.video: expected a file, found rtsp://***@10.0.0.12/1; a live",
        "line 10: estimator: settings of the estimator 'movenet': long_side",
        "line 12: fusion: min_joints = 18 leaves nobody",
        "line 15: output.lag: unknown key; did you mean 'lag_s'?",
        "line 16: rules.0.kind: is missing",
    ]
    lines = [line.strip() for line in told.splitlines()[1:]]
    assert len(lines) == len(expected)
    for line, start in zip(lines, expected, strict=True):
        assert line.startswith(start), line


def test_videos_are_looked_at_though_the_rig_cannot_be_read(site: Path) -> None:
    (site.parent / "cam1.mp4").unlink()
    told = faults_of(site, '"rig.toml"', '"gone.toml"')
    assert "line 3: rig: cannot read the rig" in told
    assert "line 7: sources.cam1.video: cannot read video" in told


@pytest.mark.parametrize("key", ["notify", "alerts"])
def test_keys_for_alerts_of_other_programs_lead_to_outputs(site: Path, key: str) -> None:
    told = faults_of(site, "[sources.cam1]", f"[{key}.x]\n[sources.cam1]")
    assert "events are sent by [[outputs]]" in told
    assert "did you mean" not in told


def test_poses_of_a_camera_that_the_rig_lacks_are_told(tmp_path: Path) -> None:
    site = make_site(tmp_path)
    write_rig(Rig(ring(3).cameras[1:]), tmp_path / "rig.toml")
    assert "line 4: poses: " in faults_of(site, "made", "other")


def test_a_rate_of_poses_that_is_assumed_is_remarked(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    site = make_site(tmp_path)
    site.write_text(site.read_text().replace("walk.poses.jsonl", "results"))
    (tmp_path / "results").mkdir()
    for name in ("cam0", "cam1"):
        (tmp_path / "results" / f"{name}.json").write_text("[]")
    assert "30 frames per second assumed" in check_site(site).remarks[0]
    assert caplog.messages == []


def test_settings_outside_of_what_is_sensible_are_remarked(site: Path) -> None:
    site.write_text(site.read_text() + "[fusion]\njoint_sigma_m = 20\nmin_joints = 9\n")
    assert check_site(site).remarks[-2:] == (
        "fusion: joint_sigma_m = 20 is far outside the sensible range (0.012 to 0.04 m)",
        "fusion: min_joints = 9 is outside the sensible range (4 to 8)",
    )


def test_settings_by_their_earlier_names_are_remarked(site: Path) -> None:
    site.write_text(site.read_text() + "[fusion]\ndoubt_s = 2\n")
    checked = check_site(site)
    assert checked.file.site.fusion.model_dump()["single_view_death_s"] == 2.0
    assert checked.remarks[-1] == (
        "fusion.doubt_s is called single_view_death_s today; the old name still works"
    )


def test_more_joints_than_a_body_has_are_refused_with_their_line(site: Path) -> None:
    told = faults_of(site, "[sources.cam1]", "[fusion]\nmin_joints = 18\n[sources.cam1]")
    assert "line 6: fusion: min_joints = 18 leaves nobody" in told


def test_files_of_feeds_are_looked_at(site: Path) -> None:
    place = "[lines.left]\npoints_m = [[0.0, 0.0], [1.0, 0.0]]\n"
    site.write_text(site.read_text() + place + '[feeds.gate]\nfile = "gate.jsonl"\n')
    assert "gate.jsonl cannot be read: No such file" in check_site(site).remarks[-1]
    (site.parent / "gate.jsonl").write_text('{"t_s": 1, "grant": "lfet"}\n')
    assert "feed gate tells of line 'lfet'" in check_site(site).remarks[-1]
    assert "feeds.gate.file: expected a file with messages" in faults_of(site, "gate.jsonl", ".")
    assert "found one with a NUL" in faults_of(site, 'file = "."', 'file = "a\\u0000b"')
