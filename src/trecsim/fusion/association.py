"""Who is who: the mixture whose components are whole people (thesis eq. 28-33).

A detection of a camera belongs to one of the people or to clutter. The log likelihood ratio of
detection and person, relative to clutter, sums over the key points, so that a person is the
component and not each type of key point by itself.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.fusion import kernels
from trecsim.fusion.images import Images
from trecsim.fusion.model import Model

# Errors of a detection's key points hang together, so 17 of them are worth about a third.
_TEMPER = 3.0
_REACH_M = 0.8


@dataclass(frozen=True, slots=True, eq=False)
class Association:
    """Which detection of each image belongs to which track.

    Attributes
    ----------
    match
        Index of the detection among all of the images, or -1.
    flip
        1 where it must be read with left and right exchanged.
    responsibility
        How surely it belongs to the track, 0 to 1.
    """

    match: Int64[np.ndarray, "track view"]
    flip: Int64[np.ndarray, "track view"]
    responsibility: Float64[np.ndarray, "track view"]


def responsibilities(
    log_ratio: Float64[np.ndarray, "track person"],
) -> Float64[np.ndarray, "track person"]:
    """Return each track's responsibility for each detection, next to clutter (thesis eq. 33).

    Parameters
    ----------
    log_ratio
        Log likelihood ratio to clutter; -inf where a pair is out of the question.

    Notes
    -----
    Log-sum-exp over the people and clutter, whose log ratio is 0 (thesis eq. 25-26).

    Examples
    --------
    >>> responsibilities(np.array([[0.0, 30.0], [-np.inf, 30.0]])).round(3)
    array([[0.5, 0.5],
           [0. , 0.5]])
    """
    top = log_ratio.max(axis=0, initial=0.0)
    share = np.exp(log_ratio - top)
    return np.asarray(share / (share.sum(axis=0) + np.exp(-top)))


def assign(
    log_ratio: Float64[np.ndarray, "track person"],
) -> Int64[np.ndarray, " track"]:
    """Return for each track the detection that makes the sum of log ratios largest, or -1.

    Examples
    --------
    >>> assign(np.array([[5.0, 4.0], [4.5, -1.0], [-3.0, -3.0]]))
    array([ 1,  0, -1])
    """
    best = np.full(len(log_ratio), -1, np.int64)
    if log_ratio.size == 0:
        return best
    wanted = log_ratio > 0.0
    rows = np.flatnonzero(wanted.sum(axis=1) == 1)
    columns = wanted[rows].argmax(axis=1)
    alone = wanted.sum(axis=0)[columns] == 1
    best[rows[alone]] = columns[alone]
    # Only where claims meet is there anything to weigh.
    row = np.flatnonzero(wanted.any(axis=1) & (best < 0))
    column = np.setdiff1d(np.flatnonzero(wanted.any(axis=0)), best)
    if len(row) and len(column):
        part = np.empty(len(row), np.int64)
        kernels.assign(np.ascontiguousarray(log_ratio[np.ix_(row, column)]), part)
        best[row[part >= 0]] = column[part[part >= 0]]
    return best


def associate(
    model: Model,
    images: Images,
    xyz_m: Float64[np.ndarray, "view track joint 3"],
    cov_m2: Float64[np.ndarray, "track joint 3 3"],
) -> Association:
    """Assign the detections of every image to the tracks.

    Parameters
    ----------
    model
        Constants of the run.
    images
        The frame set.
    xyz_m, cov_m2
        Predicted joints at each image's time, and their covariance.
    """
    n_track = len(cov_m2)
    match = np.full((n_track, len(images)), -1, np.int64)
    flip = np.zeros((n_track, len(images)), np.int64)
    sure = np.zeros((n_track, len(images)))
    tracks = np.arange(n_track)
    for v in range(len(images)):
        first, last = images.offset[v], images.offset[v + 1]
        if first == last or n_track == 0:
            continue
        ratio, mirrored = score(model, images, v, xyz_m[v], cov_m2)
        best = assign(ratio)
        found = tracks[best >= 0]
        match[found, v] = first + best[found]
        flip[found, v] = mirrored[found, best[found]]
        sure[found, v] = responsibilities(ratio / _TEMPER)[found, best[found]]
    return Association(match, flip, sure)


def score(
    model: Model,
    images: Images,
    view: int,
    xyz_m: Float64[np.ndarray, "track joint 3"],
    cov_m2: Float64[np.ndarray, "track joint 3 3"],
) -> tuple[Float64[np.ndarray, "track person"], Int64[np.ndarray, "track person"]]:
    """Return log ratio to clutter and mirror state of one image's detections for every track."""
    first, last = images.offset[view], images.offset[view + 1]
    cam = images.cam[view]
    ratio = np.empty((len(xyz_m), last - first))
    flip = np.empty((len(xyz_m), last - first), np.int64)
    kernels.score_view(
        model.P[cam],
        model.focal_px[cam],
        xyz_m,
        cov_m2,
        images.xy_px[first:last],
        images.score[first:last],
        model.noise,
        _REACH_M,
        ratio,
        flip,
    )
    return ratio, flip
