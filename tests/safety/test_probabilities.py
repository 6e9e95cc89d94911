"""Probabilities of places against slow twins: sums over a grid, samples, and SciPy."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trecsim.safety.gaussian import below, normal_cdf
from trecsim.safety.polygons import Polygon, Prism

SQUARE = Polygon(np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [0.0, 2.0]]))
BAY = Polygon(np.array([[0.0, 0], [4, 0], [4, 3], [2.5, 3], [2.5, 1], [1.5, 1], [1.5, 3], [0, 3]]))


def on_a_grid(polygon: Polygon, xy_m: np.ndarray, cov_m2: np.ndarray, side: int = 200) -> float:
    """Sum the density over the points of a grid that are inside, far too slowly."""
    root = np.linalg.cholesky(cov_m2)
    steps = (np.arange(side) + 0.5) / side * 12.0 - 6.0
    askew = np.array([[math.cos(1.0), -math.sin(1.0)], [math.sin(1.0), math.cos(1.0)]])
    white = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2) @ askew
    weight = np.exp(-0.5 * np.square(white).sum(axis=1))
    inside = polygon.distance_m(xy_m + white @ root.T) > 0.0
    return float(weight @ inside / weight.sum())


def random_cov(rng: np.random.Generator, size: int, scale_m: float) -> np.ndarray:
    root = rng.normal(size=(size, size)) * scale_m
    return root @ root.T + 1e-6 * np.eye(size)


def test_the_normal_distribution_is_known() -> None:
    np.testing.assert_allclose(
        normal_cdf(np.array([-1.0, 0.0, 2.0])), [0.15865525, 0.5, 0.97724987]
    )
    assert below(2.0, 0.0, 1.0) == pytest.approx(0.97724987)


@given(st.integers(0, 2**32 - 1), st.sampled_from([SQUARE, BAY]), st.sampled_from([0.02, 0.3, 2.0]))
def test_the_probability_of_a_zone_equals_the_sum_over_a_grid(
    seed: int, polygon: Polygon, scale_m: float
) -> None:
    rng = np.random.default_rng(seed)
    xy_m, cov_m2 = rng.uniform(-0.5, 4.5, 2), random_cov(rng, 2, scale_m)
    found = polygon.probability(xy_m[None], cov_m2[None])[0]
    assert found == pytest.approx(on_a_grid(polygon, xy_m, cov_m2), abs=2e-3)


def test_on_a_side_it_is_half_on_a_corner_a_quarter_and_a_narrow_zone_is_never_sure() -> None:
    cov_m2 = np.full((4, 2, 2), 0.01 * np.eye(2))
    places = np.array([[2.0, 0.0], [4.0, 2.0], [1.5, 1.0], [2.0, 1.0]])
    np.testing.assert_allclose(SQUARE.probability(places, cov_m2)[:2], [0.5, 0.25])
    assert BAY.probability(places, cov_m2)[2] == pytest.approx(0.75)  # a corner that points inwards
    strip = Polygon(np.array([[0.0, 0.95], [4.0, 0.95], [4.0, 1.05], [0.0, 1.05]]))
    sure = 2.0 * below(0.5, 0.0, 1.0) - 1.0
    assert strip.probability(places, cov_m2)[3] == pytest.approx(sure)


@given(st.integers(0, 2**32 - 1))
def test_two_halves_of_a_zone_are_as_probable_as_the_whole_and_moving_all_changes_nothing(
    seed: int,
) -> None:
    rng = np.random.default_rng(seed)
    xy_m, cov_m2 = rng.uniform(-0.5, 4.5, (1, 2)), random_cov(rng, 2, 0.5)[None]
    halves = [
        Polygon(np.array([[0.0, 0.0], [1.3, 0.0], [2.2, 2.0], [0.0, 2.0]])),
        Polygon(np.array([[1.3, 0.0], [4.0, 0.0], [4.0, 2.0], [2.2, 2.0]])),
    ]
    whole = SQUARE.probability(xy_m, cov_m2)
    np.testing.assert_allclose(
        sum(one.probability(xy_m, cov_m2) for one in halves), whole, atol=1e-9
    )
    angle = rng.uniform(0.0, 2 * np.pi)
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    moved = Polygon(SQUARE.corners_m @ turn.T + 7.0)
    again = moved.probability(xy_m @ turn.T + 7.0, turn @ cov_m2 @ turn.T)
    np.testing.assert_allclose(again, whole, atol=1e-8)


@given(st.integers(0, 2**32 - 1))
def test_the_probability_of_a_prism_equals_the_share_of_samples_inside(seed: int) -> None:
    rng = np.random.default_rng(seed)
    xyz_m, cov_m2 = rng.uniform([-0.2, -0.2, 0.8], [0.5, 0.5, 1.2]), random_cov(rng, 3, 0.15)
    samples_m = rng.multivariate_normal(xyz_m, cov_m2, 5_000)
    inside = (
        (SQUARE.distance_m(samples_m[:, :2]) > 0) & (samples_m[:, 2] > 0) & (samples_m[:, 2] < 1)
    )
    found = Prism(SQUARE, (0.0, 1.0)).probability(xyz_m[None], cov_m2[None])[0]
    assert found == pytest.approx(inside.mean(), abs=0.03)


def test_a_point_without_uncertainty_is_inside_or_not_and_an_unknown_one_is_unknown() -> None:
    xy_m = np.array([[0.001, 1.0], [-0.001, 1.0], [np.nan, 1.0]])
    cov_m2 = np.array([np.zeros((2, 2)), np.full((2, 2), np.nan), np.eye(2)])
    np.testing.assert_array_equal(SQUARE.probability(xy_m, cov_m2), [1.0, 0.0, np.nan])


def test_corners_may_go_either_way_round() -> None:
    xy_m, cov_m2 = np.array([[0.05, 1.0]]), np.full((1, 2, 2), 0.01 * np.eye(2))
    other = Polygon(SQUARE.corners_m[::-1])
    assert other.probability(xy_m, cov_m2) == pytest.approx(SQUARE.probability(xy_m, cov_m2))
    assert other.distance_m(xy_m)[0] == pytest.approx(0.05)
    np.testing.assert_allclose(other.normals(xy_m), [[1.0, 0.0]])


@given(st.integers(0, 2**32 - 1), st.integers(5, 60), st.floats(0.3, 60.0))
def test_the_points_by_which_a_zone_is_looked_for_are_few_and_in_it(
    seed: int, corners: int, wide_m: float
) -> None:
    rng = np.random.default_rng(seed)
    angle = (np.arange(corners) + rng.uniform(0.1, 0.9, corners)) * 2.0 * np.pi / corners
    star_m = np.stack([np.cos(angle), np.sin(angle)], 1) * rng.uniform(0.3, 1.0, (corners, 1))
    for polygon in (SQUARE, BAY, Polygon(wide_m * star_m)):
        assert 3 <= len(polygon.inner_m) <= 40
        assert (polygon.distance_m(polygon.inner_m) > 0.0).all()
