"""The two places of a limb's end that one camera alone sees: its ray meets the sphere twice."""

import math

import numpy as np

from trecsim.compiler import inner
from trecsim.fusion.kernels.anatomy import Moment, move_joint, workspace
from trecsim.fusion.kernels.curve import knots, locate
from trecsim.fusion.kernels.information import right_side
from trecsim.fusion.kernels.reported_covariance import last_two
from trecsim.fusion.kernels.track_groups import Trajectories
from trecsim.fusion.kernels.usual_directions import usual_direction
from trecsim.fusion.tuning import (
    GROUND_MEASURE_M2,
    PLACE_S,
    PLACE_SURE,
    PLACES_APART_M,
    SUPPORT_S,
)


@inner(allocates=True)
def choose_places(cameras, postures, contact_height_m, tracks, level, sights, now, white_share):
    """Move limbs' ends that one camera sees to their other place where postures say so, in place.

    Parameters
    ----------
    cameras, postures, contact_height_m
        `Cameras`, `Postures`, and the height of each joint when the body rests on it, (joint,) [m].
    tracks, level
        `Trajectories` at the time of the frame set, changed in place; height of the ground under
        each person and its variance, (track, 2).
    sights
        When each camera last supported each joint, (track, joint, cam) [s]; how many do now,
        (track, joint); and, changed in place, the log likelihood ratio of the other place of each
        joint to the one it is in, averaged over time, (track, joint).
    now, white_share
        `Now`, and see `Moment`.

    Notes
    -----
    The ray of the camera meets the sphere of the limb's length about its near end before and behind
    that end. The image is the same. Where the limb points, relative to the trunk and to the limb
    above, follows a von Mises-Fisher distribution whose mean depends on the limb above: knees and
    elbows bend one way. A place below the ground is less likely. The log likelihood ratio is
    averaged over `PLACE_S`, since errors of consecutive frame sets are correlated; above
    `PLACE_SURE` the joint is moved, and its trajectory with it.
    """
    if postures.trunk.shape[0] == 0:
        return
    R, z, c, x, cov_m2 = tracks
    joint_s, n_seen, other_place = sights
    n, weights = R.shape[2], np.empty(4)
    tmp, span = workspace(n), locate(knots(now.t_s, now), n // 3, weights)
    moment = Moment(span, weights, white_share, 0.0)
    axes, mean, shift_m = np.empty((3, 3)), np.empty(3), np.empty(3)
    memory = math.exp(-now.elapsed_s / PLACE_S)
    for k in range(x.shape[0]):
        for i in range(postures.joints.shape[0]):
            far = postures.joints[i, 0]
            camera, second_s = last_two(joint_s[k, far])
            if n_seen[k, far] > 1 or camera < 0 or second_s > now.t_s - SUPPORT_S:
                other_place[k, far] = 0.0
                continue
            other_place[k, far] *= memory
            if n_seen[k, far] < 1:
                continue
            apart_m = other_place_of(x[k], postures, i, cameras.position_m[camera], shift_m)
            if not apart_m > PLACES_APART_M:
                continue
            usual_direction(x[k], postures, i, axes, mean)
            ratio = log_ratio(x[k], postures, i, mean, shift_m)
            height_m = x[k, far, 2] - level[k, 0] - contact_height_m[far]
            ratio += below_ground(height_m + shift_m[2], level[k, 1])
            ratio -= below_ground(height_m, level[k, 1])
            other_place[k, far] += (1.0 - memory) * ratio
            if other_place[k, far] > PLACE_SURE:
                joint = Trajectories(R[k, far], z[k, far], c[k, far], x[k, far], cov_m2[k, far])
                move_joint(joint, shift_m, moment, tmp)
                right_side(R[k, far], c[k, far], z[k, far])
                other_place[k, far] *= -1.0


@inner
def other_place_of(x, postures, i, origin_m, shift_m):
    """Write the way to the other place of limb `i`'s end to `shift_m` (3,); return its length.

    `x` are a person's joints, (joint, 3), `origin_m` is the camera's place, (3,), both in [m].
    """
    far, near, _ = postures.joints[i]
    length_m = along_m = 0.0
    for p in range(3):
        shift_m[p] = x[far, p] - origin_m[p]
        length_m += shift_m[p] * shift_m[p]
    length_m = math.sqrt(length_m)
    for p in range(3):
        shift_m[p] /= length_m
        along_m += shift_m[p] * (x[near, p] - x[far, p])
    for p in range(3):
        shift_m[p] *= 2.0 * along_m
    return 2.0 * abs(along_m)


@inner
def log_ratio(x, postures, i, mean, shift_m):
    """Return the log likelihood ratio of the other place of limb `i`'s end to the present one.

    `x` are a person's joints, (joint, 3) [m], `mean` is what `usual_direction` writes, `shift_m`
    the way to the other place, (3,) [m].
    """
    far, near, _ = postures.joints[i]
    length_m = other_m = 0.0
    for p in range(3):
        length_m += (x[far, p] - x[near, p]) ** 2
        other_m += (x[far, p] + shift_m[p] - x[near, p]) ** 2
    length_m, other_m = max(math.sqrt(length_m), 1e-6), max(math.sqrt(other_m), 1e-6)
    ratio = 0.0
    for p in range(3):
        now = (x[far, p] - x[near, p]) / length_m
        then = (x[far, p] + shift_m[p] - x[near, p]) / other_m
        ratio += mean[p] * (then - now)
    return ratio


@inner
def below_ground(height_m, var):
    """Return the log likelihood of a height [m] above where the joint rests on the ground.

    `var` is the variance of the ground's height [m^2].
    """
    depth_m = min(height_m, 0.0)
    return -0.5 * depth_m * depth_m / (var + GROUND_MEASURE_M2)
