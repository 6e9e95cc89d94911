"""Parquet keeps more than CSV: states, velocities and covariances."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from made_live import assert_same_bits
from made_tracks import assert_same, snapshot, walk
from trecsim.errors import InputError
from trecsim.store.parquet_file import TracksInfo
from trecsim.store.parquet_writing import write_file
from trecsim.store.precision import rounded
from trecsim.store.rows import COLUMNS, DETAILS
from trecsim.store.tracks import export_tracks, read_tracks, tracks_writer
from trecsim.store.tracks_parquet import tables_of
from trecsim.values import Snapshot


def detailed(moments: int, condition: float = 100.0) -> list[Snapshot]:
    """Return snapshots with covariances of any direction, and velocities."""
    rng = np.random.default_rng(7)
    made = []
    for one in walk(moments, people=3):
        turn = np.linalg.qr(rng.normal(size=(3, 17, 3, 3)))[0]
        variances = 1e-4 * condition ** np.array([0.0, 0.5, 1.0])
        made.append(
            replace(
                one,
                cov_m2=turn @ (variances[:, None] * turn.swapaxes(-1, -2)),
                velocity_mps=rng.normal(size=(3, 17, 3)),
                state=np.array(["confirmed", "coasting", "provisional"]),
            )
        )
    return made


def write(path: Path, made: list[Snapshot]) -> Path:
    with tracks_writer(path) as writer:
        for one in made:
            writer.write(one)
    return path


def write_floats(path: Path, made: list[Snapshot], *, details: bool = True) -> Path:
    """Write what `trecsim export` makes: floats, in the order of time."""
    info = TracksInfo(details=details)
    write_file(path, tables_of(made, info), info)
    return path


def test_states_velocities_and_covariances_come_back(tmp_path: Path) -> None:
    made = detailed(5)
    read = list(read_tracks(write(tmp_path / "t.parquet", made), provisional=True))
    assert [one.t_s for one in read] == [one.t_s for one in made]
    for a, b in zip(read, made, strict=True):
        assert a.state.tolist() == b.state.tolist()
        np.testing.assert_allclose(a.xyz_m, b.xyz_m, atol=0.5e-3 + 1e-9)
        np.testing.assert_allclose(a.sigma_m, b.sigma_m, rtol=0.01)
        np.testing.assert_allclose(a.velocity_mps, b.velocity_mps, atol=0.5e-2 + 1e-9)
        np.testing.assert_allclose(a.cov_m2, b.cov_m2, atol=1e-4 / 6)  # smallest variance: 1e-4


def test_the_columns_are_those_of_the_contract(tmp_path: Path) -> None:
    table = pq.read_table(write(tmp_path / "t.parquet", detailed(2)))
    velocities, covariances = ["vx_mps", "vy_mps", "vz_mps"], [f"c{axes}_m2" for axes in AXES]
    assert table.column_names == [*COLUMNS, "state", *velocities, *covariances]
    assert table["state"].to_pylist()[::34] == ["confirmed", "coasting", "provisional"]
    first = detailed(2)[0]  # people, joints and times in this order
    assert table["cxz_m2"][0].as_py() == pytest.approx(first.cov_m2[0, 0, 0, 2], abs=1e-5)
    assert float(table["vz_mps"][0].as_py()) == pytest.approx(first.velocity_mps[0, 0, 2], abs=0.01)


AXES = ("xx", "xy", "xz", "yy", "yz", "zz")


def test_what_a_reader_gets_is_known_while_recording(tmp_path: Path) -> None:
    """Rules that work on it give the same on the recording."""
    made = detailed(5)
    read = list(read_tracks(write(tmp_path / "t.parquet", made), provisional=True))
    assert_same_bits(read, [rounded(one) for one in made])


@pytest.mark.parametrize("condition", [1.0, 100.0, 1e4])
def test_covariances_stay_positive_definite(tmp_path: Path, condition: float) -> None:
    """One camera knows a place a hundred times less along its ray than across it."""
    made = detailed(20, condition)
    for one in read_tracks(write(tmp_path / "t.parquet", made)):
        smallest = np.linalg.eigvalsh(one.cov_m2)[..., 0]
        np.testing.assert_allclose(smallest, 1e-4, rtol=0.4)


def test_csv_from_parquet_is_the_csv_of_the_rounded_numbers_to_the_byte(tmp_path: Path) -> None:
    made = detailed(20)
    write(tmp_path / "direct.csv", [rounded(one) for one in made])
    export_tracks(write(tmp_path / "t.parquet", made), tmp_path / "exported.csv")
    assert (tmp_path / "exported.csv").read_bytes() == (tmp_path / "direct.csv").read_bytes()


def test_an_exported_parquet_file_has_all_details_that_there_were(tmp_path: Path) -> None:
    write(tmp_path / "a.parquet", detailed(5))
    export_tracks(tmp_path / "a.parquet", tmp_path / "b.parquet")
    export_tracks(tmp_path / "b.parquet", tmp_path / "c.parquet")
    assert pq.read_table(tmp_path / "b.parquet").equals(pq.read_table(tmp_path / "c.parquet"))
    for a, b in zip(
        read_tracks(tmp_path / "a.parquet", provisional=True),
        read_tracks(tmp_path / "b.parquet", provisional=True),
        strict=True,
    ):
        np.testing.assert_array_equal(a.cov_m2, b.cov_m2)
        np.testing.assert_allclose(a.xyz_m, b.xyz_m, rtol=1e-6)
        np.testing.assert_allclose(a.velocity_mps, b.velocity_mps, atol=0.5 / 1024)
        assert a.state.tolist() == b.state.tolist()
    export_tracks(tmp_path / "a.parquet", tmp_path / "a.csv")
    export_tracks(tmp_path / "a.csv", tmp_path / "d.parquet")
    assert pq.read_table(tmp_path / "d.parquet").column_names == list(COLUMNS)


def test_people_who_are_not_confirmed_yet_are_left_out_unless_asked_for(tmp_path: Path) -> None:
    made = detailed(3)
    alone = replace(snapshot(9.0, [5]), state=np.array(["provisional"]))
    for name in ("t.csv", "t.parquet"):
        read = list(read_tracks(write(tmp_path / name, [*made, alone])))
        assert [one.id.tolist() for one in read] == [[0, 1]] * 3
    asked = list(read_tracks(tmp_path / "t.parquet", provisional=True))
    assert [one.id.tolist() for one in asked] == [[0, 1, 2]] * 3 + [[5]]


def test_a_file_without_details_is_read(tmp_path: Path) -> None:
    made = list(walk(3))
    read = list(read_tracks(write_floats(tmp_path / "t.parquet", made, details=False)))
    assert_same(read, made)
    np.testing.assert_allclose(read[0].cov_m2[0, 0], 0.02**2 * np.eye(3), rtol=1e-6)
    assert np.isnan(read[0].velocity_mps).all()
    assert read[0].state.tolist() == ["confirmed", "confirmed"]


def test_some_details_may_be_missing(tmp_path: Path) -> None:
    table = pq.read_table(write_floats(tmp_path / "t.parquet", detailed(2)))
    pq.write_table(table.drop_columns(["state", "vx_mps"]), tmp_path / "t.parquet")
    read = next(read_tracks(tmp_path / "t.parquet"))
    np.testing.assert_allclose(read.cov_m2[0, 0], detailed(1)[0].cov_m2[0, 0], rtol=1e-3, atol=1e-7)
    assert np.isnan(read.velocity_mps).all()


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("state", pa.scalar("asleep"), r"state: \['asleep'\] not a state"),
        ("vx_mps", pa.scalar(np.inf), "row 1: velocities must be finite"),
        ("cxx_m2", pa.scalar(-1.0), "row 1: covariances must be finite or NaN, variances from 0"),
        ("cxy_m2", pa.scalar(np.inf), "row 1: covariances must be finite"),
        ("x_m", pa.scalar(1e20), r"row 1: x_m, y_m, z_m must be within 1e\+06 m"),
        ("sigma_m", pa.scalar(1e7), r"row 1: sigma_m must be a number from 0 to 1e\+06"),
        ("t_s", pa.scalar(1e300), r"row 1: t_s must be a finite number up to 1e\+11 s"),
    ],
)
def test_details_that_cannot_be_are_told(
    tmp_path: Path, name: str, value: pa.Scalar, message: str
) -> None:
    table = pq.read_table(write_floats(tmp_path / "t.parquet", detailed(1)[:1]))
    column = pa.array([value.as_py()] * len(table))
    wrong = table.set_column(table.column_names.index(name), name, column)
    pq.write_table(wrong, tmp_path / "t.parquet")
    with pytest.raises(InputError, match=message):
        list(read_tracks(tmp_path / "t.parquet"))


def test_every_detail_has_a_column_that_compresses_byte_by_byte_or_is_few_words(
    tmp_path: Path,
) -> None:
    write_floats(tmp_path / "t.parquet", detailed(50))
    group = pq.ParquetFile(tmp_path / "t.parquet").metadata.row_group(0)
    encodings = {
        group.column(n).path_in_schema: group.column(n).encodings for n in range(group.num_columns)
    }
    assert all("BYTE_STREAM_SPLIT" in encodings[name] for name in DETAILS if name != "state")
