"""What is reported of a moment: joints adjusted to the limb lengths, covariances with bias."""

import math

import numpy as np

from trecsim.compiler import inner
from trecsim.fusion.kernels.distance_filter import LOG, RATE
from trecsim.fusion.kernels.ground import raise_to_ground
from trecsim.fusion.kernels.lengths import tighten
from trecsim.fusion.kernels.mixture import project
from trecsim.fusion.kernels.small_matrices import invert3, sandwich3
from trecsim.fusion.kernels.track_groups import Bodies
from trecsim.fusion.tuning import (
    BIAS_WANDER_PER_S,
    FADED_QUALITY,
    NEAR_M,
    SUPPORT_S,
    TWO_PLACES_S,
    UNSEEN_DRIFT_MPS,
    UNSEEN_DRIFT_S,
    UNSEEN_SIGMA_M,
    UNSEEN_SIGMA_MPS,
)


@inner
def bias_information(cameras, noise, j, x, last_s, quality, sights, now_s, info, good, M):
    """Write what the cameras that see a joint say about it, if only lasting errors count.

    Parameters
    ----------
    cameras, noise
        `Cameras` and `Noise`.
    j, x
        The joint and its place, (3,).
    last_s, quality, sights, now_s
        When each camera last supported it, (cam,), the inverse of the noise variance of the key
        point in its newest image relative to a good one, (cam,), 0 if it shows none; `Sights`, and
        the time of what is stated [s].
    info
        Result, the upper triangle of (3, 3) [1/m^2]; singular where fewer than two cameras see the
        joint.
    good
        Result, the same if all key points were good ones.
    M
        Result, (3, 3): information of the calibration's errors in it, ``sum J' W B W J``.
    """
    P, focal_px = cameras.P, cameras.focal_px
    usual_m, share, least_px2 = noise.sigma_m[j], noise.bias_share, noise.floor_px * noise.floor_px
    for p in range(3):
        for q in range(3):
            info[p, q] = good[p, q] = M[p, q] = 0.0
    for c in range(last_s.shape[0]):
        if not last_s[c] > now_s - sights.look_back_s[c]:
            continue
        w, _, _, du, dv = project(P, c, x[0], x[1], x[2])
        if not w > NEAR_M:
            continue
        certainty = min(quality[c], 1.0) if quality[c] > 0.0 else FADED_QUALITY
        good_px = usual_m * focal_px[c] / w
        good_weight = 1.0 / (share * (good_px * good_px + least_px2))
        weight = 1.0 / (share * (good_px * good_px / certainty + least_px2))
        of_camera = weight * weight * cameras.error_px2[c]
        for p in range(3):
            for q in range(3):
                both = du[p] * du[q] + dv[p] * dv[q]
                info[p, q] += weight * both
                good[p, q] += good_weight * both
                M[p, q] += of_camera * both


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
def lasting_error(info, scale, sigma, bounded, bias_m2):
    """Write the covariance of the lasting error of a joint's position or velocity.

    Parameters
    ----------
    info
        See `bias_information`.
    scale
        Standard deviation of the error per metre of lasting error of the position.
    sigma
        Its standard deviation in directions that no camera tells of.
    bounded
        Scratch, (3, 3).
    bias_m2
        Result, (3, 3).
    """
    for p in range(3):
        for q in range(p, 3):
            bounded[p, q] = info[p, q] / (scale * scale)
        bounded[p, p] += 1.0 / (sigma * sigma)
    invert3(bounded, bias_m2)


@inner
def add3(a, b):
    """Add `b` to `a`, both (3, 3), in place."""
    for p in range(3):
        for q in range(3):
            a[p, q] += b[p, q]


@inner
def disagreement_m2(noise, j, sights, k, now_s):
    """Return the variances, per axis, that disagreement about a joint adds [m^2].

    The first is that of cameras that do not agree with the joint, the second of those that do.

    Parameters
    ----------
    noise, j
        `Noise`, and the joint.
    sights, k, now_s
        `Sights`, the track, and the time of what is stated [s].

    Notes
    -----
    Cameras agree with the joint or they do not; either these or those see an outlier, each with the
    probability `outlier_share`. Key points of low score count less. If those that do not agree are
    right, the joint is where they see it. Those that agree may still be further apart than their
    noise: then the mean of them is as uncertain as their spread says.
    """
    newest_s, look_back_s, joint_s, off_m2, quality = sights
    agree = apart = 0.0
    n = 0
    away_m2 = spread_m2 = 0.0
    for c in range(newest_s.shape[0]):
        q = min(quality[k, j, c], 1.0)
        if not q > 0.0 or not newest_s[c] > now_s - look_back_s[c]:
            continue
        if joint_s[k, j, c] >= newest_s[c]:
            agree += q
            n += 1
            spread_m2 += off_m2[k, j, c] - 2.0 * noise.sigma_m[j] ** 2 / q
        else:
            apart += q
            away_m2 += q * off_m2[k, j, c]
    of_mean_m2 = 0.5 * spread_m2 / (n * (n - 1)) if n > 1 and spread_m2 > 0.0 else 0.0
    if not apart > 0.0:
        return 0.0, of_mean_m2
    agree_wrong, apart_wrong = noise.outlier_share**agree, noise.outlier_share**apart
    return 0.5 * agree_wrong / (agree_wrong + apart_wrong) * away_m2 / apart, of_mean_m2


@inner(allocates=True)
def add_other_places(cameras, limbs, limb_m, x, cov_m2, joint_s, now_s):
    """Add the other place of limbs that one camera sees to the covariances of a person, in place.

    Parameters
    ----------
    cameras, limbs, limb_m
        `Cameras`, `Limbs` and the person's lengths (limb,).
    x, cov_m2
        Joints and covariances, (joint, 3) and (joint, 3, 3).
    joint_s, now_s
        When each camera last supported each joint, (joint, cam), and the time of what is stated
        [s].

    Notes
    -----
    The ray of one camera meets the sphere of a limb's length about the limb's other end in two
    places, before and behind that end. Half of their distance is added along the ray, the less the
    shorter it is that a second camera saw the joint; and what is open of the other end, too. The
    joint may lie between the two: across the line of sight a limb's length does not move it.
    """
    ray, added_m2 = np.empty(3), np.empty(x.shape[0])
    for j in range(x.shape[0]):
        added_m2[j] = 0.0
    for i in range(limbs.chain.shape[0]):
        near, far, limb = limbs.chain[i]
        c, second_s = last_two(joint_s[far])
        share = min(max(now_s - SUPPORT_S - second_s, 0.0) / TWO_PLACES_S, 1.0)
        if c < 0 or not share > 0.0:
            continue
        length_m = 0.0
        for p in range(3):
            ray[p] = x[far, p] - cameras.position_m[c, p]
            length_m += ray[p] * ray[p]
        length_m = math.sqrt(length_m)
        along_m = apart_m2 = 0.0
        for p in range(3):
            ray[p] /= length_m
            along_m += ray[p] * (x[far, p] - x[near, p])
            apart_m2 += (x[far, p] - x[near, p]) ** 2
        beside_m2 = apart_m2 - along_m * along_m  # of the near joint, from the ray
        half_m2 = max(limb_m[limb] * limb_m[limb] - beside_m2, along_m * along_m)
        added_m2[far] = share * half_m2 + added_m2[near]
        for p in range(3):
            for q in range(3):
                cov_m2[far, p, q] += added_m2[far] * ray[p] * ray[q]


@inner
def last_two(last_s):
    """Return the camera that supported a joint last, -1 if none, and when a second one did [s]."""
    best, latest, second = -1, -math.inf, -math.inf
    for c in range(last_s.shape[0]):
        if last_s[c] > latest:
            best, latest, second = c, last_s[c], latest
        else:
            second = max(second, last_s[c])
    return best, second


@inner(allocates=True)
def report_all(cameras, noise, limbs, bodies, sights, now_s, joints):
    """Hold everybody's joints by limbs and ground, add lasting errors to covariances, in place.

    Parameters
    ----------
    cameras, noise, limbs, bodies
        `Cameras`, `Noise`, `Limbs` and `Bodies`.
    sights, now_s
        `Sights`, and the time of what is stated [s].
    joints
        Joints, their covariances and those of their velocities as the trajectories have them,
        (track, joint, 3) and (track, joint, 3, 3); changed in place.

    Notes
    -----
    Most of a detector's error is a bias that lasts for seconds. Smoothing does not remove it, and
    no residual shows it, as the trajectory contains it, too; so its covariance is added to what is
    reported, not to the state. The bias also stretches limbs; the joints are adjusted to the limb
    lengths here, where their covariance includes it, as it is for key points of good score. What
    low scores add comes after: it says nothing about the other end of the limb.
    """
    x, cov_m2, velocity_cov_m2ps2 = joints
    joint_s, common_m2 = sights.joint_s, noise.common_m2
    info, good, M = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    bounded, bias_m2, good_m2 = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    later_m2 = np.empty((x.shape[1], 3, 3))
    for k in range(x.shape[0]):
        for j in range(x.shape[1]):
            last_s, quality = joint_s[k, j], sights.quality[k, j]
            bias_information(
                cameras, noise, j, x[k, j], last_s, quality, sights, now_s, info, good, M
            )
            off_m = unseen_sigma_m(last_s, now_s)
            lasting_error(good, 1.0, off_m, bounded, good_m2)
            lasting_error(info, 1.0, off_m, bounded, bias_m2)
            add3(cov_m2[k, j], good_m2)
            sandwich3(bias_m2, M, later_m2[j])
            apart_m2, of_mean_m2 = disagreement_m2(noise, j, sights, k, now_s)
            for p in range(3):
                cov_m2[k, j, p, p] += apart_m2
                later_m2[j, p, p] += of_mean_m2
                for q in range(3):
                    later_m2[j, p, q] += bias_m2[p, q] - good_m2[p, q]
            lasting_error(info, BIAS_WANDER_PER_S, UNSEEN_SIGMA_MPS, bounded, bias_m2)
            add3(velocity_cov_m2ps2[k, j], bias_m2)
        body = Bodies(bodies.limb_m[k], bodies.limb_m2[k], bodies.level[k])
        tighten(x[k], cov_m2[k], limbs, body)
        # A length is linearised about the place that was chosen: it would rule the other one out.
        add_other_places(cameras, limbs, bodies.limb_m[k], x[k], cov_m2[k], joint_s[k], now_s)
        # The error of a camera moves the whole body, and lengths are learnt with what all cameras
        # err in together: they tell nothing about either.
        for j in range(x.shape[1]):
            add3(cov_m2[k, j], later_m2[j])
            for p in range(3):
                cov_m2[k, j, p, p] += common_m2[j]
        raise_to_ground(bodies.level[k], x[k], cov_m2[k])


@inner
def widen_along_rays(origin_m, cov, x, cov_m2, velocity_cov_m2ps2):
    """Add to a person's covariances, in place, how far off it may be along the rays of one camera.

    Parameters
    ----------
    origin_m, cov
        The camera, (3,), and the covariance of the distance's filter, (4, 4).
    x, cov_m2, velocity_cov_m2ps2
        Joints (joint, 3), their covariances and those of their velocities, (joint, 3, 3).

    Notes
    -----
    A distance that is off by a share moves each joint on its ray by that share of its own distance.
    """
    for j in range(x.shape[0]):
        for a in range(3):
            for b in range(3):
                along_m2 = (x[j, a] - origin_m[a]) * (x[j, b] - origin_m[b])
                cov_m2[j, a, b] += cov[LOG, LOG] * along_m2
                velocity_cov_m2ps2[j, a, b] += cov[RATE, RATE] * along_m2
