"""Coverage, sharpness and labels in 2D, as the benchmarks of real video count them."""

import numpy as np
import pytest

from harness import regions
from harness.actors_2d import followed_in_2d
from trecsim.values import Poses2D


def _errors(scale: float) -> regions.Errors:
    """Return errors on a sphere of radius 2 standard deviations, stated `scale` times as large."""
    axes = np.concatenate([np.eye(3), -np.eye(3)])
    return regions.Errors(2.0 * axes, np.tile(scale**2 * np.eye(3), (6, 1, 1)))


def test_errors_of_two_sigma_are_inside_the_90_but_not_the_50_percent_region() -> None:
    assert regions.inside(_errors(1.0), 0.90) == 100.0
    assert regions.inside(_errors(1.0), 0.50) == 0.0
    assert regions.inside(_errors(2.0), 0.50) == 100.0


def test_the_likelihood_is_best_for_the_true_sigma() -> None:
    off = np.random.default_rng(0).normal(size=(4000, 3))
    by_scale = {
        scale: regions.likelihood(regions.Errors(off, np.tile(scale**2 * np.eye(3), (4000, 1, 1))))
        for scale in (0.5, 1.0, 2.0)
    }
    assert min(by_scale, key=by_scale.__getitem__) == 1.0
    assert by_scale[1.0] == pytest.approx(0.5 * np.log(2 * np.pi) + 0.5, abs=0.02)


def test_the_widest_reach_of_a_region_is_that_of_its_longest_axis() -> None:
    cov = np.diag([1.0, 4.0, 9.0])[None]
    assert regions.widest(cov)[0] == pytest.approx(3.0 * np.sqrt(6.2514), rel=1e-4)


def _image(frame: int, *middles_px: float) -> Poses2D:
    body = np.stack([np.linspace(0.0, 40.0, 17), np.linspace(0.0, 200.0, 17)], axis=1)
    xy_px = np.stack([body + np.array([x, 0.0]) for x in middles_px])
    return Poses2D("cam", frame / 60, xy_px, np.ones(xy_px.shape[:2]), np.ones(len(middles_px)))


def test_labels_follow_their_people_whichever_comes_first_in_an_image() -> None:
    images = [_image(0, 100.0, 400.0), _image(1, 390.0, 110.0), _image(2, 120.0, 380.0)]
    labels = followed_in_2d(images, {"left": (120.0, 100.0), "right": (420.0, 100.0)})
    assert labels["left"][:, 0, 0].tolist() == [100.0, 110.0, 120.0]
    assert labels["right"][:, 0, 0].tolist() == [400.0, 390.0, 380.0]


def test_who_is_not_in_an_image_has_no_label_there() -> None:
    images = [_image(0, 100.0, 400.0), _image(1, 105.0), _image(2, 110.0, 400.0)]
    labels = followed_in_2d(images, {"left": (120.0, 100.0), "right": (420.0, 100.0)})
    assert np.isnan(labels["right"][1]).all()
    assert labels["right"][2, 0, 0] == 400.0
