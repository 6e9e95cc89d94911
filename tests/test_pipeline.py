"""Runs end to end on a made site, and every way one can end."""

import errno
import json
import os
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from made_rigs import ring
from made_site import body_at, make_site
from trecsim import pipeline, run_watch
from trecsim.calibration import read_rig
from trecsim.errors import InputError, SetupError
from trecsim.geometry import Rig
from trecsim.pipeline import track
from trecsim.site_run import run
from trecsim.sites.check import CheckedSite, check_site
from trecsim.store.parquet_reading import read_info
from trecsim.store.rig_digest import rig_sha256
from trecsim.store.timing_csv import read_timing
from trecsim.store.tracks import kept_of, read_tracks
from trecsim.values import Poses2D


@pytest.fixture
def checked(tmp_path: Path) -> CheckedSite:
    return check_site(make_site(tmp_path))


def test_a_run_keeps_tracks_and_summary(checked: CheckedSite, tmp_path: Path) -> None:
    seen: list[tuple[int, int | None]] = []
    out = tmp_path / "out"
    summary = run(checked, out, progress=lambda done, total: seen.append((done, total)))
    assert (summary.ended, summary.fault) == ("complete", None)
    assert (summary.images, summary.frame_sets, summary.people) == (120, 40, 1)
    assert seen[-1] == (120, None)
    assert sorted(path.name for path in out.iterdir()) == [
        "rig.toml",
        "summary.json",
        "timing.csv",
        "tracks.parquet",
    ]
    *_, last = read_tracks(out)
    assert np.abs(last.xyz_m[0] - body_at(last.t_s)).max() < 0.02
    assert read_info(out / "tracks.parquet").rig_sha256 == rig_sha256(checked.rig)


def test_a_run_keeps_its_cameras_and_what_each_frame_set_cost(
    checked: CheckedSite, tmp_path: Path
) -> None:
    run(checked, tmp_path / "out")
    assert rig_sha256(read_rig(tmp_path / "out" / "rig.toml")) == rig_sha256(checked.rig)
    timing = read_timing(tmp_path / "out" / "timing.csv")
    assert len(timing.t_s) == 40
    assert timing.images.sum() == 120
    assert timing.people.tolist() == [1] * 40
    assert (timing.fusion_ms > 0).all()


def test_the_track_command_writes_the_same_timings_on_request(
    checked: CheckedSite, tmp_path: Path
) -> None:
    run(checked, tmp_path / "out")
    poses, timing = tmp_path / "walk.poses.jsonl", tmp_path / "timing.csv"
    summary = track(checked.rig, poses, tmp_path / "tracks.csv", timing=timing)
    ours, theirs = read_timing(timing), read_timing(tmp_path / "out" / "timing.csv")
    np.testing.assert_array_equal(ours.t_s, theirs.t_s)
    np.testing.assert_array_equal(ours.people, theirs.people)
    assert summary["fusion_ms"]["max"] == pytest.approx(ours.fusion_ms.max(), abs=1e-3)


def test_poses_that_are_wrong_from_the_start_leave_no_timings(
    checked: CheckedSite, tmp_path: Path
) -> None:
    (tmp_path / "bad.poses.jsonl").write_text("{}\n")
    with pytest.raises(InputError):
        track(
            checked.rig,
            tmp_path / "bad.poses.jsonl",
            tmp_path / "tracks.csv",
            timing=tmp_path / "timing.csv",
        )
    assert list(tmp_path.glob("timing*")) == []


def test_the_summary_tells_settings_and_versions(checked: CheckedSite, tmp_path: Path) -> None:
    run(checked, tmp_path / "out")
    facts = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert facts["format"] == "trecsim.summary/1"
    assert facts["frame_sets"] == 40
    assert set(facts["fusion_ms"]) == {"median", "p95", "max", "mean"}
    assert facts["configuration"]["fusion"]["knot_s"] > 0
    assert facts["versions"]["mc3d-trecsim"]


def test_poses_are_kept_on_request(tmp_path: Path) -> None:
    run(check_site(make_site(tmp_path, more="[output]\nposes = true\n")), tmp_path / "out")
    kept = (tmp_path / "out" / "poses.jsonl").read_text()
    assert kept == (tmp_path / "walk.poses.jsonl").read_text()


def test_without_a_place_a_run_gets_a_new_directory_beside_the_site(
    checked: CheckedSite, tmp_path: Path
) -> None:
    assert run(checked).out.parent == tmp_path / "recordings" / "made"


def test_a_recording_is_not_overwritten(checked: CheckedSite, tmp_path: Path) -> None:
    run(checked, tmp_path / "out")
    before = (tmp_path / "out" / "summary.json").read_text()
    with pytest.raises(InputError, match="is not empty"):
        run(checked, tmp_path / "out")
    assert (tmp_path / "out" / "summary.json").read_text() == before


def test_a_run_that_is_stopped_keeps_what_it_has(checked: CheckedSite, tmp_path: Path) -> None:
    asked = iter([False] * 89 + [True])
    summary = run(checked, tmp_path / "out", stop=lambda: next(asked))
    assert (summary.ended, summary.images) == ("stopped", 90)
    assert summary.frame_sets == 30
    assert list(read_tracks(tmp_path / "out"))[-1].t_s == summary.last_s
    assert json.loads((tmp_path / "out" / "summary.json").read_text())["ended"] == "stopped"


def test_a_run_that_is_interrupted_says_what_it_keeps(checked: CheckedSite, tmp_path: Path) -> None:
    def interrupt(done: int, total: int | None) -> None:
        if done == 100:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt, match=r"after \d+ frame sets; .* kept in .*out"):
        run(checked, tmp_path / "out", progress=interrupt)
    assert len(list(read_tracks(tmp_path / "out"))) > 20


def test_a_run_that_is_interrupted_before_its_first_frame_set_leaves_nothing(
    checked: CheckedSite, tmp_path: Path
) -> None:
    def interrupt(done: int, total: int | None) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt, match="nothing is kept"):
        run(checked, tmp_path / "out", progress=interrupt)
    assert not (tmp_path / "out").exists()


def test_a_run_tells_now_and_then_how_far_it_is(
    checked: CheckedSite, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    told: list[int] = []
    monkeypatch.setattr(run_watch, "TELL_EVERY_S", 0.0)
    run(checked, tmp_path / "out", tell=lambda tally: told.append(tally.frame_sets))
    assert len(told) >= 120  # once an image, and while kernels are compiled
    assert told == sorted(told)
    assert told[-1] >= 39
    told.clear()
    monkeypatch.setattr(run_watch, "TELL_EVERY_S", 1e9)
    run(checked, tmp_path / "again", tell=lambda tally: told.append(tally.frame_sets))
    assert told == []


def test_a_recording_that_breaks_off_is_told_and_what_came_before_kept(
    tmp_path: Path,
) -> None:
    checked = check_site(make_site(tmp_path))
    poses = tmp_path / "walk.poses.jsonl"
    lines = poses.read_text().splitlines()
    lines[91] = lines[91].replace('"t_s"', '"time"')
    poses.write_text("\n".join(lines) + "\n")
    with pytest.raises(InputError, match=r"line 92.*the results before that are kept in .*out"):
        run(checked, tmp_path / "out")
    facts = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert facts["ended"] == "failed"
    assert "line 92" in facts["fault"]
    assert len(list(read_tracks(tmp_path / "out"))) > 20


def test_a_run_that_fails_at_once_leaves_nothing(checked: CheckedSite, tmp_path: Path) -> None:
    poses = tmp_path / "walk.poses.jsonl"
    poses.write_text(poses.read_text().replace('"t_s"', '"time"'))
    with pytest.raises(InputError, match="line 2"):
        run(checked, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_disk_that_fills_up_keeps_what_was_recorded(
    checked: CheckedSite, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    replace_file = Path.replace

    def full(temporary: Path, target: Path) -> Path:
        if target.name == "tracks.parquet":
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return replace_file(temporary, target)

    monkeypatch.setattr(Path, "replace", full)
    with pytest.raises(SetupError, match=r"disk is full.*kept in .*tracks\.parquet\.parts"):
        run(checked, tmp_path / "out")
    assert len(list(read_tracks(tmp_path / "out"))) > 20


@pytest.mark.parametrize("name", ["tracks.csv", "tracks.parquet"])
def test_track_writes_either_format(checked: CheckedSite, tmp_path: Path, name: str) -> None:
    summary = track(checked.rig, tmp_path / "walk.poses.jsonl", tmp_path / name)
    assert (summary["frame_sets"], summary["people"]) == (40, 1)
    assert len(list(read_tracks(tmp_path / name))) > 30


@pytest.mark.parametrize("name", ["tracks.csv", "tracks.parquet"])
def test_poses_that_are_wrong_at_once_leave_nothing(
    checked: CheckedSite, tmp_path: Path, name: str
) -> None:
    poses = tmp_path / "walk.poses.jsonl"
    poses.write_text(poses.read_text().replace('"t_s"', '"time"'))
    before = sorted(tmp_path.iterdir())
    with pytest.raises(InputError, match="line 2"):
        track(checked.rig, poses, tmp_path / name)
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize("name", ["tracks.csv", "tracks.parquet"])
def test_ctrl_c_while_tracking_keeps_what_was_finished(
    checked: CheckedSite, tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    read = pipeline.read_poses

    def interrupted(*given: object, **more: object) -> Iterator[Poses2D]:
        for count, poses in enumerate(read(*given, **more)):  # type: ignore[arg-type]
            if count == 100:
                raise KeyboardInterrupt
            yield poses

    monkeypatch.setattr(pipeline, "read_poses", interrupted)
    kept = kept_of(tmp_path / name)
    with pytest.raises(KeyboardInterrupt, match=rf"stopped.*kept in {kept}"):
        track(checked.rig, tmp_path / "walk.poses.jsonl", tmp_path / name)
    assert not (tmp_path / name).exists()
    assert kept.exists()


def test_the_digest_of_a_rig_changes_with_every_number() -> None:
    rig = ring(2)
    first, second = rig
    nudged = second.T_cam_world.copy()
    nudged[0, 3] += 1e-12
    others = [
        Rig((first, replace(second, T_cam_world=nudged))),
        Rig((first, replace(second, name="other"))),
        Rig((first, replace(second, time_offset_s=0.01))),
        Rig((first, replace(second, time_drift_ppm=0.5))),
        Rig((first, replace(second, time_drift_ppm=0.5, time_ref_s=2.0))),
        Rig((second, first)),
    ]
    digests = {rig_sha256(one) for one in [rig, *others]}
    assert len(digests) == 7


def test_the_digest_survives_the_file(tmp_path: Path, checked: CheckedSite) -> None:
    assert rig_sha256(read_rig(tmp_path / "rig.toml")) == rig_sha256(checked.rig)


def test_the_summary_of_a_run_holds_what_does_not_fit(tmp_path: Path) -> None:
    site = make_site(tmp_path)
    poses = tmp_path / "walk.poses.jsonl"
    late = [
        json.dumps({**json.loads(line), "t_s": json.loads(line)["t_s"] + 1000.0})
        if '"cam1"' in line
        else line
        for line in poses.read_text().splitlines()
    ]
    poses.write_text("\n".join(late) + "\n")
    summary = run(check_site(site), tmp_path / "out")
    facts = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert facts["remarks"] == list(summary.remarks)
    assert any("cam1" in text for text in summary.remarks)


def test_starts_within_one_second_get_a_folder_each(
    checked: CheckedSite, monkeypatch: pytest.MonkeyPatch
) -> None:
    from trecsim import site_run

    class Frozen(site_run.datetime):
        @classmethod
        def now(cls, tz: object = None) -> "Frozen":
            return cls(2026, 3, 1, 10, 15, 0)

    monkeypatch.setattr(site_run, "datetime", Frozen)
    names = [run(checked).out.name for _ in range(3)]
    assert names == ["20260301T101500Z", "20260301T101500Z-2", "20260301T101500Z-3"]
