"""Regions learn, from what happens, how wide they must be."""

import numpy as np
import pytest

from forecasting.made_walks import STEP_S, line, walks
from trecsim.forecasting import Forecaster
from trecsim.forecasting.path_scores import evaluated
from trecsim.forecasting.trails import Trails


@pytest.mark.parametrize("turning", [0.02, 0.3])
def test_coverage_reaches_its_level_whatever_people_do(turning: float) -> None:
    """Calm and restless walkers, both unlike the table, for 12 minutes."""
    rng = np.random.default_rng(8)
    velocity, at_m = rng.normal(0, 1.0, (6, 2)), rng.uniform(0, 30, (6, 2))
    moments = []
    for i in range(1800):
        velocity = 0.98 * velocity + rng.normal(0, turning, velocity.shape)
        at_m = at_m + STEP_S * velocity
        moments.append((i * STEP_S, np.arange(6), at_m.copy()))
    scores = evaluated(moments)
    late = scores.inside[len(scores.inside) // 3 :].mean(axis=(0, 2))
    np.testing.assert_allclose(late, [0.5, 0.8, 0.9, 0.95], atol=0.03)
    assert scores.whole[len(scores.whole) // 3 :].mean() == pytest.approx(0.9, abs=0.04)


def test_where_all_stood_still_somebody_may_still_walk_off() -> None:
    """The regions shrink to nothing, but what is wider than they are stays possible."""
    forecaster = Forecaster()
    for moment in line(0.0, 400):
        (made,) = forecaster.step(*moment)
    assert np.sqrt(made.region_m2[1, -1, 0, 0]) < 0.02
    assert 0.3 < np.sqrt(made.total_cov_m2[-1, 0, 0]) < 1.5


def test_positions_between_samples_are_interpolated() -> None:
    trails = Trails()
    for t_s in (0.0, 0.4, 0.8):
        trails.add(t_s, np.array([3]), np.array([[t_s, 2 * t_s]]))
    found = trails.at(np.array([3]), np.array([-0.1, 0.0, 0.2, 0.8, 0.9]))
    np.testing.assert_allclose(
        found[0], [[np.nan] * 2, [0, 0], [0.2, 0.4], [0.8, 1.6], [np.nan] * 2]
    )


def test_a_long_gap_is_not_filled() -> None:
    trails = Trails()
    for t_s in (0.0, 3.0):
        trails.add(t_s, np.array([3]), np.array([[t_s, 0.0]]))
    assert trails.pasts(3.0, np.array([3])).count.tolist() == [1]


def test_the_memory_of_a_fast_camera_lasts_as_long() -> None:
    trails = Trails()
    for i in range(1200):
        trails.add(i / 120, np.array([3]), np.array([[i / 120, 0.0]]))
    then_s = 1199 / 120 - 5.0
    np.testing.assert_allclose(trails.at(np.array([3]), np.array([then_s]))[0, 0, 0], then_s)


def test_who_left_is_forgotten_and_the_place_used_again() -> None:
    trails = Trails()
    for person in range(200):
        trails.add(20.0 * person, np.array([person]), np.zeros((1, 2)))
    assert len(trails._times_s) == 8
    assert np.isnan(trails.at(np.array([150]), np.array([3000.0]))).all()


def test_walks_differ() -> None:
    first, second = walks(1, 2, 3), walks(2, 2, 3)
    assert not np.array_equal(first[-1][2], second[-1][2])
