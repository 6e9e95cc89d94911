"""A frame set as arrays: what the kernels read."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int64

from trecsim.fusion.settings import FusionSettings
from trecsim.fusion.spline import ORDER, KnotGrid
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
    """

    cam: Int64[np.ndarray, " view"]
    t_s: Float64[np.ndarray, " view"]
    offset: Int64[np.ndarray, " view_plus_1"]
    xy_px: Float64[np.ndarray, "person joint 2"]
    score: Float64[np.ndarray, "person joint"]

    @classmethod
    def nothing(cls, n_joint: int) -> "Images":
        """Return no image at all."""
        return cls(
            np.empty(0, np.int64),
            np.empty(0),
            np.zeros(1, np.int64),
            np.empty((0, n_joint, 2)),
            np.empty((0, n_joint)),
        )

    def __len__(self) -> int:
        """Return the number of images."""
        return len(self.cam)

    @property
    def view_of(self) -> Int64[np.ndarray, " person"]:
        """The image each detection comes from."""
        return np.repeat(np.arange(len(self)), np.diff(self.offset))

    def placed(
        self, grid: KnotGrid
    ) -> tuple[Int64[np.ndarray, " view"], Float64[np.ndarray, "view 4"]]:
        """Return each image's place on the knot grid: span and weights of control points."""
        places = [grid.locate(t) for t in self.t_s]
        return (
            np.array([span for span, _ in places], np.int64),
            np.array([weights for _, weights in places], np.float64).reshape(-1, ORDER),
        )

    def images(self, which: Bool[np.ndarray, " view"]) -> "Images":
        """Return the images that `which` marks, with all their detections."""
        here = which[self.view_of]
        count = np.diff(self.offset)[which]
        return Images(
            self.cam[which],
            self.t_s[which],
            np.concatenate([[0], np.cumsum(count)]),
            self.xy_px[here],
            self.score[here],
        )

    def detections(self, which: Int64[np.ndarray, " some"]) -> "Images":
        """Return the same images with only the detections `which`, given in rising order."""
        count = np.bincount(self.view_of[which], minlength=len(self))
        return Images(
            self.cam,
            self.t_s,
            np.concatenate([[0], np.cumsum(count)]),
            self.xy_px[which],
            self.score[which],
        )

    def joined(self, other: "Images") -> "Images":
        """Return these images and then those of `other`."""
        return Images(
            np.concatenate([self.cam, other.cam]),
            np.concatenate([self.t_s, other.t_s]),
            np.concatenate([self.offset, self.offset[-1] + other.offset[1:]]),
            np.concatenate([self.xy_px, other.xy_px]),
            np.concatenate([self.score, other.score]),
        )


def prepare(views: Sequence[Poses2D], rig: Rig, n_joint: int, settings: FusionSettings) -> Images:
    """Undistort the detections of `views`, leave out what cannot be used, and stack them.

    Parameters
    ----------
    views
        Images of known cameras.
    rig
        The cameras.
    n_joint
        Number of joints of the skeleton.
    settings
        Thresholds of scores and of key points per detection.
    """
    xy_px, score, count = [np.empty((0, n_joint, 2))], [np.empty((0, n_joint))], [0]
    for view in views:
        xy, s = _usable(view, rig, settings)
        xy_px.append(xy)
        score.append(s)
        count.append(len(s))
    return Images(
        cam=np.array([rig.index(view.camera) for view in views], np.int64),
        t_s=np.array([view.t_s for view in views], np.float64),
        offset=np.cumsum(count),
        xy_px=np.concatenate(xy_px),
        score=np.concatenate(score),
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
