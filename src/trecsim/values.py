"""The values that flow between the stages: frozen, and their arrays read-only by custom.

Axis names are the same everywhere: ``cam frame person joint knot step limb``.
Missing numbers are NaN.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64, UInt8


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """One image of one camera.

    Attributes
    ----------
    camera
        Name of the camera in the rig.
    index
        Running number of the image in its source, from 0.
    t_s
        When it was taken [s]; Unix time live, any origin in recordings.
    image
        Pixels, RGB.
    """

    camera: str
    index: int
    t_s: float
    image: UInt8[np.ndarray, "h w 3"]


@dataclass(frozen=True, slots=True, eq=False)
class Poses2D:
    """The people found in one image of one camera.

    Attributes
    ----------
    camera
        Name of the camera in the rig.
    t_s
        When the image was taken [s].
    xy_px
        Key points in the raw, still distorted image [px]; NaN where missing.
    score
        The estimator's confidence per key point, 0 to 1; 0 where missing.
    person_score
        The estimator's confidence per person, 0 to 1.
    """

    camera: str
    t_s: float
    xy_px: Float64[np.ndarray, "person joint 2"]
    score: Float64[np.ndarray, "person joint"]
    person_score: Float64[np.ndarray, " person"]


@dataclass(frozen=True, slots=True, eq=False)
class FrameSet:
    """What the cameras delivered in one window of time; an absent camera is absent.

    Attributes
    ----------
    t_s
        Time of the newest image in the set [s].
    views
        One entry per image, each with its own time; a camera may appear more than once.
    """

    t_s: float
    views: tuple[Poses2D, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Snapshot:
    """Where everybody is at one moment.

    Attributes
    ----------
    t_s
        The moment [s].
    id
        Identity per person, never reused for somebody else in a recording.
    xyz_m
        Joints in the world frame [m].
    cov_m2
        Their covariance [m^2].
    support
        Cameras that support the joint now; 0 means it is carried along.
    """

    t_s: float
    id: Int64[np.ndarray, " person"]
    xyz_m: Float64[np.ndarray, "person joint 3"]
    cov_m2: Float64[np.ndarray, "person joint 3 3"]
    support: Int64[np.ndarray, "person joint"]

    @property
    def sigma_m(self) -> Float64[np.ndarray, "person joint"]:
        """One standard deviation per joint: root of the mean variance over the axes [m]."""
        sigma: Float64[np.ndarray, "person joint"] = np.sqrt(
            np.trace(self.cov_m2, axis1=-2, axis2=-1) / 3.0
        )
        return sigma
