"""The slow and obvious twin of the kernel that finds the cameras' errors."""

import numpy as np

from trecsim.fusion import tuning

TURN, TILT, DELAY = slice(0, 3), slice(0, 2), 3


def prior(found, scale):
    """Return the variances before anything is known, wider where much was found: an L1 norm."""
    tilt = np.sqrt((found[:, TILT] ** 2).sum(axis=1)) / tuning.PUSHED_RAD
    tilted, late = np.hypot(1.0, [tilt, found[:, DELAY] / tuning.PUSHED_S])
    wider = np.stack([tilted, tilted, np.ones_like(late), late], axis=1)
    return wider * ([scale * tuning.TURN_SIGMA_RAD**2] * 3 + [tuning.CLOCK_SIGMA_S**2])


def corrected(info, vector, before, scale):
    """Return what is found, its variance, what of it is applied, the scale, and what is left."""
    n, first = len(vector), prior(before, scale)
    cov = np.linalg.inv(info.reshape(4 * n, 4 * n) + np.diag(1.0 / first.ravel()))
    found = (cov @ vector.ravel()).reshape(n, 4)
    found[:, DELAY] -= np.median(found[:, DELAY])
    variance = cov.diagonal().reshape(n, 4).copy()
    spread = (found**2 + variance)[:, TURN] / first[:, TURN]
    scale *= (tuning.PRIOR_WEIGHT / scale + spread.sum()) / (tuning.PRIOR_WEIGHT + spread.size)
    by_chance = (cov.diagonal() - (cov**2) @ (1.0 / first.ravel())).reshape(n, 4)
    applied = found * applied_share(found, by_chance)
    hidden = min(1.0, tuning.EYES_OF_A_POINT / n) * scale * tuning.TURN_SIGMA_RAD**2
    left = np.maximum(variance[:, TILT].mean(axis=1), hidden) + tuning.LEAST_TURN_RAD**2
    about_mean = np.eye(n) - 1.0 / n
    variance[:, DELAY] = (about_mean @ cov[DELAY::4, DELAY::4] @ about_mean).diagonal()
    return found, variance, applied, scale, left


def applied_share(found, by_chance):
    tilt = (found[:, TILT] ** 2).sum(axis=1)
    tilt /= tuning.PUSHED_RAD**2 + tuning.SURE**2 * by_chance[:, TILT].sum(axis=1)
    late = found[:, DELAY] ** 2
    late /= tuning.PUSHED_S**2 + tuning.SURE**2 * by_chance[:, DELAY]
    kept = 1.0 - 1.0 / np.maximum([tilt, late], 1.0) ** 2
    return kept.T[:, [0, 0, 0, 1]]
