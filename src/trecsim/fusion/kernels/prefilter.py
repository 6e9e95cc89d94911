"""What of an estimator's output is used, and how far it is trusted (thesis section 3.6.5)."""

import math
from typing import no_type_check

from numba import njit

from trecsim.fusion.kernels.undistortion import undistort

# How the noise of a key point grows as its score falls, and by how much at most.
SCORE_POWER, LARGEST_FACTOR = 1.7, 6.0


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def score_to_factor(score, good_score):
    """Return by how much a key point of this score is less certain than a good one.

    Notes
    -----
    The median error of OpenPose on Shelf is 10 px at scores above 0.8, 15 px at 0.6 to 0.8 and
    26 px at 0.4 to 0.6: a power of -1.7.
    """
    if score >= good_score:
        return 1.0
    return min((good_score / max(score, 1e-3)) ** SCORE_POWER, LARGEST_FACTOR)


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def prefilter(xy_px, score, cam, offset, lenses, min_score, good_score, min_joints, factor, kept):
    """Undistort the key points that can be used, blot out the others, drop who has too few left.

    Parameters
    ----------
    xy_px, score
        Raw key points of all images (person, joint, 2), their scores (person, joint); NaN where
        unknown. Undistorted in place, those of the detections that are kept first; what is not to
        be used becomes NaN.
    cam, offset
        Camera of each image (view,), and where its detections begin (view + 1,).
    undistortion
        The `Undistortion` of all cameras.
    min_score, good_score
        Scores below which a key point is not used, and from which on it is as good as it gets.
    min_joints
        Fewest key points that a detection must have left.
    factor
        Result, (person, joint), in the order of `xy_px`: see `score_to_factor`.
    kept
        Result, (view + 1,): `offset` among the detections that are kept.
    """
    n = 0
    kept[0] = 0
    for v in range(cam.shape[0]):
        for d in range(offset[v], offset[v + 1]):
            known = 0
            for j in range(xy_px.shape[1]):
                x, y, trust = math.nan, math.nan, LARGEST_FACTOR
                if score[d, j] >= min_score:
                    x, y = undistort(lenses, cam[v], xy_px[d, j, 0], xy_px[d, j, 1])
                if math.isfinite(x + y):
                    trust = score_to_factor(score[d, j], good_score)
                    known += 1
                else:
                    x = y = math.nan
                xy_px[n, j, 0], xy_px[n, j, 1], factor[n, j] = x, y, trust
            if known >= min_joints:
                n += 1
        kept[v + 1] = n
