"""Laws of the floor forecast: what holds for any scene."""

import numpy as np
import pytest

from forecasting.made_walks import line, walks
from trecsim.errors import ConfigError
from trecsim.forecasting import AHEAD_S, Forecast, Forecaster, Moment
from trecsim.forecasting.forecasts import horizons


def run(moments: list[Moment], **how: float) -> list[list[Forecast]]:
    forecaster = Forecaster(**how)
    return [forecaster.step(*moment) for moment in moments]


def test_forecasts_turn_and_move_with_the_scene() -> None:
    moments = walks(1, 6, 30)
    angle = 0.7
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    shift = np.array([3.0, -8.0])
    moved = [(t, person, xy @ turn.T + shift) for t, person, xy in moments]
    for here, there in zip(run(moments)[-1], run(moved)[-1], strict=True):
        np.testing.assert_allclose(here.xy_m @ turn.T + shift, there.xy_m, atol=1e-7)
        np.testing.assert_allclose(turn @ here.cov_m2 @ turn.T, there.cov_m2, atol=1e-7)
        np.testing.assert_allclose(turn @ here.region_m2 @ turn.T, there.region_m2, atol=1e-7)


def test_nothing_after_the_moment_is_used() -> None:
    moments = walks(2, 4, 30)
    other = [(t, person, xy + (i >= 20) * 5.0) for i, (t, person, xy) in enumerate(moments)]
    for a, b in zip(run(moments)[:20], run(other)[:20], strict=True):
        for one, same in zip(a, b, strict=True):
            np.testing.assert_array_equal(one.xy_m, same.xy_m)
            np.testing.assert_array_equal(one.region_m2, same.region_m2)


def test_the_order_of_the_people_does_not_matter() -> None:
    moments = walks(3, 5, 20)
    swapped = [(t, person[::-1], xy[::-1]) for t, person, xy in moments]
    for one, same in zip(run(moments)[-1], run(swapped)[-1][::-1], strict=True):
        assert one.person == same.person
        np.testing.assert_allclose(one.xy_m, same.xy_m, atol=1e-9)


def test_who_stands_is_expected_to_stand() -> None:
    made = run(list(line(0.0, 12)))[-1][0]
    np.testing.assert_allclose(made.xy_m[0], np.repeat([[0.0, 1.0]], 12, axis=0), atol=1e-6)
    middle = np.sqrt(np.linalg.det(made.region_m2[0, -1]))
    assert middle < 0.05  # half of those who stand have not left in 4.8 s


@pytest.mark.parametrize("seed", [4, 5])
def test_weights_and_covariances_are_those_of_a_distribution(seed: int) -> None:
    for one in run(walks(seed, 4, 40))[-1]:
        assert one.weight.sum() == pytest.approx(1.0, abs=0.005)
        assert one.weight.min() >= 0.0
        for matrices in (one.cov_m2, one.region_m2, one.path_m2[None]):
            assert np.linalg.eigvalsh(matrices).min() > 0.0
            grown = np.linalg.eigvalsh(np.diff(matrices, axis=1))
            assert grown.min() >= -1e-9


def test_regions_of_higher_levels_hold_those_of_lower_ones() -> None:
    for one in run(walks(6, 4, 40))[-1]:
        assert np.linalg.eigvalsh(np.diff(one.region_m2, axis=0)).min() >= -1e-9


def test_companions_keep_together() -> None:
    """Two who walk side by side, one of them turning away a little, are drawn to each other."""
    t_s = np.arange(8) * 0.4
    straight = np.stack([1.2 * t_s, 0 * t_s], axis=1)
    turning = np.stack([1.2 * t_s, 0.7 + 0.04 * t_s**2], axis=1)
    alone = [(float(t), np.array([2]), turning[[i]]) for i, t in enumerate(t_s)]
    pair = [
        (float(t), np.array([1, 2]), np.stack([straight[i], turning[i]])) for i, t in enumerate(t_s)
    ]
    away_alone = run(alone)[-1][0].xy_m[0, -1, 1]
    away_paired = run(pair)[-1][1].xy_m[0, -1, 1]
    assert away_paired < away_alone - 0.1


def test_other_horizons_give_the_same_path() -> None:
    moments = walks(7, 3, 15)
    usual = run(moments)[-1][0]
    fine = run(moments, ahead_s=horizons(4.8, 0.1))[-1][0]
    np.testing.assert_allclose(fine.xy_m[0][3::4], usual.xy_m[0], atol=1e-9)
    np.testing.assert_allclose(fine.region_m2[:, 3::4], usual.region_m2, rtol=1e-6)


def test_a_faster_stream_gives_the_same_forecast() -> None:
    slow = run(list(line(1.3, 9)))[-1][0]
    fast = run(list(line(1.3, 65, step_s=0.05)))[-1][0]
    np.testing.assert_allclose(slow.xy_m[0], fast.xy_m[0], atol=0.02)


def test_forecasts_come_at_the_asked_rate() -> None:
    made = run(list(line(1.0, 101, step_s=0.05)), every_s=0.2)
    assert sum(bool(one) for one in made) == 26


def test_nobody_gives_no_forecast() -> None:
    assert Forecaster().step(0.0, np.empty(0, np.int64), np.empty((0, 2))) == []


def test_people_whose_floor_point_is_unknown_get_none() -> None:
    made = Forecaster().step(0.0, np.array([1, 2]), np.array([[np.nan, np.nan], [1.0, 2.0]]))
    assert [one.person for one in made] == [2]


@pytest.mark.parametrize(("ahead_s", "step_s"), [(0.2, 0.4), (4.8, 0.0), (60.0, 0.4)])
def test_horizons_that_cannot_be_are_refused(ahead_s: float, step_s: float) -> None:
    with pytest.raises(ConfigError, match="horizons: expected 0 < step"):
        horizons(ahead_s, step_s)


def test_the_usual_horizons_are_those_of_the_protocol() -> None:
    np.testing.assert_allclose(AHEAD_S, np.arange(1, 13) * 0.4)


def test_moments_of_a_crowd_are_those_of_each_person() -> None:
    forecaster, moments = Forecaster(), walks(9, 5, 12)
    for moment in moments[:-1]:
        forecaster.step(*moment)
    made = forecaster.together(*moments[-1])
    assert made is not None
    mean_m, upper_m2 = made.moments()
    for one, mean, upper in zip(made.each(), mean_m, upper_m2, strict=True):
        np.testing.assert_allclose(mean, one.mean_m, atol=1e-12)
        np.testing.assert_allclose(upper, one.total_cov_m2[:, [0, 0, 1], [0, 1, 1]], atol=1e-12)
