"""Where viewing rays meet: the first guess of all points."""

import numpy as np

from trecsim.calibrating.people.kernels.small import invert_three
from trecsim.compiler import kernel


@kernel(allocates=True)
def meet(first, cam, z, T, xyz_m):
    """Write the point nearest to the viewing rays of each point's observations [m]."""
    A, b, ray = np.empty((3, 3)), np.empty(3), np.empty(3)
    for p in range(xyz_m.shape[0]):
        A[:] = 0.0
        b[:] = 0.0
        for o in range(first[p], first[p + 1]):
            pose = T[cam[o]]
            square = 0.0
            for i in range(3):
                ray[i] = pose[0, i] * z[o, 0] + pose[1, i] * z[o, 1] + pose[2, i]
                square += ray[i] * ray[i]
            for i in range(3):
                for j in range(3):
                    share = (1.0 if i == j else 0.0) - ray[i] * ray[j] / square
                    A[i, j] += share
                    for k in range(3):
                        b[i] -= share * pose[k, j] * pose[k, 3]
        for i in range(3):
            A[i, i] += 1e-6
        invert_three(A)
        for i in range(3):
            xyz_m[p, i] = A[i, 0] * b[0] + A[i, 1] * b[1] + A[i, 2] * b[2]
