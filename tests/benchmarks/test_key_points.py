"""Errors of key points, on hand-made sights of which the figures are known."""

import numpy as np
import pytest

from detector.key_points import MIRROR, Sights, figures, sights_of, together
from trecsim.values import Poses2D

# A person 100 pixels tall: pairs of shoulders, elbows, wrists, hips, knees and ankles.
PERSON_PX = np.array(
    [[x, y] for y in (100.0, 120.0, 140.0, 150.0, 175.0, 200.0) for x in (260.0, 240.0)]
)


def poses(*limbs_px: np.ndarray, score: float = 0.9) -> Poses2D:
    xy_px = np.full((len(limbs_px), 17, 2), np.nan)
    xy_px[:, 5:] = np.array(limbs_px).reshape(-1, 12, 2)
    known = np.isfinite(xy_px[..., 0])
    return Poses2D("c", 0.0, xy_px, known * score, np.full(len(limbs_px), score))


def seen(*found_px: np.ndarray, frame: int = 0, score: float = 0.9) -> Sights:
    return sights_of(0, frame, (640, 480), PERSON_PX[None], poses(*found_px, score=score))


def test_a_shift_is_every_error_and_lasts() -> None:
    shift = np.array([3.0, 4.0])
    sights = together([seen(PERSON_PX + shift, frame=frame) for frame in range(30)])
    found = figures(sights, sights)
    assert found["person found"] == 1.0
    assert found["hip missing"] == 0.0
    assert found["knee error p50 px"] == found["wrist error p99 px"] == pytest.approx(5.0)
    assert found["error p90 of height"] == pytest.approx(0.05)
    assert found["error p50 px, score 0.8 to 1.0"] == pytest.approx(5.0)
    assert found["correlation over 25"] == pytest.approx(1.0)
    assert found["white part px"] == found["left and right swapped"] == 0.0


def test_new_errors_in_every_image_are_white() -> None:
    rng = np.random.default_rng(0)
    noisy = [
        seen(PERSON_PX + 2.0 * rng.standard_normal((12, 2)), frame=frame) for frame in range(300)
    ]
    found = figures(together(noisy), together(noisy))
    assert found["white part px"] == pytest.approx(2.0, rel=0.05)
    assert abs(found["correlation over 1"]) < 0.05
    assert found["elbow error p50 px"] == pytest.approx(2.0 * 1.177, rel=0.1)


def test_missing_joints_and_people_count_only_inside_the_image() -> None:
    without = PERSON_PX.copy()
    without[2] = np.nan  # the left elbow
    cut = sights_of(0, 2, (640, 151), PERSON_PX[None], poses(PERSON_PX))  # legs are outside
    assert cut.inside.sum() == 8
    assert np.isnan(cut.error_px[0, 8:]).all()
    all_ = together([seen(without, frame=0), seen(frame=1), cut])
    found = figures(all_, all_)
    assert found["person found"] == 0.5  # too little of the third is in the image
    assert found["elbow missing"] == 0.25
    assert found["shoulder missing"] == 0.0
    assert found["knee missing"] == 0.0


def test_who_is_exchanged_left_to_right_is_noticed() -> None:
    exchanged = seen(PERSON_PX[MIRROR])
    assert figures(exchanged, exchanged)["left and right swapped"] == 1.0
    shifted = seen(PERSON_PX + 2.0)
    assert figures(shifted, shifted)["left and right swapped"] == 0.0


def test_what_nothing_tells_is_nan() -> None:
    once = seen(PERSON_PX + 2.0)
    found = figures(once, once)
    assert np.isnan(found["error p50 px, score 0.4 to 0.6"])
    assert np.isnan(found["correlation over 1"])
    assert np.isnan(found["white part px"])
    nobody = seen()
    assert figures(nobody, nobody)["person found"] == 0.0
    assert np.isnan(figures(nobody, nobody)["hip error p50 px"])


def test_everybody_gets_the_nearest_key_points_once() -> None:
    right = np.array([1.0, 0.0])
    two_px = np.stack((PERSON_PX, PERSON_PX + 30 * right))
    near = poses(PERSON_PX + 29 * right, PERSON_PX + 2 * right, PERSON_PX + 300 * right)
    sights = sights_of(0, 0, (640, 480), two_px, near)
    np.testing.assert_allclose(sights.error_px[:, :, 0].mean(axis=1), [2.0, -1.0])


def test_nothing_found_is_nobody_found() -> None:
    sights = sights_of(0, 0, (640, 480), PERSON_PX[None], poses())
    assert np.isnan(sights.found_px).all()
    assert not sights.score.any()
