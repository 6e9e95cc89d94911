"""Fitting a frame set: every joint is found, and the trajectories take it in."""

import math
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float64, Int64

from trecsim.compiler import inner
from trecsim.fusion.kernels.curve import locate, point
from trecsim.fusion.kernels.groups import Fitted
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
from trecsim.fusion.kernels.mixture import project
from trecsim.fusion.kernels.small_matrices import invert3, sandwich3, scale
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
    fitted
        Result: `Fitted`, of this person.
    lasting
        Mean innovation in each camera so far, and see `Taken.is_apart`.
    """

    xyz_m: Float64[np.ndarray, "view joint 3"]
    prior_m2: Float64[np.ndarray, "joint 3 3"]
    match: Int64[np.ndarray, " view"]
    flip: Int64[np.ndarray, " view"]
    fitted: Fitted
    lasting: tuple[Float64[np.ndarray, "cam 2"], Bool[np.ndarray, " view"]]


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
        spread(person.match, located, person.fitted, j)


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


@inner(allocates=True)
def nis_ratio_of_cameras(cameras, noise, measured, person, located):
    """Return the same ratio, without what lasting errors of the cameras explain.

    Parameters
    ----------
    cameras, noise, measured, person, located
        `Cameras`, `Noise`, `Measurements`, `Person` and `Located`.

    Notes
    -----
    An image whose error has the variance ``B`` shifts the fit by ``Q J' W e``, with the weight
    ``W``. So ``d P^-1 d`` grows by ``tr(P^-1 Q M Q)``, ``M = sum J' W B W J`` (a consider
    covariance). And what all key points of a camera have been off by lately is no news: the shift
    that it explains, ``Q J' W`` times that, is taken off.
    """
    shift_m, cov_m2, is_known = located.shift_m, located.cov_m2, located.is_known
    prior_m2 = person.prior_m2
    info, M, wide = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    pull, rest = np.empty(3), np.empty(3)
    found_nis = expected_nis = 0.0
    for j in range(is_known.shape[0]):
        if not is_known[j]:
            continue
        lasting_errors(cameras, noise, measured, person, shift_m[j], j, M, pull)
        sandwich3(cov_m2[j], M, wide)
        for p in range(3):
            rest[p] = shift_m[j, p]
            for q in range(3):
                rest[p] -= cov_m2[j, p, q] * pull[q]
        invert3(prior_m2[j], info)
        for p in range(3):
            expected_nis += 1.0
            for q in range(3):
                found_nis += rest[p] * info[p, q] * rest[q]
                expected_nis += info[p, q] * (wide[q, p] - cov_m2[j, q, p])
    return found_nis / expected_nis if expected_nis > 0.0 else 0.0


@inner
def lasting_errors(cameras, noise, measured, person, shift_m, j, M, pull):
    """Write what lasting errors may do to the fit of joint `j`, and what they are known to do.

    Parameters
    ----------
    cameras, noise, measured, person
        `Cameras`, `Noise`, `Measurements` and `Person`.
    shift_m, j
        How far the joint lies from its prediction, (3,), and its index.
    M, pull
        Results: ``sum J' W B W J`` (3, 3) and ``sum J' W e`` (3,), with ``B`` of the calibration
        and of the key points, where other cameras have come in between, and ``e`` what is known.
    """
    match, fitted, (off_px, is_apart) = person.match, person.fitted, person.lasting
    for p in range(3):
        pull[p] = 0.0
        for q in range(3):
            M[p, q] = 0.0
    for v in range(match.shape[0]):
        weight = fitted.weight[v, j]
        if match[v] < 0 or not weight > 0.0:
            continue
        c, x = measured.cam[v], person.xyz_m[v, j]
        _, _, _, du, dv = project(
            cameras.P, c, x[0] + shift_m[0], x[1] + shift_m[1], x[2] + shift_m[2]
        )
        var = 0.0
        if is_apart[v]:
            scale_ = measured.sigma_scale[match[v], noise.mirror[j] if person.flip[v] else j]
            sigma_px = noise.sigma_m[j] * scale_ / fitted.m_per_px[v, j]
            var = cameras.error_px2[c]
            var += noise.bias_share * (sigma_px * sigma_px + noise.floor_px * noise.floor_px)
        for p in range(3):
            pull[p] += weight * (off_px[c, 0] * du[p] + off_px[c, 1] * dv[p])
            for q in range(3):
                M[p, q] += weight * weight * var * (du[p] * du[q] + dv[p] * dv[q])


@inner
def inflate_covariance(R, z, inflation):
    """Multiply the covariance of one person's trajectories by `inflation`, in place."""
    for j in range(R.shape[0]):
        scale(R[j], z[j], 1.0 / math.sqrt(inflation))


@inner(allocates=True)
def fit_all(cameras, noise, measured, prediction, matches, tracks, lasting, fitted):
    """Fit every track to the detections assigned to it in one frame set, in place.

    Parameters
    ----------
    cameras, noise, measured, prediction, matches
        `Cameras`, `Noise`, `Measurements`, `Prediction` and `Matches`.
    tracks
        `Trajectories`, changed in place.
    lasting
        See `Sightings.view_off_px` and `Taken.is_apart`.
    fitted
        Result: `Fitted`.

    Notes
    -----
    The process noise is low, which suits steady motion. A sharp turn shows in the innovations of
    all joints together; then the covariance of the whole body is inflated by the ratio of the
    innovations to their usual size (as in the strong tracking filter of Zhou and Frank 1996), and
    the joints are located again. What the calibration's error may do to the innovations is expected
    of them: it is no turn.
    """
    R, z, c, x_m, cov_m2 = tracks
    view_off_px, is_apart = lasting
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
            Fitted(
                fitted.inlier[k], fitted.innovation_px[k], fitted.off_px[k], fitted.weight[k],
                fitted.m_per_px[k],
            ),
            (view_off_px[k], is_apart),
        )  # fmt: skip
        n = gather_views(seen, measured, prediction, moment, k, matches)
        inflation = 1.0
        for again in range(2):
            seek_body(cameras, noise, measured, person, inflation, seen, n, found, tmp)
            ratio = 0.0 if again else nis_ratio(found, person.prior_m2)
            if ratio > NIS_GATE:
                ratio = nis_ratio_of_cameras(cameras, noise, measured, person, found)
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
def spread(match, located, fitted, j):
    """Write how the key points of joint `j` fit, as it was `located`, to `fitted`."""
    inlier, innovation_px, off_px, weight, m_per_px = fitted
    n = 0
    for v in range(match.shape[0]):
        inlier[v, j] = weight[v, j] = m_per_px[v, j] = 0.0
        for a in range(2):
            innovation_px[v, j, a] = off_px[v, j, a] = 0.0
        if match[v] >= 0:
            if located.is_known[j] and located.m_per_px[n] > 0.0:
                inlier[v, j], weight[v, j] = located.inlier[n], located.weight_px[n]
                m_per_px[v, j] = located.m_per_px[n]
                for a in range(2):
                    innovation_px[v, j, a] = located.innovation_px[n, a]
                    off_px[v, j, a] = located.off_px[n, a]
            n += 1
