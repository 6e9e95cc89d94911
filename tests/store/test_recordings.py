"""The folder of a recording: claimed, written, continued, discarded."""

from pathlib import Path

import numpy as np
import pytest

from made_tracks import assert_same, snapshot, walk
from trecsim.errors import InputError
from trecsim.sources import read_poses
from trecsim.store.names import RIG_FROM
from trecsim.store.parquet_file import TracksInfo
from trecsim.store.recordings import (
    Stored,
    claim_folder,
    discard_recording,
    newest_rig,
    poses_recorder,
    stored_in,
    timing_recorder,
    tracks_recorder,
)
from trecsim.store.timing_csv import StepTiming, read_timing, timing_in
from trecsim.store.timing_writer import TimingWriter
from trecsim.store.tracks import read_tracks
from trecsim.values import Poses2D, Snapshot

INFO = TracksInfo(rig_sha256="abc")


def record(
    folder: Path, moments: list[Snapshot], *, resume: bool = False, crash: bool = False
) -> None:
    """Record what `trecsim run` would; a crash ends without giving files their names."""
    (folder / "rig.toml").touch()
    tracks = tracks_recorder(folder, INFO, resume=resume)
    timing = timing_recorder(folder, resume=resume)
    poses = poses_recorder(folder, resume=resume)
    for one in moments:
        tracks.write(one)
        timing.write(StepTiming(one.t_s, 2, len(one.id), 1.5))
        poses.write(image("north", one.t_s))
    for writer in (tracks, timing, poses):
        if crash:
            writer.abandon()
        else:
            writer.close()


def image(camera: str, t_s: float) -> Poses2D:
    return Poses2D(camera, t_s, np.ones((1, 17, 2)), np.ones((1, 17)), np.ones(1))


@pytest.mark.parametrize("crash", [False, True])
def test_a_recording_is_continued_with_all_its_files(tmp_path: Path, crash: bool) -> None:
    before, after = list(walk(10)), [snapshot(100.0 + one.t_s, [7, 8]) for one in walk(5)]
    record(tmp_path, before, crash=crash)
    assert stored_in(tmp_path) == Stored(2, before[-1].t_s, "abc")
    record(tmp_path, after, resume=True)
    assert_same(list(read_tracks(tmp_path)), before + after)
    times_s = [one.t_s for one in before + after]
    timing = timing_in(tmp_path)
    assert timing is not None
    assert read_timing(timing).t_s.tolist() == times_s
    assert [one.t_s for one in read_poses(tmp_path / "poses.jsonl")] == times_s
    assert stored_in(tmp_path) == Stored(9, after[-1].t_s, "abc")
    names = ["poses.jsonl", "rig.toml", "timing.csv", "tracks.parquet"]
    assert sorted(path.name for path in tmp_path.iterdir()) == names
    assert all((tmp_path / name).is_file() for name in names)  # since it is short


def test_a_long_recording_that_is_continued_keeps_its_segments(tmp_path: Path) -> None:
    before = [snapshot(t_s, [1]) for t_s in (0.0, 1800.0)]
    after = [snapshot(t_s, [2]) for t_s in (3000.0, 7200.0)]
    record(tmp_path, before, crash=True)
    record(tmp_path, after, resume=True)
    assert (tmp_path / "tracks.parquet").is_dir()
    assert (tmp_path / "timing.csv").is_dir()
    assert_same(list(read_tracks(tmp_path)), before + after)
    times_s = [one.t_s for one in before + after]
    assert read_timing(tmp_path / "timing.csv").t_s.tolist() == times_s


def test_what_is_stored_already_is_not_stored_again(tmp_path: Path) -> None:
    moments = list(walk(10))
    record(tmp_path, moments[:6], crash=True)
    record(tmp_path, moments[3:], resume=True)
    assert_same(list(read_tracks(tmp_path)), moments)
    assert read_timing(tmp_path / "timing.csv").t_s.tolist() == [one.t_s for one in moments]
    poses = [one.t_s for one in read_poses(tmp_path / "poses.jsonl")]
    assert poses == [one.t_s for one in moments]


def test_timings_of_a_long_recording_lie_in_segments(tmp_path: Path) -> None:
    path = tmp_path / "timing.csv"
    times_s = np.arange(0.0, 3 * 3600.0, 600.0).tolist()
    with timing_recorder(tmp_path) as writer:
        for t_s in times_s:
            writer.write(StepTiming(t_s, 2, 1, 1.5))
        unfinished = read_timing(tmp_path / "timing.csv.partial")
        assert unfinished.t_s.tolist() == times_s[:12]  # the rest is not with the system yet
    assert sorted(one.name for one in path.iterdir()) == [f"0000000{n}.csv" for n in (1, 2, 3)]
    assert timing_in(tmp_path) == path
    assert read_timing(path).t_s.tolist() == times_s
    assert read_timing(path, 3000.0, 4200.0).t_s.tolist() == [3000.0, 3600.0, 4200.0]


def test_only_the_timings_that_are_asked_for_are_read(tmp_path: Path) -> None:
    with timing_recorder(tmp_path) as writer:
        for t_s in np.arange(0.0, 3 * 3600.0, 600.0).tolist():
            writer.write(StepTiming(t_s, 2, 1, 1.5))
    damaged = tmp_path / "timing.csv" / "00000002.csv"
    damaged.write_bytes(damaged.read_bytes() + b"damaged\n")
    assert len(read_timing(tmp_path / "timing.csv", 7300.0).t_s) == 5
    with pytest.raises(InputError, match=r"00000002\.csv"):
        read_timing(tmp_path / "timing.csv", 7000.0)


def test_the_next_identity_is_above_all_that_are_stored(tmp_path: Path) -> None:
    assert stored_in(tmp_path) == Stored(0, None, None)
    record(tmp_path, [snapshot(0.0, [3, 41]), snapshot(1.0, [5])], crash=True)
    assert stored_in(tmp_path).next_person == 42


def test_a_recording_of_nobody_ends_with_its_timings(tmp_path: Path) -> None:
    record(tmp_path, [snapshot(5.0, [])], crash=True)
    assert stored_in(tmp_path) == Stored(0, 5.0, None)


def test_a_new_recording_needs_an_empty_folder(tmp_path: Path) -> None:
    record(tmp_path, list(walk(3)))
    with pytest.raises(InputError, match=r"not empty; .*--out, or --resume to go on"):
        claim_folder(tmp_path)
    with claim_folder(tmp_path, resume=True), claim_folder(tmp_path / "new", resume=True):
        pass
    assert len(list(read_tracks(tmp_path))) == 3


def test_a_folder_of_something_else_is_not_continued(tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").touch()
    with pytest.raises(InputError, match=r"holds no recording to go on with.*found thesis\.tex"):
        claim_folder(tmp_path, resume=True)


@pytest.mark.parametrize("crash", [False, True])
def test_discarding_removes_a_recording_and_nothing_else(tmp_path: Path, crash: bool) -> None:
    (tmp_path / "notes.txt").touch()
    record(tmp_path, [snapshot(t_s, [1]) for t_s in (0.0, 4000.0, 8000.0)], crash=crash)
    (tmp_path / RIG_FROM.format("1780000000.000")).touch()
    discard_recording(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["notes.txt"]


def test_the_newest_rig_is_that_of_the_last_repair(tmp_path: Path) -> None:
    assert newest_rig(tmp_path) == tmp_path / "rig.toml"
    for t_s in ("1780000000.500", "1779999999.000"):
        (tmp_path / RIG_FROM.format(t_s)).touch()
    assert newest_rig(tmp_path) == tmp_path / "rig-from-1780000000.500.toml"


def test_a_rig_of_somebody_else_beside_tracks_is_neither_shown_nor_removed(tmp_path: Path) -> None:
    own = tmp_path / "rig-from-metashape.toml"
    own.touch()
    assert newest_rig(tmp_path) == tmp_path / "rig.toml"
    discard_recording(tmp_path)
    assert own.exists()


def test_poses_that_lie_there_twice_are_not_continued(tmp_path: Path) -> None:
    for name in ("poses.jsonl", "poses.jsonl.partial"):
        (tmp_path / name).touch()
    with pytest.raises(InputError, match="are both there"):
        poses_recorder(tmp_path, resume=True)


@pytest.mark.parametrize("resume", [False, True])
def test_timings_and_tracks_of_one_file_are_one_file(tmp_path: Path, resume: bool) -> None:
    with TimingWriter(tmp_path / "timing.csv", resume=resume) as writer:
        for t_s in (0.0, 1e6):
            writer.write(StepTiming(t_s, 2, 1, 1.5))
    assert (tmp_path / "timing.csv").is_file()
