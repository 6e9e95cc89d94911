"""Slow and obvious twins of the kernels that measure how far away somebody is."""

import numpy as np

import reference_fusion as reference
from trecsim.fusion import tuning

LOG, RATE, SIZE, LEVEL = range(4)
RATE_S = 0.1


def at_one_m(ray_of, xy_px):
    """Place the joints on the upright plane across the line of sight, 1 m ahead."""
    ray = np.c_[xy_px, np.ones(len(xy_px))] @ ray_of.T
    ray /= np.linalg.norm(ray, axis=1, keepdims=True)
    level = np.nansum(ray[:, :2], axis=0)
    ahead = ray[:, :2] @ (level / np.linalg.norm(level))
    return ray / np.where(ahead > 0.1, ahead, np.nan)[:, None]


def usual_size_m(ruler, plane):
    """Divide usual lengths by lengths at 1 m, of limbs that are not foreshortened."""
    first, second = ruler.joints.T
    length = np.linalg.norm(plane[first] - plane[second], axis=1)
    says_m = ruler.length_m / length
    told_m = np.sort(says_m[np.isfinite(says_m)])
    if len(told_m) < 2:
        return np.nan
    across = says_m <= tuning.FORESHORTENED * told_m[1]
    return ruler.length_m[across].sum() / length[across].sum()


def ankle_drop(ruler, plane, sigma_scale):
    """Average the logarithms of how low the ankles are, and how uncertain they are."""
    below = -plane[ruler.ankles, 2]
    seen = below > 0.0
    if not seen.any():
        return np.nan, 0.0, 0
    return np.exp(np.log(below[seen]).mean()), sigma_scale[ruler.ankles][seen].mean(), seen.sum()


def begun(log_m, level_spread):
    speed = tuning.RANGE_SPEED_MPS * np.exp(-log_m)
    return np.array([log_m, 0.0, 0.0, 0.0]), np.diag(
        [1.0, speed**2, tuning.SIZE_SPREAD**2, level_spread**2]
    )


def moved_on(mean, cov, elapsed_s):
    F = np.eye(4)
    F[LOG, RATE], F[RATE, RATE] = elapsed_s, np.exp(-elapsed_s / tuning.RANGE_MEMORY_S)
    mean = F @ mean
    noise = np.zeros((4, 4))
    noise[RATE, RATE] = tuning.RANGE_ACCEL_M2PS3 * elapsed_s * np.exp(-2.0 * mean[LOG])
    return mean, F @ cov @ F.T + noise


def measured(mean, cov, log_m, var, lasting):
    """Update by Kalman's equations; return whether the measurement was believed, too."""
    if not np.isfinite(log_m):
        return mean, cov, True
    h = np.eye(4)[LOG] + np.eye(4)[lasting]
    off, spread = log_m - h @ mean, h @ cov @ h + var
    if off**2 > tuning.RANGE_GATE**2 * spread:
        return mean, cov, False
    gain = cov @ h / spread
    return mean + gain * off, cov - np.outer(gain, gain) * spread, True


def looked(mean, cov, size_m, drop, above_m, since_s):
    again = max(1.0, tuning.WALK_NOISE_S / max(since_s, 1e-3))
    mean, cov, agrees = measured(mean, cov, np.log(size_m), tuning.SIZE_NOISE**2 * again, SIZE)
    below, scale, n_ankle = drop
    if below > 0.0 and above_m > 0.0:
        step = tuning.STEP_NOISE_M[0 if n_ankle == 1 else 1] * np.exp(-mean[LOG])
        var = ((tuning.SOLE_NOISE_M * scale / above_m) ** 2 + step**2) * again
        mean, cov, more = measured(mean, cov, np.log(above_m / below), var, LEVEL)
        agrees = agrees and more
    return mean, cov, agrees


def anew(mean, cov, log_m, rate, variance, speed_mps):
    mean, cov = mean.copy(), cov.copy()
    mean[[LOG, RATE]] = log_m, rate
    cov[[LOG, RATE]] = 0.0
    cov[:, [LOG, RATE]] = 0.0
    cov[LOG, LOG], cov[RATE, RATE] = variance, (speed_mps * np.exp(-log_m)) ** 2
    return mean, cov


def joints_at(c, knot_time):
    """Evaluate the curves with control points `c` (joint, n)."""
    points = c.reshape(len(c), -1, 3)
    return reference.basis_rows([knot_time], 0.0, 1.0, points.shape[1])[0] @ points


def log_range(c, torso, origin_m, knot_time, knot_s):
    """Return the logarithm of the horizontal distance, and its rate over the last tenth."""
    here, before = (
        np.log(np.linalg.norm((joints_at(c, t)[torso].mean(axis=0) - origin_m)[:2]))
        for t in (knot_time, knot_time - RATE_S / knot_s)
    )
    return here, (here - before) / RATE_S


def relative_variance(x, cov_m2, torso, origin_m):
    way_m = x[torso].mean(axis=0) - origin_m
    return way_m @ cov_m2[torso].mean(axis=0) @ way_m / (way_m @ way_m) ** 2


def moved_along_rays(c, torso, origin_m, log_m, rate, knot_time, knot_s):
    """Return the control points moved from the camera, those of other times by the rate, too."""
    here, rate_here = log_range(c, torso, origin_m, knot_time, knot_s)
    points = c.reshape(len(c), -1, 3)
    since_s = (np.arange(points.shape[1]) - 1.0 - knot_time) * knot_s
    factor = np.exp(np.clip(log_m - here + (rate - rate_here) * since_s, -0.5, 0.5))
    return (origin_m + factor[:, None] * (points - origin_m)).reshape(c.shape)


def height_share(x, limb_m, ruler):
    """Height of the limbs whose ends are known, over their lengths; NaN if less than half are."""
    first, second = ruler.joints.T
    high_m, long_m = np.abs(x[first, 2] - x[second, 2]), limb_m[ruler.limb]
    known = np.isfinite(high_m)
    enough = long_m[known].sum() > 0.5 * long_m.sum()
    return high_m[known].sum() / long_m[known].sum() if enough else np.nan


def known(cameras, ruler, cam, torso, person, body, when, before_m2):
    """Return the filter of somebody whom two cameras have measured until now."""
    (c, x, cov_m2), (limb_m, limb_m2, level), origin_m = person, body, cameras.position_m[cam]
    log_m, rate = log_range(c, torso, origin_m, *when)
    limb_m, limb_m2 = limb_m[ruler.limb], limb_m2[ruler.limb]
    above_m = max(origin_m[2] - ruler.ankle_height_m - level[0], 0.1)
    mean = np.array([log_m, rate, np.log(ruler.length_m / limb_m).mean(), 0.0])
    placed = relative_variance(x, cov_m2, torso, origin_m)
    placed += (tuning.PLACE_SIGMA_M / np.exp(log_m)) ** 2 + before_m2
    size2 = (limb_m2 / limb_m**2).mean() + tuning.KNOWN_SIZE_SPREAD**2
    rate2 = (tuning.KNOWN_RATE_MPS / np.exp(log_m)) ** 2
    level2 = (level[1] + tuning.GROUND_MEASURE_M2) / above_m**2
    return mean, np.diag([placed, rate2, size2, level2])
