"""Tracks as pandas tables."""

import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from made_tracks import snapshot, walk
from trecsim.errors import SetupError
from trecsim.skeleton import COCO17
from trecsim.store.rows import COLUMNS, DETAILS
from trecsim.store.tracks import read_tracks, tracks_writer
from trecsim.values import Snapshot


def write(path: Path, made: list[Snapshot]) -> Path:
    with tracks_writer(path) as writer:
        for one in made:
            writer.write(one)
    return path


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_the_tidy_table_has_the_columns_of_the_csv_file(tmp_path: Path, suffix: str) -> None:
    path = write(tmp_path / f"t{suffix}", list(walk(3)))
    table = read_tracks(path).to_dataframe()
    assert table.columns.tolist() == list(COLUMNS)
    assert len(table) == 3 * 2 * 17
    nose = table[(table.person == 1) & (table.joint == "nose")]
    np.testing.assert_allclose(nose.x_m, [1.0, 1.04, 1.08], rtol=1e-6)
    assert nose.support.tolist() == [3, 3, 3]
    assert table.joint.cat.categories.tolist() == list(COCO17.joints)


def test_the_wide_table_has_a_row_per_time_and_person(tmp_path: Path) -> None:
    made = [snapshot(0.0, [1, 2]), snapshot(0.04, [2])]
    table = read_tracks(write(tmp_path / "t.parquet", made)).to_dataframe(wide=True)
    assert table[["t_s", "person"]].to_numpy().tolist() == [[0.0, 1], [0.0, 2], [0.04, 2]]
    assert table.columns.tolist()[2:7] == [
        "nose_x_m", "nose_y_m", "nose_z_m", "nose_sigma_m", "nose_support",
    ]  # fmt: skip
    assert len(table.columns) == 2 + 17 * 5
    np.testing.assert_allclose(table.right_ankle_y_m, [1.6] * 3, rtol=1e-6)


@pytest.mark.parametrize("wide", [False, True])
def test_details_are_there_when_asked_for(tmp_path: Path, wide: bool) -> None:
    tracks = read_tracks(write(tmp_path / "t.parquet", list(walk(2))))
    table = tracks.to_dataframe(wide=wide, details=True)
    assert table.state.tolist() == ["confirmed"] * len(table)
    name = "nose_czz_m2" if wide else "czz_m2"
    np.testing.assert_allclose(table[name], 0.02**2, rtol=0.02)
    assert wide or table.columns.tolist() == [*COLUMNS, *DETAILS]


@pytest.mark.parametrize("wide", [False, True])
def test_a_recording_of_nobody_is_an_empty_table(tmp_path: Path, wide: bool) -> None:
    table = read_tracks(write(tmp_path / "t.csv", [])).to_dataframe(wide=wide)
    assert len(table) == 0
    assert table.columns[0] == "t_s"


def test_the_table_holds_everything_whatever_has_been_read_before(tmp_path: Path) -> None:
    tracks = read_tracks(write(tmp_path / "t.csv", list(walk(3))), from_s=0.03)
    next(tracks)
    assert tracks.to_dataframe().t_s.unique().tolist() == [0.04, 0.08]
    assert [one.t_s for one in tracks] == [0.08]


def test_the_table_is_what_pandas_reads_from_the_file(tmp_path: Path) -> None:
    table = read_tracks(write(tmp_path / "t.csv", list(walk(3)))).to_dataframe()
    other = pd.read_csv(tmp_path / "t.csv")
    pd.testing.assert_frame_equal(
        table.astype({"joint": str}), other.astype({"joint": str}), check_dtype=False, rtol=1e-6
    )


def test_without_pandas_the_message_tells_how_to_install_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tracks = read_tracks(write(tmp_path / "t.csv", list(walk(3))))
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(SetupError, match=r"pandas, which is not installed: .*install .*\[pandas\]"):
        tracks.to_dataframe()


def test_tracks_are_printed_in_one_short_line(tmp_path: Path) -> None:
    path = write(tmp_path / "t.csv", list(walk(3)))
    assert repr(read_tracks(path)) == "<Tracks of t.csv>"
    assert repr(read_tracks(path, from_s=1.0, until_s=2.5)) == "<Tracks of t.csv, 1 to 2.5 s>"
