"""One frame set enters all tracks: predict, associate, fit, constrain, in one call."""

import math

import numpy as np

from trecsim.compiler import inner, kernel
from trecsim.fusion.kernels.anatomy import constrain_all
from trecsim.fusion.kernels.body_motion import extend_all
from trecsim.fusion.kernels.camera_error_kernels import keep_key_points, note_camera_errors
from trecsim.fusion.kernels.curve import evaluate_all, knots
from trecsim.fusion.kernels.distances import Shown, hold_distances
from trecsim.fusion.kernels.fitting_kernels import fit_all
from trecsim.fusion.kernels.groups import Fitted, Matches, Prediction
from trecsim.fusion.kernels.information import covariance_all
from trecsim.fusion.kernels.limb_places import choose_places
from trecsim.fusion.kernels.matching import associate_all, owners
from trecsim.fusion.kernels.mixture import slack_after
from trecsim.fusion.kernels.pair_checks import note_redundant, note_swaps
from trecsim.fusion.kernels.presence import (
    age,
    count_supported,
    count_unseen,
    note_support,
    second_newest,
)
from trecsim.fusion.kernels.small_matrices import largest
from trecsim.fusion.tuning import GATE_M, LEAST_INDEPENDENCE, MIRROR_S, SUPPORT_S, SWAP_EVIDENCE


@kernel(allocates=True)
def update_all(
    cameras, noise, bones, limbs, ruler, postures, motion, tracks, bodies, sightings, waiting,
    confirmed, doubts, ranges, errors, measured, taken, now, matches, owner, work,
):  # fmt: skip
    """Take the detections of one frame set into all tracks, in place.

    Parameters
    ----------
    cameras, noise, bones, limbs, ruler, postures, motion
        Constants: `Cameras`, `Noise`, `Bones`, `Limbs`, `Ruler`, `Postures` and `Motion`.
    tracks, bodies, sightings, waiting, confirmed, doubts, ranges
        The tracks: `Trajectories`, `Bodies`, `Sightings`, `Waiting`, which are reported, (track,),
        `Doubts` and `Ranges`.
    errors
        `CameraErrors`, changed in place.
    measured, taken, now
        The frame set: `Measurements`, `Taken` and `Now`, with the knot grid moved on.
    matches
        Result: `Matches`. Given, where new tracks are fitted to their own detections.
    owner
        Result, (person,): see `owners`.
    work
        How many control points are appended first, whether the matches are given (then the tracks
        are fitted and nothing else), whether to check the tracks for swaps, and whether they are
        those of people whom two cameras have never seen.

    Returns
    -------
    How many detections may start a track, and whether any track is to be mirrored.
    """
    steps, given, check, is_single = work
    if steps:
        append(tracks, sightings, motion, taken, now, steps)
    prediction = predict(tracks, sightings, taken, now)
    if not given:
        associate_all(cameras, noise, measured, prediction, GATE_M, matches)
    shape = tracks.R.shape[0], taken.t_s.shape[0], tracks.R.shape[1]
    fitted = Fitted(
        np.empty(shape), np.empty((*shape, 2)), np.empty((*shape, 2)), np.empty(shape),
        np.empty(shape),
    )  # fmt: skip
    weighted = Matches(matches.match, matches.flip, worth(matches, taken, motion))
    lasting = sightings.view_off_px, taken.is_apart
    fit_all(cameras, noise, measured, prediction, weighted, tracks, lasting, fitted)
    before_s = second_newest(sightings.camera_s)
    note_support(measured, noise.mirror, taken, matches, fitted, sightings)
    age(sightings, matches, now, taken.look_back_s, before_s)
    if given:
        return 0, False
    trusted = np.empty(shape[0], np.bool_)
    for k in range(shape[0]):
        trusted[k] = confirmed[k] and sightings.two_view_s[k] == now.t_s
    keep_key_points(measured, noise.mirror, matches, fitted, taken, waiting)
    note_camera_errors(cameras, tracks, trusted, now, waiting, errors)
    if check:
        note_redundant(
            cameras, measured, prediction.xyz_m, matches.match, confirmed, doubts.redundant_count
        )
        note_swaps(cameras, bones, noise, measured, matches.match, doubts.swap_evidence)
    n_seen = np.empty(tracks.x_m.shape[:2], np.int64)
    unseen_s = np.empty(tracks.x_m.shape[:2])
    count_supported(sightings.joint_s, now.t_s, taken.look_back_s, n_seen)
    count_unseen(sightings.joint_s, now.t_s, unseen_s)
    constrain_all(
        tracks, bodies, (n_seen, unseen_s), limbs, postures, noise.white_share, prediction.now,
        now.elapsed_s,
    )  # fmt: skip
    shown = Shown(cameras, noise.mirror, motion.torso, ruler, measured, taken)
    if not is_single:
        sights = sightings.joint_s, n_seen, doubts.other_place
        choose_places(
            cameras, postures, limbs.contact_height_m, tracks, bodies.level, sights, now,
            noise.white_share,
        )  # fmt: skip
    hold_distances(shown, tracks, bodies, sightings, confirmed, ranges, matches, now, is_single)
    two_view_s = trusted_two_view_s(sightings.two_view_s, doubts.swap_evidence)
    n_open = owners(matches.match, two_view_s, now.t_s, SUPPORT_S, owner)
    return n_open, largest(sightings.mirrored_duration_s) > MIRROR_S


@inner(allocates=True)
def append(tracks, sightings, motion, taken, now, steps):
    """Append control points to all trajectories, in place."""
    seen = np.empty(tracks.x_m.shape[:2], np.int64)
    count_supported(sightings.joint_s, now.t_s - now.knot_s, taken.look_back_s, seen)
    for _ in range(steps):
        extend_all(
            tracks, seen, motion.torso, motion.stiffness, motion.own_memory, motion.coasting_memory
        )


@inner(allocates=True)
def predict(tracks, sightings, taken, now):
    """Return the `Prediction` of all tracks for the images of a frame set."""
    n_view, n_track, n_joint = taken.t_s.shape[0], tracks.c.shape[0], tracks.c.shape[1]
    knot_time, here = np.empty(n_view), knots(now.t_s, now)
    for v in range(n_view):
        knot_time[v] = knots(taken.t_s[v] - taken.delay_s[v], now)
    xyz_m = np.empty((n_view, n_track, n_joint, 3))
    evaluate_all(tracks.c, knot_time, xyz_m)
    cov_m2 = np.empty((n_track, n_joint, 3, 3))
    covariance_all(tracks.R, here, cov_m2)
    slack = np.empty((n_view, n_track))
    for k in range(n_track):
        seen_s = largest(sightings.camera_s[k])
        for v in range(n_view):
            slack[v, k] = slack_after(taken.t_s[v] - seen_s)
    return Prediction(knot_time, here, xyz_m, cov_m2, slack)


@inner(allocates=True)
def worth(matches, taken, motion):
    """Return what each detection is worth to its track: less, soon after its camera's last image.

    Errors of a detector that are closer in time than `error_memory_s` are correlated.
    """
    responsibility = matches.weight
    weight = np.empty(responsibility.shape)
    for v in range(weight.shape[1]):
        independence = max(taken.since_s[v] / motion.error_memory_s, LEAST_INDEPENDENCE)
        for k in range(weight.shape[0]):
            weight[k, v] = responsibility[k, v] * min(independence, 1.0)
    return weight


@inner(allocates=True)
def trusted_two_view_s(two_view_s, swap_evidence):
    """Return when two cameras last supported each track; never, if its detections are swapped.

    Swapped means that they are of two people, by the evidence so far.
    """
    trusted_s = np.empty(two_view_s.shape[0])
    for k in range(trusted_s.shape[0]):
        trusted_s[k] = -math.inf if swap_evidence[k] > SWAP_EVIDENCE else two_view_s[k]
    return trusted_s
