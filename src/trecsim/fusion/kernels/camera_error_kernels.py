"""What the residuals of all people tell of each camera's errors: its turn, and its clock."""

import math

import numpy as np

from trecsim.compiler import inner
from trecsim.fusion.kernels.curve import derivative, knots, locate, point
from trecsim.fusion.kernels.mixture import project
from trecsim.fusion.tuning import (
    CAMERA_CHECK_S,
    CAMERA_ERROR_S,
    CAMERA_LAG_S,
    CAMERA_MEASURE_S,
    INLIER,
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
        `Waiting`, changed in place: one image for each camera and track at a time.
    """
    for v in range(measured.cam.shape[0]):
        c = measured.cam[v]
        for k in range(matches.match.shape[0]):
            d = matches.match[k, v]
            if d < 0 or taken.t_s[v] - waiting.t_s[k, c] < CAMERA_LAG_S + CAMERA_CHECK_S:
                continue
            waiting.t_s[k, c] = taken.t_s[v]
            waiting.is_pending[k, c] = True
            for j in range(mirror.shape[0]):
                m = mirror[j] if matches.flip[k, v] else j
                good = fitted.inlier[k, v, j] > INLIER
                waiting.weight[k, j, c] = fitted.weight[k, v, j] if good else 0.0
                for a in range(2):
                    waiting.xy_px[k, j, c, a] = measured.xy_px[d, m, a]


@inner(allocates=True)
def note_camera_errors(cameras, tracks, trusted, now, waiting, errors):
    """Add the residuals of key points that were kept to each camera's equations, in place.

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
    ``s`` lies off by ``J_w w - v s``, with the joint's velocity ``v`` in the image. Both are told
    apart by people who move in different directions, or stand. Residuals are taken `CAMERA_LAG_S`
    after the image, when images of all cameras before and after it have shaped the trajectory: at
    once, that of the only camera of a frame set would depend on whose turn it is.

    Residuals of one camera last for seconds and are correlated over a body: they count by the time
    that has passed, and 17 of them as about a third.
    """
    place_weights, speed_weights = np.empty(4), np.empty(4)
    scratch = np.empty(3), np.empty(3), np.empty(_UNKNOWNS), np.empty(_UNKNOWNS)
    for k in range(trusted.shape[0]):
        for c in range(waiting.t_s.shape[1]):
            if not waiting.is_pending[k, c] or now.t_s - waiting.t_s[k, c] < CAMERA_LAG_S:
                continue
            waiting.is_pending[k, c] = False
            if not trusted[k]:
                continue
            since_s = max(waiting.t_s[k, c] - errors.learned_s[c], 0.0)
            if since_s > 0.0:
                errors.learned_s[c] = waiting.t_s[k, c]
                forget(errors, c, math.exp(-min(since_s, 1e3) / CAMERA_ERROR_S))
            share = min(CAMERA_LAG_S + CAMERA_CHECK_S, CAMERA_MEASURE_S) / CAMERA_MEASURE_S / TEMPER
            there = knots(waiting.t_s[k, c] - errors.applied[c, 3], now)
            n = tracks.c.shape[2] // 3
            span = locate(there, n, place_weights)
            derivative(there, n, now.knot_s, speed_weights)
            for j in range(tracks.c.shape[1]):
                if waiting.weight[k, j, c] > 0.0:
                    add_key_point(
                        cameras, c, waiting.xy_px[k, j, c], share * waiting.weight[k, j, c],
                        (tracks.c[k, j], span, place_weights, speed_weights), errors, scratch,
                    )  # fmt: skip


@inner
def add_key_point(cameras, c, xy_px, weight, where, errors, scratch):
    """Add the residual of one key point to its camera's equations, in place."""
    control_m, span, place_weights, speed_weights = where
    x, speed_mps, row_u, row_v = scratch
    point(control_m, span, place_weights, x)
    point(control_m, span, speed_weights, speed_mps)
    w, u, v, du, dv = project(cameras.P, c, x[0], x[1], x[2])
    if not w > NEAR_M:
        return
    turned(errors.centre_px[c], cameras.focal_px[c], u, v, row_u, row_v)
    row_u[3] = row_v[3] = 0.0
    for a in range(3):
        row_u[3] -= du[a] * speed_mps[a]
        row_v[3] -= dv[a] * speed_mps[a]
    add(errors, c, row_u, xy_px[0] - u, weight)
    add(errors, c, row_v, xy_px[1] - v, weight)


@inner
def forget(errors, c, kept):
    """Keep only a share of what is known of a camera, in place."""
    for i in range(_UNKNOWNS):
        errors.vector[c, i] *= kept
        for m in range(_UNKNOWNS):
            errors.info[c, i, m] *= kept


@inner
def turned(centre_px, f, u, v, row_u, row_v):
    """Write by how much a pixel moves per radian of the three turns of its camera [px]."""
    x, y = (u - centre_px[0]) / f, (v - centre_px[1]) / f
    row_u[0], row_u[1], row_u[2] = -f * x * y, f * (1.0 + x * x), -f * y
    row_v[0], row_v[1], row_v[2] = -f * (1.0 + y * y), f * x * y, f * x


@inner
def add(errors, c, row, off_px, weight):
    """Add one equation to a camera's normal equations, of what would be left if nothing applied."""
    info, vector, applied = errors.info[c], errors.vector[c], errors.applied[c]
    total = off_px
    for i in range(_UNKNOWNS):
        total += row[i] * applied[i]
    for i in range(_UNKNOWNS):
        vector[i] += weight * row[i] * total
        for m in range(_UNKNOWNS):
            info[i, m] += weight * row[i] * row[m]
