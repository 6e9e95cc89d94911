"""All tracks as arrays: the state of the fusion."""

from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float64, Int64

from trecsim.fusion.kernels import Bodies, Doubts, Ranges, Sightings, Trajectories, Waiting, Who


@dataclass(eq=False)
class Population:
    """The tracks; the first axis of every array is the track.

    What the arrays hold changes with every frame set; other arrays make another population.

    Attributes
    ----------
    R, z
        Square-root information of each joint's live control points.
    c
        The control points themselves: the solution of ``R c = z`` [m].
    xyz_m, cov_m2
        Joints and their covariances at the time of the last frame set [m, m^2].
    id
        Identity, never reused for somebody else.
    born_s
        When the track began [s].
    confirmed
        Whether it is reported.
    two_view_duration_s
        For how long at least two cameras have supported it, in all [s].
    last_two_view_s
        When two cameras last supported it [s].
    last_seen_s
        When each camera last supported it [s].
    joint_last_seen_s
        When each camera last supported each joint [s].
    mirrored_duration_s
        For how long most cameras have read it with left and right exchanged [s].
    joint_off_m2, joint_quality
        How far each camera's newest key point lies from each joint [m^2], and how good it is.
    view_off_px
        Mean innovation in each camera, averaged over time.
    waiting_s, waiting_is_pending, waiting_px, waiting_weight
        Key points that wait for the trajectory to be smoothed; see `Waiting`.
    swap_evidence
        Evidence that its detections of two cameras are of two people [log likelihood ratio].
    redundant_count
        Number of checks in which other tracks explain all of its detections.
    other_place
        Evidence that a limb's end is in the other of its two places on the ray of the camera that
        alone sees it [log likelihood ratio].
    limb_m, limb_m2
        Learnt distances between the body's joints, and their variances [m, m^2].
    ground_level
        Learnt height of the ground under the person, and its variance [m, m^2].
    range_cam, range_mean, range_cov, range_upright
        How far the person is from the camera that alone sees it; see `Ranges`. The errors of the
        distance are common to all joints, and not in the covariances of the trajectories.
    """

    R: Float64[np.ndarray, "track joint n n"]
    z: Float64[np.ndarray, "track joint n"]
    c: Float64[np.ndarray, "track joint n"]
    xyz_m: Float64[np.ndarray, "track joint 3"]
    cov_m2: Float64[np.ndarray, "track joint 3 3"]
    id: Int64[np.ndarray, " track"]
    born_s: Float64[np.ndarray, " track"]
    confirmed: Bool[np.ndarray, " track"]
    two_view_duration_s: Float64[np.ndarray, " track"]
    last_two_view_s: Float64[np.ndarray, " track"]
    last_seen_s: Float64[np.ndarray, "track cam"]
    joint_last_seen_s: Float64[np.ndarray, "track joint cam"]
    mirrored_duration_s: Float64[np.ndarray, " track"]
    joint_off_m2: Float64[np.ndarray, "track joint cam"]
    joint_quality: Float64[np.ndarray, "track joint cam"]
    view_off_px: Float64[np.ndarray, "track cam 2"]
    waiting_s: Float64[np.ndarray, "track cam"]
    waiting_is_pending: Bool[np.ndarray, "track cam"]
    waiting_px: Float64[np.ndarray, "track joint cam 2"]
    waiting_weight: Float64[np.ndarray, "track joint cam"]
    swap_evidence: Float64[np.ndarray, " track"]
    redundant_count: Float64[np.ndarray, " track"]
    other_place: Float64[np.ndarray, "track joint"]
    limb_m: Float64[np.ndarray, "track limb"]
    limb_m2: Float64[np.ndarray, "track limb"]
    ground_level: Float64[np.ndarray, "track 2"]
    range_cam: Int64[np.ndarray, " track"]
    range_mean: Float64[np.ndarray, "track 4"]
    range_cov: Float64[np.ndarray, "track 4 4"]
    range_upright: Bool[np.ndarray, " track"]

    @cached_property
    def trajectories(self) -> Trajectories:
        """The trajectories, and the joints at the time of the last frame set."""
        return Trajectories(self.R, self.z, self.c, self.xyz_m, self.cov_m2)

    @cached_property
    def bodies(self) -> Bodies:
        """What is learnt of the bodies."""
        return Bodies(self.limb_m, self.limb_m2, self.ground_level)

    @cached_property
    def sightings(self) -> Sightings:
        """When cameras supported the tracks."""
        return Sightings(
            self.last_seen_s, self.joint_last_seen_s, self.last_two_view_s,
            self.two_view_duration_s, self.mirrored_duration_s, self.joint_off_m2,
            self.joint_quality, self.view_off_px,
        )  # fmt: skip

    @cached_property
    def waiting(self) -> Waiting:
        """Key points that wait for the trajectory to be smoothed."""
        return Waiting(
            self.waiting_s, self.waiting_is_pending, self.waiting_px, self.waiting_weight
        )

    @cached_property
    def doubts(self) -> Doubts:
        """What speaks against the tracks."""
        return Doubts(self.swap_evidence, self.redundant_count, self.other_place)

    @cached_property
    def ranges(self) -> Ranges:
        """How far people are from the camera that alone sees them."""
        return Ranges(self.range_cam, self.range_mean, self.range_cov, self.range_upright)

    @cached_property
    def who(self) -> Who:
        """Whom the tracks follow."""
        return Who(self.id, self.born_s, self.confirmed)

    @classmethod
    def empty(cls, n_joint: int, live: int, n_cam: int, n_limb: int) -> "Population":
        """Return an empty population."""
        n = 3 * live
        return cls(
            R=np.empty((0, n_joint, n, n)),
            z=np.empty((0, n_joint, n)),
            c=np.empty((0, n_joint, n)),
            xyz_m=np.empty((0, n_joint, 3)),
            cov_m2=np.empty((0, n_joint, 3, 3)),
            id=np.empty(0, np.int64),
            born_s=np.empty(0),
            confirmed=np.empty(0, bool),
            two_view_duration_s=np.empty(0),
            last_two_view_s=np.empty(0),
            last_seen_s=np.empty((0, n_cam)),
            joint_last_seen_s=np.empty((0, n_joint, n_cam)),
            mirrored_duration_s=np.empty(0),
            joint_off_m2=np.empty((0, n_joint, n_cam)),
            joint_quality=np.empty((0, n_joint, n_cam)),
            view_off_px=np.empty((0, n_cam, 2)),
            waiting_s=np.empty((0, n_cam)),
            waiting_is_pending=np.empty((0, n_cam), bool),
            waiting_px=np.empty((0, n_joint, n_cam, 2)),
            waiting_weight=np.empty((0, n_joint, n_cam)),
            swap_evidence=np.empty(0),
            redundant_count=np.empty(0),
            other_place=np.empty((0, n_joint)),
            limb_m=np.empty((0, n_limb)),
            limb_m2=np.empty((0, n_limb)),
            ground_level=np.empty((0, 2)),
            range_cam=np.empty(0, np.int64),
            range_mean=np.empty((0, 4)),
            range_cov=np.empty((0, 4, 4)),
            range_upright=np.empty(0, bool),
        )

    def __len__(self) -> int:
        """Return the number of tracks."""
        return len(self.id)

    def keep(self, which: Bool[np.ndarray, " track"]) -> "Population":
        """Return only the tracks that `which` marks."""
        if np.count_nonzero(which) == len(which):
            return self
        return Population(*(getattr(self, name)[which] for name in _ARRAYS))

    def joined(self, other: "Population") -> "Population":
        """Return both populations as one."""
        return Population(
            *(np.concatenate([getattr(self, name), getattr(other, name)]) for name in _ARRAYS)
        )

    def mirror(self, k: int, mirror: Int64[np.ndarray, " joint"]) -> None:
        """Exchange left and right of track `k`, in place."""
        for values in (
            self.R, self.z, self.c, self.xyz_m, self.cov_m2, self.joint_last_seen_s,
            self.joint_off_m2, self.joint_quality, self.waiting_px, self.waiting_weight,
            self.other_place,
        ):  # fmt: skip
            values[k] = values[k][mirror]


_ARRAYS = tuple(field.name for field in fields(Population))
