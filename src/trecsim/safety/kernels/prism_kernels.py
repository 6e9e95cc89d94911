"""How surely joints are inside an upright prism; see `trecsim.safety.polygons.Prism`."""

import math

import numpy as np

from trecsim.compiler import inner, kernel
from trecsim.safety.kernels.gaussian_kernels import cdf
from trecsim.safety.kernels.polygon_kernels import LEAST_SIGMA_M, SURE, box, inside, known

_SLICES, _SLICE_WEIGHTS = np.polynomial.legendre.leggauss(16)
_OPEN = 1e-6  # probabilities between this and 1 minus this are neither 0 nor 1


@inner
def _is_open(probability):
    return _OPEN < probability < 1.0 - _OPEN


@inner
def _inside_prism(corners, around, z_m, xyz_m, cov_m2):
    """Return the probability that one joint is inside."""
    x, y, z = xyz_m[0], xyz_m[1], xyz_m[2]
    over = inside(corners, around, x, y, cov_m2[0, 0], cov_m2[0, 1], cov_m2[1, 1])
    if over <= 0.0:  # the height does not matter
        return over
    sigma = math.sqrt(known(cov_m2[2, 2]) + LEAST_SIGMA_M * LEAST_SIGMA_M)
    low, high = (z_m[0] - z) / sigma, (z_m[1] - z) / sigma
    in_height = cdf(high) - cdf(low)
    with_x, with_y = known(cov_m2[0, 2]), known(cov_m2[1, 2])
    correlated = with_x != 0.0 or with_y != 0.0
    if not (correlated and _is_open(in_height) and _is_open(over)):
        return over * in_height
    low, high = max(low, -SURE), min(high, SURE)
    shift_x, shift_y = with_x / sigma, with_y / sigma
    least = LEAST_SIGMA_M * LEAST_SIGMA_M
    xx = known(cov_m2[0, 0]) + least - shift_x * shift_x
    xy = known(cov_m2[0, 1]) - shift_x * shift_y
    yy = known(cov_m2[1, 1]) + least - shift_y * shift_y
    total = weights = 0.0
    for k in range(_SLICES.shape[0]):
        at = 0.5 * (low + high) + 0.5 * (high - low) * _SLICES[k]
        weight = _SLICE_WEIGHTS[k] * math.exp(-0.5 * at * at)
        weights += weight
        total += weight * inside(corners, around, x + at * shift_x, y + at * shift_y, xx, xy, yy)
    return in_height * total / weights


@kernel
def inside_joints(corners, z_m, rows, xyz_m, cov_m2, counts, found):
    """Write the probability that joints are inside to `found` (row, joint); 0 where none counts.

    Parameters
    ----------
    corners, z_m
        Base [m], and from where to where above the floor [m].
    rows
        Which people.
    xyz_m, cov_m2
        Of all people and joints: means [m] and covariances [m^2]; unknown ones count as none.
    counts
        Which joints of these people count (row, joint).
    """
    around = box(corners)
    for n in range(rows.shape[0]):
        for joint in range(counts.shape[1]):
            found[n, joint] = 0.0
            if counts[n, joint]:
                found[n, joint] = _inside_prism(
                    corners, around, z_m, xyz_m[rows[n], joint], cov_m2[rows[n], joint]
                )
