"""Floor paths are read from tracks, from a CSV of points and in the layout of ETH/UCY."""

from pathlib import Path

import numpy as np
import pytest

from lab.evaluation.scored_cases import snapshots_of
from trecsim.errors import InputError
from trecsim.store.ethucy import sets_in
from trecsim.store.floor_paths import read_floor_paths
from trecsim.store.tracks import tracks_writer


def test_points_come_in_order_of_time_from_any_order(tmp_path: Path) -> None:
    path = tmp_path / "points.csv"
    path.write_text("t_s,person,x_m,y_m\n0.4,1,2,3\n0.0,1,1,3\n0.4,2,5,5\n")
    (first, one, at), (second, both, _) = read_floor_paths(path)
    assert (first, second) == (0.0, 0.4)
    assert (one.tolist(), both.tolist()) == ([1], [1, 2])
    np.testing.assert_array_equal(at, [[1, 3]])


@pytest.mark.parametrize("step", [6, 10])
def test_the_usual_step_of_frames_is_0_4_s(tmp_path: Path, step: int) -> None:
    path = tmp_path / "scene.txt"
    path.write_text("".join(f"{780 + step * i}\t1.0\t{i}\t0.5\n" for i in range(4)))
    times = [t_s for t_s, _, _ in read_floor_paths(path)]
    np.testing.assert_allclose(np.diff(times), 0.4)


@pytest.mark.parametrize("suffix", ["csv", "parquet"])
def test_tracks_give_floor_points(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"tracks.{suffix}"
    snapshots = list(snapshots_of([{1: 0.0, 2: 3.0}] * 3))
    with tracks_writer(path) as writer:
        for snapshot in snapshots:
            writer.write(snapshot)
    found = read_floor_paths(path)
    assert len(found) == 3
    np.testing.assert_allclose(
        found[0][2], snapshots[0].xyz_m[:, [15, 16], :2].mean(axis=1), atol=1e-6
    )


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("t_s,person,x_m,y_m\n0,1,2,3\n0.4,one,2,3\n", "line 3: expected t_s, person"),
        ("t_s,person,x_m,y_m\n0,1,2,3\n0,1,2,4\n", "person 1 is there twice at 0 s"),
        ("t_s,person,x_m,y_m\n0,-1,2,3\n", "line 2: expected a finite time"),
        ("t_s,person,x_m,y_m\n0,1,2,1e9\n", "line 2: x and y must be within"),
        ("780 1 2\n", "line 1: expected four numbers"),
        ("780 1 2 3\n", "nobody is there twice"),
    ],
)
def test_what_is_wrong_is_told(tmp_path: Path, text: str, told: str) -> None:
    path = tmp_path / ("points.csv" if text.startswith("t_s") else "scene.txt")
    path.write_text(text)
    with pytest.raises(InputError, match=told):
        read_floor_paths(path)


def test_a_folder_of_eth_ucy_that_lacks_a_file_says_which(tmp_path: Path) -> None:
    (tmp_path / "biwi_hotel.txt").write_text("0 1 2 3\n")
    with pytest.raises(InputError, match=r"lacks biwi_eth\.txt"):
        sets_in([tmp_path])


def test_files_are_sets_of_their_own() -> None:
    found = sets_in([Path("a/walk.csv"), Path("b/walk.csv")])
    assert list(found) == ["walk", "b/walk.csv"]
