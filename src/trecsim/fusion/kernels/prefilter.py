"""What of an estimator's output is used, and how far it is trusted (thesis section 3.6.5)."""

import math

import numpy as np

from trecsim.compiler import inner, kernel
from trecsim.fusion.kernels.undistortion_kernels import undistort
from trecsim.fusion.tuning import (
    COARSE_VARIANCE,
    DUPLICATE_JOINTS,
    DUPLICATE_SHARE,
    FAR_PX,
    FINE_PIXEL_SHARE,
    LARGEST_SIGMA_SCALE,
    SCORE_POWER,
)


@inner
def score_to_sigma_scale(score, good_score):
    """Return by how much a key point of this score is less certain than a good one.

    Notes
    -----
    The median error of OpenPose on Shelf is 10 px at scores above 0.8, 15 px at 0.6 to 0.8 and
    26 px at 0.4 to 0.6: a power of -1.7.
    """
    if score >= good_score:
        return 1.0
    return min((good_score / max(score, 1e-3)) ** SCORE_POWER, LARGEST_SIGMA_SCALE)


@inner
def look_to_sigma_scale(pixel_px, size_px):
    """Return by how much the key points of a person are less certain for a coarse look.

    Parameters
    ----------
    pixel_px
        Size of a pixel of the network's input in the image [px]; NaN where it is not known, which
        counts as fine.
    size_px
        The larger side of the box around the person's key points [px].
    """
    share = pixel_px / max(size_px, 1.0) / FINE_PIXEL_SHARE
    if not share > 1.0:
        return 1.0
    return min(math.sqrt(1.0 + COARSE_VARIANCE * (share * share - 1.0)), LARGEST_SIGMA_SCALE)


@kernel
def prefilter(
    xy_px, score, pixel_px, cam, offset, undistortion, min_score, good_score, min_joints,
    sigma_scale, kept,
):  # fmt: skip
    """Undistort the key points of all images, and drop what cannot be used or is there twice.

    Parameters
    ----------
    xy_px, score
        Raw key points (person, joint, 2) and their scores (person, joint); NaN where unknown. In
        place, the detections that are kept come first, undistorted, NaN where not to be used.
    pixel_px
        How finely each person was looked at, (person,): see `look_to_sigma_scale`.
    cam, offset
        Camera of each image (view,), and where its detections begin (view + 1,).
    undistortion
        The `Undistortion` of all cameras.
    min_score, good_score
        Scores below which a key point is not used, and from which on it is as good as it gets.
    min_joints
        Fewest key points that a detection must have left.
    sigma_scale
        Result, (person, joint), in the order of `xy_px`: the product of `score_to_sigma_scale` and
        `look_to_sigma_scale`.
    kept
        Result, (view + 1,): `offset` among the detections that are kept.
    """
    for v in range(cam.shape[0]):
        undistort(undistortion, cam[v], xy_px[offset[v] : offset[v + 1]])
        for d in range(offset[v], offset[v + 1]):
            for j in range(xy_px.shape[1]):
                sigma_scale[d, j] = LARGEST_SIGMA_SCALE
                near = abs(xy_px[d, j, 0]) < FAR_PX and abs(xy_px[d, j, 1]) < FAR_PX
                if near and score[d, j] >= min_score:
                    sigma_scale[d, j] = score_to_sigma_scale(score[d, j], good_score)
                else:
                    xy_px[d, j, 0] = xy_px[d, j, 1] = math.nan
            coarseness = look_to_sigma_scale(pixel_px[d], extent_px(xy_px[d]))
            for j in range(xy_px.shape[1]):
                sigma_scale[d, j] *= coarseness
    suppress_duplicates(offset, xy_px, sigma_scale)
    close_up(xy_px, sigma_scale, offset, min_joints, kept)


@inner
def close_up(xy_px, sigma_scale, offset, min_joints, kept):
    """Move the detections that have so many key points to the front, in place; see `prefilter`."""
    n = 0
    kept[0] = 0
    for v in range(offset.shape[0] - 1):
        for d in range(offset[v], offset[v + 1]):
            known = 0
            for j in range(xy_px.shape[1]):
                known += not math.isnan(xy_px[d, j, 0])
                xy_px[n, j, 0], xy_px[n, j, 1] = xy_px[d, j, 0], xy_px[d, j, 1]
                sigma_scale[n, j] = sigma_scale[d, j]
            n += known >= min_joints
        kept[v + 1] = n


@inner(allocates=True)
def suppress_duplicates(offset, xy_px, sigma_scale):
    """Suppress duplicate detections, in place; return how many detections are left.

    Parameters
    ----------
    offset
        Image ``v`` has the detections ``offset[v] .. offset[v + 1]``.
    xy_px, sigma_scale
        Key points (person, joint, 2), NaN where unknown, and by how much each is less certain
        than a good one, (person, joint). Of two duplicates the more certain one stays.
    """
    total_weight = np.empty(xy_px.shape[0])
    for d in range(xy_px.shape[0]):
        total_weight[d] = 0.0
        for j in range(xy_px.shape[1]):
            if not math.isnan(xy_px[d, j, 0]):
                total_weight[d] += 1.0 / sigma_scale[d, j]
    left = xy_px.shape[0]
    for v in range(offset.shape[0] - 1):
        for d in range(offset[v], offset[v + 1]):
            reach_px = DUPLICATE_SHARE * extent_px(xy_px[d])
            for e in range(d + 1, offset[v + 1]):
                if (
                    total_weight[d] == 0.0
                    or total_weight[e] == 0.0
                    or not are_duplicates(xy_px[d], xy_px[e], reach_px)
                ):
                    continue
                gone = d if total_weight[e] > total_weight[d] else e
                total_weight[gone] = 0.0
                left -= 1
                for j in range(xy_px.shape[1]):
                    xy_px[gone, j, 0] = xy_px[gone, j, 1] = math.nan
    return left


@inner
def extent_px(xy_px):
    """Return the larger side of the box around the known key points of one detection."""
    extent = 0.0
    for a in range(2):
        low, high = math.inf, -math.inf
        for j in range(xy_px.shape[0]):
            if not math.isnan(xy_px[j, a]):
                low, high = min(low, xy_px[j, a]), max(high, xy_px[j, a])
        extent = max(extent, high - low)
    return extent


@inner
def are_duplicates(one_px, other_px, reach_px):
    """Return whether two detections have enough key points in common, all in one place."""
    common = 0
    for j in range(one_px.shape[0]):
        if math.isnan(one_px[j, 0]) or math.isnan(other_px[j, 0]):
            continue
        common += 1
        for a in range(2):
            if abs(one_px[j, a] - other_px[j, a]) > reach_px:
                return False
    return common >= DUPLICATE_JOINTS
