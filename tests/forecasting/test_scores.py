"""Scores of forecasts, against figures by hand and against the published ones."""

from pathlib import Path

import numpy as np
import pytest

from forecasting.made_walks import line, walks
from trecsim.forecasting.path_scores import PATHS, evaluated, representatives
from trecsim.store.floor_paths import read_floor_paths


def test_a_straight_walk_has_no_error_at_constant_velocity() -> None:
    scores = evaluated(list(line(1.0, 25)))
    assert len(scores.error_m) == 25 - 19
    assert scores.constant_m.max() < 1e-9
    assert scores.summary()["constant_velocity"] == {
        "ade_m": pytest.approx(0.0, abs=1e-9),
        "fde_m": pytest.approx(0.0, abs=1e-9),
    }


def test_constant_velocity_repeats_the_last_displacement() -> None:
    """Somebody who stops at once after 8 samples: the error grows by 0.4 m with each step."""
    moments = list(line(1.0, 8))
    moments += [(i * 0.4, np.array([7]), np.array([[2.8, 1.0]])) for i in range(8, 20)]
    scores = evaluated(moments)
    np.testing.assert_allclose(scores.constant_m[0], 0.4 * np.arange(1, 13))


def test_twenty_paths_begin_with_the_guess() -> None:
    centre = np.zeros((1, 12, 2))
    found = representatives(centre, np.broadcast_to(np.eye(2), (1, 12, 2, 2)))
    assert found.shape == (1, PATHS, 12, 2)
    np.testing.assert_array_equal(found[0, 0], 0.0)


def test_the_best_of_twenty_is_never_worse_than_the_guess() -> None:
    scores = evaluated(walks(1, 5, 40))
    assert (scores.best_m.mean(axis=1) <= scores.error_m.mean(axis=1) + 1e-12).all()
    assert (scores.best_last_m <= scores.error_m[:, -1] + 1e-12).all()


def test_the_likelihood_is_a_density() -> None:
    """Its integral over the floor is 1, from the forecast's own modes."""
    from trecsim.forecasting import Forecaster
    from trecsim.forecasting.path_scores import _nll

    forecaster = Forecaster()
    for moment in walks(2, 1, 12):
        (made,) = forecaster.step(*moment)
    side = np.linspace(-12, 12, 241)
    total = 0.0
    for x in side:
        truth = made.xy_m[0][-1] + np.stack([np.full(241, x), side], axis=1)
        whole = np.repeat(truth[:, None], 12, axis=1)
        total += np.exp(-_nll([made] * 241, whole)[:, -1]).sum() * 0.01
    assert total == pytest.approx(1.0, abs=0.02)


def test_no_samples_have_no_scores() -> None:
    assert len(evaluated(list(line(1.0, 5))).error_m) == 0


def test_hotel_is_forecast_better_than_at_constant_velocity(shared_data: Path) -> None:
    scores = evaluated(read_floor_paths(shared_data / "ethucy" / "biwi_hotel.txt")).summary()
    assert scores["samples"] == 1197
    assert scores["constant_velocity"]["ade_m"] == pytest.approx(0.319, abs=5e-4)
    assert scores["constant_velocity"]["fde_m"] == pytest.approx(0.614, abs=5e-4)
    assert scores["ade_m"] < 0.26
    assert scores["fde_m"] < 0.49
    assert scores["best_of_20"]["ade_m"] < 0.14
    for level, share in scores["coverage"].items():
        assert share == pytest.approx(float(level), abs=0.03)
