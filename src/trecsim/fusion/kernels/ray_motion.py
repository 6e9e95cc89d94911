"""A whole body moved along the rays of the camera that alone sees it: its image stays the same."""

import math

from trecsim.compiler import inner
from trecsim.fusion.kernels.curve import BLOCK, locate, point
from trecsim.fusion.kernels.information import right_side

# The rate of the distance is measured over this time [s].
_RATE_S = 0.1
# The past of a trajectory is moved by no more than this factor, as a logarithm.
_MOST = 0.5


@inner
def log_distance(c, torso, origin_m, knot_time, tmp):
    """Return the logarithm of a body's horizontal distance from `origin_m` at one time.

    Parameters
    ----------
    c, torso
        Control points of one person, (joint, n), and the joints whose mean is its position.
    origin_m, knot_time
        The camera, (3,), and the time in knots.
    tmp
        Scratch: weights (4,) and a point (3,).
    """
    weights, x = tmp
    span = locate(knot_time, c.shape[1] // BLOCK, weights)
    ahead = aside = 0.0
    for j in torso:
        point(c[j], span, weights, x)
        ahead += x[0]
        aside += x[1]
    ahead = ahead / torso.shape[0] - origin_m[0]
    aside = aside / torso.shape[0] - origin_m[1]
    return math.log(max(math.sqrt(ahead * ahead + aside * aside), 1e-3))


@inner
def log_range(c, torso, origin_m, now, tmp):
    """Return the logarithm of a person's horizontal distance from a camera, and its rate [1/s].

    Parameters as for `log_distance`, with the pair of time in knots and distance of knots [s].
    """
    knot_time, knot_s = now
    here = log_distance(c, torso, origin_m, knot_time, tmp)
    before = log_distance(c, torso, origin_m, knot_time - _RATE_S / knot_s, tmp)
    return here, (here - before) / _RATE_S


@inner
def relative_variance(x, cov_m2, torso, origin_m):
    """Return the variance of a person's distance by its trajectories, over its square.

    `x` and `cov_m2` are joints and covariances, (joint, 3) and (joint, 3, 3).
    """
    way_m = (
        middle(x, torso, 0) - origin_m[0],
        middle(x, torso, 1) - origin_m[1],
        middle(x, torso, 2) - origin_m[2],
    )
    far_m2 = along = 0.0
    for a in range(3):
        far_m2 += way_m[a] * way_m[a]
        for b in range(3):
            for j in torso:
                along += way_m[a] * cov_m2[j, a, b] * way_m[b] / torso.shape[0]
    return along / (far_m2 * far_m2)


@inner
def middle(x, torso, a):
    """Return the mean of coordinate `a` of the joints `torso`."""
    total = 0.0
    for j in torso:
        total += x[j, a]
    return total / torso.shape[0]


@inner
def move_along_rays(person, torso, origin_m, log_m, rate, now, tmp):
    """Put a person at a distance from a camera, with a rate of it, in place.

    Parameters
    ----------
    person
        `Trajectories` of one person.
    torso, origin_m
        The joints whose mean is the person's position, and the camera, (3,).
    log_m, rate
        Logarithm of the horizontal distance, and its rate [1/s].
    now, tmp
        See `log_range`.

    Notes
    -----
    The control point at the time ``t`` moves by the factor ``exp(a + b (t - now))`` from the
    camera, so that each joint stays on its ray, in the past as well.
    """
    R, z, c, x_m, _ = person
    (knot_time, knot_s), (weights, _) = now, tmp
    here, rate_here = log_range(c, torso, origin_m, now, tmp)
    n = c.shape[1]
    for i in range(n // BLOCK):
        since_s = (i - 1.0 - knot_time) * knot_s  # of the control point's own time
        by = log_m - here + (rate - rate_here) * since_s
        factor = math.exp(min(max(by, -_MOST), _MOST))
        for j in range(c.shape[0]):
            for a in range(BLOCK):
                c[j, BLOCK * i + a] = origin_m[a] + factor * (c[j, BLOCK * i + a] - origin_m[a])
    span = locate(knot_time, n // BLOCK, weights)
    for j in range(c.shape[0]):
        right_side(R[j], c[j], z[j])
        point(c[j], span, weights, x_m[j])
