"""People whom one camera sees are held at the distance that body and ground tell."""

import math
from typing import NamedTuple

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.compiler import inner
from trecsim.fusion.kernels.body_size import (
    LEAST_ABOVE_M,
    above_ankle_m,
    ankle_drop,
    height_share,
    upright_plane,
    usual_size_m,
)
from trecsim.fusion.kernels.curve import knots
from trecsim.fusion.kernels.distance_filter import (
    LEVEL,
    LOG,
    RATE,
    SIZE,
    begin_again,
    clear_filter,
    look,
    move_on,
    stay,
)
from trecsim.fusion.kernels.groups import Cameras, Measurements, Ruler, Taken
from trecsim.fusion.kernels.presence import supporting
from trecsim.fusion.kernels.ray_motion import log_range, move_along_rays, relative_variance
from trecsim.fusion.kernels.track_groups import Trajectories
from trecsim.fusion.tuning import (
    GROUND_MEASURE_M2,
    KNOWN_RATE_MPS,
    KNOWN_SIZE_SPREAD,
    PLACE_SIGMA_M,
    SAME_S,
    SAT_DOWN,
    UPRIGHT,
)


class Shown(NamedTuple):
    """What a frame set shows, and what is needed to make distances of it.

    Attributes
    ----------
    cameras, mirror, torso, ruler
        `Cameras`, each joint's left-right counterpart, the joints whose mean is a person's
        position, and `Ruler`.
    measured, taken
        `Measurements` and `Taken`.
    """

    cameras: Cameras
    mirror: Int64[np.ndarray, " joint"]
    torso: Int64[np.ndarray, " joint_of_torso"]
    ruler: Ruler
    measured: Measurements
    taken: Taken


class Sheet(NamedTuple):
    """Arrays that the kernels overwrite, allocated once per call."""

    xy_px: Float64[np.ndarray, "joint 2"]
    at_one_m: Float64[np.ndarray, "joint 3"]
    basis: Float64[np.ndarray, "4"]
    x: Float64[np.ndarray, "3"]


@inner(allocates=True)
def hold_distances(shown, tracks, bodies, sightings, confirmed, ranges, matches, now, is_single):
    """Hold everybody whom one camera sees at the distance that body and ground tell, in place.

    Parameters
    ----------
    shown
        `Shown`.
    tracks, bodies, sightings, confirmed
        The tracks after the fit: `Trajectories`, `Bodies`, `Sightings`, and which are reported.
    ranges
        `Ranges`, changed in place.
    matches, now
        `Matches` and `Now`.
    is_single
        Whether the tracks are those of people whom two cameras have never seen.
    """
    if shown.ruler.joints.shape[0] < 2:
        return
    n_joint = tracks.c.shape[1]
    sheet = Sheet(np.empty((n_joint, 2)), np.empty((n_joint, 3)), np.empty(4), np.empty(3))
    when = knots(now.t_s, now), now.knot_s
    for k in range(tracks.c.shape[0]):
        person = Trajectories(
            tracks.R[k], tracks.z[k], tracks.c[k], tracks.x_m[k], tracks.cov_m2[k]
        )
        joint_s = sightings.joint_s[k]
        if is_single:
            hold_new(shown, k, joint_s, person, bodies, ranges, matches, when, now, sheet)
            continue
        n = supporting(sightings.camera_s[k], now.t_s, shown.taken.look_back_s)
        if n > 1 or not confirmed[k]:
            ranges.cam[k] = -1
            continue
        if ranges.cam[k] >= 0:
            move_on(ranges.mean[k], ranges.cov[k], now.elapsed_s)
        if n == 1:
            c = first_supporting(sightings.camera_s[k], now.t_s, shown.taken.look_back_s)
            hold_known(shown, k, c, joint_s, person, bodies, ranges, matches, when, now, sheet)


@inner
def hold_new(shown, k, joint_s, person, bodies, ranges, matches, when, now, sheet):
    """Hold person `k`, whom two cameras have never seen, at the distance that images tell.

    Parameters
    ----------
    shown, k, person, bodies, ranges, matches, now
        As for `hold_distances`; `person` is the `Trajectories` of person `k`.
    joint_s
        When each camera last supported each joint of the person, (joint, cam) [s].
    when, sheet
        Time of the frame set in knots and distance of knots [s], and `Sheet`.
    """
    move_on(ranges.mean[k], ranges.cov[k], now.elapsed_s)
    look_at(shown, k, joint_s, bodies, ranges, matches, sheet)
    change_camera(shown, k, person, ranges, matches, when, sheet)
    hold_at_distance(shown, k, person, ranges, when, sheet)


@inner
def hold_known(shown, k, c, joint_s, person, bodies, ranges, matches, when, now, sheet):
    """Hold person `k`, whom camera `c` alone sees now, at the distance that images tell.

    Parameters as for `hold_new`. Nothing tells the distance of somebody who does not stand.
    """
    if ranges.cam[k] != c:
        begin_known(shown, k, c, person, bodies, ranges, when, sheet)
    if stands(shown, k, joint_s, bodies, ranges, matches, sheet):
        look_at(shown, k, joint_s, bodies, ranges, matches, sheet)
        hold_at_distance(shown, k, person, ranges, when, sheet)
    else:
        take_over(shown, k, person, ranges, when, now.elapsed_s, sheet)


@inner
def first_supporting(last_s, now_s, look_back_s):
    """Return the first camera that supports a person now; see `supporting`."""
    for c in range(last_s.shape[0]):
        if last_s[c] > now_s - look_back_s[c]:
            return c
    return -1


@inner
def begin_known(shown, k, c, person, bodies, ranges, when, sheet):
    """Begin to measure the distance of person `k` from camera `c`, which alone sees the person.

    Another camera saw the person until now, alone, or two did: they have measured the body, too.
    """
    mean, cov, ruler = ranges.mean[k], ranges.cov[k], shown.ruler
    origin_m = shown.cameras.position_m[c]
    before_m2 = cov[LOG, LOG] if ranges.cam[k] >= 0 else 0.0
    log_m, rate = log_range(person.c, shown.torso, origin_m, when, (sheet.basis, sheet.x))
    size = size2 = 0.0
    n = ruler.limb.shape[0]
    for i in range(n):
        limb_m = bodies.limb_m[k, ruler.limb[i]]
        size += math.log(ruler.length_m[i] / limb_m) / n
        size2 += bodies.limb_m2[k, ruler.limb[i]] / (limb_m * limb_m) / n
    above_m = max(above_ankle_m(shown.cameras, ruler, c, bodies.level[k, 0]), LEAST_ABOVE_M)
    far_m2 = math.exp(2.0 * log_m)
    clear_filter(mean, cov)
    mean[LOG], mean[RATE], mean[SIZE] = log_m, rate, size
    cov[LOG, LOG] = (
        relative_variance(person.x_m, person.cov_m2, shown.torso, origin_m)
        + PLACE_SIGMA_M * PLACE_SIGMA_M / far_m2
        + before_m2
    )
    cov[RATE, RATE] = KNOWN_RATE_MPS * KNOWN_RATE_MPS / far_m2
    cov[SIZE, SIZE] = size2 + KNOWN_SIZE_SPREAD * KNOWN_SIZE_SPREAD
    cov[LEVEL, LEVEL] = (bodies.level[k, 1] + GROUND_MEASURE_M2) / (above_m * above_m)
    ranges.cam[k], ranges.is_upright[k] = c, False


@inner
def stands(shown, k, joint_s, bodies, ranges, matches, sheet):
    """Note and return whether person `k` stands or walks: once up, until lower than sitting.

    What the newest image shows at the distance measured so far decides, not the joints: where one
    camera looks, a foot that is misplaced along its ray may be above the head.
    """
    c, lengths_m = ranges.cam[k], bodies.limb_m[k]
    for v in range(matches.match.shape[1]):
        if matches.match[k, v] >= 0 and shown.measured.cam[v] == c:
            place_upright(shown, k, joint_s, v, c, matches, sheet)
            share = math.exp(ranges.mean[k, LOG]) * height_share(
                sheet.at_one_m, lengths_m, shown.ruler
            )
            if not math.isnan(share):
                ranges.is_upright[k] = share >= (SAT_DOWN if ranges.is_upright[k] else UPRIGHT)
    return ranges.is_upright[k]


@inner
def place_upright(shown, k, joint_s, v, c, matches, sheet):
    """Write the joints of person `k` in image `v` on the upright plane at 1 m to `sheet`."""
    measured, d = shown.measured, matches.match[k, v]
    since_s = shown.taken.t_s[v] - SAME_S
    believed(measured.xy_px[d], joint_s, c, since_s, shown.mirror, matches.flip[k, v], sheet)
    upright_plane(shown.cameras.ray_of[c], sheet.xy_px, sheet.at_one_m)


@inner
def look_at(shown, k, joint_s, bodies, ranges, matches, sheet):
    """Take in, in place, what the images of its camera tell of the distance of person `k`."""
    measured, c = shown.measured, ranges.cam[k]
    above_m = above_ankle_m(shown.cameras, shown.ruler, c, bodies.level[k, 0])
    for v in range(matches.match.shape[1]):
        d = matches.match[k, v]
        if d < 0 or measured.cam[v] != c:
            continue
        place_upright(shown, k, joint_s, v, c, matches, sheet)
        look(
            ranges.mean[k], ranges.cov[k], usual_size_m(shown.ruler, sheet.at_one_m),
            ankle_drop(shown.ruler, sheet.at_one_m, measured.sigma_scale[d]), above_m,
            shown.taken.since_s[v],
        )  # fmt: skip


@inner
def believed(xy_px, joint_s, c, since_s, mirror, is_flipped, sheet):
    """Copy those key points to `sheet` that have supported their joints since `since_s`.

    Parameters
    ----------
    xy_px, joint_s, c
        Key points of one detection, (joint, 2), when each camera last supported each joint of its
        track, (joint, cam), and its camera.
    since_s
        Time of its image [s].
    mirror, is_flipped
        Each joint's left-right counterpart, and whether the detection is read with them exchanged.
    sheet
        `Sheet`.
    """
    for m in range(xy_px.shape[0]):
        j = mirror[m] if is_flipped else m
        good = joint_s[j, c] >= since_s
        for a in range(2):
            sheet.xy_px[m, a] = xy_px[m, a] if good else math.nan


@inner
def change_camera(shown, k, person, ranges, matches, when, sheet):
    """Measure from the camera that sees person `k` now, in place.

    What several cameras see at once is at the distance that its trajectories tell.
    """
    cam, match = shown.measured.cam, matches.match[k]
    least = most = -1
    same = False
    for v in range(match.shape[0]):
        if match[v] >= 0:
            least = cam[v] if least < 0 else min(least, cam[v])
            most = max(most, cam[v])
            same |= cam[v] == ranges.cam[k]
    if least < 0 or (same and least == most):
        return
    if not same:
        ranges.cam[k] = least
    origin_m = shown.cameras.position_m[ranges.cam[k]]
    log_m, rate = log_range(person.c, shown.torso, origin_m, when, (sheet.basis, sheet.x))
    variance = relative_variance(person.x_m, person.cov_m2, shown.torso, origin_m)
    begin_again(ranges.mean[k], ranges.cov[k], log_m, rate, variance)


@inner
def hold_at_distance(shown, k, person, ranges, when, sheet):
    """Put person `k` at the distance that has been measured, in place."""
    log_m, rate = ranges.mean[k, LOG], ranges.mean[k, RATE]
    origin_m = shown.cameras.position_m[ranges.cam[k]]
    move_along_rays(person, shown.torso, origin_m, log_m, rate, when, (sheet.basis, sheet.x))


@inner
def take_over(shown, k, person, ranges, when, elapsed_s, sheet):
    """Take over the distance of person `k` from its trajectories, in place."""
    origin_m = shown.cameras.position_m[ranges.cam[k]]
    log_m, rate = log_range(person.c, shown.torso, origin_m, when, (sheet.basis, sheet.x))
    stay(ranges.mean[k], ranges.cov[k], log_m, rate, elapsed_s)
