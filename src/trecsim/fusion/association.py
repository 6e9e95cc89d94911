"""Association: a mixture model whose components are whole people (thesis eq. 28-33).

A detection belongs to one of the tracks or to clutter. The log likelihood ratio of detection and
track, relative to clutter, sums over the key points, so that the person is the component and not
each type of key point by itself.
"""

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.fusion import kernels
from trecsim.fusion.model import Model
from trecsim.fusion.tuning import GATE_M


def score(
    model: Model,
    cam: int,
    xy_px: Float64[np.ndarray, "person joint 2"],
    factor: Float64[np.ndarray, "person joint"],
    xyz_m: Float64[np.ndarray, "track joint 3"],
    cov_m2: Float64[np.ndarray, "track joint 3 3"],
) -> tuple[Float64[np.ndarray, "track person"], Int64[np.ndarray, "track person"]]:
    """Return log ratio to clutter and mirror state of each detection of a camera and each track."""
    ratio = np.empty((len(xyz_m), len(xy_px)))
    flip = np.empty((len(xyz_m), len(xy_px)), np.int64)
    kernels.score_view(
        model.cameras,
        model.noise,
        cam,
        (xyz_m, cov_m2, np.ones(len(xyz_m))),
        (xy_px, factor),
        GATE_M,
        (ratio, flip),
    )
    return ratio, flip


def away_m(
    model: Model,
    cam: int,
    xyz_m: Float64[np.ndarray, "track joint 3"],
    xy_px: Float64[np.ndarray, "person joint 2"],
) -> Float64[np.ndarray, "person track"]:
    """Return how far the key points of each detection lie from each track on average.

    At the track's distance [m]; infinite where a joint of the track is behind the camera.
    """
    P, focal_px = model.cameras.P[cam], model.cameras.focal_px[cam]
    point = xyz_m @ P[:, :3].T + P[:, 3]
    seen, depth_m = np.isfinite(xy_px[:, None, :, 0]), point[..., 2]
    with np.errstate(divide="ignore", invalid="ignore"):
        off_px = np.linalg.norm(point[..., :2] / depth_m[..., None] - xy_px[:, None], axis=-1)
    off_m = np.where(seen, off_px * depth_m / focal_px, 0.0).sum(axis=-1)
    ahead = ((depth_m > 0.0) | ~seen).all(axis=-1)
    return np.where(ahead, off_m / np.maximum(seen.sum(axis=-1), 1), np.inf)
