"""Curves drawn with few points."""

import numpy as np
import pytest

from trecsim.lab.report.curves import curve


def test_a_short_curve_is_drawn_as_it_is() -> None:
    t, value = np.arange(5.0), np.array([1.0, 5.0, 2.0, 4.0, 3.0])
    drawn = curve(t, value)
    np.testing.assert_array_equal(drawn.t, t)
    np.testing.assert_array_equal(drawn.middle, value)
    np.testing.assert_array_equal(drawn.low, drawn.high)


def test_a_long_curve_has_medians_and_a_band_of_90_percent() -> None:
    value = np.tile(np.arange(100.0), 100)
    drawn = curve(np.arange(10_000.0), value, most=10)
    assert len(drawn.t) == 10
    np.testing.assert_allclose(drawn.middle, 49.5, atol=0.6)
    np.testing.assert_allclose(drawn.low, 5, atol=0.6)
    np.testing.assert_allclose(drawn.high, 94, atol=0.6)


def test_unknown_values_are_left_out_and_a_long_pause_breaks_the_line() -> None:
    t = np.arange(100.0)
    value = np.where((t > 40) & (t < 70), np.nan, 1.0)
    drawn = curve(t, value)
    assert np.isnan(drawn.t).sum() == 1
    assert not np.isfinite(drawn.middle[np.isnan(drawn.t)]).any()
    assert len(drawn.t) == 71 + 1


def test_values_of_one_time_make_one_point() -> None:
    drawn = curve(np.repeat([0.0, 1.0, 2.0], 4), np.tile([1.0, 2.0, 3.0, 4.0], 3), together=True)
    assert len(drawn.t) == 3
    np.testing.assert_allclose(drawn.middle, 2.5)


@pytest.mark.parametrize("together", [True, False])
def test_a_curve_of_nothing_is_empty(together: bool) -> None:
    assert len(curve(np.empty(0), np.empty(0), together=together).t) == 0
    assert len(curve(np.arange(3.0), np.full(3, np.nan), together=together).t) == 0
