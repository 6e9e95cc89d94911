"""Tracks come back as they were written, whatever the format."""

import json
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pyarrow.parquet as pq
import pytest
from hypothesis import given, settings

from made_live import assert_same_bits
from made_tracks import assert_same, recordings, snapshot, walk
from often import often
from trecsim.errors import InputError
from trecsim.store.parquet_reading import read_info
from trecsim.store.precision import rounded
from trecsim.store.tracks import TracksInfo, export_tracks, read_tracks, tracks_writer
from trecsim.values import Snapshot


def write(path: Path, made: list[Snapshot]) -> Path:
    with tracks_writer(path) as writer:
        for one in made:
            writer.write(one)
    return path


@given(made=recordings())
@settings(max_examples=often(20))
def test_what_is_written_is_read(made: list[Snapshot]) -> None:
    with TemporaryDirectory() as folder:
        read = list(read_tracks(write(Path(folder) / "tracks.csv", made)))
        assert_same(read, made, exact=True)
        read = list(read_tracks(write(Path(folder) / "tracks.parquet", made)))
        assert_same_bits(read, [rounded(one) for one in made])


@given(made=recordings())
@settings(max_examples=often(20))
def test_export_there_and_back_gives_the_same_bytes(made: list[Snapshot]) -> None:
    with TemporaryDirectory() as name:
        folder = Path(name)
        first = write(folder / "a.csv", made)
        export_tracks(first, folder / "b.parquet")
        export_tracks(folder / "b.parquet", folder / "c.csv")
        assert (folder / "c.csv").read_bytes() == first.read_bytes()


def test_a_float64_comes_back_within_half_a_micrometre(tmp_path: Path) -> None:
    xyz_m = np.random.default_rng(1).uniform(-7.9, 7.9, (1, 17, 3))
    (read,) = read_tracks(write(tmp_path / "t.csv", [snapshot(0.0, [1], xyz_m)]))
    assert 0 < np.abs(read.xyz_m - xyz_m).max() < 0.5e-6


def test_the_extent_of_an_export_is_counted(tmp_path: Path) -> None:
    path = write(tmp_path / "t.csv", list(walk(10, people=3)))
    extent = export_tracks(path, tmp_path / "t.parquet")
    assert (extent.moments, extent.people, extent.rows) == (10, 3, 510)
    assert extent.last_s == pytest.approx(0.36)


def test_a_parquet_file_says_what_it_is(tmp_path: Path) -> None:
    path = tmp_path / "t.parquet"
    with tracks_writer(path, TracksInfo(rig_sha256="abc")) as writer:
        writer.write(snapshot(0.0, [1]))
    facts = json.loads(pq.read_schema(path).metadata[b"trecsim"])
    assert facts == {
        "format": "trecsim.tracks/3",
        "skeleton": "coco17",
        "unit": "m",
        "rig_sha256": "abc",
    }
    export_tracks(path, tmp_path / "again.parquet")
    assert read_info(tmp_path / "again.parquet").rig_sha256 == "abc"


def test_a_moment_without_anybody_is_not_recorded(tmp_path: Path) -> None:
    path = write(tmp_path / "t.csv", [snapshot(0.0, [1]), snapshot(1.0, []), snapshot(2.0, [1])])
    assert [s.t_s for s in read_tracks(path)] == [0.0, 2.0]


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_an_empty_recording_is_a_recording(tmp_path: Path, suffix: str) -> None:
    assert list(read_tracks(write(tmp_path / f"t{suffix}", []))) == []


def test_an_unknown_suffix_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"one of \.csv, \.parquet, not with '\.xlsx'"):
        tracks_writer(tmp_path / "t.xlsx")


def test_tracks_that_are_not_there_are_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"there are no tracks at .*gone\.csv"):
        next(read_tracks(tmp_path / "gone.csv"))


def test_a_directory_is_read_by_the_tracks_in_it(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"expected tracks.parquet or tracks.csv"):
        list(read_tracks(tmp_path))
    for name, moments in (("tracks.csv", 3), ("tracks.parquet", 4)):  # the second goes first
        with tracks_writer(tmp_path / name) as writer:
            for moment in walk(moments):
                writer.write(moment)
        assert len(list(read_tracks(tmp_path))) == moments
