"""All cameras see a joint in the same wrong place, which person, pose and time decide."""

from dataclasses import replace

import numpy as np
import pytest

from trecsim.geometry.triangulation import triangulate
from trecsim.lab.simulation.body_shape import body
from trecsim.lab.simulation.common_error import CommonError, with_common_error
from trecsim.lab.simulation.detector import Footage, detect
from trecsim.lab.simulation.detector_errors import ANNOTATED, CLOTHED, PERFECT, REAL
from trecsim.lab.simulation.paths import through
from trecsim.lab.simulation.room import corner_rig
from trecsim.lab.simulation.scene import room_scene, simulate
from trecsim.lab.simulation.walkers import poses, walker

SPREAD_M = 0.03
SIZE = CommonError((0.0,) * 17, (SPREAD_M,) * 17, (0.3,) * 17, 0.5, 0.25)
T_S = np.arange(200) / 25.0


def crowd(people: int = 2, around: bool = True) -> np.ndarray:
    """Return people who walk in circles, or who stand, (time, person, 17, 3)."""
    motions = []
    for number in range(people):
        angle = np.linspace(-1.0, 9.0, 120) + number
        circle_m = np.stack((np.cos(angle), np.sin(angle)), axis=1)
        path_m = circle_m if around else np.repeat([[1.0 * number, 0.0]], 120, axis=0)
        motions.append(walker(body(1.75), through(np.linspace(-1.0, 9.0, 120), path_m)))
    return np.ascontiguousarray(np.moveaxis(poses(motions, T_S), 0, 1))


def away_m(xyz_m: np.ndarray, size: CommonError = SIZE, seed: int = 7) -> np.ndarray:
    shown_m = with_common_error(T_S[: len(xyz_m)], xyz_m, size, np.random.default_rng(seed))
    return shown_m - xyz_m


def in_trunk(xyz_m: np.ndarray, offset_m: np.ndarray) -> np.ndarray:
    """Return offsets along the axes of each trunk."""
    up = xyz_m[..., 5:7, :].mean(axis=-2) - xyz_m[..., 11:13, :].mean(axis=-2)
    up /= np.linalg.norm(up, axis=-1, keepdims=True)
    forward = np.cross(xyz_m[..., 11, :] - xyz_m[..., 12, :], up)
    forward /= np.linalg.norm(forward, axis=-1, keepdims=True)
    axes = np.stack((forward, np.cross(up, forward), up), axis=-1)
    return np.einsum("tpja,tpai->tpji", offset_m, axes)


def test_the_error_does_not_depend_on_when_a_camera_looks() -> None:
    xyz_m = crowd()
    shown_m = with_common_error(T_S, xyz_m, SIZE, np.random.default_rng(7))
    later_m = with_common_error(T_S[50::3], xyz_m[50::3], SIZE, np.random.default_rng(7))
    np.testing.assert_allclose(later_m, shown_m[50::3], atol=1e-12)


def test_it_has_the_stated_spread_and_mean_about_every_person() -> None:
    up_m = tuple(np.linspace(0.0, 0.08, 17))
    offset_m = np.concatenate(
        [in_trunk(xyz_m := crowd(8), away_m(xyz_m, replace(SIZE, up_m=up_m), s)) for s in range(6)],
        axis=1,
    )
    np.testing.assert_allclose(offset_m.mean(axis=(0, 1, 2))[:2], 0.0, atol=0.003)
    np.testing.assert_allclose(offset_m[..., 2].mean(axis=(0, 1)), up_m, atol=0.012)
    about_m = offset_m - offset_m.mean(axis=(0, 1, 2))
    about_m[..., 2] -= np.array(up_m) - np.mean(up_m)
    assert np.sqrt((about_m**2).mean()) == pytest.approx(SPREAD_M, rel=0.08)


def test_without_size_there_is_none() -> None:
    none = replace(SIZE, spread_m=(0.0,) * 17)
    assert not none
    assert SIZE
    np.testing.assert_allclose(away_m(crowd(), none), 0.0, atol=1e-12)
    assert not REAL.common_error
    assert not PERFECT.common_error


def test_a_persons_own_part_is_constant_in_the_trunk_and_differs_between_people() -> None:
    xyz_m = crowd(6)
    offset_m = in_trunk(xyz_m, away_m(xyz_m, replace(SIZE, person=(1.0,) * 17)))
    np.testing.assert_allclose(offset_m, np.broadcast_to(offset_m[:1], offset_m.shape), atol=1e-9)
    first = offset_m[0].reshape(6, -1)
    alike = np.corrcoef(first)[np.triu_indices(6, 1)]
    assert np.abs(alike).max() < 0.5
    assert first.std(axis=1) == pytest.approx(np.full(6, SPREAD_M), rel=0.35)


def test_the_part_of_the_pose_stays_while_the_pose_does_and_comes_back_with_it() -> None:
    of_pose = replace(SIZE, person=(0.0,) * 17, pose=1.0)
    still_m = away_m(np.repeat(crowd()[:1], 50, axis=0), of_pose)
    assert np.abs(still_m).max() > SPREAD_M
    np.testing.assert_allclose(still_m, still_m[:1] + np.zeros_like(still_m), atol=1e-12)
    there_m = crowd()
    there_and_back_m = np.concatenate((there_m[:100], there_m[:100][::-1]))
    moving_m = away_m(there_and_back_m, of_pose)
    np.testing.assert_allclose(moving_m[:100], moving_m[100:][::-1], atol=1e-12)
    # Half a turn later nothing is left of it; from image to image it changes but little.
    apart = (moving_m[:20] * moving_m[80:100]).mean() / (moving_m**2).mean()
    assert abs(apart) < 0.3
    assert np.median(np.abs(np.diff(moving_m[:100], axis=0))) < 0.3 * SPREAD_M


def test_what_wanders_is_forgotten_within_its_time() -> None:
    wandering = replace(SIZE, person=(0.0,) * 17, pose=0.0)
    xyz_m = crowd(8, around=False)
    offset_m = in_trunk(xyz_m, away_m(xyz_m, wandering))

    def correlation(frames: int) -> float:
        return float((offset_m[frames:] * offset_m[:-frames]).mean() / (offset_m**2).mean())

    assert correlation(5) == pytest.approx(np.exp(-0.2 / 0.25), abs=0.1)
    assert correlation(50) == pytest.approx(0.0, abs=0.1)


@pytest.mark.parametrize("detector", [ANNOTATED, CLOTHED])
def test_cameras_all_round_agree_on_the_wrong_place(detector) -> None:
    xyz_m = np.moveaxis(crowd(1), 1, 0)
    rig = corner_rig(9.0, 9.0, 2.5)
    agreed = replace(
        PERFECT,
        common_up_m=detector.common_up_m,
        common_spread_m=detector.common_spread_m,
        common_person=detector.common_person,
    )
    views = []
    for number, camera in enumerate(rig):
        footage = Footage(camera, T_S, T_S, xyz_m, np.array([1.75]), common_seed=3)
        found = detect(footage, agreed, np.random.default_rng(number))
        views.append(np.stack([one.xy_px[0, 5:] for one in found]))
    placed_m, _ = triangulate(rig.P, np.stack(views))
    shown_m = with_common_error(
        T_S, np.moveaxis(xyz_m, 0, 1), agreed.common_error, np.random.default_rng(3)
    )[:, 0, 5:]
    error_m, apart_m = placed_m - xyz_m[0, :, 5:], placed_m - shown_m
    # Each camera relies on it by its own doubt, so they agree to a fraction of its size.
    assert np.linalg.norm(apart_m, axis=-1).mean() < 0.4 * np.linalg.norm(error_m, axis=-1).mean()
    stated_m2 = np.square(detector.common_spread_m[5:]) * 3 + np.square(detector.common_up_m[5:])
    assert (error_m**2).sum(axis=-1).mean() == pytest.approx(stated_m2.mean(), rel=0.5)


def test_the_people_of_another_seed_are_wrong_in_another_way() -> None:
    scene = replace(
        room_scene(people=1, seconds=2.0), detector=replace(PERFECT, common_spread_m=(0.05,) * 17)
    )
    perfect = replace(scene, detector=PERFECT)
    shifts_px = []
    for seed in (1, 2):
        pair = zip(simulate(scene, seed).poses, simulate(perfect, seed).poses, strict=True)
        moved = [a.xy_px - b.xy_px for a, b in pair if a.xy_px.shape == b.xy_px.shape]
        shifts_px.append(np.nanmean(np.concatenate(moved), axis=(0,)))
    assert np.nanmedian(np.abs(shifts_px[0])) > 1.0
    assert np.nanmedian(np.abs(shifts_px[0] - shifts_px[1])) > 1.0


def test_only_the_direction_of_the_mean_differs_between_annotated_and_clothed() -> None:
    def of(detector, joint: int) -> float:
        spread_m2 = 3 * np.square(detector.common_spread_m[joint])
        return float(spread_m2 + np.square(detector.common_up_m[joint]))

    for joint in range(17):
        assert of(CLOTHED, joint) == pytest.approx(of(ANNOTATED, joint))
        assert 0.3 <= CLOTHED.common_person[joint] <= 1.0
    assert CLOTHED.sigma == ANNOTATED.sigma
