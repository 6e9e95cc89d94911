import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from made_videos import numbered, write_sound, write_video
from trecsim import estimators
from trecsim.cli.estimate_command import cameras_of
from trecsim.errors import InputError
from trecsim.estimators.estimator_settings import checked
from trecsim.estimators.movenet import MoveNetSettings
from trecsim.sources import read_poses
from trecsim.values import Frame, Poses2D

Command = Callable[..., tuple[int, str, str]]


class Somebody:
    """Finds one person in every image, all joints at its centre."""

    skeleton = "coco17"
    stops_at: int | None = None
    fault: BaseException = KeyboardInterrupt()

    def __init__(self, settings: MoveNetSettings) -> None:
        self.settings = settings

    def __call__(self, frame: Frame) -> Poses2D:
        if frame.index == self.stops_at:
            raise self.fault
        centre = np.array([frame.image.shape[1] / 2, frame.image.shape[0] / 2])
        xy_px = np.broadcast_to(centre, (1, 17, 2)).copy()
        return Poses2D(frame.camera, frame.t_s, xy_px, np.full((1, 17), 0.5), np.array([0.5]))


class Point:
    name, value = "somebody", "tests"

    def load(self) -> Callable[..., Somebody]:
        return lambda argument, **given: Somebody(checked(MoveNetSettings, given, "somebody"))


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the current directory, with videos and an installed estimator."""
    monkeypatch.setattr(estimators, "entry_points", lambda group: [Point()])
    monkeypatch.chdir(tmp_path)
    (tmp_path / "videos").mkdir()
    write_video(tmp_path / "videos" / "north.mp4", numbered(6))
    write_video(tmp_path / "videos" / "south.mp4", numbered(4))
    return tmp_path


def estimate(trecsim: Command, *arguments: object) -> tuple[int, str, str]:
    return trecsim("estimate", *arguments, "--estimator", "somebody", "--out", "f.poses.jsonl")


def cameras(path: str = "f.poses.jsonl") -> list[str]:
    return [poses.camera for poses in read_poses(Path(path))]


def test_cameras_are_called_like_their_files(trecsim: Command) -> None:
    code, out, _ = estimate(trecsim, "videos/north.mp4", "videos/south.mp4")
    assert code == 0
    assert out.startswith("f.poses.jsonl: 10 images of 2 cameras, 1.00 people in each")
    assert cameras().count("north") == 6
    assert cameras().count("south") == 4


def test_cameras_may_be_given_a_name(trecsim: Command) -> None:
    assert estimate(trecsim, "a=videos/north.mp4", "b=videos/south.mp4")[0] == 0
    assert set(cameras()) == {"a", "b"}


def test_a_directory_stands_for_its_videos(trecsim: Command, folder: Path) -> None:
    (folder / "videos" / "notes.txt").write_text("no video")
    assert estimate(trecsim, "videos")[0] == 0
    assert set(cameras()) == {"north", "south"}


def test_the_summary_is_one_json_object(trecsim: Command) -> None:
    code, out, err = estimate(trecsim, "videos", "--json")
    summary = json.loads(out)
    assert (code, err) == (0, "")
    assert summary["images"] == 10
    assert summary["people_per_image"] == 1.0
    assert summary["cameras"]["north"] == {"images": 6, "people_per_image": 1.0}
    assert summary["out"] == "f.poses.jsonl"


def test_settings_reach_the_estimator(trecsim: Command) -> None:
    code, _, err = estimate(trecsim, "videos", "--long-side", 99999, "--max-people", 0)
    assert code == 2
    assert "long_side" in err
    assert "max_people" in err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["none.mp4"], "none.mp4: no such file"),
        (["empty"], "no video in the directory empty"),
        (["videos", "videos/north.mp4"], "camera 'north' is there twice"),
        (["=videos/north.mp4"], "expected NAME=VIDEO"),
        ([], "no video is given"),
        (["sound.mp4"], "no video in it"),
        (["text.mp4"], "no video"),
        (["cut.mp4"], "cut off|damaged"),
    ],
)
def test_wrong_videos(trecsim: Command, folder: Path, arguments: list[str], message: str) -> None:
    (folder / "empty").mkdir()
    write_sound(folder / "sound.mp4")
    (folder / "text.mp4").write_text("no video at all")
    whole = (folder / "videos" / "north.mp4").read_bytes()
    (folder / "cut.mp4").write_bytes(whole[: len(whole) // 2])
    code, out, err = estimate(trecsim, *arguments)
    assert (code, out) == (2, "")
    assert err.startswith("trecsim: ")
    assert any(part in err for part in message.split("|")), err
    assert not list(folder.glob("f.poses*"))


def test_all_wrong_videos_come_in_one_message(trecsim: Command) -> None:
    _, _, err = estimate(trecsim, "a.mp4", "b.mp4")
    assert "a.mp4" in err
    assert "b.mp4" in err


def test_an_unknown_estimator(trecsim: Command) -> None:
    code, _, err = trecsim("estimate", "videos", "--estimator", "somebod", "--out", "f.poses.jsonl")
    assert code == 2
    assert "did you mean 'somebody'" in err


def test_an_output_that_would_be_taken_for_something_else(trecsim: Command) -> None:
    code, _, err = trecsim("estimate", "videos", "--out", "f.json")
    assert code == 2
    assert ".poses.jsonl" in err


def test_an_output_in_a_directory_that_is_not_there(trecsim: Command) -> None:
    arguments = ("estimate", "videos", "--estimator", "somebody", "--out", "no/f.poses.jsonl")
    code, _, err = trecsim(*arguments)
    assert code == 2
    assert "no/f.poses.jsonl" in err


@pytest.mark.parametrize(
    ("fault", "exit_code", "told"),
    [(KeyboardInterrupt(), 1, "stopped"), (InputError("it broke"), 2, "it broke")],
)
def test_what_was_finished_is_kept(
    trecsim: Command,
    folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    fault: BaseException,
    exit_code: int,
    told: str,
) -> None:
    monkeypatch.setattr(Somebody, "stops_at", 3)
    monkeypatch.setattr(Somebody, "fault", fault)
    code, out, err = estimate(trecsim, "videos/north.mp4")
    assert (code, out) == (exit_code, "")
    assert f"{told}; 3 images are kept in f.poses.jsonl.partial" in err
    assert not (folder / "f.poses.jsonl").exists()
    assert cameras("f.poses.jsonl.partial") == ["north"] * 3


def test_nothing_is_kept_of_nothing(
    trecsim: Command, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Somebody, "stops_at", 0)
    _, _, err = estimate(trecsim, "videos/north.mp4")
    assert "nothing was finished" in err
    assert not list(folder.glob("f.poses*"))


def test_a_file_with_an_equals_sign_in_its_name_is_a_file(folder: Path) -> None:
    path = folder / "a=b.mp4"
    path.touch()
    assert cameras_of((str(path),)) == {"a=b": path}


def test_a_directory_of_images_is_told_from_one_of_videos(tmp_path):
    (tmp_path / "0001.jpg").write_bytes(b"\xff\xd8\xff")
    with pytest.raises(InputError, match=r"no video .*; sequences of images are not read: make a"):
        cameras_of((str(tmp_path),))
