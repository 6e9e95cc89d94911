"""One frame set enters all tracks: predict, associate, fit, constrain, in one call."""

import math

import numpy as np

from trecsim.compiler import inner, kernel
from trecsim.fusion.kernels.anatomy import constrain_all
from trecsim.fusion.kernels.body_motion import extend_all
from trecsim.fusion.kernels.curve import evaluate_all, knots
from trecsim.fusion.kernels.fitting_kernels import fit_all
from trecsim.fusion.kernels.groups import Matches, Prediction
from trecsim.fusion.kernels.information import covariance_all
from trecsim.fusion.kernels.matching import associate_all, owners
from trecsim.fusion.kernels.pair_checks import note_redundant, note_swaps
from trecsim.fusion.kernels.presence import age, count_since, note_support
from trecsim.fusion.kernels.small_matrices import largest
from trecsim.fusion.tuning import GATE_M, LEAST_INDEPENDENCE, MIRROR_S, SUPPORT_S, SWAP_EVIDENCE


@kernel(allocates=True)
def update_all(
    cameras, noise, bones, limbs, motion, tracks, bodies, sightings, confirmed, doubts, measured,
    taken, now, matches, owner, work,
):  # fmt: skip
    """Take the detections of one frame set into all tracks, in place.

    Parameters
    ----------
    cameras, noise, bones, limbs, motion
        Constants: `Cameras`, `Noise`, `Bones`, `Limbs` and `Motion`.
    tracks, bodies, sightings, confirmed, doubts
        The tracks: `Trajectories`, `Bodies`, `Sightings`, which are reported, (track,), and
        `Doubts`.
    measured, taken, now
        The frame set: `Measurements`, `Taken` and `Now`, with the knot grid moved on.
    matches
        Result: `Matches`. Given, where new tracks are fitted to their own detections.
    owner
        Result, (person,): see `owners`.
    work
        How many control points are appended first, whether the matches are given (then the tracks
        are fitted and nothing else), and whether to check the tracks for swaps.

    Returns
    -------
    How many detections may start a track, and whether any track is to be mirrored.
    """
    steps, given, check = work
    if steps:
        append(tracks, sightings, motion, now, steps)
    prediction = predict(tracks, taken, now)
    if not given:
        associate_all(cameras, noise, measured, prediction, GATE_M, matches)
    shape = tracks.R.shape[0], taken.t_s.shape[0], tracks.R.shape[1]
    inlier = np.empty(shape)
    weighted = Matches(matches.match, matches.flip, worth(matches, taken, motion))
    fit_all(cameras, noise, measured, prediction, weighted, tracks, inlier)
    note_support(measured.cam, taken.t_s, matches, inlier, sightings)
    age(sightings, matches, now.t_s, now.elapsed_s)
    if given:
        return 0, False
    if check:
        note_redundant(
            cameras, measured, prediction.xyz_m, matches.match, confirmed, doubts.redundant_count
        )
        note_swaps(cameras, bones, noise, measured, matches.match, doubts.swap_evidence)
    n_seen = np.empty(tracks.x_m.shape[:2], np.int64)
    count_since(sightings.joint_s, now.t_s - SUPPORT_S, n_seen)
    constrain_all(tracks, bodies, n_seen, limbs, noise.white_share, prediction.now, now.elapsed_s)
    two_view_s = trusted_two_view_s(sightings.two_view_s, doubts.swap_evidence)
    n_open = owners(matches.match, two_view_s, now.t_s, SUPPORT_S, owner)
    return n_open, largest(sightings.mirrored_duration_s) > MIRROR_S


@inner(allocates=True)
def append(tracks, sightings, motion, now, steps):
    """Append control points to all trajectories, in place."""
    seen = np.empty(tracks.x_m.shape[:2], np.int64)
    count_since(sightings.joint_s, now.t_s - now.knot_s - SUPPORT_S, seen)
    for _ in range(steps):
        extend_all(
            tracks, seen, motion.torso, motion.stiffness, motion.own_memory, motion.coasting_memory
        )


@inner(allocates=True)
def predict(tracks, taken, now):
    """Return the `Prediction` of all tracks for the images of a frame set."""
    n_view, n_track, n_joint = taken.t_s.shape[0], tracks.c.shape[0], tracks.c.shape[1]
    knot_time, here = np.empty(n_view), knots(now.t_s, now)
    for v in range(n_view):
        knot_time[v] = knots(taken.t_s[v], now)
    xyz_m = np.empty((n_view, n_track, n_joint, 3))
    evaluate_all(tracks.c, knot_time, xyz_m)
    cov_m2 = np.empty((n_track, n_joint, 3, 3))
    covariance_all(tracks.R, here, cov_m2)
    return Prediction(knot_time, here, xyz_m, cov_m2)


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
