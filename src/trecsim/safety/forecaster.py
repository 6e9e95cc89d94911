"""The seam for forecasts: what rules that warn early are given."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float64

from trecsim.values import Snapshot


@dataclass(frozen=True, slots=True, eq=False)
class Forecast:
    """Where one person will be: several modes, the likeliest first.

    Attributes
    ----------
    person
        Identity of the person.
    ahead_s
        Times after the moment of the forecast [s].
    weight
        Probability of each mode.
    xy_m
        Floor points [m].
    cov_m2
        Their covariances [m^2].
    """

    person: int
    ahead_s: Float64[np.ndarray, " step"]
    weight: Float64[np.ndarray, " mode"]
    xy_m: Float64[np.ndarray, "mode step 2"]
    cov_m2: Float64[np.ndarray, "mode step 2 2"]


@runtime_checkable
class Forecaster(Protocol):
    """Tells where people will be, from what has been seen so far."""

    def __call__(self, snapshot: Snapshot) -> Sequence[Forecast]:
        """Take the next moment; return a forecast for each person in it who has one."""
        ...
