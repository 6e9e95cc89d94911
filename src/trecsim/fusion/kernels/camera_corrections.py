"""Errors of all cameras from their normal equations, and projections without them."""

import math

import numpy as np

from trecsim.compiler import inner, kernel
from trecsim.fusion.kernels.cholesky import cholesky, invert_cholesky
from trecsim.fusion.tuning import (
    CLOCK_SIGMA_S,
    EYES_OF_A_POINT,
    LEAST_TURN_RAD,
    PRIOR_WEIGHT,
    PUSHED_RAD,
    PUSHED_S,
    SURE,
    TURN_SIGMA_RAD,
)

_UNKNOWNS, _DELAY = 4, 3


@kernel(allocates=True)
def correct_all(equations, learnt, scale, calibrated, corrected):
    """Find the cameras' errors, and write projections without those that are sure.

    Parameters
    ----------
    equations
        Normal equations of all cameras: (cam, 4, cam, 4) and (cam, 4).
    learnt
        Errors found, their variances, and what of them is applied, (cam, 4) each; changed in place.
    scale
        Variance of the turns relative to their prior, as far as it is known.
    calibrated
        Intrinsics (cam, 3, 3), poses (cam, 3, 4) and focal lengths (cam,) as calibrated.
    corrected
        Results: projections (cam, 3, 4), ray matrices (cam, 3, 3) and error variances (cam,)
        [px^2]; see `Cameras`.

    Returns
    -------
    The scale as it is known now.

    Notes
    -----
    See `camera_errors.CameraErrors.corrected`.
    """
    (info, vector), (found, variance, applied) = equations, learnt
    n = found.shape[0]
    prior = prior_of(found, scale)
    cov = inverse_of(info, prior)
    solve(cov, vector, found)
    less_median(found)
    spread = 0.0
    for c in range(n):
        for i in range(_UNKNOWNS):
            variance[c, i] = cov[_UNKNOWNS * c + i, _UNKNOWNS * c + i]
            if i < _DELAY:
                spread += (found[c, i] ** 2 + variance[c, i]) / prior[c, i]
    if n > 1:
        about_mean(cov, variance)
    scale *= (PRIOR_WEIGHT / scale + spread) / (PRIOR_WEIGHT + 3.0 * n)
    hidden = min(1.0, EYES_OF_A_POINT / n) * scale * TURN_SIGMA_RAD**2
    (K, pose, focal_px), (P, ray_of, error_px2) = calibrated, corrected
    KR = np.empty((3, 3))
    for c in range(n):
        apply_sure(c, found, cov, prior, applied)
        left = max(0.5 * (variance[c, 0] + variance[c, 1]), hidden) + LEAST_TURN_RAD**2
        error_px2[c] = focal_px[c] * focal_px[c] * left
        turn(K[c], applied[c], KR)
        for i in range(3):
            for k in range(4):
                P[c, i, k] = KR[i, 0] * pose[c, 0, k] + KR[i, 1] * pose[c, 1, k]
                P[c, i, k] += KR[i, 2] * pose[c, 2, k]
        invert(P[c], ray_of[c])
    return scale


@inner(allocates=True)
def prior_of(found, scale):
    """Return the variances of turn and delay of each camera, before anything is known, (cam, 4)."""
    prior, turn2 = np.empty(found.shape), scale * TURN_SIGMA_RAD**2
    for c in range(found.shape[0]):
        tilt2 = (found[c, 0] ** 2 + found[c, 1] ** 2) / PUSHED_RAD**2
        late = found[c, _DELAY] / PUSHED_S
        prior[c, 0] = prior[c, 1] = math.sqrt(1.0 + tilt2) * turn2
        prior[c, 2] = turn2
        prior[c, _DELAY] = math.sqrt(1.0 + late * late) * CLOCK_SIGMA_S**2
    return prior


@inner(allocates=True)
def inverse_of(info, prior):
    """Return the covariance of all errors, (4 cam, 4 cam), by their information and the prior."""
    n = _UNKNOWNS * info.shape[0]
    A, cov = np.empty((n, n)), np.empty((n, n))
    for c in range(info.shape[0]):
        for i in range(_UNKNOWNS):
            for d in range(info.shape[0]):
                for k in range(_UNKNOWNS):
                    A[_UNKNOWNS * c + i, _UNKNOWNS * d + k] = info[c, i, d, k]
            A[_UNKNOWNS * c + i, _UNKNOWNS * c + i] += 1.0 / prior[c, i]
    cholesky(A)
    invert_cholesky(A)
    for i in range(n):
        for k in range(i, n):
            total = 0.0
            for m in range(k, n):
                total += A[i, m] * A[k, m]
            cov[i, k] = cov[k, i] = total
    return cov


@inner
def solve(cov, vector, found):
    """Write the errors that residuals tell to `found`, (cam, 4)."""
    for c in range(found.shape[0]):
        for i in range(_UNKNOWNS):
            total = 0.0
            for d in range(found.shape[0]):
                for k in range(_UNKNOWNS):
                    total += cov[_UNKNOWNS * c + i, _UNKNOWNS * d + k] * vector[d, k]
            found[c, i] = total


@inner(allocates=True)
def less_median(found):
    """Take the median delay off all delays, in place: common to all, it is no error."""
    n = found.shape[0]
    delays_s = np.empty(n)
    for c in range(n):  # sorted as they come
        i = c
        while i > 0 and delays_s[i - 1] > found[c, _DELAY]:
            delays_s[i] = delays_s[i - 1]
            i -= 1
        delays_s[i] = found[c, _DELAY]
    median_s = 0.5 * (delays_s[(n - 1) // 2] + delays_s[n // 2])
    for c in range(n):
        found[c, _DELAY] -= median_s


@inner
def about_mean(cov, variance):
    """Write the variances of the delays about their mean to `variance` (cam, 4).

    No residual tells what all clocks are late by; it is taken off the delays found, and must not
    make them less sure.
    """
    n = variance.shape[0]
    of_mean = 0.0
    for c in range(n):
        for d in range(n):
            of_mean += cov[_UNKNOWNS * c + _DELAY, _UNKNOWNS * d + _DELAY] / (n * n)
    for c in range(n):
        with_mean = 0.0
        for d in range(n):
            with_mean += cov[_UNKNOWNS * c + _DELAY, _UNKNOWNS * d + _DELAY] / n
        variance[c, _DELAY] += of_mean - 2.0 * with_mean


@inner
def apply_sure(c, found, cov, prior, applied):
    """Write what is applied of the errors of camera `c`: nearly all of them, or nothing.

    What is no larger than chance, or lasting errors of key points, make it, is none.
    """
    tilt = (found[c, 0] ** 2 + found[c, 1] ** 2) / (
        PUSHED_RAD**2 + SURE**2 * (by_chance(c, 0, cov, prior) + by_chance(c, 1, cov, prior))
    )
    late = found[c, _DELAY] ** 2 / (PUSHED_S**2 + SURE**2 * by_chance(c, _DELAY, cov, prior))
    turns, delays = 1.0 - 1.0 / max(tilt, 1.0) ** 2, 1.0 - 1.0 / max(late, 1.0) ** 2
    for i in range(_DELAY):
        applied[c, i] = turns * found[c, i]
    applied[c, _DELAY] = delays * found[c, _DELAY]


@inner
def by_chance(c, i, cov, prior):
    """Return the variance that unknown `i` of camera `c` has where there is no error."""
    row = _UNKNOWNS * c + i
    total = cov[row, row]
    for d in range(prior.shape[0]):
        for k in range(_UNKNOWNS):
            total -= cov[row, _UNKNOWNS * d + k] ** 2 / prior[d, k]
    return total


@inner
def turn(K, rotation_rad, out):
    """Write ``K R`` to `out` (3, 3), with the rotation by a rotation vector (Rodrigues)."""
    x, y, z = rotation_rad[0], rotation_rad[1], rotation_rad[2]
    angle = math.sqrt(x * x + y * y + z * z)
    by = 1.0 / max(angle, 1e-12)
    x, y, z, s, c = x * by, y * by, z * by, math.sin(angle), 1.0 - math.cos(angle)
    rows = (
        (1.0 - c * (y * y + z * z), c * x * y - s * z, c * x * z + s * y),
        (c * x * y + s * z, 1.0 - c * (x * x + z * z), c * y * z - s * x),
        (c * x * z - s * y, c * y * z + s * x, 1.0 - c * (x * x + y * y)),
    )
    for i in range(3):
        for k in range(3):
            out[i, k] = K[i, 0] * rows[0][k] + K[i, 1] * rows[1][k] + K[i, 2] * rows[2][k]


@inner
def invert(P, out):
    """Write the inverse of the first three columns of `P` to `out` (3, 3)."""
    a, b, c = P[0, 0], P[0, 1], P[0, 2]
    d, e, f = P[1, 0], P[1, 1], P[1, 2]
    g, h, i = P[2, 0], P[2, 1], P[2, 2]
    p, q, r = e * i - f * h, f * g - d * i, d * h - e * g
    by = 1.0 / (a * p + b * q + c * r)
    out[0, 0], out[0, 1], out[0, 2] = p * by, (c * h - b * i) * by, (b * f - c * e) * by
    out[1, 0], out[1, 1], out[1, 2] = q * by, (a * i - c * g) * by, (c * d - a * f) * by
    out[2, 0], out[2, 1], out[2, 2] = r * by, (b * g - a * h) * by, (a * e - b * d) * by
