"""Everybody who is tracked, as arrays: the state of the fusion."""

from dataclasses import dataclass, fields

import numpy as np
from jaxtyping import Bool, Float64, Int64


@dataclass(slots=True, eq=False)
class Population:
    """The tracked people; the first axis of every array is the track.

    Attributes
    ----------
    R, z
        Square-root information of each joint's live control points.
    c
        The control points themselves: the solution of ``R c = z`` [m].
    x_m, cov_m2
        Joints and their covariances at the time of the last frame set [m, m^2].
    id
        Identity, never reused for somebody else.
    born_s
        When the track began [s].
    confirmed
        Whether it is reported.
    together_s
        For how long two cameras have supported it [s].
    two_s
        When two cameras last supported it [s].
    camera_s
        When each camera last supported the person [s].
    joint_s
        When each camera last supported each joint [s].
    mirrored_s
        For how long most cameras have read the person with left and right exchanged [s].
    crossed
        Evidence that its detections of two cameras are of two people, as log likelihood ratio.
    needless
        At how many looks others could have explained all that is seen of it.
    limb_m, limb_m2
        Distances that the body keeps, as learnt so far, and their variances [m, m^2].
    """

    R: Float64[np.ndarray, "track joint n n"]
    z: Float64[np.ndarray, "track joint n"]
    c: Float64[np.ndarray, "track joint n"]
    x_m: Float64[np.ndarray, "track joint 3"]
    cov_m2: Float64[np.ndarray, "track joint 3 3"]
    id: Int64[np.ndarray, " track"]
    born_s: Float64[np.ndarray, " track"]
    confirmed: Bool[np.ndarray, " track"]
    together_s: Float64[np.ndarray, " track"]
    two_s: Float64[np.ndarray, " track"]
    camera_s: Float64[np.ndarray, "track cam"]
    joint_s: Float64[np.ndarray, "track joint cam"]
    mirrored_s: Float64[np.ndarray, " track"]
    crossed: Float64[np.ndarray, " track"]
    needless: Float64[np.ndarray, " track"]
    limb_m: Float64[np.ndarray, "track limb"]
    limb_m2: Float64[np.ndarray, "track limb"]

    @classmethod
    def nobody(cls, n_joint: int, live: int, n_cam: int, n_limb: int) -> "Population":
        """Return an empty population."""
        n = 3 * live
        return cls(
            R=np.empty((0, n_joint, n, n)),
            z=np.empty((0, n_joint, n)),
            c=np.empty((0, n_joint, n)),
            x_m=np.empty((0, n_joint, 3)),
            cov_m2=np.empty((0, n_joint, 3, 3)),
            id=np.empty(0, np.int64),
            born_s=np.empty(0),
            confirmed=np.empty(0, bool),
            together_s=np.empty(0),
            two_s=np.empty(0),
            camera_s=np.empty((0, n_cam)),
            joint_s=np.empty((0, n_joint, n_cam)),
            mirrored_s=np.empty(0),
            crossed=np.empty(0),
            needless=np.empty(0),
            limb_m=np.empty((0, n_limb)),
            limb_m2=np.empty((0, n_limb)),
        )

    def __len__(self) -> int:
        """Return the number of tracks."""
        return len(self.id)

    def keep(self, which: Bool[np.ndarray, " track"]) -> "Population":
        """Return only the tracks that `which` marks."""
        if np.count_nonzero(which) == len(which):
            return self
        return Population(**{f.name: getattr(self, f.name)[which] for f in fields(self)})

    def joined(self, other: "Population") -> "Population":
        """Return both populations as one."""
        return Population(
            **{
                f.name: np.concatenate([getattr(self, f.name), getattr(other, f.name)])
                for f in fields(self)
            }
        )

    def mirror(self, k: int, mirror: Int64[np.ndarray, " joint"]) -> None:
        """Exchange left and right of track `k`, in place."""
        for values in (self.R, self.z, self.c, self.x_m, self.cov_m2, self.joint_s):
            values[k] = values[k][mirror]
