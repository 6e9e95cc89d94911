"""Films and pictures: decoded again and compared with where people are."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import av
import numpy as np
import pytest

from made_motion import RATE_HZ, recorded, two_walkers, walking_m
from made_rigs import ring
from made_videos import write_video
from trecsim import cli
from trecsim.calibration import write_rig
from trecsim.errors import InputError, SetupError
from trecsim.export.exporting import export_tracks
from trecsim.export.motions import collect
from trecsim.films import FilmSettings, filming, render
from trecsim.films.alerts import Alert, open_at, read_alerts
from trecsim.films.bodies_drawn import person_colour
from trecsim.films.camera_tiles import CameraTile
from trecsim.films.film_settings import FilmInput
from trecsim.films.people_at import Lookup
from trecsim.films.predicted import Predicted
from trecsim.films.scene3d import eye_on
from trecsim.films.stage import stage_around
from trecsim.films.strokes import ALARM, WARNING
from trecsim.sources import VideoFile
from trecsim.store.tracks import read_tracks, tracks_writer
from trecsim.values import Snapshot

GREY = 90
SMALL = FilmSettings(width=480, height=270)


def near(image: np.ndarray, at_px: np.ndarray, colour: tuple[int, int, int]) -> float:
    """Return how far the nearest pixel of about a colour is from a point [px]."""
    alike = (np.abs(image.astype(int) - colour) < 60).all(axis=2)
    y, x = np.nonzero(alike)
    return float(np.hypot(x - at_px[0], y - at_px[1]).min()) if len(x) else np.inf


def standing(folder: Path) -> tuple[Path, np.ndarray]:
    """Record one person who walks slowly past the middle for 2 s."""
    t_s = np.arange(50) / RATE_HZ
    xyz_m = walking_m(t_s) * [0.3, 1.0, 1.0]
    return recorded(folder / "tracks.csv", {1: xyz_m}, t_s), xyz_m


def floor_of(xyz_m: np.ndarray) -> np.ndarray:
    return xyz_m[0, 15:, :2].mean(axis=0)


def grey_video(path: Path, frames: int = 50) -> Path:
    return write_video(path, [np.full((270, 480, 3), GREY, np.uint8)] * frames)


@pytest.mark.parametrize("lens", ["none", "brown", "fisheye"])
def test_skeletons_are_where_the_lens_puts_them(lens: str, tmp_path: Path) -> None:
    tracks, xyz_m = standing(tmp_path)
    lookup = Lookup(collect(read_tracks(tracks)))
    for camera in ring(3, lens):
        video = VideoFile(grey_video(tmp_path / f"{camera.name}.mp4"), camera.name)
        tile = CameraTile(camera, video, [1.0])
        image = np.zeros((270, 480, 3), np.uint8)
        tile.draw(image, lookup)
        tile.close()
        wanted = (camera.project(xyz_m[25]) + 0.5) * [480 / 1920, 270 / 1080] - 0.5
        for joint in (5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16):
            assert near(image, wanted[joint], person_colour(1)) < 2.0
        coloured = (np.abs(image.astype(int) - GREY) > 40).any(axis=2)
        y, x = np.nonzero(coloured[40:])
        low, high = wanted.min(axis=0) - 40, wanted.max(axis=0) + 40
        assert ((x > low[0]) & (x < high[0]) & (y + 40 > low[1] - 40) & (y + 40 < high[1])).all()


def test_people_are_drawn_where_they_were_when_the_image_was_taken(tmp_path: Path) -> None:
    t_s = np.arange(50) / RATE_HZ
    tracks = recorded(tmp_path / "t.csv", {1: walking_m(t_s)}, t_s)
    lookup = Lookup(collect(read_tracks(tracks)))
    people = lookup.at(1.017)
    np.testing.assert_allclose(people.xyz_m, walking_m(np.array([1.017])), atol=2e-3)


def test_nobody_is_shown_in_a_gap(tmp_path: Path) -> None:
    tracks, _, _ = two_walkers(tmp_path)
    lookup = Lookup(collect(read_tracks(tracks)))
    assert [lookup.at(t_s).person for t_s in (1.0, 2.0, 9.0)] == [(3, 7), (3,), ()]
    assert np.isnan(lookup.at(3.3).xyz_m[0, 0]).all()


def test_a_single_moment_is_shown(tmp_path: Path) -> None:
    t_s = np.array([5.0])
    tracks = recorded(tmp_path / "t.csv", {1: walking_m(t_s)}, t_s)
    assert Lookup(collect(read_tracks(tracks))).at(5.0).person == (1,)
    assert render(tracks, tmp_path / "p.png", None, SMALL).people == 1


def test_paths_are_interrupted_where_nobody_was_tracked(tmp_path: Path) -> None:
    t_s = np.concatenate([np.arange(25), np.arange(125, 150)]) / RATE_HZ
    tracks = recorded(tmp_path / "t.csv", {1: walking_m(t_s)}, t_s)
    lookup = Lookup(collect(read_tracks(tracks)))
    path_m = lookup.path_m(1)
    broken = np.isnan(path_m).all(axis=1)
    assert broken.sum() == 1
    before = lookup.path_rows(1, 0.0, 2.0)  # the last points are less evened
    assert np.isfinite(path_m[before]).all()
    np.testing.assert_allclose(path_m[before][-1], floor_of(walking_m(t_s[24:25])), atol=0.05)
    after = lookup.path_rows(1, 2.0, 9.0)
    assert broken[after].tolist() == [True, *[False] * (after.stop - after.start - 1)]


def test_a_film_decodes_to_the_frames_that_were_asked_for(tmp_path: Path) -> None:
    tracks, _ = standing(tmp_path)
    rig = ring(2)
    videos = {camera.name: grey_video(tmp_path / f"{camera.name}.mp4") for camera in rig}
    done: list[tuple[int, int | None]] = []
    made = render(
        tracks, tmp_path / "a film.mp4", FilmInput(rig, videos),
        FilmSettings(480, 270, rate_hz=12.5, from_s=0.2, to_s=1.4),
        lambda at, of: done.append((at, of)),
    )  # fmt: skip
    assert (made.frames, made.people, made.cameras) == (16, 1, ("cam0", "cam1"))
    assert done[-1] == (16, 16)
    with av.open(str(made.out)) as film:
        stream = film.streams.video[0]
        assert (stream.width, stream.height, float(stream.average_rate)) == (480, 270, 12.5)
        images = [(picture.time, picture.to_ndarray(format="rgb24")) for picture in film.decode()]
    np.testing.assert_allclose([t for t, _ in images], np.arange(16) / 12.5, atol=1e-3)
    blue = person_colour(1)
    assert all(
        (np.abs(image.astype(int) - blue) < 60).all(axis=2).sum() > 50 for _, image in images
    )
    assert not np.array_equal(images[0][1], images[-1][1])


def test_without_videos_the_view_and_the_plan_fill_a_picture(tmp_path: Path) -> None:
    tracks, _, _ = two_walkers(tmp_path)
    made = render(tracks, tmp_path / "p.png", None, SMALL)
    assert (made.frames, made.people, made.cameras) == (1, 2, ())
    from PIL import Image

    image = np.array(Image.open(made.out).convert("RGB"))
    assert image.shape == (270, 480, 3)
    for half in (image[:, :312], image[:, 312:]):
        for person in (3, 7):
            assert (np.abs(half.astype(int) - person_colour(person)) < 30).all(axis=2).sum() > 20


def test_the_eye_has_the_whole_floor_and_people_on_it_in_view() -> None:
    for points in ([[0.0, 0.0]], [[-30.0, 2.0], [40.0, 9.0]], [[5.0, -50.0], [6.0, 60.0]]):
        stage = stage_around(np.array(points), None, {}, {})
        eye = eye_on(stage, 640, 360)
        corners = stage.corners()
        box = np.concatenate([np.insert(corners, 2, 0.0, 1), np.insert(corners, 2, 1.8, 1)])
        seen = eye.project(box)
        assert (seen > 0).all()
        assert (seen < [640, 360]).all()
        assert np.ptp(seen, axis=0).max() > 0.5 * 360


def test_events_are_shown_while_they_are_open(tmp_path: Path) -> None:
    def line(phase: str, t_s: float, end_s: float | None = None) -> str:
        data = {
            "event": "a", "phase": phase, "severity": "alarm", "t_start_s": 1.0,
            "t_detect_s": t_s, "t_end_s": end_s, "rule": {"id": "strip", "kind": "zone.enter"},
            "zone": "edge", "people": [{"person": 4}],
        }  # fmt: skip
        return json.dumps({"data": data})

    file = tmp_path / "events.jsonl"
    file.write_text("\n".join([line("new", 1.2), line("update", 2.0), line("end", 5.0, 4.5)]))
    alerts = read_alerts(file)
    shown = {t_s: sorted(open_at(alerts, t_s).people) for t_s in (1.1, 1.3, 4.4, 4.6)}
    assert shown == {1.1: [], 1.3: [4], 4.4: [4], 4.6: []}
    assert alerts[0].text == "strip (edge): 4"
    about_cameras = {"data": {"event": "c", "phase": "new", "severity": "warning"}}
    file.write_text(json.dumps(about_cameras))
    assert read_alerts(file) == []
    file.write_text('{"data": 3}\n')
    with pytest.raises(InputError, match="line 1 is no event"):
        read_alerts(file)


def test_a_person_is_marked_by_the_worst_event_and_not_by_information() -> None:
    def about(severity: str, *people: int) -> Alert:
        return Alert(0.0, 9.0, severity, severity, people)

    alerts = open_at([about("alarm", 1), about("warning", 1, 2), about("info", 1, 3)], 1.0)
    marks = [alerts.colour(person) for person in (1, 2, 3, 4)]
    assert marks == [ALARM, WARNING, None, None]


def test_a_path_is_evened_over_the_steps_of_the_feet(tmp_path: Path) -> None:
    t_s = np.arange(100) / RATE_HZ
    xyz_m = walking_m(t_s)
    xyz_m[:, 15, 1] += 0.2 * (np.sin(2 * np.pi * 1.6 * t_s) > 0)  # an ankle moves sideways
    lookup = Lookup(collect(read_tracks(recorded(tmp_path / "t.csv", {1: xyz_m}, t_s))))
    path_m = lookup.path_m(1)[5:-5]
    assert np.ptp(path_m[:, 1]) < 0.03 < np.ptp(xyz_m[:, 15:, 1].mean(axis=1))
    assert (np.diff(path_m[:, 0]) > 0).all()


def test_forecasts_are_shown_until_the_next_is_due(tmp_path: Path) -> None:
    file = tmp_path / "forecast.jsonl"
    mode = {
        "weight": 1.0, "xy_m": [[1.0, 0.0], [2.0, 0.0]],
        "cov_m2": [[0.01, 0.0, 0.01], [0.04, 0.0, 0.09]],
    }  # fmt: skip
    file.write_text(json.dumps({"t_s": 1.0, "person": 2, "ahead_s": [0.4, 0.8], "modes": [mode]}))
    predicted = Predicted(file)
    assert predicted.at(2, 0.9) == []
    ((path_m, region_m),) = predicted.at(2, 1.2)
    assert path_m.tolist() == mode["xy_m"]
    np.testing.assert_allclose(np.ptp(region_m, axis=0) / 2, np.sqrt(1.386) * np.array([0.2, 0.3]))
    assert predicted.at(2, 2.0) == []
    file.write_text("{}\n")
    with pytest.raises(InputError, match="line 1 is no forecast"):
        Predicted(file)


@pytest.mark.parametrize(
    ("settings", "text"),
    [
        ({"from_s": 9.0}, "no tracks from 9 s to the end; they last"),
        ({"from_s": 1.0, "to_s": 0.5}, "no tracks from 1 s to 0.5 s"),
        ({"from_s": -1.0}, "no tracks from -1 s"),
        ({"at_s": -1.0}, "--at-s -1"),
        ({"width": 10}, "--width 10"),
        ({"rate_hz": 0.0}, "--rate-hz 0"),
        ({"trail_s": -1.0}, "--trail-s -1"),
        ({"from_s": np.nan}, "--from-s nan"),
        ({"to_s": np.nan}, "--to-s nan"),
        ({"at_s": np.nan}, "--at-s nan"),
    ],
)
def test_settings_that_cannot_be_are_refused(
    settings: dict[str, float], text: str, tmp_path: Path
) -> None:
    tracks, _, _ = two_walkers(tmp_path)
    ending = ".png" if "at_s" in settings else ".mp4"
    with pytest.raises(InputError, match=text):
        render(tracks, tmp_path / f"o{ending}", None, FilmSettings(**settings))
    assert sorted(tmp_path.iterdir()) == [tracks]


def test_a_part_of_the_tracks_is_read_as_in_the_whole(tmp_path: Path) -> None:
    t_s = 100.0 + np.arange(250) / RATE_HZ
    late_m = walking_m(t_s, 1)
    late_m[:200] = np.nan
    tracks = recorded(tmp_path / "t.csv", {1: walking_m(t_s), 4: late_m}, t_s)
    pictures = []
    for name, settings in (
        ("a.png", FilmSettings(480, 270, at_s=8.2, trail_s=1.0)),
        ("b.png", FilmSettings(480, 270, from_s=8.2, to_s=8.2, trail_s=1.0)),
    ):
        made = render(tracks, tmp_path / name, None, settings)
        assert made.from_s == pytest.approx(108.2)
        assert made.people == 2
        pictures.append(made.out.read_bytes())
    assert pictures[0] == pictures[1]
    film = render(tracks, tmp_path / "f.mp4", None, FilmSettings(480, 270, from_s=4.0, to_s=4.2))
    assert (film.frames, film.people) == (6, 1)
    with pytest.raises(InputError, match="--at-s is the moment of a picture"):
        render(tracks, tmp_path / "g.mp4", None, FilmSettings(at_s=1.0))


def test_only_the_owner_can_read_a_picture_of_people(tmp_path: Path) -> None:
    tracks, _, _ = two_walkers(tmp_path)
    assert render(tracks, tmp_path / "p.png", None, SMALL).out.stat().st_mode & 0o077 == 0


@pytest.mark.parametrize("known", [0, 20, 50])
def test_somebody_of_whom_nothing_is_known_is_not_drawn(known: int, tmp_path: Path) -> None:
    t_s = np.arange(50) / RATE_HZ
    xyz_m = np.stack([walking_m(t_s), walking_m(t_s) + 1.0], axis=1)
    xyz_m[known:, 1] = np.nan
    with tracks_writer(tmp_path / "t.parquet") as writer:
        for time_s, pose_m in zip(t_s.tolist(), xyz_m, strict=True):
            cov_m2 = np.tile(1e-4 * np.eye(3), (2, 17, 1, 1))
            writer.write(Snapshot(time_s, np.array([1, 2]), pose_m, cov_m2, np.full((2, 17), 3)))
    tracks = tmp_path / "t.parquet"
    at_s = replace(SMALL, at_s=0.2)
    assert render(tracks, tmp_path / "p.png", None, at_s).people == (2 if known else 1)
    at_s = replace(SMALL, at_s=1.5)
    assert render(tracks, tmp_path / "p.png", None, at_s).frames == 1
    made = export_tracks(tracks, tmp_path / "t.usda")
    assert made.people == (2 if known else 1)


def test_a_video_of_no_camera_and_an_unknown_ending_are_refused(tmp_path: Path) -> None:
    tracks, _, _ = two_walkers(tmp_path)
    video = grey_video(tmp_path / "north.mp4", 3)
    with pytest.raises(InputError, match="'north' is not in the rig"):
        render(tracks, tmp_path / "o.mp4", FilmInput(ring(2), {"north": video}), SMALL)
    with pytest.raises(InputError, match=r"\.mp4 for a film"):
        render(tracks, tmp_path / "o.gif")


def test_an_interrupted_film_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tracks, _, _ = two_walkers(tmp_path)

    def interrupt(at: int, of: int | None) -> None:
        if at == 5:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        render(tracks, tmp_path / "o.mp4", None, SMALL, interrupt)
    assert sorted(tmp_path.iterdir()) == [tracks]

    def missing() -> None:
        raise SetupError("films and pictures need OpenCV")

    monkeypatch.setattr(filming, "opencv", missing)
    with pytest.raises(SetupError):
        render(tracks, tmp_path / "o.mp4")


def test_the_command_takes_what_lies_beside_the_tracks(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    tracks, _ = standing(tmp_path)
    write_rig(ring(2), tmp_path / "rig.toml")
    video = grey_video(tmp_path / "cam1.mp4")
    run: Callable[..., object] = cli.main
    for arguments in (
        [tracks, tmp_path / "o.png", video, "--json", "--width", "480", "--height", "270"],
        [tmp_path, tmp_path / "p.png", "--json"],
    ):
        with pytest.raises(SystemExit) as ended:
            run(["render", *map(str, arguments)])
        assert ended.value.code == 0
    first, second = map(json.loads, capsys.readouterr().out.splitlines())
    assert (first["cameras"], first["people"], second["cameras"]) == (["cam1"], 1, [])
