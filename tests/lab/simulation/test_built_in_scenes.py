"""Every built-in scene can be simulated, is what it says, and is seen by its cameras."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from trecsim.lab.simulation import BUILT_IN, read_scene, simulate
from trecsim.lab.simulation.floor_plan import COLUMNS, ROWS, floor_plan
from trecsim.lab.simulation.occlusion import hidden_behind_obstacles
from trecsim.lab.simulation.scene import Scene
from trecsim.lab.simulation.walkers import poses

SAMPLE_S = 0.25
# Of the moments of people there, the share in which two cameras have most of them in the image.
COVERED = dict.fromkeys(BUILT_IN, 0.95) | {
    "side-entry": 0.85,  # they come from outside of what both see
    "gate": 0.8,  # its walls hide legs
    "two-rooms": 0.7,  # nobody sees the corridor
}
NEAREST_M = {"crossing-50cm": 0.5, "crossing-30cm": 0.3, "hugging": 0.34}


@cache
def people(name: str) -> np.ndarray:
    """Return everybody's joints a few times a second, as the scene's own seed makes them."""
    scene = read_scene(name)
    of_people, _ = np.random.SeedSequence(scene.seed).spawn(2)
    people = scene.people(scene.seconds, np.random.default_rng(of_people))
    t_s = np.arange(0.0, scene.seconds, SAMPLE_S)
    return poses([person.motion for person in people], t_s)


def cameras_that_see(scene: Scene, xyz_m: np.ndarray) -> np.ndarray:
    """Return by how many cameras each joint is seen, other people left out."""
    seen = np.zeros(xyz_m.shape[:-1], dtype=int)
    for camera in scene.rig:
        px = camera.project(xyz_m)
        inside = ((px > -0.5) & (px < np.array(camera.size_px) - 0.5)).all(axis=-1)
        seen += inside & ~hidden_behind_obstacles(camera.position_m, xyz_m, scene.obstacles)
    return seen


@pytest.mark.parametrize("name", BUILT_IN)
def test_people_are_where_two_cameras_see_them(name: str) -> None:
    scene, xyz_m = read_scene(name), people(name)
    here = np.isfinite(xyz_m[..., 0, 0])
    mostly = (cameras_that_see(scene, xyz_m) >= 2).mean(axis=-1) > 0.6
    assert mostly[here].mean() > COVERED[name]
    assert here.any(axis=1).all()  # everybody comes
    assert here.mean() > 0.3


@pytest.mark.parametrize("name", BUILT_IN)
def test_people_move_as_people_do(name: str) -> None:
    xyz_m = people(name)
    here = np.isfinite(xyz_m[..., 0, 0])
    assert xyz_m[here][..., 2].min() > 0.0
    assert xyz_m[here][..., 2].max() < 2.5
    hips_m = xyz_m[:, :, 11:13].mean(axis=2)
    step_m = np.linalg.norm(np.diff(hips_m[..., :2], axis=1), axis=-1)
    step_m = step_m[np.isfinite(step_m) & (step_m < 2.0)]  # who comes back is elsewhere
    assert step_m.max() < 3.2 * SAMPLE_S
    apart_m = np.linalg.norm(hips_m[:, None, :, :2] - hips_m[None, :, :, :2], axis=-1)
    apart_m[np.arange(len(hips_m)), np.arange(len(hips_m))] = np.nan
    if name in NEAREST_M:
        assert np.nanmin(apart_m) == pytest.approx(NEAREST_M[name], abs=0.05)
    elif len(hips_m) > 1:
        assert np.nanmin(apart_m) > 0.4
    for box in read_scene(name).obstacles:
        inside = ((hips_m > box.low_m) & (hips_m < box.high_m)).all(axis=-1)
        assert not inside.any()


@pytest.mark.parametrize("name", BUILT_IN)
def test_every_scene_can_be_simulated(name: str) -> None:
    scene = replace(read_scene(name), seconds=0.3)
    made = simulate(scene)
    assert {one.camera for one in made.poses} == set(scene.rig.names)
    assert made.truth_xyz_m.shape == (scene.people.count, 16, 17, 3)


@pytest.mark.parametrize("name", ["rotating", "gate", "crowded-room"])
def test_another_seed_gives_other_bodies_and_noise(name: str) -> None:
    scene = replace(read_scene(name), seconds=1.0)
    made, other = simulate(scene), simulate(scene, scene.seed + 1)
    arm_m, other_arm_m = (
        np.linalg.norm(one.truth_xyz_m[0, 0, 5] - one.truth_xyz_m[0, 0, 7]) for one in (made, other)
    )
    assert abs(arm_m - other_arm_m) > 1e-3
    scores = [[score for seen in one.poses for score in seen.person_score] for one in (made, other)]
    assert scores[0] != scores[1]


def test_the_hall_has_twelve_cameras_and_fifty_people() -> None:
    scene = read_scene("hall")
    assert (len(scene.rig), scene.people.count) == (12, 50)


def test_postures_are_taken() -> None:
    def heads_m(name: str) -> np.ndarray:
        return people(name)[..., 0, 2]

    assert np.nanmin(heads_m("lying-down")) < 0.4
    assert np.nanmin(heads_m("falling")[0]) < 0.4
    assert np.nanmin(heads_m("falling")[1:]) > 1.3
    assert np.nanmin(heads_m("crawling")[0]) < 0.9
    assert np.nanmin(heads_m("standing-up"), axis=1) == pytest.approx([1.15, 1.15], abs=0.25)
    wrists_m = people("arms-up")[0, :, 9:11, 2]
    assert (wrists_m > heads_m("arms-up")[0][:, None]).all(axis=1).mean() > 0.1
    shoulders_m = np.diff(people("rotating")[:, :, 5:7, :2], axis=2)[:, :, 0]
    turned = np.unwrap(np.arctan2(shoulders_m[..., 1], shoulders_m[..., 0]), axis=1)
    assert (np.ptp(turned, axis=1) > 5.0).all()


def test_who_left_comes_back_as_the_same_person() -> None:
    xyz_m = people("leaving-returning")
    here = np.isfinite(xyz_m[..., 0, 0])
    for person in (0, 1):
        changes = np.flatnonzero(np.diff(here[person].astype(int)))
        assert len(changes) == 2  # there, away, there
        thigh_m = np.linalg.norm(xyz_m[person, :, 11] - xyz_m[person, :, 13], axis=-1)
        assert np.nanstd(thigh_m) < 1e-3
    assert here[2].all()


@pytest.mark.parametrize("name", ["two-rooms", "gate", "standing-up"])
def test_the_small_picture_shows_cameras_and_people(name: str) -> None:
    plan = floor_plan(read_scene(name))
    lines = plan.split("\n")
    assert len(lines) == ROWS
    assert max(map(len, lines)) <= COLUMNS
    cameras = len(read_scene(name).rig)
    assert cameras - 2 <= sum(plan.count(arrow) for arrow in "→↗↑↖←↙↓↘◉") <= cameras
    assert "o" in plan
    assert ("▒" in plan) == bool(read_scene(name).obstacles)
