"""Scenes: the same for the same seed, clocks, and truth that fits the images."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from trecsim.errors import InputError
from trecsim.geometry import Camera, Rig
from trecsim.lab.simulation.detector import Footage, detect
from trecsim.lab.simulation.detector_errors import PERFECT
from trecsim.lab.simulation.paths import through
from trecsim.lab.simulation.room import corner_rig
from trecsim.lab.simulation.scene import Clock, PathWalkers, Scene, Wanderers, room_scene, simulate
from trecsim.store.truth import write_truth
from trecsim.values import Poses2D


def same(left: Poses2D, right: Poses2D) -> bool:
    return (left.camera, left.t_s) == (right.camera, right.t_s) and all(
        np.array_equal(getattr(left, name), getattr(right, name), equal_nan=True)
        for name in ("xy_px", "score", "person_score")
    )


def test_the_same_seed_gives_the_same_and_another_seed_another_simulation() -> None:
    scene = room_scene(people=2, seconds=3.0)
    first, again, other = (simulate(scene, seed) for seed in (7, 7, 8))
    assert len(first.poses) == len(again.poses) == 300
    assert all(same(*pair) for pair in zip(first.poses, again.poses, strict=True))
    np.testing.assert_array_equal(first.truth_xyz_m, again.truth_xyz_m)
    assert not np.array_equal(first.truth_xyz_m, other.truth_xyz_m, equal_nan=True)


def test_what_cameras_agree_on_is_by_another_chance_than_the_people(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    seeds = []

    def watched(footage: Footage, *rest: Any) -> list[Poses2D]:
        seeds.append(footage.common_seed)
        return detect(footage, *rest)

    monkeypatch.setattr("trecsim.lab.simulation.scene.detect", watched)
    simulate(room_scene(people=1, seconds=0.5), 7)
    assert len(set(seeds)) == 1
    of_people, of_cameras = np.random.SeedSequence(7).spawn(2)
    habits = np.random.default_rng(seeds[0])
    drawn = [rng.random() for rng in (habits, *np.random.default_rng(seeds[0]).spawn(2))]
    others = [np.random.default_rng(own).random() for own in (7, of_people, of_cameras)]
    assert not set(drawn) & set(others)


def test_one_more_camera_changes_neither_the_people_nor_the_other_cameras() -> None:
    three, four = (
        Scene(corner_rig(8.0, 6.0, 2.7, cameras), Wanderers(2, 6.0, 5.0), 2.0) for cameras in (3, 4)
    )
    few, many = simulate(three, 0), simulate(four, 0)
    np.testing.assert_array_equal(few.truth_xyz_m, many.truth_xyz_m)
    kept = [one for one in many.poses if one.camera != "cam4"]
    assert all(same(*pair) for pair in zip(few.poses, kept, strict=True))


def test_perfect_images_triangulate_to_the_truth() -> None:
    made = simulate(replace(room_scene(people=1, seconds=2.0), detector=PERFECT), 3)
    for one in made.poses[::7]:
        at = np.array(
            [
                np.interp(one.t_s, made.truth_t_s, v)
                for v in made.truth_xyz_m[0].reshape(len(made.truth_t_s), -1).T
            ]
        )
        truth_px = made.rig[one.camera].project(at.reshape(17, 3))
        known = np.isfinite(one.xy_px[0, :, 0])
        assert np.abs(one.xy_px[0] - truth_px)[known].max() < 2.0  # linear between truths


def test_images_come_in_the_order_they_were_taken() -> None:
    made = simulate(room_scene(people=1, seconds=2.0), 0)
    times_s = [one.t_s for one in made.poses]
    assert times_s == sorted(times_s)
    assert len(set(times_s)) > 100  # the cameras run freely


def test_clocks_have_their_own_rate_start_and_gaps() -> None:
    rng = np.random.default_rng(0)
    assert len(Clock(fps=30.0).ticks(10.0, rng)[0]) == 300
    assert Clock(fps=10.0, start_s=0.05).ticks(1.0, rng)[0][0] == 0.05
    assert len(Clock(dropped=0.2).ticks(100.0, rng)[0]) == pytest.approx(2000, rel=0.05)
    jittered = Clock(jitter_s=0.02).ticks(50.0, rng)[0]
    assert (np.diff(jittered) > 0).all()
    assert np.std(np.diff(jittered)) > 0.005
    assert len(Clock(start_s=5.0).ticks(3.0, rng)[0]) == 0


def test_stamps_are_wrong_by_what_the_clock_says_and_right_with_the_rigs_offset() -> None:
    rig = corner_rig(8.0, 6.0, 2.7, 2)
    late = Camera(
        "late",
        rig.cameras[1].size_px,
        rig.cameras[1].K,
        rig.cameras[1].T_cam_world,
        time_offset_s=0.5,
    )
    rig = Rig((rig.cameras[0], late))
    clocks = (Clock(stamp_error_s=0.01), Clock())
    made = simulate(Scene(rig, Wanderers(1, 5.0, 5.0), 1.0, PERFECT, clocks), 0)
    stamps = {name: [one.t_s for one in made.poses if one.camera == name] for name in rig.names}
    np.testing.assert_allclose(stamps["cam1"], np.arange(25) / 25 + 0.01)
    np.testing.assert_allclose(np.array(stamps["late"]) + 0.5, np.arange(25) / 25)


def test_a_scripted_crossing_comes_as_close_as_it_says() -> None:
    t_s = np.array([0.0, 4.0])
    paths = (
        through(t_s, np.array([[-2.0, 0.2], [2.0, 0.2]])),
        through(t_s, np.array([[2.0, -0.2], [-2.0, -0.2]])),
    )
    made = simulate(Scene(corner_rig(8.0, 6.0, 2.7), PathWalkers(paths), 4.0), 0)
    hips_m = made.truth_xyz_m[:, :, 11:13, :2].mean(axis=2)
    assert np.linalg.norm(hips_m[0] - hips_m[1], axis=1).min() == pytest.approx(0.4, abs=0.06)


def test_an_empty_room_and_a_camera_without_images_are_scenes_too() -> None:
    rig = corner_rig(8.0, 6.0, 2.7, 2)
    clocks = (Clock(), Clock(start_s=99.0))
    made = simulate(Scene(rig, Wanderers(0, 6.0, 5.0), 1.0, clocks=clocks), 0)
    assert {one.camera for one in made.poses} == {"cam1"}
    assert made.truth_xyz_m.shape == (0, 51, 17, 3)


@pytest.mark.parametrize(
    ("change", "match"),
    [({"clocks": (Clock(),) * 3}, "4 cameras, 3 clocks"), ({"seconds": -1.0}, "positive length")],
)
def test_a_scene_that_cannot_be_is_refused(change: dict[str, object], match: str) -> None:
    with pytest.raises(InputError, match=match):
        replace(room_scene(), **change)  # type: ignore[arg-type]


def test_a_clock_that_cannot_be_is_refused() -> None:
    with pytest.raises(InputError, match="fps"):
        Clock(fps=0.0)


def test_the_truth_file_holds_times_and_joints(tmp_path: Path) -> None:
    made = simulate(room_scene(people=2, seconds=1.0), 0)
    write_truth(tmp_path / "truth.npz", made.truth_t_s, made.truth_xyz_m)
    with np.load(tmp_path / "truth.npz") as truth:
        np.testing.assert_array_equal(truth["t_s"], made.truth_t_s)
        np.testing.assert_array_equal(truth["xyz_m"], made.truth_xyz_m)
    assert [path.name for path in tmp_path.iterdir()] == ["truth.npz"]
