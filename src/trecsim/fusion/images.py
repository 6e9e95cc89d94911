"""A frame set as arrays: what the kernels read."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int64

from trecsim.fusion import kernels
from trecsim.fusion.kernels.prefilter import blot_out_twins
from trecsim.fusion.model import Model
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
    factor
        By how much each key point is less certain than a good one.
    """

    cam: Int64[np.ndarray, " view"]
    t_s: Float64[np.ndarray, " view"]
    offset: Int64[np.ndarray, " view_plus_1"]
    xy_px: Float64[np.ndarray, "person joint 2"]
    factor: Float64[np.ndarray, "person joint"]

    def __len__(self) -> int:
        """Return the number of images."""
        return len(self.cam)

    def detections(self, which: Bool[np.ndarray, " person"]) -> "Detections":
        """Return the detections that `which` marks, each by itself."""
        view_of = np.repeat(np.arange(len(self)), np.diff(self.offset))[which]
        return Detections(
            self.cam[view_of], self.t_s[view_of], self.xy_px[which], self.factor[which]
        )


@dataclass(frozen=True, slots=True, eq=False)
class Detections:
    """Detections that belong to nobody, each with the camera and time of its own image.

    Attributes
    ----------
    cam, t_s
        Camera (index in the rig) and time.
    xy_px, factor
        Key points, as for `Images`.
    """

    cam: Int64[np.ndarray, " person"]
    t_s: Float64[np.ndarray, " person"]
    xy_px: Float64[np.ndarray, "person joint 2"]
    factor: Float64[np.ndarray, "person joint"]

    @classmethod
    def nothing(cls, n_joint: int) -> "Detections":
        """Return no detection."""
        return cls(
            np.empty(0, np.int64), np.empty(0), np.empty((0, n_joint, 2)), np.empty((0, n_joint))
        )

    def __len__(self) -> int:
        """Return the number of detections."""
        return len(self.cam)

    def take(self, which: Int64[np.ndarray, " some"] | Bool[np.ndarray, " person"]) -> "Detections":
        """Return the detections `which`."""
        return Detections(self.cam[which], self.t_s[which], self.xy_px[which], self.factor[which])

    def joined(self, other: "Detections") -> "Detections":
        """Return these detections and then those of `other`."""
        return Detections(
            np.concatenate([self.cam, other.cam]),
            np.concatenate([self.t_s, other.t_s]),
            np.concatenate([self.xy_px, other.xy_px]),
            np.concatenate([self.factor, other.factor]),
        )

    def as_images(self) -> Images:
        """Return every detection as an image of its own."""
        return Images(self.cam, self.t_s, np.arange(len(self) + 1), self.xy_px, self.factor)


def prepare(views: Sequence[Poses2D], model: Model) -> Images:
    """Undistort the detections of `views`, leave out what cannot be used or is there twice.

    Parameters
    ----------
    views
        Images of known cameras.
    model
        Constants of the run, among them the thresholds.
    """
    s = model.settings
    cam = [model.cam_of[view.camera] for view in views]
    xy_px = np.concatenate(
        [_undistorted(view, c, model) for view, c in zip(views, cam, strict=True)]
    )
    score = np.concatenate([view.score for view in views]).astype(np.float64, copy=False)
    offset = np.zeros(len(views) + 1, np.int64)
    np.cumsum([len(view.xy_px) for view in views], out=offset[1:])
    factor = np.empty(score.shape)
    fewest = kernels.prefilter(xy_px, score, s.min_score, s.good_score, factor)
    left = blot_out_twins(offset, xy_px, factor)
    if fewest < s.min_joints or left < len(xy_px):
        enough = np.isfinite(xy_px[..., 0]).sum(axis=1) >= s.min_joints
        kept = np.concatenate([[0], np.cumsum(enough)])
        offset, xy_px, factor = kept[offset], xy_px[enough], factor[enough]
    return Images(
        np.array(cam, np.int64), np.array([view.t_s for view in views]), offset, xy_px, factor
    )


def _undistorted(view: Poses2D, cam: int, model: Model) -> Float64[np.ndarray, "person joint 2"]:
    xy_px = np.asarray(view.xy_px, np.float64)
    if not model.distorted[cam] or not len(xy_px):
        return xy_px
    return model.rig.cameras[cam].undistort(xy_px)
