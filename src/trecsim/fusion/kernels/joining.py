"""Which detections of further cameras show somebody whom two cameras have just found."""

import math

import numpy as np

from trecsim.compiler import kernel
from trecsim.fusion.kernels.matching import pair_log_ratio, project_person
from trecsim.fusion.tuning import CANDIDATE_SIGMA_M, GATE_M, JOIN_SCORE, PAIR_MPS


@kernel(allocates=True)
def join_all(cameras, noise, pool, xyz_m, taken_s, free, joined, flip):
    """Write which free detection of each further camera is of the same person, if any is.

    Parameters
    ----------
    cameras, noise
        `Cameras` and `Noise`.
    pool
        The detections: cameras and times (person,), key points (person, joint, 2), NaN where
        unknown, and by how much each is less certain than a good one, (person, joint).
    xyz_m, taken_s
        Joints of the person as two cameras tell, (joint, 3), NaN where unknown, and when [s].
    free
        Which detections are nobody's, (person,).
    joined
        Detection of each camera, (cam,): -1 where one is to be found, and result.
    flip
        Result, (cam,): 1 where that one is read with left and right exchanged.
    """
    cam, t_s, xy_px, sigma_scale = pool
    n_joint = xyz_m.shape[0]
    uv, S, depth_m = np.empty((n_joint, 2)), np.empty((n_joint, 3)), np.empty(n_joint)
    cov_m2 = np.zeros((n_joint, 3, 3))
    for c in range(joined.shape[0]):
        if joined[c] >= 0:
            continue
        camera, best, is_projected = (cameras.focal_px[c], cameras.error_px2[c]), -math.inf, False
        for d in range(cam.shape[0]):
            if cam[d] != c or not free[d]:
                continue
            if not is_projected:
                moved_m = PAIR_MPS * (t_s[d] - taken_s)
                for j in range(n_joint):
                    for a in range(3):
                        cov_m2[j, a, a] = CANDIDATE_SIGMA_M * CANDIDATE_SIGMA_M + moved_m * moved_m
                project_person(cameras.P, cameras.focal_px, c, xyz_m, cov_m2, 1.0, uv, S, depth_m)
                is_projected = True
            ratio, flipped = pair_log_ratio(
                uv, S, depth_m, camera, xy_px[d], sigma_scale[d], noise, GATE_M
            )
            if ratio > best:
                best = ratio
                if ratio >= JOIN_SCORE:
                    joined[c], flip[c] = d, flipped
