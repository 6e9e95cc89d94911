"""A Kalman filter of how far somebody is from the camera that alone sees them; see `Ranges`."""

import math

from trecsim.compiler import inner
from trecsim.fusion.tuning import (
    KNOWN_RATE_MPS,
    RANGE_ACCEL_M2PS3,
    RANGE_DRIFT2_PER_S,
    RANGE_GATE,
    RANGE_MEMORY_S,
    RANGE_SPEED_MPS,
    SIZE_NOISE,
    SIZE_SPREAD,
    SOLE_NOISE_M,
    STEP_NOISE_M,
    WALK_NOISE_S,
)

# Entries of the state.
LOG, RATE, SIZE, LEVEL = range(4)


@inner
def begin_filter(mean, cov, log_m, level_spread):
    """Begin a filter that knows nothing yet but a rough distance.

    Parameters
    ----------
    mean, cov
        Results, (4,) and (4, 4).
    log_m, level_spread
        Logarithm of the distance, and relative spread of the one that the ground tells.
    """
    clear_filter(mean, cov)
    mean[LOG] = log_m
    cov[LOG, LOG] = 1.0
    cov[RATE, RATE] = RANGE_SPEED_MPS * RANGE_SPEED_MPS * math.exp(-2.0 * log_m)
    cov[SIZE, SIZE] = SIZE_SPREAD * SIZE_SPREAD
    cov[LEVEL, LEVEL] = level_spread * level_spread


@inner
def clear_filter(mean, cov):
    """Set a filter to zero."""
    for i in range(mean.shape[0]):
        mean[i] = 0.0
        for k in range(mean.shape[0]):
            cov[i, k] = 0.0


@inner
def begin_again(mean, cov, log_m, rate, variance):
    """Take over a distance from another source, in place; lasting errors stay.

    Parameters
    ----------
    mean, cov
        The filter.
    log_m, rate, variance
        Logarithm of the distance, its rate [1/s], and the variance of the logarithm.
    """
    for i in range(RATE + 1):
        for k in range(mean.shape[0]):
            cov[i, k] = cov[k, i] = 0.0
    mean[LOG], mean[RATE] = log_m, rate
    cov[LOG, LOG] = variance
    cov[RATE, RATE] = (RANGE_SPEED_MPS * math.exp(-log_m)) ** 2


@inner
def stay(mean, cov, log_m, rate, elapsed_s):
    """Take over a distance that nothing has measured, in place; it becomes less sure."""
    begin_again(mean, cov, log_m, rate, cov[LOG, LOG] + RANGE_DRIFT2_PER_S * elapsed_s)
    cov[RATE, RATE] = (KNOWN_RATE_MPS * math.exp(-log_m)) ** 2


@inner
def move_on(mean, cov, elapsed_s):
    """Predict the state after `elapsed_s`, in place."""
    kept = math.exp(-elapsed_s / RANGE_MEMORY_S)
    mean[LOG] += elapsed_s * mean[RATE]
    mean[RATE] *= kept
    for k in range(cov.shape[0]):
        cov[LOG, k] += elapsed_s * cov[RATE, k]
        cov[RATE, k] *= kept
    for i in range(cov.shape[0]):
        cov[i, LOG] += elapsed_s * cov[i, RATE]
        cov[i, RATE] *= kept
    cov[RATE, RATE] += RANGE_ACCEL_M2PS3 * elapsed_s * math.exp(-2.0 * mean[LOG])


@inner
def measure(mean, cov, log_m, variance, lasting):
    """Take in a distance, in place; return whether it was believed.

    One that is off by more than `RANGE_GATE` standard deviations is left out. One that is not
    finite tells nothing.

    Parameters
    ----------
    mean, cov
        The filter.
    log_m, variance
        Logarithm of the distance with its lasting error, and the variance of its noise.
    lasting
        Entry of the lasting error in the state.
    """
    if not math.isfinite(log_m):
        return True
    off = log_m - mean[LOG] - mean[lasting]
    spread = (
        cov[LOG, LOG] + cov[LOG, lasting] + cov[lasting, LOG] + cov[lasting, lasting] + variance
    )
    if off * off > RANGE_GATE * RANGE_GATE * spread:
        return False
    a, b = cov[0, LOG] + cov[0, lasting], cov[1, LOG] + cov[1, lasting]
    c, d = cov[2, LOG] + cov[2, lasting], cov[3, LOG] + cov[3, lasting]
    gain = a / spread, b / spread, c / spread, d / spread
    for i in range(4):
        mean[i] += gain[i] * off
        for k in range(4):
            cov[i, k] -= gain[i] * gain[k] * spread
    return True


@inner
def look(mean, cov, size_m, drop, above_m, since_s):
    """Take in what one detection tells of a distance, in place; return whether it was believed.

    Parameters
    ----------
    mean, cov
        The filter.
    size_m, drop
        See `usual_size_m` and `ankle_drop`.
    above_m
        Height of the camera above an ankle that stands on the ground as it is assumed [m].
    since_s
        Time since the last detection of this person [s].
    """
    again = max(1.0, WALK_NOISE_S / max(since_s, 1e-3))
    agrees = measure(mean, cov, math.log(size_m), SIZE_NOISE * SIZE_NOISE * again, SIZE)
    below, scale, n_ankle = drop
    if below > 0.0 and above_m > 0.0:
        step_m = STEP_NOISE_M[0] if n_ankle == 1 else STEP_NOISE_M[1]
        sole, step = SOLE_NOISE_M * scale / above_m, step_m * math.exp(-mean[LOG])
        noise = (sole * sole + step * step) * again
        agrees &= measure(mean, cov, math.log(above_m / below), noise, LEVEL)
    return agrees
