"""Compact files: what is read has the same bits as what was written, in whatever pieces."""

import tempfile
from dataclasses import replace
from pathlib import Path

import duckdb
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from made_live import any_snapshots, assert_same_bits, live_moments
from often import often
from trecsim.errors import InputError
from trecsim.skeleton import COCO17
from trecsim.store.compact import COMPACT_SCHEMA, compact_table, moments_in
from trecsim.store.compact_file import merged, write_compact
from trecsim.store.compaction import complete_segment, merge_parts
from trecsim.store.parquet_file import TracksInfo, read_contents
from trecsim.store.parquet_reading import read_info, read_parquet
from trecsim.store.precision import rounded
from trecsim.store.tracks import export_tracks, read_tracks
from trecsim.values import Snapshot

INFO = TracksInfo(rig_sha256="ab")


def write(path: Path, moments: list[Snapshot]) -> Path:
    write_compact(path, [compact_table(moments, COCO17)], INFO)
    return path


@given(st.lists(any_snapshots(), max_size=4, unique_by=lambda one: one.t_s))
def test_a_table_gives_back_every_bit(made: list[Snapshot]) -> None:
    moments = sorted((rounded(one) for one in made), key=lambda one: one.t_s)

    assert_same_bits(list(moments_in(compact_table(moments, COCO17), COCO17)), moments)


@settings(max_examples=often(30))
@given(
    st.lists(any_snapshots(), min_size=1, max_size=8, unique_by=lambda one: one.t_s),
    st.lists(st.integers(1, 3), min_size=8, max_size=8),
    st.lists(st.integers(2, 4), max_size=3),
    st.booleans(),
)
def test_parts_of_any_size_merged_in_any_way_give_back_every_bit(
    made: list[Snapshot], sizes: list[int], merges: list[int], complete: bool
) -> None:
    moments = sorted((rounded(one) for one in made), key=lambda one: one.t_s)
    with tempfile.TemporaryDirectory() as place:
        parts = Path(place) / "00000001"
        parts.mkdir()
        first = 0
        for number, size in enumerate(sizes, start=1):
            if part := moments[first : first + size]:
                write(parts / f"{number:06d}.parquet", part)
            first += size
        for at_least in merges:
            merge_parts(parts, INFO, at_least)
        if complete:
            complete_segment(Path(place), 1, INFO, frozenset(), 3)

        assert_same_bits(list(read_parquet(Path(place))), moments)


def test_a_file_gives_back_every_bit_and_moments_without_people(tmp_path: Path) -> None:
    moments = list(live_moments(200))
    path = write(tmp_path / "tracks.parquet", moments)

    assert_same_bits(list(read_parquet(path)), moments)
    assert any(len(one.id) == 0 for one in moments)
    assert read_info(path) == INFO


def test_merged_files_are_the_file_that_would_have_been_written_at_once(tmp_path: Path) -> None:
    moments = list(live_moments(90))
    parts = [write(tmp_path / f"{n}.parquet", moments[n : n + 30]) for n in (0, 30, 60)]

    assert merged(parts).equals(compact_table(moments, COCO17))


def test_a_time_between_is_read_alone(tmp_path: Path) -> None:
    moments = list(live_moments(90))
    tables = [compact_table(moments[n : n + 30], COCO17) for n in (0, 30, 60)]
    write_compact(tmp_path / "t.parquet", tables, INFO)

    found = read_parquet(tmp_path / "t.parquet", moments[25].t_s, moments[64].t_s)
    assert_same_bits(list(found), moments[25:65])


def test_other_readers_of_tracks_see_no_moment_without_people(tmp_path: Path) -> None:
    path = write(tmp_path / "tracks.parquet", list(live_moments(50)))

    assert all(len(one.id) for one in read_tracks(path, provisional=True))
    assert all((one.state != "provisional").all() for one in read_tracks(path))


def test_a_moment_without_anybody_has_one_row_without_a_person(tmp_path: Path) -> None:
    moments = list(live_moments(10))
    rows = compact_table(moments, COCO17).to_pylist()

    empty = [row for row in rows if row["person"] is None]
    assert [row["t_s"] for row in empty] == [one.t_s for one in moments if not len(one.id)]
    assert empty[0]["joint"] is None
    assert empty[0]["x_m"] is None


def test_the_extent_of_a_file_without_anybody_is_known(tmp_path: Path) -> None:
    moments = [one for one in live_moments(30) if not len(one.id)]
    contents = read_contents(write(tmp_path / "t.parquet", moments))

    assert (contents.first_s, contents.last_s) == (moments[0].t_s, moments[-1].t_s)
    assert contents.highest_person == -1


def test_a_compact_file_becomes_a_csv_file_with_its_short_numbers(tmp_path: Path) -> None:
    moments = [one for one in live_moments(5) if len(one.id)]
    write(tmp_path / "tracks.parquet", moments)
    export_tracks(tmp_path / "tracks.parquet", tmp_path / "tracks.csv")

    line = (tmp_path / "tracks.csv").read_text().splitlines()[1].split(",")
    assert len(line[3].partition(".")[2]) <= 3


def test_a_file_of_a_newer_version_is_refused_with_a_sentence(tmp_path: Path) -> None:
    table = compact_table(list(live_moments(3)), COCO17)
    newer = table.replace_schema_metadata({"trecsim": '{"format": "trecsim.tracks/4"}'})
    pq.write_table(newer, tmp_path / "t.parquet", store_decimal_as_integer=True)

    with pytest.raises(InputError, match=r"tracks/4'; it was made by a newer trecsim"):
        list(read_parquet(tmp_path / "t.parquet"))


def damaged(change: str) -> pa.Table:
    """Return a compact table in which something is wrong."""
    table = compact_table([one for one in live_moments(5) if len(one.id)], COCO17)
    if change == "twice":
        return pa.concat_tables([table, table])
    column, values = {
        "infinite": ("t_s", pa.array(np.full(len(table), np.inf))),
        "negative": ("person", pa.array(np.full(len(table), -5))),
        "joint": ("joint", pa.array(["tail"] * len(table)).dictionary_encode()),
        "floats": ("x_m", pa.array(np.zeros(len(table)))),
        "text": ("cxy_m2", pa.array(["much"] * len(table))),
        "infinite covariance": ("cxy_m2", pa.array(np.full(len(table), np.inf))),
        "negative variance": ("cxx_m2", pa.array(np.full(len(table), -1e-4))),
        "indefinite": ("cxy_m2", pa.array(np.full(len(table), 1.0))),
    }[change]
    return table.set_column(table.column_names.index(column), column, values)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ("twice", "given twice"),
        ("infinite", "t_s must be"),
        ("negative", "person must not"),
        ("joint", "tail"),
        ("floats", "x_m: expected decimals"),
        ("text", "cxy_m2: expected numbers with a fraction, found string"),
        ("infinite covariance", "covariances must be finite or NaN"),
        ("negative variance", "covariances must be finite or NaN, and positive"),
        ("indefinite", "positive semidefinite"),
    ],
)
def test_impossible_content_is_refused(tmp_path: Path, change: str, told: str) -> None:
    table = damaged(change).replace_schema_metadata({"trecsim": '{"format": "trecsim.tracks/3"}'})
    pq.write_table(table, tmp_path / "t.parquet", store_decimal_as_integer=True)

    with pytest.raises(InputError, match=told):
        list(read_parquet(tmp_path / "t.parquet"))


def test_time_that_runs_backwards_is_refused(tmp_path: Path) -> None:
    moments = list(live_moments(40))
    tables = [compact_table(moments[20:], COCO17), compact_table(moments[:20], COCO17)]
    write_compact(tmp_path / "t.parquet", tables, INFO)

    with pytest.raises(InputError, match="time runs backwards"):
        list(read_parquet(tmp_path / "t.parquet"))


def test_sql_sees_metres_and_names(tmp_path: Path) -> None:
    moments = [one for one in live_moments(20) if len(one.id)]
    moments = [replace(one, state=np.full(len(one.id), "confirmed")) for one in moments]
    path = write(tmp_path / "tracks.parquet", moments)

    query = "SELECT max(z_m), count(DISTINCT person) FROM read_parquet(?) WHERE joint = 'nose'"
    highest, people = duckdb.execute(query, [str(path)]).fetchall()[0]
    assert float(highest) == np.nanmax([np.nanmax(one.xyz_m[:, 0, 2]) for one in moments])
    assert people == len({person for one in moments for person in one.id.tolist()})


def test_a_file_that_duckdb_wrote_again_can_be_read(tmp_path: Path) -> None:
    moments = list(live_moments(20))
    path = write(tmp_path / "a.parquet", moments)
    duckdb.execute(f"COPY (FROM '{path}') TO '{tmp_path / 'b.parquet'}' (FORMAT parquet)")
    table = pq.read_table(tmp_path / "b.parquet")
    assert set(table.column_names) == set(COMPACT_SCHEMA.names)
    table = table.replace_schema_metadata({"trecsim": '{"format": "trecsim.tracks/3"}'})
    pq.write_table(table, tmp_path / "c.parquet")

    assert_same_bits(list(read_parquet(tmp_path / "c.parquet")), moments)
