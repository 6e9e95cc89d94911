"""A run goes on with the recording of an earlier one, however that ended."""

import json
import logging
import os
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from made_rigs import ring
from made_site import body_at, make_site
from trecsim.calibration import write_rig
from trecsim.errors import InputError
from trecsim.site_run import run
from trecsim.sites.check import CheckedSite, check_site
from trecsim.sources import read_poses
from trecsim.store.timing_csv import read_timing
from trecsim.store.tracks import read_tracks

# Runs a site and kills itself while it reads the image whose number is given.
KILLED = """
import os, signal, sys
from pathlib import Path
from trecsim.site_run import run
from trecsim.sites.check import check_site
from trecsim.store import tracks_parquet

tracks_parquet._PART_S = 0.0
last = int(sys.argv[3])
kill = lambda done, total: os.kill(os.getpid(), signal.SIGKILL) if done == last else None
run(check_site(Path(sys.argv[1])), Path(sys.argv[2]), progress=kill)
"""


@pytest.fixture
def checked(tmp_path: Path) -> CheckedSite:
    return check_site(make_site(tmp_path, more="[output]\nposes = true\n"))


def stopped(checked: CheckedSite, out: Path, images: int, *, resume: bool = False) -> None:
    """Run until so many images are done."""
    seen: list[int] = []
    run(
        checked,
        out,
        resume=resume,
        progress=lambda done, total: seen.append(done),
        stop=lambda: images in seen,
    )


def assert_complete(out: Path, moments: int = 40) -> None:
    """Fail unless everything is there once, in order, and the walker where he was."""
    tracks = list(read_tracks(out))
    times_s = [one.t_s for one in tracks]
    assert times_s == sorted(set(times_s))
    for one in tracks[-5:]:
        assert np.abs(one.xyz_m[0] - body_at(one.t_s)).max() < 0.05
    np.testing.assert_allclose(read_timing(out / "timing.csv").t_s, np.arange(moments) / 25.0)
    poses = [(one.camera, one.t_s) for one in read_poses(out / "poses.jsonl")]
    assert poses == [(f"cam{n}", i / 25.0) for i in range(moments) for n in range(3)]


def people(out: Path) -> list[int]:
    """Return the identities in order of their first moments."""
    return list(dict.fromkeys(int(one) for moment in read_tracks(out) for one in moment.id))


def test_a_stopped_run_is_continued_where_it_ended(checked: CheckedSite, tmp_path: Path) -> None:
    stopped(checked, tmp_path / "out", 60)
    before = list(read_tracks(tmp_path / "out"))
    summary = run(checked, tmp_path / "out", resume=True)
    assert summary.ended == "complete"
    assert (summary.images, summary.frame_sets) == (60, 20)
    assert_complete(tmp_path / "out")
    assert [one.t_s for one in read_tracks(tmp_path / "out")][: len(before)] == [
        one.t_s for one in before
    ]
    assert people(tmp_path / "out") == [0, 1]
    ((last_s, next_s),) = summary.gaps_s
    assert last_s == before[-1].t_s
    assert last_s < next_s < last_s + 0.5
    facts = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert facts["gaps_s"] == [[last_s, next_s]]


def test_a_killed_run_is_continued(tmp_path: Path) -> None:
    site = make_site(tmp_path, more="[output]\nposes = true\n")
    ended = subprocess.run(
        [sys.executable, "-c", KILLED, str(site), str(tmp_path / "out"), "70"],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
        check=False,
    )
    assert ended.returncode == -signal.SIGKILL
    assert (tmp_path / "out" / ".lock").exists()
    with pytest.raises(InputError, match="or --resume to go on with the recording in it"):
        run(check_site(site), tmp_path / "out")
    summary = run(check_site(site), tmp_path / "out", resume=True)
    assert summary.ended == "complete"
    assert_complete(tmp_path / "out")
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == [
        "poses.jsonl",
        "rig.toml",
        "summary.json",
        "timing.csv",
        "tracks.parquet",
    ]


def test_a_run_may_be_continued_more_than_once(checked: CheckedSite, tmp_path: Path) -> None:
    stopped(checked, tmp_path / "out", 39)
    stopped(checked, tmp_path / "out", 39, resume=True)
    summary = run(checked, tmp_path / "out", resume=True)
    assert_complete(tmp_path / "out")
    assert people(tmp_path / "out") == [0, 1, 2]
    assert len(summary.gaps_s) == 2


def test_without_a_recording_a_new_one_begins(checked: CheckedSite, tmp_path: Path) -> None:
    summary = run(checked, tmp_path / "out", resume=True)
    assert (summary.images, summary.gaps_s) == (120, ())
    assert_complete(tmp_path / "out")
    assert (tmp_path / "out" / "tracks.parquet").is_file()


def test_a_recording_that_is_complete_stays_as_it_is(
    checked: CheckedSite, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    run(checked, tmp_path / "out")
    told = (tmp_path / "out" / "summary.json").read_text()
    with caplog.at_level(logging.WARNING):
        summary = run(checked, tmp_path / "out", resume=True)
    assert (summary.images, summary.frame_sets) == (0, 0)
    assert (tmp_path / "out" / "summary.json").read_text() == told
    assert "no image is later than 1.560 s, where the recording ends" in caplog.text
    assert "so there are no people" not in caplog.text
    assert_complete(tmp_path / "out")


def test_a_recording_of_other_cameras_is_not_continued(
    checked: CheckedSite, tmp_path: Path
) -> None:
    stopped(checked, tmp_path / "out", 60)
    before = sorted(path.name for path in (tmp_path / "out").iterdir())
    moved = [replace(camera, time_offset_s=0.1) for camera in ring(3)]
    write_rig(type(checked.rig)(moved), tmp_path / "rig.toml")
    with pytest.raises(InputError, match=r"out was recorded with other cameras"):
        run(check_site(tmp_path / "site.toml"), tmp_path / "out", resume=True)
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == before


def test_a_fault_before_the_first_new_frame_set_keeps_the_recording(
    checked: CheckedSite, tmp_path: Path
) -> None:
    stopped(checked, tmp_path / "out", 60)
    before = [one.t_s for one in read_tracks(tmp_path / "out")]
    poses = tmp_path / "walk.poses.jsonl"
    poses.write_text(poses.read_text().replace('"t_s"', '"time"'))
    with pytest.raises(InputError, match="line 2"):
        run(checked, tmp_path / "out", resume=True)
    assert [one.t_s for one in read_tracks(tmp_path / "out")] == before


def test_an_interruption_before_the_first_new_frame_set_keeps_the_recording(
    checked: CheckedSite, tmp_path: Path
) -> None:
    stopped(checked, tmp_path / "out", 60)
    before = [one.t_s for one in read_tracks(tmp_path / "out")]

    def interrupt(done: int, total: int | None) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt, match=r"before the first new frame set; what was in"):
        run(checked, tmp_path / "out", resume=True, progress=interrupt)
    assert [one.t_s for one in read_tracks(tmp_path / "out")] == before


def test_two_runs_do_not_share_a_folder(checked: CheckedSite, tmp_path: Path) -> None:
    refused: list[str] = []

    def begin_another(done: int, total: int | None) -> None:
        if done == 50:
            for resume in (False, True):
                with pytest.raises(InputError) as caught:
                    run(checked, tmp_path / "out", resume=resume)
                refused.append(str(caught.value))

    run(checked, tmp_path / "out", progress=begin_another)
    assert len(refused) == 2
    assert all("is in use" in text and str(os.getpid()) in text for text in refused)
    assert_complete(tmp_path / "out")


def test_a_folder_that_is_removed_while_a_run_writes_there_is_told(
    checked: CheckedSite, tmp_path: Path
) -> None:
    def remove(done: int, total: int | None) -> None:
        if done == 50:
            (tmp_path / "out").rename(tmp_path / "elsewhere")

    with pytest.raises(Exception, match="was removed or renamed while it was written") as caught:
        run(checked, tmp_path / "out", progress=remove)
    assert getattr(caught.value, "exit_code", None) == 1
