"""Fitting a frame set: every joint is found, and the trajectories take it in."""

import math

import numpy as np

from trecsim.compiler import inner, kernel
from trecsim.fusion.kernels.curve import locate, point
from trecsim.fusion.kernels.information import (
    control_points,
    curve_covariance,
    fold_gaussian,
    invert3,
    scale,
)
from trecsim.fusion.kernels.locating import (
    STEPS,
    Observed,
    clear,
    locate_joint,
    moments,
    scratch,
    sums,
)

# Covariance inflation. The normalised innovation squared of all joints of a body, over its expected
# value, shows a sharp turn from `NIS_GATE` on. In steady motion it is near `USUAL_NIS` or below, as
# a detector's errors persist and the process noise allows for the fastest joints. The inflation is
# the ratio over its usual value, at most `LARGEST_INFLATION`.
NIS_GATE, USUAL_NIS, LARGEST_INFLATION = 2.5, 1.25, 50.0


@inner
def fold_moments(R, z, c, total, j, tmp):
    """Fold the sums of every moment into a joint's trajectory, at the moment's mean time.

    Notes
    -----
    Each residual was taken at its image's own time; only the correction of the curve is taken as
    constant over a moment. At the weighted mean time the error of that vanishes to first order.
    """
    info, rhs, weight, x, basis = total.info, total.rhs, total.weight, tmp.x, tmp.basis
    for m in range(weight.shape[1]):
        if not weight[j, m] > 0.0:
            continue
        span = locate(total.knot_time[j, m] / weight[j, m], c.shape[0] // 3, basis)
        point(c, span, basis, x)
        least = 1e-6 * (info[j, m, 0, 0] + info[j, m, 1, 1] + info[j, m, 2, 2])
        fold_gaussian(R, z, info[j, m], rhs[j, m], least, x, span, basis, tmp.rows, tmp.right)
    control_points(R, z, c)


@inner
def gather_views(seen, cam, knot_time, moment, match, credit):
    """Copy what the matched images of one track have in common to `seen`; return how many."""
    n = 0
    for v in range(match.shape[0]):
        if match[v] >= 0:
            seen.cam[n], seen.knot_time[n], seen.moment[n] = cam[v], knot_time[v], moment[v]
            seen.credit[n] = credit[v]
            n += 1
    return n


@inner
def gather_joint(seen, j, xyz_m, match, flip, xy_px, sigma_scale, noise):
    """Copy the key points of joint `j` in the matched images of one track to `seen`; count them.

    `xyz_m` is (view, joint, 3), the track's own.
    """
    there_m, found_px, sigma_m = seen.xyz_m, seen.xy_px, seen.sigma_m
    other, usual_m = noise.mirror[j], noise.sigma_m[j]
    n = known = 0
    for v in range(match.shape[0]):
        d = match[v]
        if d < 0:
            continue
        m = other if flip[v] else j
        for a in range(3):
            there_m[n, a] = xyz_m[v, j, a]
        found_px[n, 0], found_px[n, 1] = xy_px[d, m, 0], xy_px[d, m, 1]
        sigma_m[n] = usual_m * sigma_scale[d, m]
        known += not math.isnan(xy_px[d, m, 0])
        n += 1
    return known


@inner
def seek_body(
    P,
    focal_px,
    seen,
    n,
    xyz_m,
    prior_m2,
    inflation,
    match,
    flip,
    xy_px,
    sigma_scale,
    noise,
    total,
    found,
    shift_m,
    cov_m2,
    inlier,
    r,
    tmp,
):
    """Find all joints of one person in the images of a frame set; see `fit_all`.

    Parameters
    ----------
    seen, n
        `Observed`, with what the person's `n` images have in common filled in.
    inflation
        Factor on the covariances of the predictions.
    total, found, shift_m, cov_m2, inlier
        Results: `Sums`; whether there is a key point of each joint, (joint,); how far the joints
        lie from their predictions, with covariances; responsibilities, (view, joint).
    r, tmp
        Scratch: (view,), and `Scratch`.
    """
    prior = tmp.prior
    for j in range(found.shape[0]):
        known = gather_joint(seen, j, xyz_m, match, flip, xy_px, sigma_scale, noise)
        for a in range(3):
            for b in range(3):
                prior[a, b] = inflation * prior_m2[j, a, b]
        found[j] = known > 0
        if known:
            locate_joint(
                P, focal_px, seen, n, prior, noise, STEPS[0], total, j, shift_m[j], cov_m2[j],
                r, tmp,
            )  # fmt: skip
        else:
            clear(total, j)
        spread(match, r, found[j], inlier, j)


@inner(allocates=True)
def nis_ratio(shift_m, cov_m2, prior_m2, found):
    """Return the normalised innovation squared of all joints, over its expected value.

    Notes
    -----
    With a prediction's covariance ``P`` and the fit's ``Q``, a shift ``d`` of the prediction has
    covariance ``P - Q``, so that ``d P^-1 d`` has the mean ``3 - tr(P^-1 Q)``. The sum over all
    joints has far less relative spread than a single joint's, and people turn as a whole.
    """
    info = np.empty((3, 3))
    found_nis = expected_nis = 0.0
    for j in range(found.shape[0]):
        if not found[j]:
            continue
        invert3(prior_m2[j], info)
        for p in range(3):
            expected_nis += 1.0
            for q in range(3):
                found_nis += shift_m[j, p] * info[p, q] * shift_m[j, q]
                expected_nis -= info[p, q] * cov_m2[j, q, p]
    return found_nis / expected_nis if expected_nis > 0.0 else 0.0


@inner
def inflate_covariance(R, z, inflation):
    """Multiply the covariance of one person's trajectories by `inflation`, in place."""
    for j in range(R.shape[0]):
        scale(R[j], z[j], 1.0 / math.sqrt(inflation))


@kernel(allocates=True)
def fit_all(
    R, z, c, xyz_m, prior_m2, cam, P, focal_px, knot_time,
    xy_px, sigma_scale, match, flip, credit, noise, now, inlier, x_m, cov_m2,
):  # fmt: skip
    """Fit every track to the detections assigned to it in one frame set, in place.

    Parameters
    ----------
    R, z, c
        Square-root information and control points, (track, joint, n, n) and (track, joint, n);
        changed in place.
    xyz_m
        Predictions at each image's own time, (view, track, joint, 3).
    prior_m2
        Their covariance at the frame set's time, (track, joint, 3, 3).
    cam, P, focal_px
        Camera of each image (view,); projections (cam, 3, 4) and mean focal lengths (cam,).
    knot_time
        Time of each image, in knots, (view,).
    xy_px, sigma_scale
        All detections of the set, (person, joint, 2) and (person, joint); see `score_view`.
    match, flip, credit
        Per track and view: index of its detection or -1; 1 to read it mirrored; weight 0 to 1.
    noise
        The detector's `Noise`.
    now
        Time of the frame set, in knots.
    inlier
        Result, (track, view, joint): responsibility of the joint for its key point.
    x_m, cov_m2
        Results: joints and covariances at the frame set's time, (track, joint, 3) and (track,
        joint, 3, 3).

    Notes
    -----
    The process noise is low, which suits steady motion. A sharp turn shows in the innovations of
    all joints together; then the covariance of the whole body is inflated by the ratio of the
    innovations to their usual size (as in the strong tracking filter of Zhou and Frank 1996), and
    the joints are located again.
    """
    n_view, n_joint = cam.shape[0], R.shape[1]
    seen = Observed(
        np.empty(n_view, np.int64), np.empty(n_view), np.empty(n_view, np.int64),
        np.empty((n_view, 3)), np.empty((n_view, 2)), np.empty(n_view), np.empty(n_view),
    )  # fmt: skip
    moment = np.empty(n_view, np.int64)
    total = sums(n_joint, moments(knot_time, moment) if n_view else 0)
    found, shift_m = np.empty(n_joint, np.bool_), np.empty((n_joint, 3))
    after_m2, tmp = np.empty((n_joint, 3, 3)), scratch(R.shape[2])
    r, weights = np.empty(n_view), np.empty(4)
    span = locate(now, R.shape[2] // 3, weights)
    for k in range(R.shape[0]):
        n = gather_views(seen, cam, knot_time, moment, match[k], credit[k])
        inflation = 1.0
        for again in range(2):
            seek_body(
                P, focal_px, seen, n, xyz_m[:, k], prior_m2[k], inflation, match[k], flip[k], xy_px,
                sigma_scale, noise, total, found, shift_m, after_m2, inlier[k], r, tmp,
            )  # fmt: skip
            ratio = 0.0 if again else nis_ratio(shift_m, after_m2, prior_m2[k], found)
            if ratio <= NIS_GATE:
                break
            inflation = min(ratio / USUAL_NIS, LARGEST_INFLATION)
            inflate_covariance(R[k], z[k], inflation)
        for j in range(n_joint):
            if found[j]:
                fold_moments(R[k, j], z[k, j], c[k, j], total, j, tmp)
            point(c[k, j], span, weights, x_m[k, j])
            curve_covariance(R[k, j], span, weights, tmp.y, cov_m2[k, j])


@inner
def spread(match, r, found, inlier, j):
    """Write the responsibilities `r` of the matched images, if found, to `inlier` (view, joint)."""
    n = 0
    for v in range(match.shape[0]):
        inlier[v, j] = 0.0
        if match[v] >= 0:
            inlier[v, j] = r[n] if found else 0.0
            n += 1
