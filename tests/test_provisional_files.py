"""Provisional people in files: only where asked for, and marked where the format can."""

from pathlib import Path

import pytest

from trecsim.lab.simulation.scene import Simulation, room_scene, simulate
from trecsim.pipeline import track
from trecsim.store.poses_writer import PosesWriter
from trecsim.store.rows import COLUMNS
from trecsim.store.tracks import export_tracks, read_tracks

Rows = set[tuple[float, int]]


@pytest.fixture(scope="module")
def made() -> Simulation:
    return simulate(room_scene(people=3, cameras=2, seconds=2.0), 3)


@pytest.fixture(scope="module")
def folder(made: Simulation, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with tracks in both formats, with and without provisional people."""
    folder = tmp_path_factory.mktemp("tracks")
    with PosesWriter(folder / "poses.jsonl") as poses:
        for image in made.poses:
            poses.write(image)
    for name in ("some.csv", "some.parquet"):
        track(made.rig, folder / "poses.jsonl", folder / name)
    for name in ("all.csv", "all.parquet"):
        track(made.rig, folder / "poses.jsonl", folder / name, provisional=True)
    return folder


def rows(path: Path, *, provisional: bool = False) -> Rows:
    found = read_tracks(path, provisional=provisional)
    return {(one.t_s, person) for one in found for person in one.id.tolist()}


def test_files_hold_provisional_people_only_where_asked_for(folder: Path) -> None:
    some = rows(folder / "some.csv")
    assert some == rows(folder / "some.parquet", provisional=True)
    assert some < rows(folder / "all.csv")


def test_csv_and_parquet_hold_the_same_people(folder: Path) -> None:
    everybody = rows(folder / "all.parquet", provisional=True)
    assert everybody == rows(folder / "all.csv")
    assert everybody > rows(folder / "all.parquet") == rows(folder / "some.csv")


def test_parquet_tells_who_is_provisional(folder: Path) -> None:
    states = {
        state
        for one in read_tracks(folder / "all.parquet", provisional=True)
        for state in one.state.tolist()
    }
    assert {"provisional", "confirmed"} <= states


def test_csv_has_the_same_columns_with_and_without_them(folder: Path) -> None:
    for name in ("some.csv", "all.csv"):
        assert (folder / name).read_text().splitlines()[0] == ",".join(COLUMNS)


@pytest.mark.parametrize("provisional", [False, True])
def test_an_export_to_csv_leaves_them_out_unless_asked_for(
    folder: Path, tmp_path: Path, provisional: bool
) -> None:
    export_tracks(folder / "all.parquet", tmp_path / "t.csv", provisional=provisional)
    assert rows(tmp_path / "t.csv") == rows(folder / ("all.csv" if provisional else "some.csv"))


def test_an_export_to_parquet_keeps_them(folder: Path, tmp_path: Path) -> None:
    export_tracks(folder / "all.parquet", tmp_path / "t.parquet")
    everybody = rows(folder / "all.parquet", provisional=True)
    assert rows(tmp_path / "t.parquet", provisional=True) == everybody
