"""What a forecast is given and what it gives: frozen values, arrays read-only by custom.

Axis names: ``person step mode level``, and ``past`` for the samples behind a forecast.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.errors import ConfigError
from trecsim.forecasting.constants import FULL_AHEAD_S, LEVELS, LONGEST_AHEAD_S, STEPS
from trecsim.forecasting.walls import NO_WALLS, Walls

AHEAD_S: Float64[np.ndarray, " step"] = np.round(np.linspace(0.0, FULL_AHEAD_S, STEPS + 1)[1:], 9)
"""Horizons of a forecast unless others are asked for: 0.4 to 4.8 s [s]."""

Moment = tuple[float, Int64[np.ndarray, " _"], Float64[np.ndarray, "_ 2"]]
"""Time [s], identities and floor points [m] of everybody seen at it."""


@dataclass(frozen=True, slots=True, eq=False)
class Pasts:
    """Where the people of one moment were, sampled every 0.4 s up to that moment.

    Attributes
    ----------
    t_s
        The moment [s].
    person
        Identities.
    xy_m
        Floor points [m], the newest last; NaN before a person was first seen. The newest is
        always known.
    """

    t_s: float
    person: Int64[np.ndarray, " person"]
    xy_m: Float64[np.ndarray, "person past 2"]

    @property
    def count(self) -> Int64[np.ndarray, " person"]:
        """Number of samples per person that are known without a gap up to the moment."""
        known = ~np.isnan(self.xy_m[..., 0])
        unbroken = np.logical_and.accumulate(known[:, ::-1], axis=1)
        return np.asarray(unbroken.sum(axis=1, dtype=np.int64))


@dataclass(frozen=True, slots=True, eq=False)
class Forecast:
    """Where one person will be: several modes, each with a weight, and regions.

    Attributes
    ----------
    t_s
        The moment at which it was made [s].
    person
        Identity.
    from_m
        Floor point at that moment [m].
    ahead_s
        Horizons after that moment [s].
    weight
        Probability of each mode; they sum to 1. The first mode is the single guess.
    xy_m
        Floor points of the modes [m].
    cov_m2
        Their covariances [m^2].
    region_m2
        Per level of `LEVELS` and step the matrix E of an ellipse around the first mode,
        e' E^-1 e <= 1, that holds the person with that probability [m^2].
    path_m2
        The same for the whole path: with a probability of 90 % the person stays inside all these
        ellipses [m^2].
    """

    t_s: float
    person: int
    from_m: Float64[np.ndarray, " 2"]
    ahead_s: Float64[np.ndarray, " step"]
    weight: Float64[np.ndarray, " mode"]
    xy_m: Float64[np.ndarray, "mode step 2"]
    cov_m2: Float64[np.ndarray, "mode step 2 2"]
    region_m2: Float64[np.ndarray, "level step 2 2"]
    path_m2: Float64[np.ndarray, "step 2 2"]

    @property
    def mean_m(self) -> Float64[np.ndarray, "step 2"]:
        """Mean over the modes [m]."""
        return np.asarray(np.tensordot(self.weight, self.xy_m, 1))

    @property
    def total_cov_m2(self) -> Float64[np.ndarray, "step 2 2"]:
        """Covariance of all modes together [m^2]."""
        off = self.xy_m - self.mean_m
        spread = self.cov_m2 + off[..., :, None] * off[..., None, :]
        return np.asarray(np.tensordot(self.weight, spread, 1))


@dataclass(frozen=True, slots=True, eq=False)
class Forecasts:
    """The forecasts of everybody at one moment, in arrays; see `Forecast` for what they hold.

    Their modes stay on this side of `walls`.
    """

    t_s: float
    person: Int64[np.ndarray, " person"]
    from_m: Float64[np.ndarray, "person 2"]
    ahead_s: Float64[np.ndarray, " step"]
    weight: Float64[np.ndarray, "person mode"]
    xy_m: Float64[np.ndarray, "person mode step 2"]
    cov_m2: Float64[np.ndarray, "person mode step 2 2"]
    region_m2: Float64[np.ndarray, "person level step 2 2"]
    path_m2: Float64[np.ndarray, "person step 2 2"]
    walls: Walls = NO_WALLS

    def each(self) -> list[Forecast]:
        """Return one forecast per person."""
        rows = zip(
            self.person.tolist(), self.from_m, self.weight, self.xy_m, self.cov_m2,
            self.region_m2, self.path_m2, strict=True,
        )  # fmt: skip
        return [
            Forecast(self.t_s, person, from_m, self.ahead_s, *others)
            for person, from_m, *others in rows
        ]

    def moments(self) -> tuple[np.ndarray, np.ndarray]:
        """Return mean (person, step, 2) [m] and xx, xy, yy (person, step, 3) of all modes [m^2]."""
        people, modes, steps = self.xy_m.shape[:3]
        weight = self.weight[:, None]
        mean_m = (weight @ self.xy_m.reshape(people, modes, -1)).reshape(people, 1, steps, 2)
        x, y = np.moveaxis(self.xy_m - mean_m, -1, 0)
        xx, xy, yy = (self.cov_m2[..., i, j] for i, j in ((0, 0), (0, 1), (1, 1)))
        upper = [(weight @ own)[:, 0] for own in (xx + x * x, xy + x * y, yy + y * y)]
        return mean_m[:, 0], np.stack(upper, axis=-1)


def horizons(ahead_s: float, step_s: float) -> Float64[np.ndarray, " step"]:
    """Return equally spaced horizons up to the farthest.

    Raises
    ------
    ConfigError
        They cannot be had.

    Examples
    --------
    >>> horizons(2.0, 0.5).tolist()
    [0.5, 1.0, 1.5, 2.0]
    """
    if not 0.0 < step_s <= ahead_s <= LONGEST_AHEAD_S:
        raise ConfigError(
            f"horizons: expected 0 < step <= ahead <= {LONGEST_AHEAD_S:g} s, found a step of "
            f"{step_s:g} s up to {ahead_s:g} s"
        )
    steps = np.arange(1, int(ahead_s / step_s + 1e-6) + 1) * step_s
    return AHEAD_S if np.array_equal(steps.round(9), AHEAD_S) else steps.round(9)


__all__ = ["AHEAD_S", "LEVELS", "Forecast", "Forecasts", "Moment", "Pasts", "horizons"]
