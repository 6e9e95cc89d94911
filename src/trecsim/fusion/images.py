"""A frame set as arrays for the kernels."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate

import numpy as np
from jaxtyping import Bool, Float64, Int64

from trecsim.errors import InputError
from trecsim.fusion import kernels
from trecsim.fusion.kernels import Measurements
from trecsim.fusion.model import Model
from trecsim.values import Poses2D


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
    sigma_scale
        Standard deviation of each key point, relative to that of a good one.
    """

    cam: Int64[np.ndarray, " view"]
    t_s: Float64[np.ndarray, " view"]
    offset: Int64[np.ndarray, " view_plus_1"]
    xy_px: Float64[np.ndarray, "person joint 2"]
    sigma_scale: Float64[np.ndarray, "person joint"]

    def __len__(self) -> int:
        """Return the number of images."""
        return len(self.cam)

    @property
    def measurements(self) -> Measurements:
        """The detections as the kernels take them."""
        return Measurements(self.cam, self.offset, self.xy_px, self.sigma_scale)

    @property
    def view_of(self) -> Int64[np.ndarray, " person"]:
        """The image of each detection."""
        return np.repeat(np.arange(len(self)), np.diff(self.offset))

    def detections(
        self, which: Bool[np.ndarray, " person"], claim: Int64[np.ndarray, " person"] | None = None
    ) -> "Detections":
        """Return the detections that `which` marks, without their images.

        `claim` tells of all detections which track of a single camera they support: none, unless
        it is given.
        """
        if claim is None:
            claim = np.full(len(which), -1)
        view_of = self.view_of[which]
        return Detections(
            self.cam[view_of], self.t_s[view_of], self.xy_px[which], self.sigma_scale[which],
            claim[which],
        )  # fmt: skip

    def only(self, which: Bool[np.ndarray, " person"]) -> "Images":
        """Return the same images with only the detections that `which` marks."""
        offset = np.concatenate([[0], np.cumsum(which)])[self.offset]
        return Images(self.cam, self.t_s, offset, self.xy_px[which], self.sigma_scale[which])


@dataclass(frozen=True, slots=True, eq=False)
class Detections:
    """Unassigned detections, each with the camera and time of its image.

    Attributes
    ----------
    cam, t_s
        Camera (index in the rig) and time.
    xy_px, sigma_scale
        Key points, as for `Images`.
    claim
        Which track of a single camera each supports; see `SingleViews`.
    """

    cam: Int64[np.ndarray, " person"]
    t_s: Float64[np.ndarray, " person"]
    xy_px: Float64[np.ndarray, "person joint 2"]
    sigma_scale: Float64[np.ndarray, "person joint"]
    claim: Int64[np.ndarray, " person"]

    @classmethod
    def nothing(cls, n_joint: int) -> "Detections":
        """Return no detection."""
        return cls(
            np.empty(0, np.int64), np.empty(0), np.empty((0, n_joint, 2)), np.empty((0, n_joint)),
            np.empty(0, np.int64),
        )  # fmt: skip

    def __len__(self) -> int:
        """Return the number of detections."""
        return len(self.cam)

    def take(self, which: Int64[np.ndarray, " some"] | Bool[np.ndarray, " person"]) -> "Detections":
        """Return the detections `which`."""
        return Detections(
            self.cam[which], self.t_s[which], self.xy_px[which], self.sigma_scale[which],
            self.claim[which],
        )  # fmt: skip

    def best(self, most: int) -> Int64[np.ndarray, " some"]:
        """Return the rows, in order, of the `most` detections with the most information."""
        if len(self) <= most:
            return np.arange(len(self))
        information = (np.isfinite(self.xy_px[..., 0]) / self.sigma_scale).sum(axis=1)
        return np.sort(np.argsort(-information, kind="stable")[:most])

    def still_open(
        self, cam: Int64[np.ndarray, " view"], since_s: Float64[np.ndarray, " cam"]
    ) -> "Detections":
        """Return those of cameras other than `cam`, which have newer images.

        Those of each camera of the rig count that were taken at `since_s` or later.
        """
        again = set(cam.tolist())
        other = [c not in again for c in self.cam.tolist()]
        return self.take(np.array(other, bool) & (self.t_s >= since_s[self.cam]))

    def joined(self, other: "Detections") -> "Detections":
        """Return these detections and then those of `other`."""
        return Detections(
            np.concatenate([self.cam, other.cam]),
            np.concatenate([self.t_s, other.t_s]),
            np.concatenate([self.xy_px, other.xy_px]),
            np.concatenate([self.sigma_scale, other.sigma_scale]),
            np.concatenate([self.claim, other.claim]),
        )

    def as_images(self) -> tuple[Images, Int64[np.ndarray, " person"]]:
        """Return the images of the detections, and the row of each detection in them."""
        order = np.lexsort((self.t_s, self.cam))
        cam, t_s = self.cam[order], self.t_s[order]
        starts = np.flatnonzero((np.diff(cam, prepend=-1) != 0) | (np.diff(t_s, prepend=0.0) != 0))
        row_of = np.empty(len(order), np.int64)
        row_of[order] = np.arange(len(order))
        return Images(
            cam[starts], t_s[starts], np.append(starts, len(order)), self.xy_px[order],
            self.sigma_scale[order],
        ), row_of  # fmt: skip


def cameras(views: Sequence[Poses2D], model: Model) -> list[int]:
    """Return the camera of each view (index in the rig).

    Raises
    ------
    InputError
        A view has other joints than the model, or no time.
    CalibrationError
        There is no such camera.
    """
    n_joint = len(model.skeleton.joints)
    for view in views:
        if view.xy_px.shape[1:] != (n_joint, 2) or not math.isfinite(view.t_s):
            raise InputError(
                f"camera {view.camera!r}: expected poses of {n_joint} joints at a finite time, "
                f"found {view.xy_px.shape[1]} joints at t_s = {view.t_s}"
            )
        if view.score.shape != view.xy_px.shape[:2]:
            raise InputError(
                f"camera {view.camera!r}: expected a score for each of {view.xy_px.shape[:2]} "
                f"people and key points, found {view.score.shape}"
            )
    index = model.cam_of
    return [
        index[view.camera] if view.camera in index else model.rig.index(view.camera)
        for view in views
    ]


def prepare(views: Sequence[Poses2D], model: Model) -> Images:
    """Undistort the detections of `views`; discard unusable ones and duplicates.

    Parameters
    ----------
    views
        Images of known cameras.
    model
        Constants of the run, among them lenses and thresholds.
    """
    s = model.settings
    cam = np.array([model.cam_of[view.camera] for view in views], np.int64)
    t_s = np.array([view.t_s for view in views], np.float64)
    offset = np.array([0, *accumulate(len(view.xy_px) for view in views)], np.int64)
    # Into C order: of views that lie otherwise in memory, the kernels would be compiled again.
    xy_px = np.empty((offset[-1], len(model.skeleton.joints), 2))
    score, pixel_px = np.empty(xy_px.shape[:2]), np.empty(len(xy_px))
    if views:
        np.concatenate([view.xy_px for view in views], out=xy_px)
        np.concatenate([view.score for view in views], out=score)
        np.concatenate([view.pixel_px for view in views], out=pixel_px)
    factor, kept = np.empty(score.shape), np.empty_like(offset)
    kernels.prefilter(
        xy_px, score, pixel_px, cam, offset, model.undistortion, s.min_score, s.good_score,
        s.min_joints, factor, kept,
    )  # fmt: skip
    n = kept[-1]
    return Images(cam, t_s, kept, xy_px[:n], factor[:n])
