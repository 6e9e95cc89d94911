"""A recording survives whatever ends it."""

import errno
import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from made_tracks import assert_same, snapshot, walk
from trecsim.errors import InputError, SetupError
from trecsim.store.parquet_reading import parts_of, read_parquet
from trecsim.store.rows import COLUMNS
from trecsim.store.tracks import read_tracks, tracks_writer
from trecsim.store.tracks_parquet import ParquetTracksWriter

# Writes a part per moment and kills itself, or is limited, at the place named by the argument.
WRITER = """
import os, pathlib, resource, shutil, signal, sys
from made_tracks import walk
from trecsim.store.tracks_parquet import ParquetTracksWriter

path, where = pathlib.Path(sys.argv[1]), sys.argv[2]
kill = lambda *_: os.kill(os.getpid(), signal.SIGKILL)
replace = pathlib.Path.replace

def kill_at(name):
    pathlib.Path.replace = lambda a, b: kill() if b.name == name else replace(a, b)

if where == "while a part is written":
    kill_at("000008.parquet")
if where == "while the parts are merged":
    kill_at("tracks.parquet")
if where == "before the parts are removed":
    shutil.rmtree = kill
with ParquetTracksWriter(path, part_s=0.0) as writer:
    for moment in walk(20):
        writer.write(moment)
    if where == "the disk is full when the parts are merged":
        resource.setrlimit(resource.RLIMIT_FSIZE, (3000, 3000))
"""


def run_writer(path: Path, where: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-B", "-c", WRITER, str(path), where],  # no compiled module is cut
        env={
            **os.environ,
            "PYTHONPATH": os.pathsep.join([str(Path(__file__).parents[1]), *sys.path]),
        },
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.parametrize(
    ("where", "moments"),
    [
        ("while a part is written", 7),
        ("while the parts are merged", 20),
        ("before the parts are removed", 20),
    ],
)
def test_a_killed_recording_can_be_read(tmp_path: Path, where: str, moments: int) -> None:
    path = tmp_path / "tracks.parquet"
    assert run_writer(path, where).returncode == -signal.SIGKILL
    assert_same(list(read_tracks(path)), list(walk(moments)))
    assert_same(list(read_tracks(tmp_path)), list(walk(moments)))


def test_a_disk_full_at_the_end_keeps_the_parts_and_says_where(tmp_path: Path) -> None:
    path = tmp_path / "tracks.parquet"
    ended = run_writer(path, "the disk is full when the parts are merged")
    assert "SetupError: cannot write" in ended.stderr
    assert f"what was recorded is kept in {parts_of(path)}" in ended.stderr
    assert not path.exists()
    assert_same(list(read_tracks(path)), list(walk(20)))


def test_a_disk_full_on_the_way_keeps_the_parts_before(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "tracks.parquet"
    replace = Path.replace

    def full(temporary: Path, target: Path) -> Path:
        if target.name == "000003.parquet":
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return replace(temporary, target)

    monkeypatch.setattr(Path, "replace", full)
    with pytest.raises(SetupError, match=r"disk is full.*what was recorded is kept"):
        record(path, 5)
    assert_same(list(read_tracks(path)), list(walk(2)))


def record(path: Path, moments: int, then: BaseException | None = None) -> None:
    with ParquetTracksWriter(path, part_s=0.0) as writer:
        for one in walk(moments):
            writer.write(one)
        if then is not None:
            raise then


def test_the_parts_are_merged_and_removed(tmp_path: Path) -> None:
    record(tmp_path / "tracks.parquet", 5)
    assert [p.name for p in tmp_path.iterdir()] == ["tracks.parquet"]
    assert pq.ParquetFile(tmp_path / "tracks.parquet").num_row_groups == 1


def test_a_part_is_written_when_its_time_has_come(tmp_path: Path) -> None:
    path, clock = tmp_path / "tracks.parquet", iter([0.0, 1.0, 1.9, 2.1, 2.1, 3.0, 4.0, 4.1])
    with ParquetTracksWriter(path, clock=lambda: next(clock)) as writer:
        for one in walk(3):
            writer.write(one)
        assert len(list(read_parquet(path))) == 3
        writer.write(snapshot(9.0, [1]))
        assert len(list(read_parquet(path))) == 3
    assert len(list(read_parquet(path))) == 4


@pytest.mark.parametrize("fault", [ValueError("x"), KeyboardInterrupt()])
def test_an_unfinished_recording_does_not_look_whole(tmp_path: Path, fault: BaseException) -> None:
    path = tmp_path / "tracks.parquet"
    with pytest.raises(type(fault)):
        record(path, 5, fault)
    assert not path.exists()
    assert_same(list(read_tracks(path)), list(walk(5)))


def test_an_error_before_anything_was_recorded_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="early"):
        record(tmp_path / "tracks.parquet", 0, ValueError("early"))
    assert list(tmp_path.iterdir()) == []


def test_parts_of_another_recording_are_not_overwritten(tmp_path: Path) -> None:
    path = tmp_path / "tracks.parquet"
    with pytest.raises(ValueError, match="x"):
        record(path, 5, ValueError("x"))
    with pytest.raises(InputError, match="a recording that has not ended"):
        record(path, 5)
    assert len(list(read_tracks(path))) == 5


def test_a_person_and_moment_takes_some_two_hundred_bytes(tmp_path: Path) -> None:
    path = tmp_path / "tracks.parquet"
    rng = np.random.default_rng(0)
    with tracks_writer(path) as writer:
        for i in range(250):
            writer.write(snapshot(i / 25, [1, 2], rng.normal(size=(2, 17, 3))))
    assert path.stat().st_size < 250 * 2 * 300


def columns() -> dict[str, pa.Array]:
    kinds = [pa.float64(), pa.int32(), pa.string(), *[pa.float64()] * 4, pa.int64()]
    values = [0.5, 1, "nose", 1.0, 2.0, 3.0, 0.02, 4]
    return {n: pa.array([v], t) for n, v, t in zip(COLUMNS, values, kinds, strict=True)}


def test_a_file_that_others_wrote_is_read(tmp_path: Path) -> None:
    made = {**columns(), "remark": pa.array(["fell"])}
    pq.write_table(pa.table(made), tmp_path / "t.parquet")
    (read,) = read_parquet(tmp_path / "t.parquet")
    np.testing.assert_array_equal(read.xyz_m[0, 0], [1, 2, 3])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"x_m": None}, "missing: x_m"),
        ({"t_s": pa.array(["noon"])}, "noon"),
        ({"joint": pa.array(["tail"])}, r"\['tail'\] not in skeleton coco17"),
        ({"person": pa.array([None], pa.int64())}, "person: a value is missing"),
        ({"sigma_m": pa.array([-1.0])}, "row 1: sigma_m must be"),
        ({"support": pa.array([-1])}, "support|-1"),
    ],
)
def test_a_wrong_file_is_told(
    tmp_path: Path, change: dict[str, pa.Array | None], message: str
) -> None:
    made = {name: column for name, column in (columns() | change).items() if column is not None}
    pq.write_table(pa.table(made), tmp_path / "t.parquet")
    with pytest.raises(InputError, match=rf"t\.parquet.*({message})"):
        list(read_parquet(tmp_path / "t.parquet"))


@pytest.mark.parametrize("content", [b"", b"PAR1", b"t_s,person\n", b"PAR1" + bytes(99) + b"PAR1"])
def test_what_is_no_parquet_file_is_told(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "t.parquet").write_bytes(content)
    with pytest.raises(InputError, match="not a readable Parquet file"):
        list(read_parquet(tmp_path / "t.parquet"))


@pytest.mark.parametrize(
    "note",
    [
        '{"format": "trecsim.tracks/9"}',
        '{"skeleton": ["x"]}',
        '{"skeleton": "dog"}',
        "{",
        "[]",
        "[" * 100_000,
    ],
)
def test_a_file_of_another_format_is_told(tmp_path: Path, note: str) -> None:
    table = pa.table(columns()).replace_schema_metadata({"trecsim": note})
    pq.write_table(table, tmp_path / "t.parquet")
    with pytest.raises(InputError, match=r"t\.parquet: (expected one of the formats|its note)"):
        list(read_parquet(tmp_path / "t.parquet"))
