"""All tracks that are reported at one time, in one call."""

import numpy as np

from trecsim.compiler import inner, kernel
from trecsim.fusion.kernels.curve import evaluate_all, knots
from trecsim.fusion.kernels.information import covariance_all
from trecsim.fusion.kernels.presence import count_supporting, supporting
from trecsim.fusion.kernels.reported_covariance import report_all, widen_along_rays
from trecsim.fusion.kernels.small_matrices import copy
from trecsim.fusion.kernels.track_groups import Bodies, Sights
from trecsim.fusion.kernels.velocity import velocity_all
from trecsim.fusion.tuning import SAME_S


@kernel(allocates=True)
def snapshot_all(cameras, noise, limbs, who, tracks, bodies, ranges, sights, now, kind, out):
    """Report the tracks that had been born at one time; return how many they are.

    Parameters
    ----------
    cameras, noise, limbs
        Constants: `Cameras`, `Noise` and `Limbs`.
    who, tracks, bodies, ranges
        All tracks: `Who`, `Trajectories`, `Bodies` and `Ranges`; they stay as they are. Those
        without an identity are not reported.
    sights
        `Sights`.
    now
        `Now`: the time of the snapshot, and the knot grid.
    kind
        Whether provisional tracks are reported, too; whether the time is that of the last frame
        set, for which the joints are known already.
    out
        Result: `Reported`, of which the first rows are written.
    """
    provisional, is_newest = kind
    x_m, cov_m2, here = tracks.x_m, tracks.cov_m2, knots(now.t_s, now)
    if not is_newest:
        x_m, cov_m2 = placed(tracks, here)
    n = 0
    for k in range(x_m.shape[0]):
        if not is_reported(who, k, provisional, now.t_s):
            continue
        out.id[n] = who.id[k]
        copy(x_m[k], out.xyz_m[n])
        for j in range(x_m.shape[1]):
            copy(cov_m2[k, j], out.cov_m2[n, j])
        mine, row = slice(k, k + 1), slice(n, n + 1)
        velocity_cov_m2ps2 = out.velocity_cov_m2ps2[row]
        velocity_all(
            tracks.R[mine], tracks.c[mine], here, now.knot_s, out.velocity_mps[row],
            velocity_cov_m2ps2,
        )  # fmt: skip
        seen = Sights(
            sights.newest_s, sights.look_back_s, sights.joint_s[mine], sights.off_m2[mine],
            sights.quality[mine],
        )  # fmt: skip
        body = Bodies(bodies.limb_m[mine], bodies.limb_m2[mine], bodies.level[mine])
        report_all(
            cameras, noise, limbs, body, seen, now.t_s,
            (out.xyz_m[row], out.cov_m2[row], velocity_cov_m2ps2),
        )  # fmt: skip
        if ranges.cam[k] >= 0:
            origin_m = cameras.position_m[ranges.cam[k]]
            widen_along_rays(
                origin_m, ranges.cov[k], out.xyz_m[n], out.cov_m2[n], out.velocity_cov_m2ps2[n]
            )
        count_supporting(seen, now.t_s, out.support[row])
        out.is_supported[n] = any_supported(seen.joint_s[0], now.t_s, seen.look_back_s)
        n += 1
    return n


@inner
def is_reported(who, k, provisional, t_s):
    """Return whether a snapshot at `t_s` reports track `k`."""
    known = who.confirmed[k] or (provisional and who.id[k] >= 0)
    return known and who.born_s[k] <= t_s + SAME_S


@inner(allocates=True)
def placed(tracks, knot_time):
    """Return all joints and their covariances at one time on the knot grid."""
    x_m, times = np.empty((1, *tracks.x_m.shape)), np.empty(1)
    times[0] = knot_time
    evaluate_all(tracks.c, times, x_m)
    cov_m2 = np.empty(tracks.cov_m2.shape)
    covariance_all(tracks.R, knot_time, cov_m2)
    return x_m[0], cov_m2


@inner
def any_supported(joint_s, now_s, look_back_s):
    """Return 1 if a camera has supported any joint lately, else 0."""
    for j in range(joint_s.shape[0]):
        if supporting(joint_s[j], now_s, look_back_s) > 0:
            return 1
    return 0
