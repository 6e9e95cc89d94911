"""The picture of a recording: it is drawn for nobody, for one and for many."""

from pathlib import Path

import numpy as np
import pytest

from made_rigs import ring
from made_tracks import snapshot, walk
from trecsim.errors import InputError
from trecsim.lab.plots.canvas import save_figure
from trecsim.lab.plots.colours import COLOURS
from trecsim.lab.plots.path_recorder import PathRecorder
from trecsim.lab.plots.paths_plot import paths_figure, plot_paths
from trecsim.lab.plots.skeletons import VIEWS_DEG
from trecsim.values import Snapshot


def recorded(snapshots: list[Snapshot]) -> PathRecorder:
    recorder = PathRecorder()
    for moment in snapshots:
        recorder.add(moment)
    return recorder


def crowd(people: int, moments: int = 30) -> list[Snapshot]:
    """Return people on circles of different size."""
    made = []
    for i in range(moments):
        angle = i / 10 + np.arange(people)
        radius_m = 0.5 + 3 * np.arange(people) / max(people, 1)
        xyz_m = np.ones((people, 17, 3)) * np.linspace(0, 1.7, 17)[:, None]
        xyz_m[..., 0] = (radius_m * np.cos(angle))[:, None]
        xyz_m[..., 1] = (radius_m * np.sin(angle))[:, None]
        made.append(snapshot(i / 10, list(range(people)), xyz_m))
    return made


@pytest.mark.parametrize(("people", "text"), [(0, "no people"), (1, "1 person"), (50, "50 people")])
def test_a_picture_is_drawn_for_any_number_of_people(
    people: int, text: str, tmp_path: Path
) -> None:
    out = tmp_path / "paths.png"
    figure = paths_figure(recorded(crowd(people)), ring(3), title="the hall", remark="a remark")
    save_figure(figure, out)
    assert out.read_bytes().startswith(b"\x89PNG")
    told = figure.get_suptitle()
    assert told.startswith("the hall\n" + text)
    assert told.endswith("a remark")


def test_a_recording_without_a_moment_gives_a_picture_of_the_room(tmp_path: Path) -> None:
    plot_paths([], ring(2), tmp_path / "paths.svg")
    assert "no people, seen by 2 cameras" in (tmp_path / "paths.svg").read_text()


def test_every_person_and_camera_is_named() -> None:
    figure = paths_figure(recorded(crowd(5)), ring(3))
    written = {text.get_text() for text in figure.axes[0].texts}
    assert {"0", "1", "2", "3", "4", *ring(3).names} <= written


def test_neighbours_in_time_have_different_colours() -> None:
    assert len(set(COLOURS)) == len(COLOURS) >= 8


def test_one_stray_point_does_not_shrink_the_room() -> None:
    moments = crowd(3, moments=300)
    far_m = np.full((3, 17, 3), 500.0)
    moments[10] = snapshot(moments[10].t_s, [0, 1, 2], far_m)
    axes = paths_figure(recorded(moments), ring(4)).axes[0]
    assert axes.get_xlim()[1] < 20.0
    assert axes.get_aspect() == 1.0


def test_times_of_long_recordings_are_told_in_hours() -> None:
    moments = [snapshot(1e9 + 3600.0 * i, [1]) for i in range(5)]
    figure = paths_figure(recorded(moments), ring(2))
    assert "1 person in 4 h" in figure.get_suptitle()
    assert figure.axes[2].get_xlim()[1] == pytest.approx(4.0)


def test_joints_that_are_unknown_are_left_out(tmp_path: Path) -> None:
    xyz_m = np.full((2, 17, 3), np.nan)
    xyz_m[0, 5:9] = 1.0
    plot_paths([snapshot(0.0, [1, 2], xyz_m)], ring(2), tmp_path / "paths.png")
    assert (tmp_path / "paths.png").stat().st_size > 10_000


def test_a_name_that_is_no_picture_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"\.png"):
        plot_paths(walk(3), ring(2), tmp_path / "paths.txt")


def test_of_a_long_recording_only_the_end_is_drawn_as_paths_and_the_title_says_so() -> None:
    recorder = PathRecorder(keep_s=60.0)
    for i in range(200):
        people = [1] if i < 100 else [2]
        recorder.add(snapshot(float(i), people))
    figure = paths_figure(recorder, ring(2))
    floor, _, presence = figure.axes
    assert floor.get_title().startswith("the last 60 s: ")
    names = {text.get_text() for text in floor.texts}
    assert "2" in names
    assert "1" not in names
    assert [label.get_text() for label in presence.get_yticklabels()] == ["1", "2"]


def test_of_a_short_recording_everything_is_drawn() -> None:
    recorder = PathRecorder(keep_s=60.0)
    for moment in walk(100):
        recorder.add(moment)
    title = paths_figure(recorder, ring(2)).axes[0].get_title()
    assert title.startswith("paths, older parts paler")


@pytest.mark.parametrize(("feet_m", "told"), [(0.08, []), (1.5, ["1.5 m"])])
def test_how_high_somebody_stands_who_is_up_on_something_is_told(
    feet_m: float, told: list[str]
) -> None:
    xyz_m = np.ones((1, 17, 3)) * np.linspace(1.7, 0.0, 17)[:, None] + [0.0, 0.0, feet_m]
    xyz_m[:, 15:, 2] = feet_m
    people = paths_figure(recorded([snapshot(0.0, [1], xyz_m)]), ring(3)).axes[1]
    texts = [text.get_text().strip() for text in people.texts]
    assert texts == ["x, 0.5 m", "y", "z", "1", *told]


def test_the_skeletons_are_seen_from_where_no_pole_of_a_camera_crosses_a_person() -> None:
    rig = ring(1)
    pole_m = rig[rig.names[0]].position_m
    usual = np.deg2rad(VIEWS_DEG[0])
    behind_m = pole_m[:2] - 2.0 * np.array([np.cos(usual), np.sin(usual)])
    xyz_m = np.ones((1, 17, 3)) * np.linspace(1.7, 0.0, 17)[:, None]
    xyz_m[..., :2] = behind_m
    crossed = paths_figure(recorded([snapshot(0.0, [1], xyz_m)]), rig).axes[1]
    assert crossed.azim in VIEWS_DEG[1:]
    xyz_m[..., :2] = behind_m + 3.0
    clear = paths_figure(recorded([snapshot(0.0, [1], xyz_m)]), rig).axes[1]
    assert clear.azim == VIEWS_DEG[0]
