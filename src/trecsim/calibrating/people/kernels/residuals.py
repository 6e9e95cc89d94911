"""What is left of each observation after the adjustment."""

import numpy as np

from trecsim.calibrating.people.kernels.looking import certainty, look, trust
from trecsim.compiler import kernel


@kernel(allocates=True)
def residuals(sights, unknowns, off_m, depth_m, weight):
    """Write what each observation is off by, bias included, its depth and its weight.

    Parameters
    ----------
    sights, unknowns
        `Sights` and `Unknowns`.
    off_m
        (observation, 2), along the camera's axes [m]; changed in place, as are the next two.
    depth_m
        Distance of the point from the camera's plane [m]; -1 behind it.
    weight
        Of the observation in the adjustment, 0 to 1.
    """
    e, by_point, by_own = np.empty(2), np.empty((2, 3)), np.empty((2, 11))
    for s in range(sights.noise_m2.shape[0]):
        for p in range(sights.point_first[s], sights.point_first[s + 1]):
            bias = unknowns.bias_m[sights.block[p]]
            for o in range(sights.first[p], sights.first[p + 1]):
                c = sights.cam[o]
                depth_m[o] = look(sights, unknowns, o, unknowns.xyz_m[p], 8, e, by_point, by_own)
                if depth_m[o] < 0.0:
                    off_m[o, 0] = off_m[o, 1] = weight[o] = 0.0
                    continue
                off_m[o, 0], off_m[o, 1] = e[0], e[1]
                x, y = e[0] - bias[c, 0], e[1] - bias[c, 1]
                sure = certainty(sights, s, o, depth_m[o], 1.0)
                weight[o] = trust((x * x + y * y) * sure)
