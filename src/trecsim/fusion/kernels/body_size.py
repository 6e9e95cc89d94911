"""What one image tells of a person's distance: the size of the body, and how low the ankles are.

All joints are placed in the upright plane across the line of sight. In it, lengths and heights are
proportional to the distance of the plane, so that each limb, and the ground, measure one number.
"""

import math

from trecsim.compiler import inner
from trecsim.fusion.tuning import FORESHORTENED

# A ray that is steeper leads to no distance along the ground: its horizontal part.
_STEEPEST = 0.1
# The camera is at least so high above an ankle, where the ground's error is made one of distance.
LEAST_ABOVE_M = 0.1


@inner
def upright_plane(ray_of, xy_px, at_one_m):
    """Write the joints, from the camera, on the upright plane at the horizontal distance of 1 m.

    Parameters
    ----------
    ray_of
        Matrix that turns a pixel of the camera into a viewing ray, (3, 3).
    xy_px
        Key points, (joint, 2); NaN where unknown.
    at_one_m
        Result, (joint, 3); NaN where there is no key point, or the ray is too steep.

    Notes
    -----
    With ``h`` the mean horizontal direction of all rays and ``r_k`` the ray of joint ``k``, the
    plane at the horizontal distance ``D`` has the joint at ``o + D r_k / (r_k h)``.
    """
    x = y = 0.0
    for j in range(xy_px.shape[0]):
        u, v = xy_px[j, 0], xy_px[j, 1]
        length = 0.0
        for a in range(3):
            at_one_m[j, a] = ray_of[a, 0] * u + ray_of[a, 1] * v + ray_of[a, 2]
            length += at_one_m[j, a] * at_one_m[j, a]
        length = math.sqrt(length)
        for a in range(3):
            at_one_m[j, a] /= length
        if not math.isnan(length):
            x += at_one_m[j, 0]
            y += at_one_m[j, 1]
    level = math.sqrt(x * x + y * y)
    for j in range(xy_px.shape[0]):
        ahead = (at_one_m[j, 0] * x + at_one_m[j, 1] * y) / level
        if not ahead > _STEEPEST:
            ahead = math.nan
        for a in range(3):
            at_one_m[j, a] /= ahead


@inner
def usual_size_m(ruler, at_one_m):
    """Return the distance at which a body has the usual size; NaN where too little of it is seen.

    Parameters
    ----------
    ruler, at_one_m
        `Ruler`, and the joints; see `upright_plane`.

    Notes
    -----
    A limb of usual length ``L`` and of length ``c`` at distance 1 says ``D = L / c``. One that is
    turned towards the camera or away from it is shorter in the image and says too much; those that
    say much more than the second nearest are left out.
    """
    joints, length_m = ruler.joints, ruler.length_m
    nearest = second = math.inf
    for i in range(length_m.shape[0]):
        says_m = length_m[i] / length_of(at_one_m, joints[i])
        if says_m < nearest:
            nearest, second = says_m, nearest
        elif says_m < second:
            second = says_m
    if second == math.inf:
        return math.nan
    usual = seen = 0.0
    for i in range(length_m.shape[0]):
        length = length_of(at_one_m, joints[i])
        if length_m[i] / length <= FORESHORTENED * second:
            usual += length_m[i]
            seen += length
    return usual / seen


@inner
def length_of(x, ends):
    """Return the distance of two joints."""
    a, b = ends
    return math.sqrt((x[a, 0] - x[b, 0]) ** 2 + (x[a, 1] - x[b, 1]) ** 2 + (x[a, 2] - x[b, 2]) ** 2)


@inner
def ankle_drop(ruler, at_one_m, sigma_scale):
    """Return how far the ankles are below the camera at 1 m, and how well that is known.

    Of two ankles the mean logarithm counts: one foot is before the body, the other one behind it.

    Parameters
    ----------
    ruler, at_one_m
        `Ruler`, and the joints; see `upright_plane`.
    sigma_scale
        Standard deviation of each key point, relative to that of a good one, (joint,).

    Returns
    -------
    The drop, NaN without an ankle; the mean of the ankles' `sigma_scale`; and their number.
    """
    total = scale = 0.0
    n = 0
    for j in ruler.ankles:
        if at_one_m[j, 2] < 0.0:
            total += math.log(-at_one_m[j, 2])
            scale += sigma_scale[j]
            n += 1
    if n == 0:
        return math.nan, 0.0, 0
    return math.exp(total / n), scale / n, n


@inner
def height_share(x, limb_m, ruler):
    """Return how high the limbs from shoulders to ankles are, as a share of their lengths.

    `x` are the joints of one person, (joint, 3), NaN where unknown, and `limb_m` the lengths of its
    limbs, (limb,). NaN where less than half of the limbs, by their lengths, are known.
    """
    high_m = long_m = all_m = 0.0
    for i in range(ruler.limb.shape[0]):
        a, b = ruler.joints[i]
        all_m += limb_m[ruler.limb[i]]
        if not math.isnan(x[a, 2] + x[b, 2]):
            high_m += abs(x[a, 2] - x[b, 2])
            long_m += limb_m[ruler.limb[i]]
    return high_m / long_m if long_m > 0.5 * all_m else math.nan


@inner
def above_ankle_m(cameras, ruler, c, level_m):
    """Return how high a camera is above an ankle that stands on the ground [m]."""
    return cameras.position_m[c, 2] - ruler.ankle_height_m - level_m
