"""Whom a camera should see: what lies in its raw image, and who stands before whom."""

import math
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float64, Int64

from trecsim.compiler import inner, kernel
from trecsim.fusion.kernels.small_matrices import largest
from trecsim.fusion.tuning import (
    AHEAD_M,
    ASIDE_M,
    BEFORE_M,
    HIDDEN_SHARE,
    IN_VIEW,
    STEP_S,
    WALKS_MPS,
)

# What `Lenses.kind` says.
PINHOLE, BROWN, FISHEYE = 0, 1, 2


class Lenses(NamedTuple):
    """How the cameras' images come about, per camera.

    Attributes
    ----------
    T_cam_world
        The first three rows of the world's motion into the camera's coordinates [m].
    position_m
        Where it stands [m].
    K
        Intrinsics [px].
    size_px
        Width and height of the raw image [px].
    kind
        ``PINHOLE``, ``BROWN`` or ``FISHEYE``.
    coefficients
        Of the distortion, as `trecsim.geometry.Camera` orders them; zeros fill them up to eight.
    radius2_max
        Square of the normalised radius up to which the distortion holds.
    """

    T_cam_world: Float64[np.ndarray, "cam 3 4"]
    position_m: Float64[np.ndarray, "cam 3"]
    K: Float64[np.ndarray, "cam 3 3"]
    size_px: Float64[np.ndarray, "cam 2"]
    kind: Int64[np.ndarray, " cam"]
    coefficients: Float64[np.ndarray, "cam 8"]
    radius2_max: Float64[np.ndarray, " cam"]


class Silhouette(NamedTuple):
    """What of a body blocks the view: capsules between joints.

    Attributes
    ----------
    ends
        Each capsule goes from the middle of the first two joints to that of the last two.
    radius_m
        Its radius [m].
    """

    ends: Int64[np.ndarray, "part 4"]
    radius_m: Float64[np.ndarray, " part"]


class Views(NamedTuple):
    """Who should see whom.

    Attributes
    ----------
    expected
        In how many cameras each person should be found; -1 for somebody whom cameras have in view,
        and others hide from all of them.
    leaving
        Whether the person is walking out of the views, or where few cameras look.
    should
        Which cameras should find the person.
    """

    expected: Int64[np.ndarray, " track"]
    leaving: Bool[np.ndarray, " track"]
    should: Bool[np.ndarray, "track cam"]


@kernel(allocates=True)
def expect_all(lenses, silhouette, looking, torso, x_m, step_m, asked, views):
    """Write which of the cameras that are looking should find people, and who is about to leave.

    Parameters
    ----------
    lenses, silhouette
        The cameras, and what of a body blocks their view.
    looking
        Which cameras deliver, (cam,).
    torso
        The joints that stand for a person.
    x_m
        Everybody's joints, (track, joint, 3).
    step_m
        How far everybody moves within a step, (track, 3).
    asked
        For whom it matters, (track,); what is told of the others is left as it is.
    views
        Result: `Views`.
    """
    expected, leaving, should = views
    nowhere, bodies = (0.0, 0.0, 0.0), extents(silhouette, torso, x_m)
    for k in range(x_m.shape[0]):
        if not asked[k]:
            continue
        before = visible = ahead = stay = n_looking = 0
        for c in range(looking.shape[0]):
            should[k, c] = False
            if not looking[c]:
                continue
            n_looking += 1
            later = has_in_view(lenses, c, x_m[k], step_m[k], torso)
            ahead += later
            if has_in_view(lenses, c, x_m[k], nowhere, torso):
                before += 1
                free = hidden_share(lenses.position_m[c], silhouette, bodies, x_m, k) < HIDDEN_SHARE
                should[k, c] = free
                visible += free
                stay += free and later
        expected[k] = visible if visible or not before else -1
        walks = math.sqrt(step_m[k, 0] ** 2 + step_m[k, 1] ** 2) > WALKS_MPS * STEP_S
        outwards = 2 * before <= n_looking and ahead <= before
        leaving[k] = walks and visible > 0 and (stay == 0 or outwards)


@inner
def has_in_view(lenses, c, x_m, step_m, torso):
    """Return whether enough of a person's torso is in a camera's image, were nobody before it.

    The person is where it is, `x_m`, after a step of `step_m`.
    """
    inside, x = 0, (0.0, 0.0, 0.0)
    for j in torso:
        x = (x_m[j, 0] + step_m[0], x_m[j, 1] + step_m[1], x_m[j, 2] + step_m[2])
        inside += in_image(lenses, c, x)
    return inside >= IN_VIEW * torso.shape[0]


@inner
def in_image(lenses, c, x):
    """Return whether the point `x` has an image in a camera's raw picture."""
    T, K = lenses.T_cam_world[c], lenses.K[c]
    w = T[2, 0] * x[0] + T[2, 1] * x[1] + T[2, 2] * x[2] + T[2, 3]
    if not w > AHEAD_M:
        return False
    u = (T[0, 0] * x[0] + T[0, 1] * x[1] + T[0, 2] * x[2] + T[0, 3]) / w
    v = (T[1, 0] * x[0] + T[1, 1] * x[1] + T[1, 2] * x[2] + T[1, 3]) / w
    if lenses.kind[c] != PINHOLE:
        if not u * u + v * v <= lenses.radius2_max[c]:
            return False
        u, v = bent(lenses.kind[c], lenses.coefficients[c], u, v)
    column = K[0, 0] * u + K[0, 1] * v + K[0, 2]
    row = K[1, 1] * v + K[1, 2]
    return -0.5 <= column < lenses.size_px[c, 0] - 0.5 and -0.5 <= row < lenses.size_px[c, 1] - 0.5


@inner
def bent(kind, k, x, y):
    """Return where a lens images the normalised point (x, y); see `trecsim.geometry.distortion`."""
    s = x * x + y * y
    if kind == FISHEYE:
        r = math.sqrt(s)
        if r < 1e-9:
            return x, y
        angle = math.atan(r)
        q = angle * angle
        scale = angle * (1.0 + q * (k[0] + q * (k[1] + q * (k[2] + q * k[3])))) / r
        return x * scale, y * scale
    radial = (1.0 + s * (k[0] + s * (k[1] + s * k[4]))) / (1.0 + s * (k[5] + s * (k[6] + s * k[7])))
    spread = radial + 2.0 * (k[2] * y + k[3] * x)
    return x * spread + k[3] * s, y * spread + k[2] * s


@inner(allocates=True)
def extents(silhouette, torso, x_m):
    """Return the middles of all torsos, and how far from it each body may hide something.

    Parameters
    ----------
    silhouette, torso, x_m
        See `expect_all`.

    Returns
    -------
    Middles, (track, 3), and radii of balls about them that hold the capsules, (track,) [m].
    """
    middle_m, radius_m = np.empty((x_m.shape[0], 3)), np.empty(x_m.shape[0])
    thickest_m = largest(silhouette.radius_m)
    for k in range(x_m.shape[0]):
        for a in range(3):
            middle_m[k, a] = 0.0
            for j in torso:
                middle_m[k, a] += x_m[k, j, a] / torso.shape[0]
        most_m2 = 0.0
        for j in range(x_m.shape[1]):
            off_m2 = 0.0
            for a in range(3):
                off_m2 += (x_m[k, j, a] - middle_m[k, a]) ** 2
            most_m2 = max(most_m2, off_m2)
        radius_m[k] = math.sqrt(most_m2) + max(thickest_m, 0.0)
    return middle_m, radius_m


@inner(allocates=True)
def hidden_share(eye_m, silhouette, bodies, x_m, k):
    """Return which share of the joints of person `k` others hide from a camera at `eye_m`.

    `bodies` are the `extents` of everybody, `x_m` everybody's joints.
    """
    (middle_m, radius_m), n_joint = bodies, x_m.shape[1]
    hidden, rays_m = np.empty(n_joint, np.bool_), np.empty((n_joint, 3))
    for j in range(n_joint):
        hidden[j] = False
        for a in range(3):
            rays_m[j, a] = x_m[k, j, a] - eye_m[a]
    own_m, other_m = np.empty(3), np.empty(3)
    far_m = way_to(eye_m, middle_m[k], own_m)
    for i in range(x_m.shape[0]):
        if i == k:
            continue
        near_m = way_to(eye_m, middle_m[i], other_m)
        if near_m < far_m - BEFORE_M and gap_m2(own_m, other_m, other_m) < ASIDE_M**2:
            hide(eye_m, silhouette, x_m[i], (other_m, radius_m[i]), rays_m, hidden)
    count = 0
    for j in range(n_joint):
        count += hidden[j]
    return count / n_joint


@inner
def way_to(eye_m, x_m, out):
    """Write the way from `eye_m` to `x_m` to `out`; return its length."""
    length_m2 = 0.0
    for a in range(3):
        out[a] = x_m[a] - eye_m[a]
        length_m2 += out[a] * out[a]
    return math.sqrt(length_m2)


@inner(allocates=True)
def hide(eye_m, silhouette, other_m, ball, rays_m, hidden):
    """Mark, in place, the joints that a body hides.

    Parameters
    ----------
    eye_m, silhouette
        The camera's place, and `Silhouette`.
    other_m, ball
        The joints of the body, and a ball that holds its capsules: middle, from the eye, and
        radius. A ray that misses the ball misses them all.
    rays_m, hidden
        Ways from the eye to the joints that may be hidden, (joint, 3), and result (joint,).
    """
    (middle_m, radius_m), ends, capsule_m = ball, silhouette.ends, silhouette.radius_m
    start, end = np.empty(3), np.empty(3)
    for j in range(rays_m.shape[0]):
        if hidden[j] or gap_m2(rays_m[j], middle_m, middle_m) > radius_m * radius_m:
            continue
        for p in range(capsule_m.shape[0]):
            for a in range(3):
                start[a] = 0.5 * (other_m[ends[p, 0], a] + other_m[ends[p, 1], a]) - eye_m[a]
                end[a] = 0.5 * (other_m[ends[p, 2], a] + other_m[ends[p, 3], a]) - eye_m[a]
            if gap_m2(rays_m[j], start, end) < capsule_m[p] ** 2:
                hidden[j] = True
                break


@inner
def gap_m2(ray, start, end):
    """Return the squared distance of two segments: origin to `ray`, `start` to `end`."""
    aa = bb = cc = d = e = 0.0
    for i in range(3):
        along = end[i] - start[i]
        aa += ray[i] * ray[i]
        bb += ray[i] * along
        cc += along * along
        d += ray[i] * start[i]
        e += along * start[i]
    # Nearest points of the two lines, then clamped one after the other.
    between = aa * cc - bb * bb
    s = min(max((d * cc - bb * e) / between, 0.0), 1.0) if between > 1e-12 * aa * cc else 0.0
    t = min(max((bb * s - e) / cc, 0.0), 1.0) if cc > 0.0 else 0.0
    s = min(max((bb * t + d) / aa, 0.0), 1.0) if aa > 0.0 else 0.0
    total = 0.0
    for i in range(3):
        total += (s * ray[i] - start[i] - t * (end[i] - start[i])) ** 2
    return total
