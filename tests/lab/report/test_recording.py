"""What lies in the folder of a recording, and what does not."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from made_recording import make_recording, snapshots
from trecsim.errors import InputError
from trecsim.lab.report.recording import Recording, read_recording
from trecsim.lab.report.recording_files import find
from trecsim.store.tracks import tracks_writer


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make_recording(tmp_path_factory.mktemp("recording") / "walk")


def read(path: Path, **options: float) -> Recording:
    return read_recording(find(path), **options)


def test_a_folder_gives_all_its_pieces(folder: Path) -> None:
    recording = read(folder)
    assert recording.name == "hall"
    assert recording.rig is not None
    assert recording.truth is not None
    assert recording.timing is not None
    assert (recording.moment_count, recording.person_moments) == (56, 56)
    assert (recording.start_s, recording.end_s) == pytest.approx((0.0, 59 * 0.04))
    assert recording.period_s == pytest.approx(0.04)
    assert recording.moment_s == pytest.approx(0.04)
    np.testing.assert_allclose(recording.t_s, np.arange(4, 60) * 0.04)


def test_a_file_of_tracks_stands_for_itself(folder: Path) -> None:
    recording = read(folder / "tracks.csv")
    assert (recording.rig, recording.timing, recording.truth) == (None, None, None)
    assert recording.name == "walk"
    assert recording.start_s == pytest.approx(4 * 0.04)


def test_pieces_can_lie_elsewhere(folder: Path) -> None:
    places = find(folder / "tracks.csv", rig=folder / "rig.toml", truth=folder / "truth.npz")
    recording = read_recording(places)
    assert recording.rig is not None
    assert recording.truth is not None


def test_the_folder_of_a_demo_gives_its_run_and_what_it_was_made_of(tmp_path: Path) -> None:
    walk = make_recording(tmp_path / "demo", 8)
    (walk / "run").mkdir()
    for name in ("tracks.csv", "timing.csv", "summary.json"):
        (walk / name).rename(walk / "run" / name)
    recording = read(walk)
    assert recording.moment_count == 4
    assert recording.truth is not None
    assert recording.places.timing == walk / "run" / "timing.csv"


def test_tracks_of_a_run_go_before_others(folder: Path, tmp_path: Path) -> None:
    for name in ("tracks.csv", "tracks.parquet"):
        with tracks_writer(tmp_path / name):
            pass
    assert find(tmp_path).tracks.name == "tracks.parquet"


@pytest.mark.parametrize(("ending", "part"), [(".csv", ".partial"), (".parquet", ".parts")])
def test_what_an_interrupted_run_left_can_be_read(tmp_path: Path, ending: str, part: str) -> None:
    path = tmp_path / f"tracks{ending}"

    def interrupted() -> None:
        with tracks_writer(path) as tracks:
            for snapshot in snapshots(10):
                tracks.write(snapshot)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert not path.exists()
    recording = read(tmp_path)
    assert recording.moment_count == 6
    assert recording.unfinished
    assert read(tmp_path / f"tracks{ending}{part}").unfinished


def test_a_part_of_the_time_counts_from_the_start_of_the_recording(folder: Path) -> None:
    recording = read(folder, from_s=1.0, to_s=1.5)
    assert recording.moment_count == 13
    assert recording.timing is not None
    assert len(recording.timing.t_s) == 13
    assert recording.start_s == pytest.approx(1.0)


@pytest.mark.parametrize(("from_s", "to_s"), [(-1.0, 5.0), (2.0, 1.0), (math.nan, 1.0)])
def test_a_part_must_have_a_length(folder: Path, from_s: float, to_s: float) -> None:
    with pytest.raises(InputError, match="must have a length"):
        read(folder, from_s=from_s, to_s=to_s)


def test_a_part_with_nobody_in_it_is_told(folder: Path) -> None:
    with pytest.raises(InputError, match="there are no people from 100 s"):
        read(folder, from_s=100.0)


def test_a_folder_without_tracks_says_what_was_expected(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"no tracks in .*expected tracks.parquet or tracks.csv"):
        find(tmp_path)
    with pytest.raises(InputError, match="there is no recording at"):
        find(tmp_path / "nothing")


@pytest.mark.parametrize("text", ["", "[]", "{", "1", "[" * 100_000, "\ud800"])
def test_a_summary_that_is_none_is_told(folder: Path, tmp_path: Path, text: str) -> None:
    (tmp_path / "tracks.csv").write_text((folder / "tracks.csv").read_text())
    (tmp_path / "summary.json").write_bytes(text.encode("utf-8", "surrogatepass"))
    with pytest.raises(InputError, match=r"summary.json is not a summary of a run"):
        read(tmp_path)


def test_a_summary_of_odd_content_does_no_harm(folder: Path, tmp_path: Path) -> None:
    (tmp_path / "tracks.csv").write_text((folder / "tracks.csv").read_text())
    (tmp_path / "summary.json").write_text(json.dumps({"site": ["x"], "ended": 3}))
    assert read(tmp_path).name == tmp_path.name


def test_times_of_a_long_recording_are_told_in_minutes_and_hours(folder: Path) -> None:
    from dataclasses import replace

    recording = read(folder)
    assert recording.clock.unit == "s"
    assert replace(recording, end_s=600.0).clock.label == "time from the start [min]"
    assert replace(recording, end_s=4 * 3600.0).clock.unit == "h"
