"""Whether stated uncertainties are judged rightly."""

import numpy as np
import pytest
from scipy.stats import chi

from trecsim.lab.evaluation.uncertainty_calibration import (
    calibration_by_support,
    radius_of,
    uncertainty_calibration,
)


@pytest.mark.parametrize("share", [0.01, 0.5, 0.9, 0.95, 0.999])
def test_the_radius_is_that_of_the_chi_distribution(share: float) -> None:
    assert radius_of(share) == pytest.approx(chi(3).ppf(share), rel=1e-9)


def test_a_gaussian_with_its_own_sigma_is_calibrated() -> None:
    rng = np.random.default_rng(0)
    sigma_m = rng.uniform(0.01, 0.1, (20_000, 17))
    error_m = np.linalg.norm(rng.normal(size=(20_000, 17, 3)) * sigma_m[..., None], axis=-1)
    result = uncertainty_calibration(error_m, sigma_m)
    assert result.joints == sigma_m.size
    within = (result.within_50, result.within_90, result.within_95)
    assert within == pytest.approx((0.5, 0.9, 0.95), abs=0.005)
    assert result.normalised_rms == pytest.approx(1.0, abs=0.005)
    too_sure = uncertainty_calibration(error_m, sigma_m / 2)
    assert too_sure.normalised_rms == pytest.approx(2.0, abs=0.01)
    assert too_sure.within_90 < 0.6


def test_four_joints_counted_by_hand() -> None:
    error_m = np.array([[0.0, 0.015, 0.024, 0.03]])  # over sigma: 0, 1.5, 2.4, 3
    result = uncertainty_calibration(error_m, np.full((1, 4), 0.01))
    assert (result.within_50, result.within_90, result.within_95) == (0.5, 0.75, 0.75)
    assert result.normalised_rms == pytest.approx(np.sqrt((1.5**2 + 2.4**2 + 3**2) / 4 / 3))


def test_joints_that_state_nothing_do_not_count() -> None:
    error_m = np.array([[0.01, 0.01, np.nan, 0.01]])
    sigma_m = np.array([[0.0, np.nan, 0.01, 0.01]])
    assert uncertainty_calibration(error_m, sigma_m).joints == 1
    nothing = uncertainty_calibration(error_m[:, :3], sigma_m[:, :3])
    assert nothing.joints == 0
    assert np.isnan([nothing.within_50, nothing.within_95, nothing.normalised_rms]).all()


def test_joints_are_told_apart_by_their_cameras() -> None:
    error_m = np.array([[0.03, 0.02, 0.01, 0.01]])
    support = np.array([[0, 1, 2, 5]], np.int16)
    result = calibration_by_support(error_m, np.full((1, 4), 0.01), support)
    assert {name: one.joints for name, one in result.items()} == {"0": 1, "1": 1, "2+": 2}
    assert result["0"].normalised_rms == pytest.approx(3 / np.sqrt(3))
    assert result["1"].within_50 == 0.0
    assert result["2+"].within_50 == 1.0
