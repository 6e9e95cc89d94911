"""What kernels take together: named groups of arrays.

A group of all tracks has the track as the first axis of its arrays. Kernels hand on the part of one
track, or of one joint, as a group of the same name without the leading axes.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float64, Int64


class Cameras(NamedTuple):
    """The cameras of a rig.

    Attributes
    ----------
    P, focal_px
        Projections for undistorted pixels, and mean focal lengths [px].
    ray_of, position_m
        Matrix that turns a pixel into the direction of its viewing ray, and where the ray starts.
    error_px2
        Variance of the calibration's error in the image, per axis [px^2]: it lasts, and it is
        common to all that the camera sees.
    """

    P: Float64[np.ndarray, "cam 3 4"]
    focal_px: Float64[np.ndarray, " cam"]
    ray_of: Float64[np.ndarray, "cam 3 3"]
    position_m: Float64[np.ndarray, "cam 3"]
    error_px2: Float64[np.ndarray, " cam"]


class Measurements(NamedTuple):
    """The detections of a frame set, image after image.

    Attributes
    ----------
    cam
        Camera of each image.
    offset
        Image ``v`` has the detections ``offset[v] .. offset[v + 1]``.
    xy_px
        Undistorted key points; NaN where missing or not to be used.
    sigma_scale
        Standard deviation of each key point, relative to that of a good one.
    """

    cam: Int64[np.ndarray, " view"]
    offset: Int64[np.ndarray, " view_plus_1"]
    xy_px: Float64[np.ndarray, "person joint 2"]
    sigma_scale: Float64[np.ndarray, "person joint"]


class Prediction(NamedTuple):
    """Predicted joints of all tracks in each image of a frame set.

    Attributes
    ----------
    knot_time, now
        Times of the images and of the frame set [knots].
    xyz_m
        Joints at each image's own time.
    cov_m2
        Their covariance at the frame set's time.
    slack
        How much further than usual each track may be from that, as it was not seen for long.
    """

    knot_time: Float64[np.ndarray, " view"]
    now: float
    xyz_m: Float64[np.ndarray, "view track joint 3"]
    cov_m2: Float64[np.ndarray, "track joint 3 3"]
    slack: Float64[np.ndarray, "view track"]


class Matches(NamedTuple):
    """Which detection of each image belongs to which track.

    Attributes
    ----------
    match
        Index of the detection among all of the images, or -1.
    flip
        1 where it is read with left and right exchanged.
    weight
        What it is worth, 0 to 1: the responsibility of the track for it.
    """

    match: Int64[np.ndarray, "track view"]
    flip: Int64[np.ndarray, "track view"]
    weight: Float64[np.ndarray, "track view"]


class Fitted(NamedTuple):
    """How the key points of a frame set fit the joints.

    Attributes
    ----------
    inlier
        Responsibility of each joint for its key point.
    innovation_px, off_px
        Key point minus joint, before and after the fit.
    weight
        Weight of the key point in the fit [1/px^2].
    m_per_px
        Length of a pixel at the joint's distance [m].
    """

    inlier: Float64[np.ndarray, "track view joint"]
    innovation_px: Float64[np.ndarray, "track view joint 2"]
    off_px: Float64[np.ndarray, "track view joint 2"]
    weight: Float64[np.ndarray, "track view joint"]
    m_per_px: Float64[np.ndarray, "track view joint"]


class CameraErrors(NamedTuple):
    """What residuals tell of each camera's errors: its turn and the delay of its clock.

    Attributes
    ----------
    info, vector
        Normal equations for three angles of the turn [rad] and the delay [s] of all cameras.
    learned_s
        Time of the newest image that contributed [s].
    applied
        Turns and delays that the projections in use contain.
    centre_px
        Principal points.
    """

    info: Float64[np.ndarray, "cam 4 cam 4"]
    vector: Float64[np.ndarray, "cam 4"]
    learned_s: Float64[np.ndarray, "1"]
    applied: Float64[np.ndarray, "cam 4"]
    centre_px: Float64[np.ndarray, "cam 2"]


class Bones(NamedTuple):
    """The limbs of the skeleton.

    Attributes
    ----------
    joints, length_m
        The two joints of each, and its usual length.
    """

    joints: Int64[np.ndarray, "bone 2"]
    length_m: Float64[np.ndarray, " bone"]


class Reported(NamedTuple):
    """What is reported of people at one time; see `trecsim.values.Snapshot`.

    Attributes
    ----------
    is_supported
        1 where any camera supports any joint, else 0.
    """

    id: Int64[np.ndarray, " person"]
    xyz_m: Float64[np.ndarray, "person joint 3"]
    cov_m2: Float64[np.ndarray, "person joint 3 3"]
    velocity_mps: Float64[np.ndarray, "person joint 3"]
    velocity_cov_m2ps2: Float64[np.ndarray, "person joint 3 3"]
    support: Int64[np.ndarray, "person joint"]
    is_supported: Int64[np.ndarray, " person"]


class Motion(NamedTuple):
    """What is assumed of how people move.

    Attributes
    ----------
    stiffness
        Weight of the smoothing prior, per joint [1/m].
    torso
        The joints whose mean velocity is that of the body.
    own_memory, coasting_memory
        How much of its own velocity a joint keeps over one knot, supported or not, 0 to 1.
    error_memory_s
        Errors of a detector that are closer in time are correlated [s].
    """

    stiffness: Float64[np.ndarray, " joint"]
    torso: Int64[np.ndarray, " joint_of_torso"]
    own_memory: float
    coasting_memory: float
    error_memory_s: float


class Limits(NamedTuple):
    """Settings that decide which tracks are reported and which end; see `FusionSettings`."""

    confirm_s: float
    death_s: float
    single_view_death_s: float
    duplicate_m: float


class Taken(NamedTuple):
    """When the images of a frame set were taken.

    Attributes
    ----------
    t_s
        Their times [s].
    since_s
        How long before each its camera took the last one [s].
    look_back_s
        For how long what each camera of the rig supported counts as supported now [s].
    delay_s
        By how much each camera's clock is late [s].
    is_apart
        Whether images of other cameras have come since its camera's last one.
    """

    t_s: Float64[np.ndarray, " view"]
    since_s: Float64[np.ndarray, " view"]
    look_back_s: Float64[np.ndarray, " cam"]
    delay_s: Float64[np.ndarray, " view"]
    is_apart: Bool[np.ndarray, " view"]


class Now(NamedTuple):
    """The time of a frame set, and its place on the knot grid.

    Attributes
    ----------
    t_s, elapsed_s
        Time of the frame set, and since the last one [s].
    origin_s, knot_s, first
        Time of knot 0, distance between knots [s], index of the oldest live control point.
    """

    t_s: float
    elapsed_s: float
    origin_s: float
    knot_s: float
    first: int


class Rays(NamedTuple):
    """Detections as viewing rays.

    Attributes
    ----------
    cam, origin_m
        Camera of each detection, and where its rays start.
    direction
        Unit directions; NaN where the key point is missing.
    sigma_scale
        Standard deviation of each key point, relative to that of a good one.
    t_s
        When each was taken [s].
    """

    cam: Int64[np.ndarray, " person"]
    origin_m: Float64[np.ndarray, "person 3"]
    direction: Float64[np.ndarray, "person joint 3"]
    sigma_scale: Float64[np.ndarray, "person joint"]
    t_s: Float64[np.ndarray, " person"]


class Ruler(NamedTuple):
    """What measures how far away somebody is whom one camera sees: body and ground.

    Attributes
    ----------
    joints, length_m
        The limbs that are across the line of sight of somebody who stands or walks: the two joints
        of each, and its usual length.
    limb
        Which of the lengths of `Bodies` they are.
    ankles, ankle_height_m
        The ankles, and how high they are when they rest on the ground; there may be none.
    """

    joints: Int64[np.ndarray, "upright 2"]
    length_m: Float64[np.ndarray, " upright"]
    limb: Int64[np.ndarray, " upright"]
    ankles: Int64[np.ndarray, " ankle"]
    ankle_height_m: float
