"""The demo: a whole run on a synthetic scene, and what it does with directories."""

from dataclasses import replace
from itertools import islice
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from made_tracks import walk
from trecsim.calibration import read_rig
from trecsim.errors import InputError, SetupError
from trecsim.films.bodies_drawn import person_colour
from trecsim.lab.demo import DemoScene, DemoSummary, _compared, demo, people_until
from trecsim.lab.demo_poses import demo_scene, without_end
from trecsim.lab.evaluation.evaluating import evaluate
from trecsim.lab.evaluation.moments import Recorded, gather
from trecsim.lab.report.recording import read_recording
from trecsim.lab.report.recording_files import find
from trecsim.lab.simulation.scene import simulate
from trecsim.sources import read_poses
from trecsim.store.truth import Truth

SHOWN = DemoScene(people=1, cameras=2)  # in a second: a demo lasts as long as its scene


@pytest.fixture(scope="module")
def room(tmp_path_factory: pytest.TempPathFactory) -> tuple[DemoSummary, list[tuple]]:
    """Run a demo; return its result and what was told of its progress."""
    told: list[tuple[int, int | None]] = []
    result = demo(
        tmp_path_factory.mktemp("demo") / "room",
        seconds=3.0,
        shown=DemoScene(people=2, cameras=3),
        progress=lambda done, total: told.append((done, total)),
    )
    return result, told


@pytest.fixture
def without_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Draw nothing, which takes longer than all the rest."""
    monkeypatch.setattr("trecsim.lab.plots.paths_plot.plot_paths", lambda *_, **__: None)
    monkeypatch.setattr("trecsim.lab.demo._draw_moment", lambda folder: None)


def test_the_demo_leaves_all_that_a_site_needs_and_a_picture(
    room: tuple[DemoSummary, list[tuple]],
) -> None:
    folder = room[0].folder
    assert sorted(path.name for path in folder.iterdir()) == [
        "moment.png",
        "paths.png",
        "poses.jsonl",
        "rig.toml",
        "run",
        "site.toml",
        "truth.npz",
    ]
    assert len(read_rig(folder / "rig.toml")) == 3
    assert len(list(read_poses(folder / "poses.jsonl"))) == 210  # one camera fails for 0.6 s
    with np.load(folder / "truth.npz") as truth:
        assert set(truth.files) == {"t_s", "xyz_m"}
        assert truth["xyz_m"].shape == (2, len(truth["t_s"]), 17, 3)


def test_a_report_of_a_demo_holds_its_tracks_against_truth_and_poses_of_their_time(
    room: tuple[DemoSummary, list[tuple]],
) -> None:
    folder = room[0].folder
    places = find(folder)
    assert places.truth == folder / "run" / "truth.npz"
    assert places.poses == folder / "run" / "poses.jsonl"
    result = evaluate(places.tracks, places.truth, rig=places.rig, poses=places.poses)
    assert result.scores is not None
    assert room[0].comparison is not None
    assert result.scores.error.median_m == pytest.approx(room[0].comparison.median_m, rel=0.05)
    assert result.reprojection is not None
    assert read_recording(places).truth is not None


def test_people_are_counted_up_to_the_end_of_the_truth() -> None:
    moments = gather(list(walk(100)))
    both = set(moments.id)
    late = replace(moments, id=np.where(np.arange(len(moments.id)) < 20, 7, moments.id))
    assert people_until(moments, moments.t_s[-1]) == len(both) == 2
    assert people_until(late, moments.t_s[9]) == 1
    assert people_until(late, moments.t_s[10]) == 3
    assert people_until(late, -1.0) == 0


def test_the_picture_of_a_moment_shows_everybody_in_both_views(
    room: tuple[DemoSummary, list[tuple]],
) -> None:
    assert room[0].moment is not None
    image = np.array(Image.open(room[0].moment).convert("RGB"), int)
    assert image.shape == (560, 1280, 3)
    for view in (image[:, :832], image[:, 832:]):
        for person in (0, 1):
            alike = (np.abs(view - person_colour(person)) < 30).all(axis=2)
            assert alike.sum() > 50


def test_the_error_against_the_truth_is_that_of_a_good_tracker(
    room: tuple[DemoSummary, list[tuple]],
) -> None:
    result, told = room
    done, total = told[-1]
    assert total == 210
    assert done > 60  # a busy machine leaves some out
    assert result.run.people == 2
    assert result.comparison is not None
    assert result.comparison.switches == 0
    assert 0.005 < result.comparison.median_m < 0.06
    assert result.comparison.recall_15cm > 0.9 * done / total


@pytest.mark.usefixtures("without_pictures")
def test_the_same_seed_gives_the_same_poses(tmp_path: Path) -> None:
    for name, seed in (("first", 0), ("again", 0), ("other", 1)):
        demo(tmp_path / name, seconds=1.0, shown=replace(SHOWN, seed=seed))
    first, again, other = (
        (tmp_path / name / "poses.jsonl").read_bytes() for name in ("first", "again", "other")
    )
    assert first == again != other


def test_a_folder_with_something_else_in_it_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "rig.toml").write_text("mine")
    (tmp_path / "site.toml").write_text("mine too")
    with pytest.raises(InputError, match="trecsim demo has not made"):
        demo(tmp_path)
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == {
        "rig.toml": "mine",
        "site.toml": "mine too",
    }


@pytest.mark.usefixtures("without_pictures")
def test_what_others_put_beside_an_earlier_demo_stays(
    room: tuple[DemoSummary, list[tuple]],
) -> None:
    folder = room[0].folder
    (folder / "notes.txt").write_text("mine")
    (folder / "run" / "notes.txt").write_text("mine")
    with pytest.raises(InputError, match=r"run is not empty"):
        demo(folder, seconds=1.0, shown=SHOWN)
    (folder / "run" / "notes.txt").unlink()
    demo(folder, seconds=1.0, shown=SHOWN)
    assert (folder / "notes.txt").read_text() == "mine"


@pytest.mark.parametrize(
    ("wrong", "named"),
    [
        ({"people": -1}, "people must be between 0 and 100, got -1"),
        ({"cameras": 1, "seconds": float("nan")}, "seconds .* got nan; cameras .* got 1"),
        ({"seed": -5}, "seed .* got -5"),
    ],
)
def test_numbers_that_cannot_be_are_told_at_once(
    tmp_path: Path, wrong: dict[str, float], named: str
) -> None:
    shown = DemoScene(**{name: wrong[name] for name in wrong if name != "seconds"})  # type: ignore[arg-type]
    with pytest.raises(InputError, match=named):
        demo(tmp_path / "room", seconds=wrong.get("seconds", 20.0), shown=shown)
    assert not (tmp_path / "room").exists()


def test_a_room_without_anybody_is_a_demo_too(tmp_path: Path) -> None:
    result = demo(tmp_path / "empty", seconds=1.0, shown=DemoScene(people=0, cameras=2))
    assert result.comparison is not None
    assert (result.run.people, result.comparison.person_frames) == (0, 0)
    assert result.picture is not None


@pytest.mark.usefixtures("without_pictures")
def test_without_scipy_the_demo_runs_and_says_what_the_scores_need(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def without(*_: object) -> None:
        raise SetupError("evaluation against ground truth needs SciPy")

    monkeypatch.setattr("trecsim.lab.demo.compare_moments", without)
    told: list[str] = []
    result = demo(tmp_path / "room", seconds=1.0, shown=SHOWN, remark=told.append)
    assert result.comparison is None
    assert result.run.people == 1
    assert told == ["evaluation against ground truth needs SciPy"]


@pytest.mark.usefixtures("without_pictures")
def test_it_ends_early_when_it_is_told_to_and_keeps_what_there_was(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("trecsim.lab.demo.CHAPTER_S", 5.0)
    asked = 0

    def stop() -> bool:
        nonlocal asked
        asked += 1
        return asked > 60

    result = demo(tmp_path / "room", seconds=None, shown=SHOWN, stop=stop)
    assert result.run.ended == "stopped"
    assert result.run.frame_sets > 10
    assert result.comparison is not None
    assert result.comparison.median_m < 0.1


def test_of_a_demo_without_an_end_the_first_piece_is_compared_and_that_is_told() -> None:
    moments = list(walk(100))
    first = moments[:25]
    true_m = np.stack([moment.xyz_m for moment in first], axis=1)
    truth = Truth(np.array([moment.t_s for moment in first]), true_m)
    told: list[str] = []
    result = _compared(Recorded(Path("made"), gather(moments), None, None), truth, told.append)
    assert result is not None
    assert (result.person_frames, result.missed) == (50, 0)
    assert told == ["only the first 1 s have ground truth: the errors are of that time"]


def test_without_an_end_other_people_follow_each_other() -> None:
    scene = demo_scene(1.0, people=1, cameras=2, seed=0)
    made = simulate(scene, 0)
    poses = list(islice(without_end(made, scene, 0), 3 * len(made.poses)))
    times = [one.t_s for one in poses]
    assert times == sorted(times)
    assert 2.9 < times[-1] < 3.2
    first, second = (poses[n * len(made.poses)].xy_px for n in (0, 1))
    assert first.shape != second.shape or not np.array_equal(first, second, equal_nan=True)


def test_one_camera_of_three_fails_for_a_while_and_comes_back() -> None:
    outage = demo_scene(20.0, people=1, cameras=3, seed=0).outages[0]
    assert outage.to_s - outage.from_s == pytest.approx(4.0)
    assert demo_scene(20.0, people=1, cameras=2, seed=0).outages == ()
