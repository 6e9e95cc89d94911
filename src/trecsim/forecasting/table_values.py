"""What is fitted on recorded people: a table of some hundred numbers."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64


@dataclass(frozen=True, slots=True, eq=False)
class Table:
    """The fitted numbers of the forecast; "kind" is the class of speed.

    Attributes
    ----------
    corrections_s
        How much of each correction's velocity counts, linearly and quadratically in the horizon
        [s].
    scale_m
        Scale of the errors at 4.8 s, along and across the heading [m].
    exponent
        The power of the horizon with which it grows.
    short
        Factor on the scale for people with 1, 2, ... 8 samples.
    weight
        Probability of each mode.
    mean
        Where the modes lie around the single guess, in units of the scale.
    sd
        Their standard deviations, in units of the scale.
    radius
        Radius of the regions of `LEVELS`, in units of the scale.
    path_radius
        Radius of the region of the whole path.
    """

    corrections_s: Float64[np.ndarray, "correction 2"]
    scale_m: Float64[np.ndarray, "kind 2"]
    exponent: Float64[np.ndarray, " kind"]
    short: Float64[np.ndarray, " past"]
    weight: Float64[np.ndarray, "kind mode"]
    mean: Float64[np.ndarray, "kind mode 2"]
    sd: Float64[np.ndarray, "kind mode 2"]
    radius: Float64[np.ndarray, "kind level"]
    path_radius: Float64[np.ndarray, " kind"]

    def __post_init__(self) -> None:
        """Make up for the rounding of the weights, which sum to 1."""
        object.__setattr__(self, "weight", self.weight / self.weight.sum(axis=1, keepdims=True))
