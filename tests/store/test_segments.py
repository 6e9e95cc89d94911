"""A long recording lies in segments of an hour; a catalogue tells which one holds what."""

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest

from made_tracks import assert_same, snapshot, walk
from trecsim.errors import InputError, SetupError
from trecsim.store import parquet_file
from trecsim.store.parquet_reading import parts_of, read_parquet, recording_segments
from trecsim.store.segments import CATALOGUE, files_in, segments_in
from trecsim.store.tracks import export_tracks, read_tracks
from trecsim.store.tracks_parquet import HOUR_S, ParquetTracksWriter
from trecsim.values import Snapshot

# Records a moment every ten minutes and kills itself at the place named by the argument.
WRITER = """
import os, pathlib, signal, sys
from made_tracks import walk
from trecsim.store import tracks_parquet
from trecsim.store.tracks_parquet import HOUR_S, ParquetTracksWriter

path, where, resume = pathlib.Path(sys.argv[1]), sys.argv[2], len(sys.argv) > 3
kill = lambda *_: os.kill(os.getpid(), signal.SIGKILL)
replace = pathlib.Path.replace
names = {
    "before a segment takes its name": "00000002.parquet",
    "before the catalogue is written": "_catalogue.json",
}
if where in names:
    pathlib.Path.replace = lambda a, b: kill() if b.name == names[where] else replace(a, b)
if where == "before the parts of a segment are removed":
    unlink = pathlib.Path.unlink
    is_part = lambda path: path.parent.name == "00000001" and path.name[0] != "."
    pathlib.Path.unlink = lambda path, **given: kill() if is_part(path) else unlink(path, **given)
if where == "before the recording takes its name":
    pathlib.Path.rename = kill
with ParquetTracksWriter(path, segment_s=HOUR_S, part_s=0.0, resume=resume) as writer:
    for moment in walk(20, step_s=600.0):
        writer.write(moment)
"""


def killed_writer(path: Path, where: str) -> None:
    ended = subprocess.run(
        [sys.executable, "-c", WRITER, str(path), where],
        env={
            **os.environ,
            "PYTHONPATH": os.pathsep.join([str(Path(__file__).parents[1]), *sys.path]),
        },
        check=False,
    )
    assert ended.returncode == -signal.SIGKILL


def hours(count: int, first: int = 0) -> Iterator[Snapshot]:
    """Yield a moment every ten minutes, of another person every hour."""
    for number in range(6 * first, 6 * (first + count)):
        yield snapshot(600.0 * number, [number // 6])


def record(path: Path, moments: Iterator[Snapshot], *, resume: bool = False) -> Path:
    with ParquetTracksWriter(path, segment_s=HOUR_S, part_s=0.0, resume=resume) as writer:
        for one in moments:
            writer.write(one)
    return path


def record_and_fail(path: Path, moments: Iterator[Snapshot], *, resume: bool = False) -> None:
    writer = ParquetTracksWriter(path, segment_s=HOUR_S, part_s=0.0, resume=resume)
    for one in moments:
        writer.write(one)
    writer.abandon()


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "tracks.parquet"


def test_each_hour_is_a_segment(path: Path) -> None:
    record(path, hours(3))
    assert [entry.name for entry in path.parent.iterdir()] == ["tracks.parquet"]
    assert [file.name for file in files_in(path)] == [f"0000000{n}.parquet" for n in (1, 2, 3)]
    assert [pq.read_table(file)["t_s"].to_pylist()[0] for file in files_in(path)] == [
        0.0,
        3600.0,
        7200.0,
    ]
    assert_same(list(read_tracks(path)), list(hours(3)))
    assert_same(list(read_tracks(path.parent)), list(hours(3)))


def test_a_recording_of_less_than_an_hour_is_one_file(path: Path) -> None:
    record(path, hours(1))
    assert path.is_file()
    assert [entry.name for entry in path.parent.iterdir()] == ["tracks.parquet"]
    assert pq.read_table(path).num_rows == 6 * 17


def test_a_track_file_is_one_file_however_long(path: Path) -> None:
    with ParquetTracksWriter(path, part_s=0.0) as writer:
        for one in hours(3):
            writer.write(one)
    assert path.is_file()


def test_other_programs_read_the_folder_of_segments_as_one_table(path: Path) -> None:
    record(path, hours(3))
    assert pq.read_table(path).num_rows == 18 * 17


def test_segments_become_a_file_by_export(path: Path) -> None:
    record(path, hours(3))
    export_tracks(path, path.parent / "one.parquet")
    assert_same(list(read_tracks(path.parent / "one.parquet")), list(hours(3)))
    export_tracks(path.parent, path.parent / "one.csv")
    assert_same(list(read_tracks(path.parent / "one.csv")), list(hours(3)))


def test_the_catalogue_tells_what_each_segment_holds(path: Path) -> None:
    record(path, hours(2))
    first, second = json.loads((path / CATALOGUE).read_text())["segments"]
    size_bytes = (path / "00000001.parquet").stat().st_size
    assert first == {
        "file": "00000001.parquet",
        "size_bytes": size_bytes,
        "rows": 6 * 17,
        "first_s": 0.0,
        "last_s": 3000.0,
        "highest_person": 0,
    }
    assert (second["first_s"], second["highest_person"]) == (3600.0, 1)


@pytest.mark.parametrize(
    "damage",
    [None, b"", b"{", b"[]", b'{"format": "trecsim.catalogue/9", "segments": []}', b"\xff"],
)
def test_a_lost_or_damaged_catalogue_is_replaced_by_the_segments(
    path: Path, damage: bytes | None
) -> None:
    record(path, hours(3))
    known = segments_in(path)
    (path / CATALOGUE).unlink()
    if damage is not None:
        (path / CATALOGUE).write_bytes(damage)
    assert segments_in(path) == known
    assert [one.t_s for one in read_parquet(path, 3600.0, 3600.0)] == [3600.0]


def test_a_catalogue_is_not_believed_about_a_file_that_has_changed(path: Path) -> None:
    record(path, hours(3))
    longer = record(path.parent / "other.parquet", hours(1, first=7))
    longer.replace(path / "00000003.parquet")
    facts = json.loads((path / CATALOGUE).read_text())
    facts["segments"][2]["size_bytes"] += 1
    (path / CATALOGUE).write_text(json.dumps(facts))
    assert [one.t_s for one in read_parquet(path, 7 * HOUR_S, 7 * HOUR_S)] == [7 * HOUR_S]


def opened_files(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Return a list that gets the name of every file of tracks that is opened from now on."""
    names: list[str] = []
    opened = parquet_file.opened_for_reading

    def note(file: Path) -> object:
        names.append(file.name)
        return opened(file)

    monkeypatch.setattr(parquet_file, "opened_for_reading", note)
    return names


def test_a_range_of_time_opens_only_the_segments_it_needs(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    record(path, hours(5))
    names = opened_files(monkeypatch)
    read = list(read_tracks(path, from_s=7000.0, until_s=7800.0))
    assert [one.t_s for one in read] == [7200.0, 7800.0]
    assert set(names) == {"00000001.parquet", "00000003.parquet"}  # the first tells the skeleton


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_a_range_of_time_includes_both_its_ends(tmp_path: Path, suffix: str) -> None:
    record(tmp_path / "a.parquet", hours(1))
    whole = tmp_path / f"whole{suffix}"
    export_tracks(tmp_path / "a.parquet", whole)
    read = list(read_tracks(whole, from_s=600.0, until_s=1800.0))
    assert [one.t_s for one in read] == [600.0, 1200.0, 1800.0]
    assert list(read_tracks(whole, from_s=1e6)) == []


def test_files_that_others_wrote_without_statistics_are_read_by_time(path: Path) -> None:
    record(path, hours(1))
    table = pq.read_table(path)
    pq.write_table(table, path, write_statistics=False)
    assert [one.t_s for one in read_tracks(path, from_s=3000.0)] == [3000.0]
    (segment,) = recording_segments(path)
    assert (segment.contents.first_s, segment.contents.last_s) == (0.0, 3000.0)


@pytest.mark.parametrize(
    ("where", "segments", "parts"),
    [
        ("before a segment takes its name", 1, 6),
        ("before the catalogue is written", 1, 0),
        ("before the parts of a segment are removed", 1, 0),
        ("before the recording takes its name", 4, 0),
    ],
)
def test_a_recording_killed_between_two_hours_can_be_read_and_continued(
    path: Path, where: str, segments: int, parts: int
) -> None:
    killed_writer(path, where)
    files = files_in(parts_of(path))
    assert [file.parent == parts_of(path) for file in files] == [True] * segments + [False] * parts
    kept = list(read_tracks(path))
    assert_same(kept, list(walk(20, step_s=600.0))[: len(kept)])
    assert len(kept) == {1: 6, 4: 20}[segments] + parts

    record(path, hours(2, first=20), resume=True)
    assert_same(list(read_tracks(path)), [*kept, *hours(2, first=20)])
    assert not parts_of(path).exists()
    assert len(files_in(path)) == segments + bool(parts) + 2
    assert sorted(one.name for one in path.iterdir()) == [
        *(file.name for file in files_in(path)),
        CATALOGUE,
    ]
    assert len(json.loads((path / CATALOGUE).read_text())["segments"]) == len(files_in(path))


@pytest.mark.parametrize("before", [0, 1, 2])
def test_a_recording_that_ended_well_is_continued(path: Path, before: int) -> None:
    record(path, hours(before))
    record(path, hours(1, first=5), resume=True)
    assert_same(list(read_tracks(path)), [*hours(before), *hours(1, first=5)])


def test_there_need_not_be_a_recording_to_continue(path: Path) -> None:
    record(path, hours(2), resume=True)
    assert_same(list(read_tracks(path)), list(hours(2)))


def test_a_recording_that_is_continued_and_fails_keeps_everything(path: Path) -> None:
    record(path, hours(2))
    record_and_fail(path, hours(1, first=5), resume=True)
    assert not path.exists()
    assert_same(list(read_tracks(path)), [*hours(2), *hours(1, first=5)])


def test_parts_of_the_layout_before_are_read_in_the_order_of_their_numbers(path: Path) -> None:
    """After 999,999 parts the names grow longer, and text would sort them wrongly."""
    parts_of(path).mkdir()
    for number, moment in zip((999_998, 999_999, 1_000_000, 1_000_001), walk(4), strict=True):
        record(path.parent / "one.parquet", iter([moment]))
        (path.parent / "one.parquet").rename(parts_of(path) / f"{number:06d}.parquet")
    assert_same(list(read_tracks(path)), list(walk(4)))
    assert_same(list(read_tracks(parts_of(path))), list(walk(4)))


def test_the_parts_of_an_hour_are_removed_when_it_is_over(path: Path) -> None:
    writer = ParquetTracksWriter(path, segment_s=HOUR_S, part_s=0.0)
    for one in hours(2):
        writer.write(one)
    folder = parts_of(path)
    assert not (folder / "00000001").exists()
    assert [file.relative_to(folder).as_posix() for file in files_in(folder)] == [
        "00000001.parquet",
        *(f"00000002/00000{n}.parquet" for n in range(1, 7)),
    ]
    writer.close()


def test_a_recording_is_readable_while_an_hour_ends(path: Path) -> None:
    """The reader has begun with the parts of an hour; then a segment replaces them."""
    writer = ParquetTracksWriter(path, segment_s=HOUR_S, part_s=0.0)
    moments = hours(3)
    for _ in range(8):
        writer.write(next(moments))
    reading = read_tracks(path)
    read = [next(reading) for _ in range(6)]  # the second part of the second hour comes next
    for one in moments:
        writer.write(one)
    writer.close()
    assert_same([*read, *reading], list(hours(3)))


def test_many_parts_are_removed_a_few_at_a_time(path: Path) -> None:
    """Removing the 1800 parts of an hour at once would stall the tracking."""
    writer = ParquetTracksWriter(path, segment_s=HOUR_S, part_s=0.0)
    left = []
    for number in range(60):
        writer.write(snapshot(80.0 * number, [1]))
        left.append(len(list((parts_of(path) / "00000001").glob("*"))))
    assert left == [*range(1, 46), 25, 5, *[0] * 13]
    writer.close()
    assert len(list(read_tracks(path))) == 60


def test_two_programs_cannot_record_to_the_same_place(path: Path) -> None:
    writer = ParquetTracksWriter(path, segment_s=HOUR_S)
    with pytest.raises(
        InputError, match=rf"parts is in use: the recording .* {os.getpid()} writes"
    ):
        ParquetTracksWriter(path, resume=True)
    writer.write(snapshot(0.0, [1]))
    writer.close()
    assert len(list(read_tracks(path))) == 1


def test_a_folder_that_is_removed_while_it_is_written_is_told_as_such(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    folder.mkdir()
    writer = ParquetTracksWriter(folder / "tracks.parquet", part_s=0.0)
    writer.write(snapshot(0.0, [1]))
    folder.rename(tmp_path / "elsewhere")
    with pytest.raises(SetupError, match="was removed or renamed while it was written"):
        writer.write(snapshot(0.04, [1]))
    with pytest.raises(SetupError, match="was removed or renamed while it was written"):
        writer.close()


def test_files_and_folders_are_for_their_owner_alone(path: Path) -> None:
    record(path, hours(2))
    writer = ParquetTracksWriter(path.parent / "b.parquet", part_s=0.0)
    writer.write(snapshot(0.0, [1]))
    made = [path, parts_of(path.parent / "b.parquet"), *path.parent.rglob("*/*")]
    modes = {(entry.is_dir(), entry.stat().st_mode & 0o777) for entry in made}
    assert modes == {(True, 0o700), (False, 0o600)}
    writer.close()


def test_the_memory_of_a_writer_does_not_grow_with_the_recording(path: Path) -> None:
    """What waits for a row group is bounded, whatever the length of a segment."""
    writer = ParquetTracksWriter(path, part_s=0.0)
    many = [snapshot(0.04 * number, list(range(400))) for number in range(90)]
    waiting = []
    for one in many:
        writer.write(one)
        assert writer._open is not None
        waiting.append(sum(map(len, writer._open._waiting)))
    writer.close()
    assert max(waiting) < parquet_file.ROWS_OF_A_GROUP < 90 * 400 * 17
    assert np.diff(waiting).min() < 0
