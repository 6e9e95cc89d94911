"""The simulated estimator errs as it is told to, and as real ones do."""

from dataclasses import replace

import numpy as np
import pytest
from pydantic import ValidationError

from trecsim.lab.simulation.body_shape import body
from trecsim.lab.simulation.detector import Footage, detect
from trecsim.lab.simulation.detector_errors import PERFECT, Detector
from trecsim.lab.simulation.occlusion import Obstacle
from trecsim.lab.simulation.paths import through
from trecsim.lab.simulation.room import corner_rig
from trecsim.lab.simulation.walkers import poses, walker

CAMERA = corner_rig(10.0, 10.0, 2.5)["cam1"]
JOINTS = {"shoulder": 5, "elbow": 7, "wrist": 9, "hip": 11, "knee": 13, "ankle": 15}


def footage(people: int = 1, seconds: float = 60.0, fps: float = 25.0) -> Footage:
    """Return people who stand side by side in the middle of the image, their backs to it."""
    t_s = np.arange(int(seconds * fps)) / fps
    motions = []
    for number in range(people):
        aside_m = 1.2 * (number - (people - 1) / 2)
        place = np.array([-0.5 + aside_m, -0.5 - aside_m])
        path = through(np.array([-1.0, seconds + 1]), np.array([place, place]))
        motions.append(walker(body(1.75), path))
    stature_m = np.full(people, 1.75)
    return Footage(CAMERA, t_s, t_s, poses(motions, t_s), stature_m)


def stacked(found, people: int) -> tuple[np.ndarray, np.ndarray]:
    """Return key points and scores of images in which the same number of people was found."""
    kept = [one for one in found if len(one.xy_px) == people]
    return np.stack([one.xy_px for one in kept]), np.stack([one.score for one in kept])


def errors(detector: Detector, seeds: int = 30) -> tuple[np.ndarray, np.ndarray, float]:
    """Return errors (run, time, joint, 2), scores, and the height of the person [px]."""
    taken = footage(seconds=8.0)
    truth_px = CAMERA.project(taken.xyz_m[0])
    distance_m = np.linalg.norm(taken.xyz_m[0, 0, 11:13].mean(axis=0) - CAMERA.position_m)
    made = [
        stacked(detect(taken, detector, np.random.default_rng(seed)), 1) for seed in range(seeds)
    ]
    error_px = np.stack([xy_px[:, 0] - truth_px for xy_px, _ in made])
    score = np.stack([one[:, 0] for _, one in made])
    return error_px, score, CAMERA.K[1, 1] * 1.75 / distance_m


def test_a_perfect_detector_gives_the_projection() -> None:
    taken = footage(people=3, seconds=2.0)
    truth_px = CAMERA.project(taken.xyz_m)
    inside = ((truth_px > 0) & (truth_px < CAMERA.size_px)).all(axis=-1)
    for i, one in enumerate(detect(taken, PERFECT, np.random.default_rng(0))):
        assert one.t_s == taken.stamp_s[i]
        order = np.argsort(one.xy_px[:, 11, 0])
        wanted = truth_px[np.argsort(truth_px[:, i, 11, 0]), i]
        seen = inside[np.argsort(truth_px[:, i, 11, 0]), i]
        np.testing.assert_allclose(one.xy_px[order][seen], wanted[seen], atol=1e-9)
        assert np.isnan(one.xy_px[order][~seen]).all()


def test_usual_errors_have_the_stated_size_per_joint() -> None:
    clean = replace(PERFECT, sigma=Detector().sigma)
    error_px, _, height_px = errors(clean, seeds=60)
    of_sigma = error_px / height_px / np.array(Detector().sigma)[:, None]
    assert np.sqrt(np.mean(of_sigma**2)) == pytest.approx(1.0, rel=0.1)
    usual = np.median(np.abs(of_sigma))
    for name, joint in JOINTS.items():
        both = np.median(np.abs(of_sigma[:, :, joint : joint + 2]))
        assert both == pytest.approx(usual, rel=0.15), name


def test_errors_last_as_those_of_a_real_detector_do() -> None:
    error_px, _, _ = errors(replace(PERFECT, sigma=(0.01,) * 17), seeds=120)
    limbs = error_px[:, :, 5:]

    def correlation(frames: int) -> float:
        return float(np.mean(limbs[:, frames:] * limbs[:, :-frames]) / np.mean(limbs**2))

    # Without memory 5 %, 30 % over 0.17 s, 65 % over 7 s, at 25 images a second.
    for frames in (1, 5, 25):
        t_s = frames / 25
        wanted = 0.30 * np.exp(-t_s / 0.17) + 0.65 * np.exp(-t_s / 7.0)
        assert correlation(frames) == pytest.approx(wanted, abs=0.08)


def test_the_score_tells_the_error() -> None:
    whole = replace(Detector(), missing_joint=(0.0,) * 17, missing_person=0.0, false_people=0.0)
    error_px, score, _ = errors(whole)
    error_px = np.linalg.norm(error_px, axis=-1)[..., 5:]
    score = score[..., 5:]
    high, middle, low = (
        np.nanmedian(error_px[(score > least) & (score <= most)])
        for least, most in ((0.8, 1.0), (0.6, 0.8), (0.4, 0.6))
    )
    assert 1.3 < middle / high < 2.2
    assert 1.3 < low / middle < 2.5


def test_tails_are_heavy() -> None:
    whole = replace(Detector(), missing_joint=(0.0,) * 17, missing_person=0.0, false_people=0.0)
    error_px, _, height_px = errors(whole)
    share = np.linalg.norm(error_px, axis=-1)[..., 5:] / height_px
    middle, ninety, ninety_nine = np.nanquantile(share, [0.5, 0.9, 0.99])
    assert ninety / middle < 3.0 < 5.0 < ninety_nine / middle


def test_joints_and_people_are_missing_as_often_as_stated() -> None:
    taken = footage(people=3, seconds=300.0, fps=5.0)
    missing = replace(Detector(), false_people=0.0, missing_person=0.04)
    found = detect(taken, missing, np.random.default_rng(0))
    people = np.concatenate([one.xy_px for one in found])
    assert len(people) / (3 * len(found)) == pytest.approx(0.96, abs=0.015)
    missing = np.isnan(people[:, 5:, 0]).mean(axis=0).reshape(6, 2).mean(axis=1)
    stated = np.array(Detector().missing_joint[5:]).reshape(6, 2)[:, 0]
    np.testing.assert_allclose(missing, stated, atol=0.025)


def test_who_stands_behind_a_wall_is_not_found_but_by_the_perfect_detector() -> None:
    taken = footage(seconds=2.0)
    middle_m = (taken.xyz_m[0, 0, 11] + CAMERA.position_m) / 2
    half_m = np.array([0.8, 0.8, 2.0])
    wall = Obstacle(tuple(middle_m - half_m), tuple(middle_m + half_m))
    behind = replace(taken, obstacles=(wall,))
    unfailing = replace(Detector(), false_people=0.0)
    assert not any(len(one.xy_px) for one in detect(behind, unfailing, np.random.default_rng(0)))
    assert all(len(one.xy_px) for one in detect(behind, PERFECT, np.random.default_rng(0)))


def test_the_smaller_the_people_the_fewer_are_found_and_the_less_sure() -> None:
    taken = footage(people=1, seconds=400.0, fps=2.0)
    unmissing = replace(Detector(), missing_person=0.0, false_people=0.0)
    shares, scores = [], []
    for height_px in (400.0, 60.0, 30.0, 15.0):
        focal_px = height_px / errors(PERFECT, seeds=1)[2]
        K = CAMERA.K * [[focal_px, 1.0, 1.0], [1.0, focal_px, 1.0], [1.0, 1.0, 1.0]]
        small = replace(taken, camera=replace(CAMERA, K=K))
        found = detect(small, unmissing, np.random.default_rng(0))
        seen = [one for one in found if len(one.xy_px)]
        shares.append(len(seen) / len(found))
        scores.append(np.mean([one.person_score[0] for one in seen]) if seen else 0.0)
    np.testing.assert_allclose(shares, [1.0, 0.95, 0.5, 0.05], atol=0.1)
    assert scores[0] > scores[1] + 0.1 > scores[2] + 0.2


@pytest.mark.parametrize(
    ("changes", "named"),
    [
        ({"swapped": 1.2}, "swapped"),
        ({"doubt": (0.1,) * 16}, "doubt"),
        ({"sigma": (np.nan,) * 17}, "sigma"),
        ({"fast_s": 0.0}, "fast_s"),
        ({"common_up_m": (np.nan,) * 17}, "common_up_m"),
        ({"common_person": (1.1,) * 17}, "common_person"),
        ({"common_s": 0.0}, "common_s"),
    ],
)
def test_impossible_detectors_are_refused(changes: dict, named: str) -> None:
    with pytest.raises(ValidationError, match=named):
        Detector(**changes)


def test_left_and_right_are_exchanged_now_and_then() -> None:
    taken = footage(people=1, seconds=400.0, fps=5.0)
    swapping = replace(PERFECT, swapped=0.05)
    xy_px, _ = stacked(detect(taken, swapping, np.random.default_rng(0)), 1)
    swapped = xy_px[:, 0, 11, 0] > xy_px[:, 0, 12, 0]  # seen from behind, left is left
    assert swapped.mean() == pytest.approx(0.05, abs=0.03)


def test_a_false_person_stands_where_nobody_is_and_has_low_scores() -> None:
    t_s = np.arange(2000) / 5.0
    empty = Footage(CAMERA, t_s, t_s, np.empty((0, len(t_s), 17, 3)), np.empty(0))
    found = detect(empty, replace(Detector(), false_people=0.05), np.random.default_rng(0))
    assert 0.02 < np.mean([len(one.xy_px) for one in found]) < 0.1
    scores = np.concatenate([one.score[one.score > 0] for one in found])
    assert np.median(scores) < 0.6
    middles = np.array([np.nanmean(one.xy_px[0], axis=0) for one in found if len(one.xy_px)])
    assert np.ptp(middles, axis=0).max() < 200.0  # it is a thing in the room


def test_missing_is_nan_with_score_zero_and_the_order_is_random() -> None:
    found = detect(footage(people=3, seconds=20.0), Detector(), np.random.default_rng(0))
    for one in found:
        np.testing.assert_array_equal(np.isnan(one.xy_px[..., 0]), one.score == 0)
        assert ((one.score >= 0) & (one.score <= 1)).all()
        assert (one.person_score > 0).all()
        known = one.xy_px[np.isfinite(one.xy_px).all(axis=-1)]
        assert ((known >= -0.5) & (known <= np.array(CAMERA.size_px) - 0.5)).all()
    firsts = [
        int(np.argmin(one.xy_px[:, 11, 0]))
        for one in found
        if len(one.xy_px) == 3 and np.isfinite(one.xy_px[:, 11, 0]).all()
    ]
    assert set(firsts) == {0, 1, 2}
