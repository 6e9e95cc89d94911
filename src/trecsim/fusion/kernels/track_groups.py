"""What kernels take together of the tracks: named groups of arrays; see `groups`."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float64, Int64


class Trajectories(NamedTuple):
    """The joints' trajectories, and where they are at the time of the frame set.

    Attributes
    ----------
    R, z, c
        Square-root information of the control points, and these: the solution of ``R c = z``.
    x_m, cov_m2
        Joints and covariances.
    """

    R: Float64[np.ndarray, "track joint n n"]
    z: Float64[np.ndarray, "track joint n"]
    c: Float64[np.ndarray, "track joint n"]
    x_m: Float64[np.ndarray, "track joint 3"]
    cov_m2: Float64[np.ndarray, "track joint 3 3"]


class Bodies(NamedTuple):
    """What is learnt of each person's body.

    Attributes
    ----------
    limb_m, limb_m2
        Lengths of the limbs and their variances.
    level
        Height of the ground under the person, and its variance.
    """

    limb_m: Float64[np.ndarray, "track limb"]
    limb_m2: Float64[np.ndarray, "track limb"]
    level: Float64[np.ndarray, "track 2"]


class Sightings(NamedTuple):
    """When cameras supported the tracks [s].

    Attributes
    ----------
    camera_s, joint_s
        Last time that each camera supported each track, and each joint.
    two_view_s, two_view_duration_s
        Last time that two cameras supported it, and for how long they have, in all.
    mirrored_duration_s
        For how long most cameras have read it with left and right exchanged.
    joint_off_m2, joint_quality
        Squared distance of each camera's newest key point from the joint, at the person's distance
        [m^2], and its measurement information relative to a good one; 0 where there is no key
        point.
    view_off_px
        Mean innovation of the key points of each camera, averaged over time.
    """

    camera_s: Float64[np.ndarray, "track cam"]
    joint_s: Float64[np.ndarray, "track joint cam"]
    two_view_s: Float64[np.ndarray, " track"]
    two_view_duration_s: Float64[np.ndarray, " track"]
    mirrored_duration_s: Float64[np.ndarray, " track"]
    joint_off_m2: Float64[np.ndarray, "track joint cam"]
    joint_quality: Float64[np.ndarray, "track joint cam"]
    view_off_px: Float64[np.ndarray, "track cam 2"]


class Waiting(NamedTuple):
    """Key points of one image per camera and track that wait until the trajectory is smoothed.

    Attributes
    ----------
    t_s, is_pending
        Time of the image [s], and whether it still waits.
    xy_px, weight
        Undistorted key points, and their weight in the fit [1/px^2]; 0 where there is none.
    """

    t_s: Float64[np.ndarray, "track cam"]
    is_pending: Bool[np.ndarray, "track cam"]
    xy_px: Float64[np.ndarray, "track joint cam 2"]
    weight: Float64[np.ndarray, "track joint cam"]


class Doubts(NamedTuple):
    """What speaks against the tracks.

    Attributes
    ----------
    swap_evidence
        Evidence that its detections of two cameras are of two people [log likelihood ratio].
    redundant_count
        Number of checks in which other tracks explain all of its detections.
    other_place
        Evidence that a limb's end is in the other of its two places on the ray of the camera that
        alone sees it [log likelihood ratio].
    """

    swap_evidence: Float64[np.ndarray, " track"]
    redundant_count: Float64[np.ndarray, " track"]
    other_place: Float64[np.ndarray, "track joint"]


class Who(NamedTuple):
    """Whom the tracks follow.

    Attributes
    ----------
    id, born_s, confirmed
        Identity, when the track began [s], and whether it is reported.
    """

    id: Int64[np.ndarray, " track"]
    born_s: Float64[np.ndarray, " track"]
    confirmed: Bool[np.ndarray, " track"]


class Ranges(NamedTuple):
    """Kalman filters of how far people are from the camera that alone sees them.

    Attributes
    ----------
    cam
        That camera; -1 where nothing is measured, as two cameras see the person, or nobody does.
    mean, cov
        Logarithm of the horizontal distance, its rate [1/s], and the lasting relative errors of
        the distances that size and ground tell.
    is_upright
        Whether the person stands or walks, so that the size of the body tells the distance.

    Notes
    -----
    Body and ground are not those that are assumed; both errors last. As they are part of the state,
    its covariance says how far the distance may be off after any time and way. Other errors, of
    gait and posture, last as long as a step.
    """

    cam: Int64[np.ndarray, " track"]
    mean: Float64[np.ndarray, "track 4"]
    cov: Float64[np.ndarray, "track 4 4"]
    is_upright: Bool[np.ndarray, " track"]


class Sights(NamedTuple):
    """How cameras see the joints of the tracks now.

    Attributes
    ----------
    newest_s
        Time of each camera's newest image [s].
    look_back_s
        For how long what each camera supported counts as supported now [s].
    joint_s
        Last time that each camera supported each joint [s].
    off_m2, quality
        See `Sightings`.
    """

    newest_s: Float64[np.ndarray, " cam"]
    look_back_s: Float64[np.ndarray, " cam"]
    joint_s: Float64[np.ndarray, "track joint cam"]
    off_m2: Float64[np.ndarray, "track joint cam"]
    quality: Float64[np.ndarray, "track joint cam"]
