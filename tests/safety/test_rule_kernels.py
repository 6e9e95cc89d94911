"""The rules' compiled kernels against their slow twins, on places and people drawn at random."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.special import owens_t

import reference_rules as reference
from trecsim.safety.ahead import Ahead
from trecsim.safety.directed_lines import Edge
from trecsim.safety.kernels import behind_line, joints_at_edge
from trecsim.safety.polygons import Polygon, Prism

SQUARE = Polygon(np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [0.0, 2.0]]))
BAY = Polygon(np.array([[0.0, 0], [4, 0], [4, 3], [2.5, 3], [2.5, 1], [1.5, 1], [1.5, 3], [0, 3]]))
EDGE = Edge(np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [6.0, 4.0]]))
SEEDS = st.integers(0, 2**32 - 1)
ZONES = st.sampled_from([SQUARE, BAY])
SPREADS_M = st.sampled_from([0.02, 0.3, 2.0])


def covariances(rng: np.random.Generator, shape: tuple[int, ...], n: int, m: float) -> np.ndarray:
    root = rng.normal(size=(*shape, n, n)) * m
    return np.asarray(root @ root.swapaxes(-1, -2) + 1e-6 * np.eye(n))


def walkers(rng: np.random.Generator, people: int = 6) -> Ahead:
    """Return people who walk past the zones, with two modes and some joints."""
    ahead_s = np.arange(13) * 0.4
    from_m, way_mps = rng.uniform(-3.0, 7.0, (people, 2)), rng.normal(0.0, 1.0, (people, 2, 2))
    xy_m = from_m[:, None, None] + way_mps[:, :, None] * ahead_s[:, None]
    grown = (0.02 + 0.2 * ahead_s)[:, None, None] ** 2
    cov_m2 = covariances(rng, (people, 2, 1), 2, 1.0) * grown
    joint_m = rng.normal(0.0, 0.3, (people, 5, 3)) + np.array([0.0, 0.0, 1.0])
    joint_m[rng.random((people, 5)) < 0.3] = np.nan
    share = rng.uniform(0.0, 1.0, people)
    weight = np.stack([share, 1.0 - share], axis=1)
    return Ahead(5.0, np.arange(people), ahead_s, weight, xy_m, cov_m2, joint_m)


def test_owens_function_equals_that_of_scipy() -> None:
    for h in np.linspace(0.0, 9.0, 19):
        for s in np.linspace(-20.0, 20.0, 33):
            with np.errstate(divide="ignore", invalid="ignore"):
                expected = np.nan_to_num(owens_t(h, s / h))
            assert behind_line(float(h), float(s)) == pytest.approx(expected, abs=1e-12)


@given(SEEDS, ZONES, SPREADS_M)
def test_a_polygon_holds_points_as_its_twin_says(seed: int, zone: Polygon, spread_m: float) -> None:
    rng = np.random.default_rng(seed)
    xy_m, cov_m2 = rng.uniform(-2.0, 6.0, (8, 2)), covariances(rng, (8,), 2, spread_m)
    expected = [reference.inside(zone.corners_m, *one) for one in zip(xy_m, cov_m2, strict=True)]
    # Sides that are 5.5 standard deviations away count as surely passed or not.
    np.testing.assert_allclose(zone.probability(xy_m, cov_m2), expected, atol=1e-7)
    distance_m, direction = zone.nearest(xy_m)
    for n, at_m in enumerate(xy_m):
        distance, towards = reference.to_border(zone.corners_m, at_m)
        assert distance_m[n] == pytest.approx(distance, abs=1e-12)
        np.testing.assert_allclose(direction[n], towards, atol=1e-9)


@given(SEEDS, ZONES, SPREADS_M)
def test_a_prism_holds_joints_as_its_twin_says(seed: int, zone: Polygon, spread_m: float) -> None:
    rng = np.random.default_rng(seed)
    xyz_m, cov_m2 = rng.uniform(-0.5, 4.5, (3, 4, 3)), covariances(rng, (3, 4), 3, spread_m)
    counts, rows = rng.random((2, 4)) < 0.7, np.array([2, 0])
    cov_m2[0, 0] = np.nan
    found = Prism(zone, (0.5, 2.0)).of_joints(rows, xyz_m, cov_m2, counts)
    for n, joint in np.ndindex(2, 4):
        at = rows[n], joint
        expected = 0.0
        if counts[n, joint]:
            expected = reference.inside_prism(zone.corners_m, (0.5, 2.0), xyz_m[at], cov_m2[at])
        # Where a point is open in one way only, place and height count as independent.
        assert found[n, joint] == pytest.approx(expected, abs=3e-6)


@given(SEEDS, SPREADS_M)
def test_joints_are_at_an_edge_as_the_twin_says(seed: int, spread_m: float) -> None:
    rng = np.random.default_rng(seed)
    xyz_m, cov_m2 = rng.uniform(-2.0, 7.0, (3, 4, 3)), covariances(rng, (3, 4), 3, spread_m)
    counts, rows = rng.random((2, 4)) < 0.7, np.array([2, 0])
    near, beyond, away_m = np.empty((3, 2, 4))
    joints_at_edge(EDGE.points_m, (0.5, 2.5), rows, xyz_m, cov_m2, counts, near, beyond, away_m)
    for n, joint in np.ndindex(2, 4):
        at = rows[n], joint
        expected = (0.0, 0.0, np.inf)
        if counts[n, joint]:
            expected = reference.at_edge(EDGE.points_m, 0.5, 2.5, xyz_m[at], cov_m2[at])
        found = near[n, joint], beyond[n, joint], away_m[n, joint]
        np.testing.assert_allclose(found, expected, atol=1e-9)


@given(SEEDS, ZONES, st.sampled_from([None, (0.8, 1.2), (3.0, 4.0)]))
def test_people_reach_a_zone_as_the_twin_says(
    seed: int, zone: Polygon, z_m: tuple[float, float] | None
) -> None:
    ahead = walkers(np.random.default_rng(seed), 3)
    found = ahead.in_polygon(zone, z_m, within_s=2.0).by
    asked = int(np.searchsorted(ahead.ahead_s, 2.0 + 1e-6)) - 1
    for n in range(len(ahead.person)):
        there = reference.reached_zone(
            [zone.parts] * len(ahead.ahead_s), z_m, ahead.xy_m[n], ahead.cov_m2[n], ahead.joint_m[n]
        )
        expected = ahead.weight[n] @ there
        # Nobody goes farther than four standard deviations; what is less is not looked at.
        until = len(expected) if expected[asked] > 0.02 else asked + 1
        np.testing.assert_allclose(found[n, :until], expected[:until], atol=0.01)


@given(SEEDS)
def test_a_polygon_is_the_sum_of_its_parts(seed: int) -> None:
    rng = np.random.default_rng(seed)
    angles = (np.arange(7) + rng.uniform(0.0, 0.9, 7)) / 7 * 2.0 * np.pi
    star = rng.uniform(0.5, 2.0, 7)[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    polygon = Polygon(star)
    parts = [Polygon(one) for one in polygon.parts]
    assert all(one.is_convex for one in parts)
    at_m = rng.uniform(-2.0, 2.0, (200, 2))
    held = np.array([one.distance_m(at_m) > 0.0 for one in parts]).sum(axis=0)
    np.testing.assert_array_equal(held == 1, polygon.distance_m(at_m) > 0.0)
    assert held.max() <= 1


@given(SEEDS)
def test_people_reach_an_edge_as_the_twin_says(seed: int) -> None:
    ahead = walkers(np.random.default_rng(seed))
    found = ahead.beyond(EDGE, 2.0).by
    for n in np.flatnonzero(ahead._may_reach(EDGE.points_m)):
        there = reference.reached_edge(
            EDGE.points_m, 2.0, ahead.xy_m[n], ahead.cov_m2[n], ahead.joint_m[n]
        )
        np.testing.assert_allclose(found[n], ahead.weight[n] @ there, atol=1e-9)


@given(SEEDS)
def test_a_zone_that_stands_still_is_reached_as_one_that_moves_nowhere(seed: int) -> None:
    ahead = walkers(np.random.default_rng(seed))
    still = ahead.in_polygon(SQUARE, (0.8, 1.2)).by
    moving = ahead.in_moving([[SQUARE]] * len(ahead.ahead_s), (0.8, 1.2)).by
    np.testing.assert_allclose(moving, still, atol=1e-3)  # four standard deviations
