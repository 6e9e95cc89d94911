"""Settings are what the kernels take, or are refused, or remarked."""

import pytest

from trecsim.errors import ConfigError
from trecsim.fusion import FusionSettings


def test_defaults_are_sensible():
    assert list(FusionSettings().remarks()) == []


def test_values_outside_of_the_sensible_range_are_remarked():
    assert list(FusionSettings(accel_leg=1e6, death_s=2.5).remarks()) == [
        "accel_leg = 1e+06 is far outside the sensible range (0.8 to 5)",
        "death_s = 2.5 is outside the sensible range (0.3 to 2 s)",
    ]


def test_a_whole_number_of_seconds_becomes_what_the_kernels_take():
    assert type(FusionSettings(death_s=1).death_s) is float


def test_a_number_too_large_for_the_kernels_is_refused():
    with pytest.raises(ConfigError, match="death_s must be a positive number"):
        FusionSettings(death_s=10**400)
