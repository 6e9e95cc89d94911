"""Modes and regions around the single guess, from the table and from what was seen on this site."""

import numpy as np
from jaxtyping import Float64

from trecsim.forecasting.guess import Guess
from trecsim.forecasting.table_values import Table
from trecsim.forecasting.tuning import SMALLEST_SIGMA_M
from trecsim.forecasting.values import AHEAD_S, LEVELS, Forecast

_MIDDLE, _OUTER = LEVELS.index(0.5), LEVELS.index(0.9)


def forecasts(
    guess: Guess,
    radius: Float64[np.ndarray, "kind 12 level"],
    path_factor: Float64[np.ndarray, " kind"],
    table: Table,
) -> list[Forecast]:
    """Return a forecast for everybody.

    Parameters
    ----------
    guess
        The single guesses and their scale.
    radius
        Radius of the regions of `LEVELS` in units of the scale, per class of speed and horizon.
    path_factor
        Factor on the radius of the 90 % regions that holds the whole path.
    table
        The fitted numbers.

    Notes
    -----
    The radii are calibrated while running, the modes follow them: the first mode, the single
    guess, is as wide as the region of 50 %, the others are as wide and as far out as that of 90 %,
    both relative to the table.
    """
    radii = radii_of(guess, radius)
    shape_m2 = guess.shape_m2
    region_m2 = (radii**2)[..., None, None] * shape_m2[:, None]
    path_m2 = (path_factor[guess.kind] ** 2)[:, None, None, None] * region_m2[:, _OUTER]
    factor = _mode_factors(guess, radii, table)
    xy_m, cov_m2 = _modes(guess, factor, table)
    return [
        Forecast(
            guess.t_s, person, guess.from_m[i], guess.ahead_s, table.weight[kind], xy_m[i],
            cov_m2[i], region_m2[i], path_m2[i],
        )
        for i, (person, kind) in enumerate(
            zip(guess.person.tolist(), guess.kind.tolist(), strict=True)
        )
    ]  # fmt: skip


def radii_of(
    guess: Guess, radius: Float64[np.ndarray, "kind 12 level"]
) -> Float64[np.ndarray, "person level step"]:
    """Return the radii of the regions per person, level and horizon; regions never shrink."""
    by_level = np.swapaxes(np.log(np.maximum.accumulate(radius, axis=2)), 1, 2)
    if guess.ahead_s is not AHEAD_S:
        by_level = np.array(
            [[np.interp(guess.ahead_s, AHEAD_S, row) for row in kind] for kind in by_level]
        )
    return _growing(np.exp(by_level)[guess.kind], guess.scale_m)


def _growing(
    factor: Float64[np.ndarray, "person many step"], scale_m: Float64[np.ndarray, "person step 2"]
) -> Float64[np.ndarray, "person many step"]:
    """Return the factors, raised where an ellipse would be smaller than the one before."""
    factor = factor.copy()
    shrinks = (scale_m[:, :-1] / scale_m[:, 1:]).max(axis=2)
    for k in range(1, factor.shape[2]):
        least = factor[..., k - 1] * shrinks[:, None, k - 1]
        np.maximum(factor[..., k], least, out=factor[..., k])
    return factor


def _mode_factors(
    guess: Guess, radii: Float64[np.ndarray, "person level step"], table: Table
) -> Float64[np.ndarray, "person mode step"]:
    usual = table.radius[guess.kind]
    middle = radii[:, _MIDDLE] / usual[:, _MIDDLE, None]
    outer = radii[:, _OUTER] / usual[:, _OUTER, None]
    others = table.weight.shape[1] - 1
    return np.concatenate([middle[:, None], np.repeat(outer[:, None], others, axis=1)], axis=1)


def _modes(
    guess: Guess, factor: Float64[np.ndarray, "person mode step"], table: Table
) -> tuple[np.ndarray, np.ndarray]:
    """Return where the modes lie and their covariances."""
    people, modes, steps = factor.shape
    flat = (people, modes * steps, 2)
    scale_m = factor[..., None] * guess.scale_m[:, None]
    off_m = (table.mean[guess.kind][:, :, None] * scale_m).reshape(flat) @ guess.axes
    xy_m = guess.xy_m[:, None] + off_m.reshape(people, modes, steps, 2)
    sd_m = np.maximum(table.sd[guess.kind][:, :, None] * scale_m, SMALLEST_SIGMA_M)
    cov_m2 = (sd_m**2).reshape(flat) @ guess.planes
    return xy_m, cov_m2.reshape(people, modes, steps, 2, 2)
