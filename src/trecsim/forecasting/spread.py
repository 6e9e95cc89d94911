"""Modes and regions around the single guess, from the table and from what was seen on this site."""

import numpy as np
from jaxtyping import Float64

from trecsim.forecasting.constants import SMALLEST_SIGMA_M
from trecsim.forecasting.forecasts import AHEAD_S, LEVELS, Forecasts
from trecsim.forecasting.guess import Guess
from trecsim.forecasting.table_values import Table

_MIDDLE, _OUTER = LEVELS.index(0.5), LEVELS.index(0.9)


def forecasts(
    guess: Guess,
    radius: Float64[np.ndarray, "kind 12 level"],
    path_factor: Float64[np.ndarray, " kind"],
    table: Table,
) -> Forecasts:
    """Return the forecasts of everybody.

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
    both relative to the table. The last one, "anywhere", is never narrower than in the table: where
    everybody has stood still so far, somebody may still walk off.
    """
    radii = radii_of(guess, radius)
    path = path_factor[guess.kind][:, None, None] * radii[:, _OUTER, None]
    modes = _mode_factors(guess, radii, table)
    ellipses = np.concatenate([radii, path, modes], axis=1)
    sizes = np.ones((*ellipses.shape[:2], 2))
    sizes[:, -modes.shape[1] :] = table.sd[guess.kind]
    matrices = _ellipses(guess, ellipses, sizes, modes.shape[1])
    levels = radii.shape[1]
    return Forecasts(
        guess.t_s, guess.person, guess.from_m, guess.ahead_s, table.weight[guess.kind],
        _means(guess, modes, table), matrices[:, levels + 1 :], matrices[:, :levels],
        matrices[:, levels],
    )  # fmt: skip


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
    others = table.weight.shape[1] - 2
    return np.stack([middle, *[outer] * others, np.maximum(outer, 1.0)], axis=1)


def _means(
    guess: Guess, factor: Float64[np.ndarray, "person mode step"], table: Table
) -> Float64[np.ndarray, "person mode step 2"]:
    """Return where the modes lie [m]."""
    off_m = (factor[..., None] * table.mean[guess.kind][:, :, None]) * guess.scale_m[:, None]
    people = len(off_m)
    turned = (off_m.reshape(people, -1, 2) @ guess.axes).reshape(off_m.shape)
    return np.asarray(guess.xy_m[:, None] + turned)


def _ellipses(
    guess: Guess,
    factor: Float64[np.ndarray, "person many step"],
    sizes: Float64[np.ndarray, "person many 2"],
    modes: int,
) -> Float64[np.ndarray, "person many step 2 2"]:
    """Return matrices of so many times the scale, in the world [m^2]; the last ones are modes'."""
    along_m2, left_m2 = (
        _variance(factor * sizes[..., i, None] * guess.scale_m[:, None, :, i], modes)
        for i in (0, 1)
    )
    x, y = guess.heading.T[:, :, None, None]
    matrices = np.empty((*factor.shape, 2, 2))
    matrices[..., 0, 0] = along_m2 * x**2 + left_m2 * y**2
    matrices[..., 1, 1] = along_m2 * y**2 + left_m2 * x**2
    matrices[..., 0, 1] = matrices[..., 1, 0] = (along_m2 - left_m2) * (x * y)
    return matrices


def _variance(sigma_m: Float64[np.ndarray, "person many step"], modes: int) -> np.ndarray:
    np.maximum(sigma_m[:, -modes:], SMALLEST_SIGMA_M, out=sigma_m[:, -modes:])
    return np.asarray(sigma_m**2)
