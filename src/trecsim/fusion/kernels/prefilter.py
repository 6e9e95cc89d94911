"""What of an estimator's output is used, and how far it is trusted (thesis section 3.6.5)."""

import math
from typing import no_type_check

from numba import njit

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
def prefilter(xy_px, score, min_score, good_score, factor):
    """Blot out key points that cannot be used, in place; return the fewest a detection has left.

    Parameters
    ----------
    xy_px, score
        Key points (person, joint, 2) and their scores (person, joint); NaN where unknown. What
        is not to be used becomes NaN.
    min_score, good_score
        Scores below which a key point is not used, and from which on it is as good as it gets.
    factor
        Result, (person, joint): see `score_to_factor`.
    """
    fewest = xy_px.shape[1]
    for d in range(xy_px.shape[0]):
        known = 0
        for j in range(xy_px.shape[1]):
            factor[d, j] = LARGEST_FACTOR
            if score[d, j] >= min_score and math.isfinite(xy_px[d, j, 0] + xy_px[d, j, 1]):
                factor[d, j] = score_to_factor(score[d, j], good_score)
                known += 1
            else:
                xy_px[d, j, 0] = xy_px[d, j, 1] = math.nan
        fewest = min(fewest, known)
    return fewest
