"""Cameras related by bodies, where nobody walks far enough for tracks on the floor."""

import dataclasses

import numpy as np
import pytest

from made_walkers import turns_deg
from trecsim.calibrating.people.body_pairs import Common, in_metres, sides, supporting
from trecsim.calibrating.people.body_sizes import size_of_body
from trecsim.calibrating.people.calibrate import calibrate_people
from trecsim.calibrating.people.epipolar import Epipolar, epipolar
from trecsim.calibrating.people.kernels.unknowns import Unknowns
from trecsim.calibrating.people.priors import Priors, Upright
from trecsim.calibrating.people.state import RigState
from trecsim.calibrating.people.tracklets import Tracklet
from trecsim.calibrating.people.tuning import HEIGHT_OF_JOINT
from trecsim.calibrating.people.world import lowered
from trecsim.geometry import Camera, Rig
from trecsim.geometry.rigid import rigid_motion, rotation_matrix
from trecsim.lab.simulation import room_scene, simulate
from trecsim.values import Poses2D

MOMENTS = 16


def camera(angle_deg, distance_m=4.0, height_m=1.9):
    """Return the pose, from the world, of a camera that looks at a body at the origin."""
    angle = np.radians(angle_deg)
    where = np.array([distance_m * np.cos(angle), distance_m * np.sin(angle), height_m])
    ahead = np.array([0.0, 0.0, 1.0]) - where
    ahead /= np.linalg.norm(ahead)
    right = np.cross(ahead, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    R = np.stack((right, np.cross(ahead, right), ahead))
    return rigid_motion(R, -R @ where)


def body(seed, stature_m=1.7):
    """Return joints of somebody who walks 1.5 m and moves arms and legs, (moment, joint, 3)."""
    rng = np.random.default_rng(seed)
    xyz = np.zeros((MOMENTS, 17, 3))
    xyz[..., 2] = stature_m * HEIGHT_OF_JOINT
    xyz[:, 5::2, 1], xyz[:, 6::2, 1] = 0.15, -0.15
    t = np.linspace(0.0, 1.0, MOMENTS)[:, None]
    for joint in (7, 8, 9, 10, 13, 14, 15, 16):
        xyz[:, joint, :2] += rng.uniform(0.15, 0.4) * np.sin(3 * t + rng.uniform(0, 6, 2))
    way = rng.uniform(0, 2 * np.pi)
    return xyz + 1.5 * np.array([np.cos(way), np.sin(way), 0.0]) * (t[:, :, None] - 0.5)


def shown(T, xyz, noise=0.0, rng=None):
    there = xyz @ T[:3, :3].T + T[:3, 3]
    z = there[..., :2] / there[..., 2:]
    return z if rng is None else z + noise * rng.normal(size=z.shape)


def track(number, start_s=0.0):
    return Tracklet(number, np.arange(3), start_s + np.arange(3.0))


def common(T_a, T_b, xyz, seed=0, noise=0.003):
    rng = np.random.default_rng(seed)
    return Common((track(0), track(1)), shown(T_a, xyz, noise, rng), shown(T_b, xyz, noise, rng))


def apart_deg(R, Q):
    return np.degrees(np.arccos(np.clip((np.trace(R @ Q.T) - 1) / 2, -1, 1)))


@pytest.mark.parametrize("angle_deg", [50.0, 110.0, -75.0, 160.0])
def test_a_body_tells_how_two_cameras_stand_from_whatever_side_they_look(angle_deg):
    T_a, T_b = camera(0.0), camera(angle_deg, 5.0, 2.6)
    pair = common(T_a, T_b, body(1))
    outliers = np.random.default_rng(2).uniform(size=pair.other.shape[:2]) < 0.15
    pair.other[outliers] += 0.1
    found = epipolar(*pair.rays, *sides(pair))
    true = T_b @ np.linalg.inv(T_a)
    assert apart_deg(found.R, true[:3, :3]) < 5.0
    assert found.t @ true[:3, 3] / np.linalg.norm(true[:3, 3]) > np.cos(np.radians(5.0))


def test_lengths_vertical_and_floor_come_from_the_body():
    T_a, T_b = camera(0.0), camera(80.0)
    true = T_b @ np.linalg.inv(T_a)
    geometry = Epipolar(true[:3, :3], true[:3, 3] / np.linalg.norm(true[:3, 3]), 1.0, 0.01)
    T, up, ankles_m = in_metres(geometry, common(T_a, T_b, body(3), noise=0.0))
    assert np.linalg.norm(T[:3, 3]) == pytest.approx(np.linalg.norm(true[:3, 3]), rel=0.1)
    assert up @ T_a[:3, 2] > np.cos(np.radians(10.0))
    assert up @ ankles_m == pytest.approx(-1.9 + 1.7 * HEIGHT_OF_JOINT[15], rel=0.15)


def test_nobody_is_two_people_at_a_time():
    T_a, T_b = camera(0.0), camera(80.0)
    true = T_b @ np.linalg.inv(T_a)
    geometry = Epipolar(true[:3, :3], true[:3, 3], 1.0, 0.01)
    right = common(T_a, T_b, body(4), seed=1, noise=0.001)
    like_it = dataclasses.replace(
        common(T_a, T_b, body(4), seed=2, noise=0.003), tracks=(right.tracks[0], track(1))
    )
    later = dataclasses.replace(
        common(T_a, T_b, body(5), seed=3, noise=0.001), tracks=(track(0, 9.0), right.tracks[1])
    )
    chosen, score = supporting(geometry, [like_it, right])
    assert chosen == [right]
    assert supporting(geometry, [like_it, right, later])[0] == [right, later]
    assert supporting(geometry, [right])[1] == score


def test_rays_that_meet_at_twice_the_distance_place_a_body_of_twice_the_size():
    T_a, T_b, xyz = camera(0.0), camera(80.0), body(6)
    z_a, z_b = shown(T_a, xyz), shown(T_b, xyz)
    size = size_of_body(z_a, z_b, T_a, T_b)
    assert size == pytest.approx(1.0, abs=0.25)
    wider_a, wider_b = T_a.copy(), T_b.copy()
    wider_a[:3, 3] *= 2.0
    wider_b[:3, 3] *= 2.0
    assert size_of_body(z_a, z_b, wider_a, wider_b) == pytest.approx(2.0 * size)


def test_the_vertical_that_a_body_shows_is_kept_by_the_gradient_of_its_cost():
    state = RigState.empty(2)
    state.T[0] = camera(0.0)
    state.found[:] = True
    T = state.T.copy()
    T[0, :3, :3] = rotation_matrix(np.array([0.03, -0.02, 0.04])) @ T[0, :3, :3]
    now = Unknowns(
        T, np.zeros((2, 2)), np.zeros((2, 3)), np.zeros((0, 3)), np.zeros(0), np.zeros((0, 2, 2))
    )
    plain = Priors(1, (), state.found)
    kept = dataclasses.replace(plain, root=0, upright=Upright(state.T[0, :3, 2], 0.1))
    free = dataclasses.replace(plain, root=0)
    right = np.zeros((2, 16))
    for priors, row in ((kept, right[0]), (free, right[1])):
        priors.add(now, state, np.zeros((16, 16)), row)
    gradient, step = (right[0] - right[1])[:3], 1e-6
    for axis in range(3):
        turned = now._replace(T=T.copy())
        turned.T[0, :3, :3] = rotation_matrix(step * np.eye(3)[axis]) @ T[0, :3, :3]
        extra = [kept.cost(one, state) - free.cost(one, state) for one in (now, turned)]
        assert -0.5 * (extra[1] - extra[0]) / step == pytest.approx(gradient[axis], abs=1e-3)


def test_a_floor_found_at_another_height_is_put_at_0():
    state = RigState.empty(2)
    state.T[:] = camera(0.0), camera(80.0)
    ankles = np.array([0.4, -0.3, -1.2])
    moved = lowered(state, -1.2)
    for before, after in zip(state.T, moved.T, strict=True):
        np.testing.assert_allclose(
            shown(after, ankles + np.array([0.0, 0.0, 1.2])), shown(before, ankles), atol=1e-12
        )


def test_two_seconds_of_people_are_enough_for_cameras_that_are_in_step():
    scene = simulate(room_scene(people=2, cameras=3, seconds=2.0), 3)
    apart_m = float(np.linalg.norm(scene.rig["cam1"].position_m - scene.rig["cam3"].position_m))
    lenses = Rig(tuple(dataclasses.replace(one, T_cam_world=np.eye(4)) for one in scene.rig))
    made = calibrate_people(scene.poses, lenses, distance=("cam1", "cam3", apart_m))
    assert turns_deg(made.rig, scene.rig).max() < 2.0
    assert made.result.verdict != "good"
    assert any("nobody walked far enough" in text for text in made.result.reasons)


STOOD_M = (np.array([0.6, 0.5, 0.0]), np.array([-0.7, -0.4, 0.0]))


def swaying(t_s, person):
    return STOOD_M[person] + 0.02 * np.array([np.sin(t_s), np.cos(1.3 * t_s), 0.0])


def on_a_line(t_s, person):
    """Return where somebody is who walks back and forth on the same straight line as the other."""
    phase = (t_s / 4.0 + 0.37 * person) % 2.0
    return np.array([3.0 * min(phase, 2.0 - phase) - 1.5, 0.0, 0.0])


def seen(cameras, way, late_s, seconds=12.0):
    """Return what cameras see of two people, each camera by its own clock."""
    rng = np.random.default_rng(8)
    people = [body(1)[0] - body(1)[0, 0] * [1, 1, 0], body(2)[0] - body(2)[0, 0] * [1, 1, 0]]
    score = np.full((2, 17), 0.9)
    for t_s in np.arange(0.0, seconds, 0.1):
        for one, late in zip(cameras, late_s, strict=True):
            xyz_m = [person + way(t_s, number) for number, person in enumerate(people)]
            xy_px = np.stack([one.project(xyz) for xyz in xyz_m])
            xy_px += rng.normal(0.0, 2.0, xy_px.shape)
            yield Poses2D(one.name, float(t_s + late), xy_px, score, np.full(2, 0.9))


@pytest.mark.parametrize("way", [swaying, on_a_line])
@pytest.mark.parametrize("late_s", [(0.0, 0.0, 0.0), (0.0, 2.4, -3.1)])
def test_people_who_only_stand_or_keep_to_one_line_make_no_good_rig(way, late_s):
    K = np.array([[1100.0, 0.0, 960.0], [0.0, 1100.0, 540.0], [0.0, 0.0, 1.0]])
    cameras = Rig(
        tuple(
            Camera(f"cam{n}", (1920, 1080), K, camera(angle, 5.0))
            for n, angle in enumerate((0.0, 80.0, 200.0))
        )
    )
    lenses = Rig(tuple(dataclasses.replace(one, T_cam_world=np.eye(4)) for one in cameras))
    made = calibrate_people(seen(cameras, way, late_s), lenses, stature_m=1.7)
    assert made.result.verdict != "good"
    assert any("let people walk" in reason for reason in made.result.reasons)
    if made.result.verdict == "usable":
        assert turns_deg(made.rig, cameras).max() < 1.0
