"""A frame set as arrays: what the kernels read."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.fusion.settings import FusionSettings
from trecsim.fusion.spline import KnotGrid
from trecsim.geometry import Rig
from trecsim.types import Poses2D


@dataclass(frozen=True, slots=True, eq=False)
class Images:
    """Detections of several images, image after image.

    Attributes
    ----------
    cam, t_s
        Camera (index in the rig) and time of each image.
    offset
        Image ``v`` has the detections ``offset[v] .. offset[v + 1]``.
    xy_px
        Undistorted key points; NaN where missing or not to be used [px].
    score
        Their scores.
    span, weights
        Place of each image on the knot grid.
    """

    cam: Int64[np.ndarray, " view"]
    t_s: Float64[np.ndarray, " view"]
    offset: Int64[np.ndarray, " view_plus_1"]
    xy_px: Float64[np.ndarray, "person joint 2"]
    score: Float64[np.ndarray, "person joint"]
    span: Int64[np.ndarray, " view"]
    weights: Float64[np.ndarray, "view 4"]

    def __len__(self) -> int:
        """Return the number of images."""
        return len(self.cam)

    @property
    def view_of(self) -> Int64[np.ndarray, " person"]:
        """The image each detection comes from."""
        return np.repeat(np.arange(len(self)), np.diff(self.offset))


def prepare(
    views: Sequence[Poses2D], rig: Rig, n_joint: int, grid: KnotGrid, settings: FusionSettings
) -> Images:
    """Undistort the detections of `views`, leave out what cannot be used, and stack them.

    Parameters
    ----------
    views
        Images of known cameras, with times inside the live part of `grid`.
    rig
        The cameras.
    n_joint
        Number of joints of the skeleton.
    grid
        The knot grid, moved on to the newest image.
    settings
        Thresholds of scores and of key points per detection.
    """
    xy_px, score, count = [np.empty((0, n_joint, 2))], [np.empty((0, n_joint))], [0]
    for view in views:
        xy, s = _usable(view, rig, settings)
        xy_px.append(xy)
        score.append(s)
        count.append(len(s))
    places = [grid.locate(view.t_s) for view in views]
    return Images(
        cam=np.array([rig.index(view.camera) for view in views], np.int64),
        t_s=np.array([view.t_s for view in views], np.float64),
        offset=np.cumsum(count),
        xy_px=np.concatenate(xy_px),
        score=np.concatenate(score),
        span=np.array([span for span, _ in places], np.int64),
        weights=np.array([w for _, w in places], np.float64).reshape(-1, 4),
    )


def _usable(
    view: Poses2D, rig: Rig, settings: FusionSettings
) -> tuple[Float64[np.ndarray, "person joint 2"], Float64[np.ndarray, "person joint"]]:
    """Return undistorted key points and scores of the detections worth looking at."""
    xy = np.array(view.xy_px, np.float64)
    score = np.nan_to_num(np.asarray(view.score, np.float64), nan=0.0)
    xy[score < settings.min_score] = np.nan
    if len(xy):
        xy = rig[view.camera].undistort(xy)
        xy[~np.isfinite(xy).all(axis=-1)] = np.nan
    enough = np.isfinite(xy[..., 0]).sum(axis=1) >= settings.min_joints
    return np.ascontiguousarray(xy[enough]), np.ascontiguousarray(score[enough])
