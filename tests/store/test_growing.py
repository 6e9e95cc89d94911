"""Files that grow while a program runs are readable at every moment, however it ends."""

import logging
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from made_tracks import assert_same, walk
from trecsim.errors import InputError, SetupError
from trecsim.lab.evaluation.evaluating import evaluate
from trecsim.lab.report.recording_files import find
from trecsim.sources import read_poses
from trecsim.store.growing import GrowingFile
from trecsim.store.timing_csv import read_timing
from trecsim.store.tracks import read_tracks
from trecsim.store.tracks_csv import CsvWriter

# Writes one moment every 40 ms of a made clock, says so, and waits to be killed.
WRITER = """
import sys, time
from pathlib import Path
import numpy as np
from made_tracks import walk
from trecsim.store.poses_writer import PosesWriter
from trecsim.store.timing_csv import StepTiming
from trecsim.store.timing_writer import TimingWriter
from trecsim.store.tracks_csv import CsvWriter
from trecsim.values import Poses2D

folder, moments = Path(sys.argv[1]), int(sys.argv[2])
now_s = 0.0
clock = lambda: now_s
image = Poses2D("north", 0.0, np.ones((1, 17, 2)), np.ones((1, 17)), np.ones(1))
with (
    CsvWriter(folder / "tracks.csv", clock=clock) as tracks,
    TimingWriter(folder / "timing.csv", clock=clock) as timing,
    PosesWriter(folder / "poses.jsonl") as poses,
):
    for moment in walk(moments):
        now_s = moment.t_s
        tracks.write(moment)
        timing.write(StepTiming(moment.t_s, 2, len(moment.id), 1.5))
    poses.write(image)
    print("written", flush=True)
    time.sleep(600)
"""


@contextmanager
def writing(folder: Path, moments: int) -> Iterator[subprocess.Popen[str]]:
    program = subprocess.Popen(
        [sys.executable, "-c", WRITER, str(folder), str(moments)],
        env={
            **os.environ,
            "PYTHONPATH": os.pathsep.join([str(Path(__file__).parents[1]), *sys.path]),
        },
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        assert program.stdout is not None
        assert program.stdout.readline() == "written\n"
        yield program
    finally:
        program.kill()
        program.communicate()


@pytest.mark.parametrize("ending", [signal.SIGKILL, signal.SIGTERM])
def test_a_killed_program_leaves_all_but_the_last_two_seconds(
    tmp_path: Path, ending: signal.Signals
) -> None:
    with writing(tmp_path, 500) as program:
        program.send_signal(ending)
        assert program.wait() == -ending
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "poses.jsonl.partial",
        "timing.csv.partial",
        "tracks.csv.partial",
    ]
    kept = list(read_tracks(tmp_path / "tracks.csv.partial"))
    assert 20.0 - 2.0 <= kept[-1].t_s + 0.04 <= 20.0
    assert_same(kept[:-1], list(walk(500))[: len(kept) - 1])
    assert 20.0 - 2.0 <= read_timing(tmp_path / "timing.csv.partial").t_s[-1] + 0.04 <= 20.0
    assert len(list(read_poses(tmp_path / "poses.jsonl.partial"))) == 1


def test_evaluate_and_report_find_what_a_killed_program_left(tmp_path: Path) -> None:
    with writing(tmp_path, 500):
        pass
    assert evaluate(tmp_path / "tracks.csv.partial").moments > 400
    assert evaluate(tmp_path).moments > 400
    places = find(tmp_path)
    assert places.tracks == tmp_path / "tracks.csv.partial"
    assert places.timing == tmp_path / "timing.csv.partial"
    assert places.poses == tmp_path / "poses.jsonl.partial"


def test_two_programs_cannot_write_the_same_file(tmp_path: Path) -> None:
    path = tmp_path / "tracks.csv"
    with writing(tmp_path, 500):
        before = (tmp_path / "tracks.csv.partial").read_bytes()
        with pytest.raises(InputError, match="another program is writing it"):
            CsvWriter(path)
        assert (tmp_path / "tracks.csv.partial").read_bytes() == before
    CsvWriter(path).close()  # the lock has ended with the program
    assert list(read_tracks(path)) == []


@pytest.mark.parametrize("cut", range(1, 60, 7))
def test_a_last_line_that_is_cut_off_is_left_out_with_a_remark(
    tmp_path: Path, cut: int, caplog: pytest.LogCaptureFixture
) -> None:
    made = list(walk(3))
    with CsvWriter(tmp_path / "t.csv") as writer:
        for one in made:
            writer.write(one)
    whole = (tmp_path / "t.csv").read_bytes()
    last = whole.rstrip().rfind(b"\n") + 1
    (tmp_path / "t.csv.partial").write_bytes(whole[: min(last + cut, len(whole) - 1)])
    with caplog.at_level(logging.WARNING):
        kept = list(read_tracks(tmp_path / "t.csv.partial"))
    assert_same(kept[:2], made[:2])
    assert caplog.messages == [f"{tmp_path}/t.csv.partial: the last line is cut off and left out"]


def test_a_last_line_without_end_of_a_complete_file_is_read(tmp_path: Path) -> None:
    path = tmp_path / "timing.csv"
    path.write_text("t_s,images,people,fusion_ms\n1,2,3,4\n2,2,3,4")
    assert read_timing(path).t_s.tolist() == [1.0, 2.0]
    path.rename(tmp_path / "timing.csv.partial")
    assert read_timing(tmp_path / "timing.csv.partial").t_s.tolist() == [1.0]


@pytest.mark.parametrize("content", [b"", b"t_s,per"])
def test_tracks_of_a_program_killed_at_once_are_empty(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "t.csv.partial").write_bytes(content)
    assert list(read_tracks(tmp_path / "t.csv.partial")) == []


def test_the_content_is_with_the_system_when_its_time_has_come(tmp_path: Path) -> None:
    now_s = 0.0
    partial = tmp_path / "a.csv.partial"
    with GrowingFile(tmp_path / "a.csv", b"n\n", clock=lambda: now_s) as file:
        assert partial.read_bytes() == b"n\n"
        file.write(b"1\n")
        now_s = 1.9
        file.write(b"2\n")
        assert partial.read_bytes() == b"n\n"
        now_s = 2.0
        file.write(b"3\n")
        assert partial.read_bytes() == b"n\n1\n2\n3\n"


def test_the_old_file_stays_until_the_new_one_is_complete(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_bytes(b"old\n")
    with GrowingFile(path, b"n\n", flush_s=0.0) as file:
        file.write(b"1\n")
        assert path.read_bytes() == b"old\n"
    assert path.read_bytes() == b"n\n1\n"
    assert [one.name for one in tmp_path.iterdir()] == ["a.csv"]


def test_a_file_that_holds_its_heading_alone_is_not_kept_after_an_error(tmp_path: Path) -> None:
    file = GrowingFile(tmp_path / "a.csv", b"n\n")
    file.abandon()
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("rest", [b"", b"3", b"3,half a li"])
def test_a_file_is_continued_without_a_line_that_was_cut_off(tmp_path: Path, rest: bytes) -> None:
    (tmp_path / "a.csv.partial").write_bytes(b"n\n1\n2\n" + rest)
    with GrowingFile(tmp_path / "a.csv", b"n\n", resume=True) as file:
        file.write(b"4\n")
    assert (tmp_path / "a.csv").read_bytes() == b"n\n1\n2\n4\n"


@pytest.mark.parametrize("left", [None, b"", b"n", b"n\n"])
def test_a_file_that_had_not_begun_is_continued_from_its_heading(
    tmp_path: Path, left: bytes | None
) -> None:
    if left is not None:
        (tmp_path / "a.csv.partial").write_bytes(left)
    with GrowingFile(tmp_path / "a.csv", b"n\n", resume=True) as file:
        file.write(b"4\n")
    assert (tmp_path / "a.csv").read_bytes() == b"n\n4\n"


def test_without_being_asked_nothing_is_continued(tmp_path: Path) -> None:
    (tmp_path / "a.csv.partial").write_bytes(b"n\n1\n2\n")
    with GrowingFile(tmp_path / "a.csv", b"n\n") as file:
        file.write(b"4\n")
    assert (tmp_path / "a.csv").read_bytes() == b"n\n4\n"


def test_a_folder_that_is_removed_meanwhile_is_told_as_such(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    folder.mkdir()
    file = GrowingFile(folder / "a.csv", b"n\n", flush_s=0.0)
    shutil.rmtree(folder)
    with pytest.raises(SetupError, match=r"a\.csv: it, or the folder .*run, was removed"):
        file.write(b"1\n")
    with pytest.raises(SetupError, match="was removed or renamed"):
        file.close()


def test_a_device_is_written_to_directly() -> None:
    with GrowingFile(Path("/dev/null"), b"n\n") as file:
        file.write(b"1\n")
    assert not Path("/dev/null.partial").exists()


def test_the_file_is_for_its_owner_alone(tmp_path: Path) -> None:
    (tmp_path / "a.csv.partial").write_bytes(b"")
    (tmp_path / "a.csv.partial").chmod(0o644)
    GrowingFile(tmp_path / "a.csv", b"n\n").close()
    assert (tmp_path / "a.csv").stat().st_mode & 0o777 == 0o600
