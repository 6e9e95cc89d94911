"""Cameras that are left out judge what the others say; the noise of the detector is estimated."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from made_people import STANDING_M, track
from made_rigs import ring
from trecsim.errors import InputError
from trecsim.geometry import Camera, Rig
from trecsim.lab.evaluation.detector_noise import DetectorNoise, detector_noise
from trecsim.lab.evaluation.image_matching import same_people
from trecsim.lab.evaluation.left_out import (
    ALL_CAMERAS,
    AT_ONCE,
    LeftOut,
    left_out,
    left_out_of_files,
)
from trecsim.lab.evaluation.left_out_images import Judged, between
from trecsim.lab.evaluation.moments import gather, interval_s
from trecsim.lab.evaluation.person_tracks import PersonTrack, people_of
from trecsim.lab.simulation.scene import Simulation, room_scene, simulate
from trecsim.store.poses_writer import PosesWriter
from trecsim.tracking import follow
from trecsim.values import Poses2D, Snapshot

STEP_S = 0.04
NOISE_M = 0.02


def walker(person: int, n: int = 80) -> PersonTrack:
    t_s = np.arange(n) * STEP_S
    shift_m = np.stack([0.6 * t_s - 0.9, np.full(n, 1.2 * person), np.zeros(n)], axis=1)
    return track(person, t_s, STANDING_M + shift_m[:, None])


def at(one: PersonTrack, t_s: float) -> np.ndarray:
    return STANDING_M + np.array([0.6 * t_s - 0.9, 1.2 * one.person, 0.0])


def noisy_image(
    camera: Camera, t_s: float, people: list[PersonTrack], seed: int, false: float = 0.0
) -> Poses2D:
    """Return an image with errors of a known size on the body, some of them half a metre."""
    rng = np.random.default_rng(seed)
    xyz_m = np.stack([at(one, t_s) for one in people])
    xy_px, by_world = camera.project_with_jacobian(xyz_m)
    px_per_m = np.sqrt((by_world**2).sum(axis=(-2, -1)) / 2.0)
    error_m = rng.normal(0.0, NOISE_M, xy_px.shape)
    error_m[rng.random(xy_px.shape[:2]) < false] += 0.5
    xy_px = xy_px + error_m * px_per_m[..., None]
    return Poses2D(camera.name, t_s, xy_px, np.ones(xy_px.shape[:2]), np.ones(len(people)))


def images(rig: Rig, people: list[PersonTrack], *, false: float = 0.0) -> list[Poses2D]:
    """Return images of cameras that take turns."""
    return [
        noisy_image(camera, step * STEP_S + 0.01 * number, people, 100 * step + number, false)
        for step in range(78)
        for number, camera in enumerate(rig)
    ]


@pytest.mark.parametrize(("false", "tolerance"), [(0.0, 0.05), (0.03, 0.12)])
def test_the_noise_of_the_detector_is_found_also_beside_false_key_points(
    false: float, tolerance: float
) -> None:
    rig, people = ring(4), [walker(0), walker(1)]
    found = detector_noise(images(rig, people, false=false), rig, people, STEP_S)

    assert found.residuals > 1000
    assert found.median_m == pytest.approx(NOISE_M, rel=tolerance)


def test_an_error_that_all_cameras_share_is_not_noise() -> None:
    """It moves the triangulated joint, and leaves no residual."""
    rig, people = ring(4), [walker(0)]
    beside = [replace(one, xyz_m=one.xyz_m + 0.05) for one in people]
    found = detector_noise(images(rig, people), rig, beside, STEP_S)

    assert found.median_m == pytest.approx(NOISE_M, rel=0.05)


def test_two_cameras_tell_no_noise() -> None:
    rig, people = ring(2), [walker(0)]
    found = detector_noise(images(rig, people), rig, people, STEP_S)

    assert found.residuals == 0
    assert np.isnan(found.sigma_m).all()


def test_each_detection_is_of_the_nearest_person_and_the_other_way_round() -> None:
    (camera,) = ring(1)
    shown = camera.project(STANDING_M + np.array([[[0.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]]]))
    found = np.stack([shown[1] + 3.0, shown[0] - 2.0, shown[0] + 20.0, shown[0] + 5000.0])

    pairs = dict(zip(*(one.tolist() for one in same_people(found, shown)), strict=True))
    assert pairs == {0: 1, 1: 0}
    assert [len(one) for one in same_people(found[:0], shown)] == [0, 0]


def moment(t_s: float, x_m: float, v_mps: float, sigma_m: float = 0.02) -> Snapshot:
    xyz_m = np.full((1, 17, 3), x_m)
    cov_m2 = np.broadcast_to(sigma_m**2 * np.eye(3), (1, 17, 3, 3)).copy()
    return Snapshot(
        t_s, np.array([5]), xyz_m, cov_m2, np.full((1, 17), 2),
        velocity_mps=np.full((1, 17, 3), v_mps),
    )  # fmt: skip


def test_between_two_moments_people_move_along_a_cubic() -> None:
    early, late = moment(0.0, 0.0, 0.0), moment(1.0, 1.0, 3.0)  # x = t^3
    for at_s in (0.0, 0.3, 1.0):
        np.testing.assert_allclose(between(early, late, at_s).xyz_m, at_s**3, atol=1e-12)


def test_without_velocities_people_move_along_a_line() -> None:
    early, late = moment(0.0, 0.0, np.nan), moment(1.0, 1.0, np.nan)
    np.testing.assert_allclose(between(early, late, 0.3).xyz_m, 0.3)


def test_only_people_of_both_moments_are_there_between() -> None:
    gone = replace(moment(1.0, 1.0, 0.0), id=np.array([6]))
    assert len(between(moment(0.0, 0.0, 0.0), gone, 0.5).id) == 0


def judged(stated_m: float) -> Judged:
    """Return key points of a camera beside a person whose place errs by 2 cm per axis."""
    (camera,) = ring(1)
    noise = DetectorNoise(np.full(17, NOISE_M), 1000)
    one = Judged(camera, noise, (-math.inf, math.inf), 400)
    rng = np.random.default_rng(3)
    for number in range(400):
        image = noisy_image(camera, 0.0, [walker(0)], number)
        there = moment(0.0, 0.0, 0.0, stated_m)
        xyz_m = at(walker(0), 0.0) + rng.normal(0.0, 0.02, (1, 17, 3))
        one._judge(image, replace(there, xyz_m=xyz_m))
    return one


@pytest.mark.parametrize(
    ("stated_m", "low", "high"), [(0.02, 0.88, 0.92), (0.01, 0.6, 0.85), (0.04, 0.97, 1.0)]
)
def test_ellipses_hold_what_they_say_if_sigma_is_right_and_less_if_it_is_too_small(
    stated_m: float, low: float, high: float
) -> None:
    squared, off_px, _, noise_share = np.concatenate(judged(stated_m).cells, axis=1)
    assert len(squared) == 400 * 17
    assert low < (squared < -2.0 * math.log(0.1)).mean() < high
    assert np.median(noise_share) == pytest.approx(
        NOISE_M**2 / (NOISE_M**2 + stated_m**2), rel=0.05
    )
    assert (off_px > 0).all()


@pytest.fixture(scope="module")
def made() -> Simulation:
    return simulate(room_scene(people=2, cameras=4, seconds=4.0), 5)


def found_in(made: Simulation, rig: Rig) -> LeftOut:
    moments = gather(follow(made.poses, rig))
    return left_out(lambda: made.poses, rig, people_of(moments), interval_s(moments))


def test_every_camera_is_left_out_once(made: Simulation) -> None:
    found = found_in(made, made.rig)
    assert [row.name for row in found.cameras] == [ALL_CAMERAS, *made.rig.names]
    assert found.overall.key_points == sum(row.key_points for row in found.cameras[1:])
    assert found.overall.key_points == sum(row.key_points for row in found.supports)
    assert all(0 < m <= n for m, n in zip(found.matched, found.people, strict=True))
    shares = (found.overall.within_50, found.overall.within_90, found.overall.within_99)
    assert 0.3 < shares[0] < shares[1] < shares[2] < 1.0
    assert (np.diff(found.curve, axis=1) >= 0).all()


def test_a_camera_that_was_turned_stands_out(made: Simulation) -> None:
    turn = math.radians(1.0)
    T = np.eye(4)
    T[:2, :2] = [[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]]
    T[[0, 1, 2]] = T[[0, 2, 1]]  # about the camera's vertical axis
    T[:, [1, 2]] = T[:, [2, 1]]
    first, *rest = made.rig
    turned = replace(first, T_cam_world=T @ first.T_cam_world)
    found = found_in(made, Rig((turned, *rest)))
    _, off, *good = (row.within_90 for row in found.cameras)
    assert off < min(good)
    assert found.cameras[1].median_px > 1.1 * max(row.median_px for row in found.cameras[2:])


def test_with_two_cameras_none_can_be_left_out(made: Simulation) -> None:
    rig = Rig(made.rig.cameras[:2])
    with pytest.raises(InputError, match="at least 3 cameras, the rig has 2"):
        left_out(lambda: made.poses, rig, [], STEP_S)


def test_it_is_done_by_itself_only_where_it_is_cheap(made: Simulation, tmp_path: Path) -> None:
    few = tmp_path / "poses.jsonl"
    with PosesWriter(few) as poses:
        for image in list(made.poses)[:40]:
            poses.write(image)
    many = tmp_path / "many.jsonl"
    with PosesWriter(many) as poses:
        for number in range(AT_ONCE + 1):
            nobody = np.empty((0, 17, 2))
            poses.write(
                Poses2D(made.rig.names[0], 0.1 * number, nobody, nobody[..., 0], np.empty(0))
            )
    two = Rig(made.rig.cameras[:2])
    assert left_out_of_files(made.rig, few, [], STEP_S, wanted=None) is not None
    assert left_out_of_files(made.rig, few, [], STEP_S, wanted=False) is None
    assert left_out_of_files(made.rig, many, [], STEP_S, wanted=None) is None
    assert left_out_of_files(None, few, [], STEP_S, wanted=None) is None
    with PosesWriter(tmp_path / "two.jsonl") as poses:
        for image in made.poses:
            if image.camera in two:
                poses.write(image)
    assert left_out_of_files(two, tmp_path / "two.jsonl", [], STEP_S, wanted=None) is None


def test_without_people_nothing_is_said(made: Simulation) -> None:
    found = left_out(lambda: made.poses, made.rig, [], STEP_S)
    assert found.overall.key_points == 0
    assert math.isnan(found.overall.within_90)
    assert np.isnan(found.curve).all()
