"""A live recording: never waits for the disk, survives its faults and the end at any moment."""

import errno
import os
import random
import shutil
import signal
import stat
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from made_live import assert_same_bits, live_moment, live_moments
from often import often
from trecsim.errors import InputError, SetupError
from trecsim.store import recorder
from trecsim.store.compaction import complete_segment, merge_parts
from trecsim.store.gaps import read_gaps
from trecsim.store.parquet_file import TracksInfo
from trecsim.store.parquet_reading import parts_of, read_parquet, recording_segments
from trecsim.store.recorder import Recorder
from trecsim.store.recordings import stored_in
from trecsim.store.segments import segments_in
from trecsim.values import Snapshot

INFO = TracksInfo()
DEADLINE_S = 60.0
TESTS = Path(__file__).parents[1]


def until(condition: Callable[[], bool]) -> None:
    """Wait for what another thread does."""
    end = time.monotonic() + DEADLINE_S
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.005)


def record(path: Path, moments: list[Snapshot], **how: object) -> Path:
    with Recorder(path, INFO, **{"part_s": 0.01, **how}) as writer:  # type: ignore[arg-type]
        for moment in moments:
            writer.write(moment)
    return path


def test_a_short_recording_is_one_file_in_the_end(tmp_path: Path) -> None:
    moments = list(live_moments(60))
    path = record(tmp_path / "tracks.parquet", moments)

    assert [one.name for one in tmp_path.iterdir()] == ["tracks.parquet"]
    assert_same_bits(list(read_parquet(path)), moments)


def test_a_recording_of_several_hours_is_a_folder_of_segments(tmp_path: Path) -> None:
    moments = list(live_moments(100))
    path = record(tmp_path / "tracks.parquet", moments, segment_s=1.0)

    assert sorted(one.name for one in path.glob("0*")) == [
        f"0000000{n}.parquet" for n in (1, 2, 3, 4)
    ]
    assert_same_bits(list(read_parquet(path)), moments)
    found = read_parquet(path, moments[30].t_s, moments[80].t_s)
    assert_same_bits(list(found), moments[30:81])


def test_an_empty_recording_can_be_read(tmp_path: Path) -> None:
    assert list(read_parquet(record(tmp_path / "tracks.parquet", []))) == []


def test_a_recording_can_be_read_while_it_is_written(tmp_path: Path) -> None:
    moments = list(live_moments(160))
    path = tmp_path / "tracks.parquet"
    with Recorder(path, INFO, part_s=0.001, parts_of_a_minute=3, segment_s=1.2) as writer:
        for number, moment in enumerate(moments):
            writer.write(moment)
            time.sleep(0.0005)
            if number == 80:
                until(lambda: writer.stored_s > moments[40].t_s)
            if writer.stored_s > moments[0].t_s and number % 10 == 0:
                found = list(read_parquet(path))
                assert_same_bits(found, moments[: len(found)])
                assert found[-1].t_s >= moments[40].t_s or number < 80


def test_files_are_for_their_owner_alone(tmp_path: Path) -> None:
    path = tmp_path / "tracks.parquet"
    with Recorder(path, INFO, part_s=0.001) as writer:
        for moment in live_moments(10):
            writer.write(moment)
        until(lambda: writer.stored_s == live_moment(9).t_s)
        modes = {
            (one.is_dir(), stat.S_IMODE(one.stat().st_mode)) for one in parts_of(path).rglob("*")
        }
    assert modes == {(True, 0o700), (False, 0o600)}


def test_a_recording_goes_on_after_a_crash_with_new_identities_and_a_gap(tmp_path: Path) -> None:
    path = tmp_path / "tracks.parquet"
    moments = list(live_moments(100))
    first = Recorder(path, INFO, part_s=0.001, segment_s=1.0)
    for moment in moments[:60]:
        first.write(moment)
    first.abandon()

    highest = max(int(one.id.max()) for one in moments[:60] if len(one.id))
    assert stored_in(tmp_path).next_person == highest + 1
    with Recorder(path, INFO, part_s=0.001, segment_s=1.0, resume=True) as writer:
        for moment in moments[50:]:  # what is there already is skipped
            writer.write(moment)

    assert_same_bits(list(read_parquet(path)), moments)
    (gap,) = read_gaps(tmp_path)
    assert (gap.from_s, gap.to_s) == (moments[59].t_s, moments[60].t_s)


def test_a_clock_that_is_set_back_is_a_fault_until_it_has_caught_up(tmp_path: Path) -> None:
    moments = list(live_moments(60))
    with Recorder(tmp_path / "tracks.parquet", INFO, part_s=0.001) as writer:
        for moment in moments[:50]:
            writer.write(moment)
        writer.write(moments[48])  # an image that came late is none
        assert writer.health.state == "writing"
        writer.write(moments[10])
        assert writer.health.state == "failing"
        assert "clock was set back" in str(writer.health.fault)
        for moment in moments[50:]:
            writer.write(moment)
        assert writer.health.state == "writing"

    assert_same_bits(list(read_parquet(tmp_path / "tracks.parquet")), moments)
    (gap,) = read_gaps(tmp_path)
    assert (gap.from_s, gap.to_s) == (moments[49].t_s, moments[50].t_s)
    assert "clock was set back" in gap.reason


def test_what_an_unfinished_recording_holds_is_not_overwritten(tmp_path: Path) -> None:
    path = tmp_path / "tracks.parquet"
    first = Recorder(path, INFO)
    first.write(live_moment(0))
    first.abandon()

    with pytest.raises(InputError, match="has not ended"):
        Recorder(path, INFO)


class FullDisk:
    """Makes every new file of a recording fail while it is on."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.on = False
        self.refused = 0
        write = recorder.write_compact

        def write_compact(path: Path, *rest: object) -> None:
            if self.on:
                self.refused += 1
                raise SetupError(f"cannot write {path}: the disk is full")
            write(path, *rest)  # type: ignore[arg-type]

        monkeypatch.setattr(recorder, "write_compact", write_compact)


def test_chores_are_done_while_the_disk_has_no_room_to_merge(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tried, done = threading.Event(), threading.Event()

    def merge_parts(*_: object) -> bool:
        tried.set()
        raise SetupError("cannot write: the disk is full")

    monkeypatch.setattr(recorder, "merge_parts", merge_parts)
    path = tmp_path / "tracks.parquet"
    writer = Recorder(path, INFO, part_s=0.01, parts_of_a_minute=2, chores=done.set)
    writer.write(live_moment(0))
    until(tried.is_set)
    done.clear()
    until(done.is_set)
    writer.abandon()


def test_a_full_disk_is_told_and_nothing_is_lost_where_it_ends_soon(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    disk = FullDisk(monkeypatch)
    moments = list(live_moments(60))
    path = tmp_path / "tracks.parquet"
    with Recorder(path, INFO, part_s=0.001) as writer:
        for moment in moments[:20]:
            writer.write(moment)
        until(lambda: writer.stored_s == moments[19].t_s)
        assert writer.health.state == "writing"
        disk.on = True
        for moment in moments[20:40]:
            writer.write(moment)
        until(lambda: writer.health.state == "failing")
        until(lambda: disk.refused > 3)
        assert "disk is full" in str(writer.health.fault)
        disk.on = False
        until(lambda: writer.health.state == "writing")
        for moment in moments[40:]:
            writer.write(moment)

    assert_same_bits(list(read_parquet(path)), moments)
    assert read_gaps(tmp_path) == []
    assert len([one for one in caplog.records if "disk is full" in one.message]) == 1
    assert "recording again" in caplog.text


def test_a_disk_that_stays_full_costs_the_newest_and_the_gap_is_recorded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    disk = FullDisk(monkeypatch)
    monkeypatch.setattr(recorder, "_WAITING_PEOPLE", 100)
    moments = list(live_moments(200))
    path = tmp_path / "tracks.parquet"
    with Recorder(path, INFO, part_s=0.001) as writer:
        disk.on = True
        writer.write(moments[0])
        until(lambda: writer.health.state == "failing")
        for moment in moments[1:150]:
            writer.write(moment)
        disk.on = False
        until(lambda: writer.health.state == "writing")
        for moment in moments[150:]:
            writer.write(moment)
            until(lambda: writer.stored_s == moment.t_s)  # noqa: B023

    found = list(read_parquet(path))
    kept = len(found) - 50
    assert 20 < kept < 150
    assert_same_bits(found, moments[:kept] + moments[150:])
    (gap,) = read_gaps(tmp_path)
    assert (gap.from_s, gap.to_s) == (moments[kept - 1].t_s, moments[150].t_s)
    assert "disk is full" in gap.reason


def test_a_disk_that_is_full_at_the_end_keeps_the_parts_and_says_where(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    disk = FullDisk(monkeypatch)
    path = tmp_path / "tracks.parquet"
    writer = Recorder(path, INFO, part_s=0.001)
    moments = list(live_moments(20))
    for moment in moments[:10]:
        writer.write(moment)
    until(lambda: writer.stored_s == moments[9].t_s)
    disk.on = True
    for moment in moments[10:]:
        writer.write(moment)

    with pytest.raises(SetupError, match=r"kept in .*parts"):
        writer.close()
    assert_same_bits(list(read_parquet(path)), moments[:10])


LIMITED = """
import resource, signal, sys
from pathlib import Path
from made_live import live_moments
from trecsim.store.parquet_file import TracksInfo
from trecsim.store.recorder import Recorder
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
writer = Recorder(Path(sys.argv[1]), TracksInfo(), part_s=0.01)
def wait(condition):
    import time
    while not condition():
        time.sleep(0.005)
moments = list(live_moments(30))
for moment in moments[:10]:
    writer.write(moment)
wait(lambda: writer.stored_s == moments[9].t_s)
hard = resource.getrlimit(resource.RLIMIT_FSIZE)[1]
resource.setrlimit(resource.RLIMIT_FSIZE, (100, hard))
for moment in moments[10:20]:
    writer.write(moment)
wait(lambda: writer.health.state == "failing")
print(writer.health.fault)
resource.setrlimit(resource.RLIMIT_FSIZE, (hard, hard))
wait(lambda: writer.health.state == "writing")
for moment in moments[20:]:
    writer.write(moment)
writer.close()
"""


def test_a_real_limit_of_the_system_is_told_and_got_over(tmp_path: Path) -> None:
    path = tmp_path / "tracks.parquet"
    paths = os.pathsep.join([str(TESTS), *sys.path])
    ended = subprocess.run(
        [sys.executable, "-B", "-c", LIMITED, str(path)],  # no compiled module is cut
        env={**os.environ, "PYTHONPATH": paths},
        capture_output=True, text=True, check=False, timeout=DEADLINE_S,
    )  # fmt: skip
    assert ended.returncode == 0, ended.stderr
    assert "the size of files is limited" in ended.stdout
    assert_same_bits(list(read_parquet(path)), list(live_moments(30)))


def test_an_error_that_is_not_the_disk_costs_one_part_and_not_the_recording(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write, broken = recorder.write_compact, [True]

    def write_compact(path: Path, *rest: object) -> None:
        if broken:
            broken.clear()
            raise ValueError("a fault in the program")
        write(path, *rest)  # type: ignore[arg-type]

    monkeypatch.setattr(recorder, "write_compact", write_compact)
    moments = list(live_moments(20))
    path = tmp_path / "tracks.parquet"
    with Recorder(path, INFO, part_s=0.001) as writer:
        writer.write(moments[0])
        until(lambda: not broken)
        for moment in moments[1:]:
            writer.write(moment)
    assert_same_bits(list(read_parquet(path)), moments[1:])


def test_writing_does_not_wait_for_a_disk_that_hangs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write, hangs = recorder.write_compact, threading.Event()

    def write_compact(path: Path, *rest: object) -> None:
        hangs.wait(DEADLINE_S)
        write(path, *rest)  # type: ignore[arg-type]

    monkeypatch.setattr(recorder, "write_compact", write_compact)
    moments = list(live_moments(200))
    path = tmp_path / "tracks.parquet"
    with Recorder(path, INFO, part_s=0.001) as writer:
        for moment in moments:
            writer.write(moment)
        hangs.set()
    assert_same_bits(list(read_parquet(path)), moments)


# Forks a child for each line that it reads; the child records until it is killed.
NURSERY = """
import itertools, os, sys, time
from pathlib import Path
import numpy, pyarrow
from made_live import live_moment
from trecsim.store.parquet_file import TracksInfo
from trecsim.store.recorder import Recorder

pyarrow.array(numpy.zeros(1))  # imports pandas, which each child would do

def endless(path):
    writer = Recorder(
        path, TracksInfo(), part_s=0.005, parts_of_a_minute=3, segment_s=0.2,
        resume=True,
    )
    begun = writer.stored_s
    first = 0 if begun < 0 else int((begun - 1.7e9) / 0.04)
    for number in itertools.count(first):
        moment = live_moment(number, people=1)
        if moment.t_s > begun:
            writer.write(moment)
            print(os.getpid(), repr(writer.stored_s), flush=True)
            time.sleep(0.005)

for line in sys.stdin:
    child = os.fork()
    if child == 0:
        endless(Path(sys.argv[1]))
    os.waitpid(child, 0)
    print("ended", flush=True)
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork and SIGKILL")
def test_kills_at_random_moments_lose_nothing_that_was_stored(tmp_path: Path) -> None:
    path = tmp_path / "tracks.parquet"
    chance = random.Random(20)
    with subprocess.Popen(
        [sys.executable, "-c", NURSERY, str(path)],
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(TESTS), *sys.path])},
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1,
    ) as nursery:  # fmt: skip
        assert nursery.stdin is not None
        assert nursery.stdout is not None
        for _ in range(often(20)):
            nursery.stdin.write("another\n")
            wanted, stored = chance.randrange(1, 7), []
            for line in nursery.stdout:
                if line == "ended\n":
                    break
                child, stored_s = line.split()
                stored.append(float(stored_s))
                if len(set(stored)) == wanted:
                    os.kill(int(child), signal.SIGKILL)
                    wanted = -1  # once
            found = list(read_parquet(path))
            assert_same_bits(found, [live_moment(n, people=1) for n in range(len(found))])
            assert not found or found[-1].t_s >= stored[-1]
        nursery.stdin.close()
    with Recorder(path, INFO, resume=True, segment_s=0.2):
        pass
    assert_same_bits(list(read_parquet(path)), found)
    assert len(list(path.glob("0*.parquet"))) > 2


def parts(tmp_path: Path, count: int) -> tuple[Path, list[Snapshot]]:
    """Return the folder of a crashed recording with `count` parts of ten moments each."""
    path = tmp_path / "tracks.parquet"
    moments = list(live_moments(10 * count))
    for n in range(count):
        writer = Recorder(path, INFO, resume=True, part_s=100.0)
        for moment in moments[10 * n : 10 * n + 10]:
            writer.write(moment)
        writer.abandon()
    folders = sorted(parts_of(path).glob("0*"))
    for n, folder in enumerate(folders[1:], start=2):
        (folder / "000001.parquet").rename(folders[0] / f"{n:06d}.parquet")
        folder.rmdir()
    return path, moments


def test_merged_parts_take_their_place_before_the_parts_go(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, moments = parts(tmp_path, 7)
    folder = parts_of(path) / "00000001"

    def crash(*_: object, **__: object) -> None:
        raise OSError(errno.EIO, "the program ends here")

    with monkeypatch.context() as patch:
        patch.setattr(Path, "unlink", crash)
        with pytest.raises((OSError, SetupError)):
            merge_parts(folder, INFO, 3)
    assert (folder / "000001-000003.parquet").exists()
    assert (folder / "000001.parquet").exists()
    assert_same_bits(list(read_parquet(path)), moments)

    assert merge_parts(folder, INFO, 3)
    assert sorted(one.name for one in folder.iterdir()) == [
        "000001-000003.parquet",
        "000004-000006.parquet",
        "000007.parquet",
    ]
    assert not merge_parts(folder, INFO, 3)
    assert_same_bits(list(read_parquet(path)), moments)


def test_a_segment_takes_its_place_before_its_parts_go(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, moments = parts(tmp_path, 5)

    def crash(*_: object, **__: object) -> None:
        raise OSError(errno.EIO, "the program ends here")

    with monkeypatch.context() as patch:
        patch.setattr(shutil, "rmtree", crash)
        with pytest.raises((OSError, SetupError)):
            complete_segment(parts_of(path), 1, INFO, frozenset(), 2)
    assert_same_bits(list(read_parquet(path)), moments)

    complete_segment(parts_of(path), 1, INFO, frozenset(), 2)
    assert not (parts_of(path) / "00000001").exists()
    assert_same_bits(list(read_parquet(path)), moments)
    (segment,) = segments_in(parts_of(path))
    assert segment.contents.rows == sum(max(one.support.size, 1) for one in moments)


def test_the_catalogue_counts_people_once(tmp_path: Path) -> None:
    moments = list(live_moments(200, people=2))
    path = record(tmp_path / "tracks.parquet", moments, segment_s=2.0)
    confirmed = {
        person
        for one in moments
        for person, state in zip(one.id.tolist(), one.state.tolist(), strict=True)
        if state != "provisional"
    }

    segments = [one.contents for one in recording_segments(path)]
    assert segments[0].people + sum(one.new_people for one in segments[1:]) == len(confirmed)
