"""Fitting a frame set: every joint is found, and the trajectories take it in."""

import math
from typing import NamedTuple

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.compiler import inner
from trecsim.fusion.kernels.curve import locate, point
from trecsim.fusion.kernels.information import control_points, curve_covariance, fold_gaussian
from trecsim.fusion.kernels.locating import (
    begin_em,
    clear,
    locate_joint,
    located,
    moments,
    observed,
    scratch,
)
from trecsim.fusion.kernels.small_matrices import invert3, scale
from trecsim.fusion.tuning import LARGEST_INFLATION, NIS_GATE, USUAL_NIS


@inner
def fold_moments(R, z, c, located, j, tmp):
    """Fold the sums of every moment into a joint's trajectory, at the moment's mean time.

    Notes
    -----
    Each residual was taken at its image's own time; only the correction of the curve is taken as
    constant over a moment. At the weighted mean time the error of that vanishes to first order.
    """
    info, rhs, knot_time, weight = located.info, located.rhs, located.knot_time, located.weight
    x, basis = tmp.x, tmp.basis
    for m in range(weight.shape[1]):
        if not weight[j, m] > 0.0:
            continue
        span = locate(knot_time[j, m] / weight[j, m], c.shape[0] // 3, basis)
        point(c, span, basis, x)
        least = 1e-6 * (info[j, m, 0, 0] + info[j, m, 1, 1] + info[j, m, 2, 2])
        fold_gaussian(R, z, info[j, m], rhs[j, m], least, x, span, basis, tmp.rows, tmp.right)
    control_points(R, z, c)


class Person(NamedTuple):
    """What a frame set says of one person, and what was predicted.

    Attributes
    ----------
    xyz_m, prior_m2
        Predicted joints at each image's time, and their covariance at the frame set's time.
    match, flip
        Detection in each image or -1; 1 where it is read with left and right exchanged.
    inlier
        Result: responsibility of each joint for its key point.
    """

    xyz_m: Float64[np.ndarray, "view joint 3"]
    prior_m2: Float64[np.ndarray, "joint 3 3"]
    match: Int64[np.ndarray, " view"]
    flip: Int64[np.ndarray, " view"]
    inlier: Float64[np.ndarray, "view joint"]


@inner
def gather_views(seen, measured, prediction, moment, k, matches):
    """Copy what the matched images of track `k` have in common to `seen`; return how many."""
    cam, knot_time, moment_of, credit = seen.cam, seen.knot_time, seen.moment, seen.credit
    slack, camera, taken = seen.slack, measured.cam, prediction.knot_time
    match, weight = matches.match[k], matches.weight[k]
    n = 0
    for v in range(match.shape[0]):
        if match[v] >= 0:
            cam[n], knot_time[n], moment_of[n] = camera[v], taken[v], moment[v]
            credit[n], slack[n] = weight[v], prediction.slack[v, k]
            n += 1
    return n


@inner
def gather_joint(seen, j, person, measured, noise):
    """Copy the key points of a joint in the matched images of one track to `seen`; count them."""
    there_m, found_px, sigma_m = seen.xyz_m, seen.xy_px, seen.sigma_m
    match, flip, xyz_m = person.match, person.flip, person.xyz_m
    xy_px, sigma_scale = measured.xy_px, measured.sigma_scale
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
def seek_body(cameras, noise, measured, person, inflation, seen, n, located, tmp):
    """Find all joints of one person in the images of a frame set; see `fit_all`.

    Parameters
    ----------
    cameras, noise, measured, person
        `Cameras`, `Noise`, `Measurements` and `Person`.
    inflation
        Factor on the covariances of the predictions.
    seen, n
        `Observed`, with what the person's `n` images have in common filled in.
    located
        Result: `Located`.
    tmp
        `Scratch`.
    """
    prior, prior_m2, is_known = tmp.prior, person.prior_m2, located.is_known
    for j in range(is_known.shape[0]):
        known = gather_joint(seen, j, person, measured, noise)
        for a in range(3):
            for b in range(3):
                prior[a, b] = inflation * prior_m2[j, a, b]
        is_known[j] = known > 0
        if known:
            begin_em(prior, located, j, tmp)
            locate_joint(cameras, noise, seen, n, located, j, tmp)
        else:
            clear(located.info[j], located.rhs[j], located.knot_time[j], located.weight[j])
        spread(person.match, located.inlier, is_known[j], person.inlier, j)


@inner(allocates=True)
def nis_ratio(located, prior_m2):
    """Return the normalised innovation squared of all joints, over its expected value.

    Parameters
    ----------
    located
        `Located`.
    prior_m2
        Covariance of the predictions, (joint, 3, 3).

    Notes
    -----
    With a prediction's covariance ``P`` and the fit's ``Q``, a shift ``d`` of the prediction has
    covariance ``P - Q``, so that ``d P^-1 d`` has the mean ``3 - tr(P^-1 Q)``. The sum over all
    joints has far less relative spread than a single joint's, and people turn as a whole.
    """
    shift_m, cov_m2, is_known = located.shift_m, located.cov_m2, located.is_known
    info = np.empty((3, 3))
    found_nis = expected_nis = 0.0
    for j in range(is_known.shape[0]):
        if not is_known[j]:
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


@inner(allocates=True)
def fit_all(cameras, noise, measured, prediction, matches, tracks, inlier):
    """Fit every track to the detections assigned to it in one frame set, in place.

    Parameters
    ----------
    cameras, noise, measured, prediction, matches
        `Cameras`, `Noise`, `Measurements`, `Prediction` and `Matches`.
    tracks
        `Trajectories`, changed in place.
    inlier
        Result, (track, view, joint): responsibility of the joint for its key point.

    Notes
    -----
    The process noise is low, which suits steady motion. A sharp turn shows in the innovations of
    all joints together; then the covariance of the whole body is inflated by the ratio of the
    innovations to their usual size (as in the strong tracking filter of Zhou and Frank 1996), and
    the joints are located again.
    """
    R, z, c, x_m, cov_m2 = tracks
    n_view, n_joint = measured.cam.shape[0], R.shape[1]
    seen = observed(n_view)
    moment = np.empty(n_view, np.int64)
    n_moment = moments(prediction.knot_time, moment) if n_view else 0
    found, tmp, weights = located(n_joint, n_moment, n_view), scratch(R.shape[2]), np.empty(4)
    is_known, y = found.is_known, tmp.y
    span = locate(prediction.now, R.shape[2] // 3, weights)
    for k in range(R.shape[0]):
        person = Person(
            prediction.xyz_m[:, k], prediction.cov_m2[k], matches.match[k], matches.flip[k],
            inlier[k],
        )  # fmt: skip
        n = gather_views(seen, measured, prediction, moment, k, matches)
        inflation = 1.0
        for again in range(2):
            seek_body(cameras, noise, measured, person, inflation, seen, n, found, tmp)
            ratio = 0.0 if again else nis_ratio(found, person.prior_m2)
            if ratio <= NIS_GATE:
                break
            inflation = min(ratio / USUAL_NIS, LARGEST_INFLATION)
            inflate_covariance(R[k], z[k], inflation)
        for j in range(n_joint):
            if is_known[j]:
                fold_moments(R[k, j], z[k, j], c[k, j], found, j, tmp)
            point(c[k, j], span, weights, x_m[k, j])
            curve_covariance(R[k, j], span, weights, y, cov_m2[k, j])


@inner
def spread(match, r, found, inlier, j):
    """Write the responsibilities `r` of the matched images, if found, to `inlier` (view, joint)."""
    n = 0
    for v in range(match.shape[0]):
        inlier[v, j] = 0.0
        if match[v] >= 0:
            inlier[v, j] = r[n] if found else 0.0
            n += 1
