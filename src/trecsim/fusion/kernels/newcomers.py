"""How far away people are of whom one detection is all that is known."""

import math

from trecsim.compiler import kernel
from trecsim.fusion.kernels.body_size import (
    LEAST_ABOVE_M,
    above_ankle_m,
    ankle_drop,
    upright_plane,
    usual_size_m,
)
from trecsim.fusion.kernels.distance_filter import begin_filter, look


@kernel(allocates=True)
def first_distances(cameras, ruler, cam, points, level, ranges, agrees, at_one_m):
    """Write how far away people are of whom one detection each is known.

    Parameters
    ----------
    cameras, ruler
        `Cameras` and `Ruler`.
    cam, points
        The detections: cameras (person,), key points (person, joint, 2), NaN where unknown, and
        by how much each is less certain than a good one, (person, joint).
    level
        Height of the ground under somebody new, and its variance [m, m^2].
    ranges
        Result: `Ranges`.
    agrees
        Result, (person,): whether all that was told of each distance was believed.
    at_one_m
        Result, (person, joint, 3): see `upright_plane`.
    """
    (xy_px, sigma_scale), (level_m, level_m2) = points, level
    for d in range(cam.shape[0]):
        upright_plane(cameras.ray_of[cam[d]], xy_px[d], at_one_m[d])
        size_m = usual_size_m(ruler, at_one_m[d])
        above_m = above_ankle_m(cameras, ruler, cam[d], level_m)
        spread = math.sqrt(level_m2) / max(above_m, LEAST_ABOVE_M)
        begin_filter(ranges.mean[d], ranges.cov[d], math.log(size_m), spread)
        drop = ankle_drop(ruler, at_one_m[d], sigma_scale[d])
        agrees[d] = math.isfinite(size_m)
        agrees[d] &= look(ranges.mean[d], ranges.cov[d], size_m, drop, above_m, math.inf)
        ranges.cam[d], ranges.is_upright[d] = cam[d], True
