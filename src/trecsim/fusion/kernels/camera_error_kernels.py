"""What the residuals of all people tell of each camera's errors: its turn, and its clock."""

import math

import numpy as np

from trecsim.compiler import inner
from trecsim.fusion.kernels.curve import derivative, knots, locate, point
from trecsim.fusion.kernels.mixture import project
from trecsim.fusion.kernels.small_matrices import invert3
from trecsim.fusion.tuning import (
    CAMERA_BLOCK_S,
    CAMERA_ERROR_S,
    CAMERA_LAG_S,
    CAMERA_MEASURE_S,
    INLIER,
    MOST_BLOCKS,
    NEAR_M,
    TEMPER,
)

_UNKNOWNS = 4


@inner
def keep_key_points(measured, mirror, matches, fitted, taken, waiting):
    """Keep the key points of a frame set until what comes later has smoothed the joints, in place.

    Parameters
    ----------
    measured, mirror, matches, fitted, taken
        `Measurements`, each joint's left-right counterpart, `Matches`, `Fitted` and `Taken`.
    waiting
        `Waiting`, changed in place: of each track, one image of each camera within a block.
    """
    for k in range(matches.match.shape[0]):
        start_s = oldest(waiting, k)
        for v in range(measured.cam.shape[0]):
            c, d = measured.cam[v], matches.match[k, v]
            if d < 0 or waiting.is_pending[k, c] or taken.t_s[v] - start_s > CAMERA_BLOCK_S:
                continue
            start_s = min(start_s, taken.t_s[v])
            waiting.t_s[k, c] = taken.t_s[v]
            waiting.is_pending[k, c] = True
            for j in range(mirror.shape[0]):
                m = mirror[j] if matches.flip[k, v] else j
                good = fitted.inlier[k, v, j] > INLIER
                waiting.weight[k, j, c] = fitted.weight[k, v, j] if good else 0.0
                for a in range(2):
                    waiting.xy_px[k, j, c, a] = measured.xy_px[d, m, a]


@inner
def oldest(waiting, k):
    """Return the time of the oldest image of a track that waits, or infinity."""
    start_s = math.inf
    for c in range(waiting.t_s.shape[1]):
        if waiting.is_pending[k, c]:
            start_s = min(start_s, waiting.t_s[k, c])
    return start_s


@inner(allocates=True)
def note_camera_errors(cameras, tracks, trusted, now, waiting, errors):
    """Add what the key points of a block say of the cameras to their equations, in place.

    Parameters
    ----------
    cameras, tracks
        `Cameras`, and `Trajectories` after the fit.
    trusted
        Which tracks are confirmed and supported by two cameras, (track,).
    now
        `Now`.
    waiting, errors
        `Waiting` and `CameraErrors`, changed in place.

    Notes
    -----
    A key point of a camera that is turned by the small rotation ``w`` and whose clock is late by
    ``s`` lies off by ``J_w w - v s``, with the joint's velocity ``v`` in the image; and by ``J d``
    if the joint is off by ``d`` from where the trajectory, which the errors have bent, has it. All
    cameras have the same ``d``, nothing is known of it, and it is eliminated: what remains are
    equations of where the cameras disagree, the same whatever the trajectory followed.

    Key points are looked at `CAMERA_LAG_S` after the last image of their block, when images of all
    cameras before and after it have shaped the trajectory. Errors of key points last for seconds
    and are correlated over a body: they count by the time that has passed, and 17 of them as about
    a third.
    """
    wait_s = CAMERA_BLOCK_S + CAMERA_LAG_S
    share = min(wait_s / CAMERA_MEASURE_S, 1.0) / TEMPER
    n_cam = waiting.t_s.shape[1]
    block = (
        np.empty(n_cam, np.int64), np.empty(n_cam), np.empty((n_cam, 2)),
        np.empty((n_cam, 2, 3)), np.empty((n_cam, 2, _UNKNOWNS)),
    )  # fmt: skip
    looked = 0
    for k in range(trusted.shape[0]):
        start_s = oldest(waiting, k)
        if now.t_s - start_s < wait_s or start_s == math.inf or looked == MOST_BLOCKS:
            continue
        if trusted[k] and now.t_s - start_s < 2.0 * wait_s:
            looked += 1
            age(errors, start_s)
            for j in range(tracks.c.shape[1]):
                n = linearise(cameras, tracks, now, waiting, errors, k, j, share, block)
                if n > 1:
                    eliminate(n, block, errors)
        for c in range(n_cam):
            waiting.is_pending[k, c] = False


@inner
def age(errors, t_s):
    """Forget what is older the more, in place."""
    since_s = t_s - errors.learned_s[0]
    if since_s > 0.0:
        errors.learned_s[0] = t_s
        kept = math.exp(-min(since_s, 1e3) / CAMERA_ERROR_S)
        for c in range(errors.vector.shape[0]):
            for i in range(_UNKNOWNS):
                errors.vector[c, i] *= kept
                for o in range(errors.vector.shape[0]):
                    for m in range(_UNKNOWNS):
                        errors.info[c, i, o, m] *= kept


@inner(allocates=True)
def linearise(cameras, tracks, now, waiting, errors, k, j, share, block):
    """Write the equations of one joint in all cameras that show it; return how many do.

    `block` takes the camera, the weight [1/px^2], what the key point is off by if nothing were
    applied [px], and its derivatives by the joint's place and the camera's errors.
    """
    cam, weight, off_px, by_place, by_error = block
    place_weights, speed_weights = np.empty(4), np.empty(4)
    x, speed_mps = np.empty(3), np.empty(3)
    n_control, n = tracks.c.shape[2] // 3, 0
    for c in range(waiting.t_s.shape[1]):
        if not (waiting.is_pending[k, c] and waiting.weight[k, j, c] > 0.0):
            continue
        there = knots(waiting.t_s[k, c] - errors.applied[c, 3], now)
        span = locate(there, n_control, place_weights)
        derivative(there, n_control, now.knot_s, speed_weights)
        point(tracks.c[k, j], span, place_weights, x)
        point(tracks.c[k, j], span, speed_weights, speed_mps)
        w, u, v, du, dv = project(cameras.P, c, x[0], x[1], x[2])
        if not w > NEAR_M:
            continue
        row_u, row_v = by_error[n]
        turned(errors.centre_px[c], cameras.focal_px[c], u, v, row_u, row_v)
        row_u[3] = row_v[3] = 0.0
        for a in range(3):
            by_place[n, 0, a], by_place[n, 1, a] = du[a], dv[a]
            row_u[3] -= du[a] * speed_mps[a]
            row_v[3] -= dv[a] * speed_mps[a]
        off_px[n, 0], off_px[n, 1] = waiting.xy_px[k, j, c, 0] - u, waiting.xy_px[k, j, c, 1] - v
        for i in range(_UNKNOWNS):
            off_px[n, 0] += row_u[i] * errors.applied[c, i]
            off_px[n, 1] += row_v[i] * errors.applied[c, i]
        cam[n], weight[n] = c, share * waiting.weight[k, j, c]
        n += 1
    return n


@inner(allocates=True)
def eliminate(n, block, errors):
    """Add the equations of one joint in `n` cameras, with its place eliminated, in place."""
    cam = block[0]
    place, off, shared = np.zeros((3, 3)), np.zeros(3), np.zeros((n, _UNKNOWNS, 3))
    inverse, moved = np.empty((3, 3)), np.empty((_UNKNOWNS, 3))
    for e in range(n):
        add_place(e, block, place, off, shared[e])
    little = 1e-6 * (place[0, 0] + place[1, 1] + place[2, 2])  # cameras may stand in one line
    for a in range(3):
        place[a, a] += little
    invert3(place, inverse)
    for e in range(n):
        info, vector = errors.info[cam[e]], errors.vector[cam[e]]
        add_own(e, block, info[:, cam[e]], vector)
        for i in range(_UNKNOWNS):
            for a in range(3):
                moved[i, a] = 0.0
                for b in range(3):
                    moved[i, a] += shared[e, i, b] * inverse[b, a]
                vector[i] -= moved[i, a] * off[a]
        for o in range(n):
            take_off(moved, shared[o], info[:, cam[o]])


@inner
def add_place(e, block, place, off, shared):
    """Add one camera's equations of the joint's place, and of it and the camera's errors."""
    _, weight, off_px, by_place, by_error = block
    for r in range(2):
        for a in range(3):
            pull = weight[e] * by_place[e, r, a]
            off[a] += pull * off_px[e, r]
            for b in range(3):
                place[a, b] += pull * by_place[e, r, b]
            for i in range(_UNKNOWNS):
                shared[i, a] += pull * by_error[e, r, i]


@inner
def add_own(e, block, info, vector):
    """Add one camera's equations of its own errors."""
    _, weight, off_px, _, by_error = block
    for r in range(2):
        for i in range(_UNKNOWNS):
            pull = weight[e] * by_error[e, r, i]
            vector[i] += pull * off_px[e, r]
            for m in range(_UNKNOWNS):
                info[i, m] += pull * by_error[e, r, m]


@inner
def take_off(moved, shared, info):
    """Take off what the joint's place explains of the equations of two cameras' errors."""
    for i in range(_UNKNOWNS):
        for m in range(_UNKNOWNS):
            for a in range(3):
                info[i, m] -= moved[i, a] * shared[m, a]


@inner
def turned(centre_px, f, u, v, row_u, row_v):
    """Write by how much a pixel moves per radian of the three turns of its camera [px]."""
    x, y = (u - centre_px[0]) / f, (v - centre_px[1]) / f
    row_u[0], row_u[1], row_u[2] = -f * x * y, f * (1.0 + x * x), -f * y
    row_v[0], row_v[1], row_v[2] = -f * (1.0 + y * y), f * x * y, f * x
