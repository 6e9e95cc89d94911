"""What is reported of a moment: joints adjusted to the limb lengths, covariances with bias."""

import math

import numpy as np

from trecsim.compiler import inner
from trecsim.fusion.kernels.groups import Bodies
from trecsim.fusion.kernels.lengths import tighten
from trecsim.fusion.kernels.mixture import project
from trecsim.fusion.kernels.small_matrices import invert3
from trecsim.fusion.tuning import (
    BIAS_WANDER_PER_S,
    NEAR_M,
    SUPPORT_S,
    UNSEEN_DRIFT_MPS,
    UNSEEN_DRIFT_S,
    UNSEEN_SIGMA_M,
    UNSEEN_SIGMA_MPS,
)


@inner
def bias_information(cameras, noise, j, x, last_s, now_s, info):
    """Write what the cameras that see a joint say about it, if only lasting errors count.

    Parameters
    ----------
    cameras, noise
        `Cameras` and `Noise`.
    j, x
        The joint and its place, (3,).
    last_s, now_s
        When each camera last supported it, (cam,), and the time of what is stated [s].
    info
        Result, the upper triangle of (3, 3) [1/m^2]; singular where fewer than two cameras see the
        joint.
    """
    P, focal_px = cameras.P, cameras.focal_px
    usual_m, share, least_px2 = noise.sigma_m[j], noise.bias_share, noise.floor_px * noise.floor_px
    for p in range(3):
        for q in range(p, 3):
            info[p, q] = 0.0
    for c in range(last_s.shape[0]):
        if not last_s[c] > now_s - SUPPORT_S:
            continue
        w, _, _, du, dv = project(P, c, x[0], x[1], x[2])
        if not w > NEAR_M:
            continue
        sigma_px = usual_m * focal_px[c] / w
        var = share * (sigma_px * sigma_px + least_px2)
        for p in range(3):
            for q in range(p, 3):
                info[p, q] += (du[p] * du[q] + dv[p] * dv[q]) / var


@inner
def unseen_sigma_m(last_s, now_s):
    """Return the lasting error of a joint in directions that no camera tells of [m]."""
    latest = second = -math.inf
    for c in range(last_s.shape[0]):
        second = max(second, min(latest, last_s[c]))
        latest = max(latest, last_s[c])
    return UNSEEN_SIGMA_M + UNSEEN_DRIFT_MPS * min(
        max(now_s - SUPPORT_S - second, 0.0), UNSEEN_DRIFT_S
    )


@inner
def widen(cov, info, scale, sigma, bounded, bias_m2):
    """Add the covariance of a lasting error to `cov` (3, 3), in place.

    Parameters
    ----------
    cov
        Of a joint's position or velocity.
    info
        See `bias_information`.
    scale
        Standard deviation of the error per metre of lasting error of the position.
    sigma
        Its standard deviation in directions that no camera tells of.
    bounded, bias_m2
        Scratch, (3, 3).
    """
    for p in range(3):
        for q in range(p, 3):
            bounded[p, q] = info[p, q] / (scale * scale)
        bounded[p, p] += 1.0 / (sigma * sigma)
    invert3(bounded, bias_m2)
    for p in range(3):
        for q in range(3):
            cov[p, q] += bias_m2[p, q]


@inner(allocates=True)
def report_all(cameras, noise, limbs, bodies, joint_s, now_s, joints):
    """Hold everybody's joints by the limbs, and add lasting errors to their covariances, in place.

    Parameters
    ----------
    cameras, noise, limbs, bodies
        `Cameras`, `Noise`, `Limbs` and `Bodies`.
    joint_s, now_s
        When each camera last supported each joint, (track, joint, cam), and the time of what is
        stated [s].
    joints
        Joints, their covariances and those of their velocities as the trajectories have them,
        (track, joint, 3) and (track, joint, 3, 3); changed in place.

    Notes
    -----
    Most of a detector's error is a bias that lasts for seconds. Smoothing does not remove it, and
    no residual shows it, as the trajectory contains it, too; so its covariance is added to what is
    reported, not to the state. The bias also stretches limbs; the joints are adjusted to the limb
    lengths here, where their covariance includes it.
    """
    x, cov_m2, velocity_cov_m2ps2 = joints
    info, bounded, bias_m2 = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    for k in range(x.shape[0]):
        for j in range(x.shape[1]):
            bias_information(cameras, noise, j, x[k, j], joint_s[k, j], now_s, info)
            off_m = unseen_sigma_m(joint_s[k, j], now_s)
            widen(cov_m2[k, j], info, 1.0, off_m, bounded, bias_m2)
            widen(
                velocity_cov_m2ps2[k, j],
                info,
                BIAS_WANDER_PER_S,
                UNSEEN_SIGMA_MPS,
                bounded,
                bias_m2,
            )
        body = Bodies(bodies.limb_m[k], bodies.limb_m2[k], bodies.level[k])
        tighten(x[k], cov_m2[k], limbs, body)
