"""The values that flow between the stages: frozen, and their arrays read-only by custom.

Axis names are the same everywhere: ``cam frame person joint knot step limb``.
Missing numbers are NaN.
"""

from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Bool, Float64, Int64, Shaped, UInt8

PROVISIONAL, CONFIRMED, COASTING = "provisional", "confirmed", "coasting"
"""States of a person in a `Snapshot`."""
STATES = np.array([COASTING, CONFIRMED])
"""The states by whether any camera supports the person."""
LOOK_DIGITS = 3
"""So many decimals of `Poses2D.pixel_px` are kept, in memory as in files."""


def _not_given() -> np.ndarray:
    return np.empty(0)


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
    size_px
        Width and height of the image as the camera took it [px], where `image` is a smaller one;
        the calibration refers to them.
    """

    camera: str
    index: int
    t_s: float
    image: UInt8[np.ndarray, "h w 3"]
    size_px: tuple[int, int] | None = None

    def __repr__(self) -> str:
        height, width = self.image.shape[:2]
        return (
            f"<Frame {self.index} of {self.camera!r}, t_s={self.t_s:.13g}, {width} x {height} px>"
        )


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
    pixel_px
        Size of a pixel of the network's input where it found the person, in pixels of the image:
        how finely it looked. NaN where that is not known.
    """

    camera: str
    t_s: float
    xy_px: Float64[np.ndarray, "person joint 2"]
    score: Float64[np.ndarray, "person joint"]
    person_score: Float64[np.ndarray, " person"]
    pixel_px: Float64[np.ndarray, " given"] = field(default_factory=_not_given, kw_only=True)

    def __post_init__(self) -> None:
        # Of other people, as after `replace` with fewer or more of them, it is not known.
        if len(self.pixel_px) != len(self.person_score):
            object.__setattr__(self, "pixel_px", np.full(len(self.person_score), np.nan))

    def __repr__(self) -> str:
        found = _count(len(self.xy_px), "person")
        return f"<Poses2D of {self.camera!r}, t_s={self.t_s:.13g}, {found}>"


@dataclass(frozen=True, slots=True, eq=False)
class FrameSet:
    """What the cameras delivered in one window of time; an absent camera is absent.

    Attributes
    ----------
    t_s
        Time of the newest image in the set; of a set without images, the present [s].
    views
        One entry per image, each with its own time; a camera may appear more than once.
    """

    t_s: float
    views: tuple[Poses2D, ...]

    def __repr__(self) -> str:
        cameras = ", ".join(view.camera for view in self.views) or "none"
        found = _count(sum(len(view.xy_px) for view in self.views), "detection")
        return f"<FrameSet t_s={self.t_s:.13g}, cameras: {cameras}; {found}>"


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
        Number of cameras that support the joint now; 0 means that it is predicted only.
    velocity_mps
        Velocity of the joints in the world frame [m/s]; NaN where it is not known, as in
        tracks from CSV files.
    velocity_cov_m2ps2
        Its covariance [m^2/s^2].
    state
        Per person "confirmed", or "coasting" where no camera supports any joint; derived from
        `support` unless given. "provisional" for a track that is not confirmed yet, which live
        sites report and recorded ones do not.

    Examples
    --------
    >>> cov_m2 = np.full((1, 17, 3, 3), 0.01)
    >>> Snapshot(0.5, np.array([7]), np.zeros((1, 17, 3)), cov_m2, np.full((1, 17), 2))
    <Snapshot t_s=0.5, 1 person: 7>
    """

    t_s: float
    id: Int64[np.ndarray, " person"]
    xyz_m: Float64[np.ndarray, "person joint 3"]
    cov_m2: Float64[np.ndarray, "person joint 3 3"]
    support: Int64[np.ndarray, "person joint"]
    velocity_mps: Float64[np.ndarray, "person joint 3"] = field(
        default_factory=_not_given, kw_only=True
    )
    velocity_cov_m2ps2: Float64[np.ndarray, "person joint 3 3"] = field(
        default_factory=_not_given, kw_only=True
    )
    state: Shaped[np.ndarray, " person"] = field(default_factory=_not_given, kw_only=True)

    def __post_init__(self) -> None:
        if self.velocity_mps.ndim != 3:
            object.__setattr__(self, "velocity_mps", np.full(self.xyz_m.shape, np.nan))
        if self.velocity_cov_m2ps2.ndim != 4:
            object.__setattr__(self, "velocity_cov_m2ps2", np.full(self.cov_m2.shape, np.nan))
        if self.state.dtype.kind != "U":
            object.__setattr__(self, "state", STATES.take(self.support.any(axis=1)))

    def __repr__(self) -> str:
        people = ", ".join(map(str, self.id[:_LISTED].tolist()))
        more = ", ..." if len(self.id) > _LISTED else ""
        listed = f": {people}{more}" if people else ""
        return f"<Snapshot t_s={self.t_s:.13g}, {_count(len(self.id), 'person')}{listed}>"

    @property
    def sigma_m(self) -> Float64[np.ndarray, "person joint"]:
        """One standard deviation per joint: root of the mean variance over the axes [m]."""
        sigma: Float64[np.ndarray, "person joint"] = np.sqrt(
            np.trace(self.cov_m2, axis1=-2, axis2=-1) / 3.0
        )
        return sigma

    @property
    def is_confirmed(self) -> Bool[np.ndarray, " person"]:
        """Who is not provisional."""
        known: Bool[np.ndarray, " person"] = self.state != PROVISIONAL
        return known

    def confirmed(self) -> "Snapshot":
        """Return the snapshot without provisional people."""
        known = self.is_confirmed
        return self if known.all() else self.of(known)

    def of(self, which: Bool[np.ndarray, " person"]) -> "Snapshot":
        """Return the snapshot with only the people whom `which` marks."""
        return Snapshot(
            self.t_s, self.id[which], self.xyz_m[which], self.cov_m2[which], self.support[which],
            velocity_mps=self.velocity_mps[which],
            velocity_cov_m2ps2=self.velocity_cov_m2ps2[which],
            state=self.state[which],
        )  # fmt: skip


# So many people are listed by name in a snapshot's short text.
_LISTED = 10


def _count(number: int, what: str) -> str:
    """Return a number of things as one writes it.

    Examples
    --------
    >>> _count(1, "person"), _count(0, "detection")
    ('1 person', '0 detections')
    """
    many = "people" if what == "person" else f"{what}s"
    return f"{number} {what if number == 1 else many}"
