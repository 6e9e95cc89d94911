"""Checks of existing tracks: detections of two people in one track, and tracks without need."""

import math

import numpy as np

from trecsim.compiler import inner
from trecsim.fusion.kernels.mixture import project
from trecsim.fusion.kernels.pairing import limb_score, meeting_score
from trecsim.fusion.tuning import (
    CLEAR_PAIR,
    FITS_BETTER_M,
    FITS_M,
    MOST_SWAP_EVIDENCE,
    NEAR_M,
    PAIR_JOINTS,
)


@inner(allocates=True)
def note_swaps(cameras, bones, noise, measured, match, evidence):
    """Gather evidence that people are two people: another one in each of two images.

    Parameters
    ----------
    cameras, bones, noise, measured
        `Cameras`, `Bones`, `Noise` and `Measurements`.
    match
        Detection of each track in each image or -1, (track, view). Only tracks with exactly two
        are looked at: a third camera would not agree with a wrong pair.
    evidence
        Per track, changed in place, at least 0: it grows by what the log ratios would gain if the
        track gave one of its detections for a free one, or exchanged it with another track; by
        `MOST_SWAP_EVIDENCE` at most.

    Notes
    -----
    Where two people stand on one plane with both cameras, each can be taken for the other in one
    image. The two bodies that this makes persist, as every image shows what they predict, but rays
    and limbs of the right ones fit better. Tracks whose own pair reaches `CLEAR_PAIR` are looked at
    only as partners of others.
    """
    n_track, n_joint = match.shape[0], measured.xy_px.shape[1]
    room = np.empty((2, n_joint, 3)), np.empty((n_joint, 3))
    sight = cameras, bones, noise, measured, room
    # Filled in loops: `np.zeros` and `np.full` would be compiled for each type and shape.
    held, own = np.empty(measured.xy_px.shape[0], np.int64), np.empty(n_track)
    gain = np.empty(n_track)
    pair, view = np.empty((n_track, 2), np.int64), np.empty((n_track, 2), np.int64)
    for d in range(held.shape[0]):
        held[d] = 0
    for k in range(n_track):
        gain[k] = -MOST_SWAP_EVIDENCE
        hold(match[k], held, pair[k], view[k])
        if pair[k, 0] >= 0:
            own[k] = pair_score(sight, view[k], pair[k, 0], pair[k, 1])
    for k in range(n_track):
        if pair[k, 0] >= 0 and own[k] < CLEAR_PAIR:
            exchange(sight, k, pair, view, own, gain)
            swapped = replaced(sight, held, pair[k], view[k])
            gain[k] = max(gain[k], swapped - own[k])
    for k in range(n_track):
        evidence[k] = max(0.0, evidence[k] + min(gain[k], MOST_SWAP_EVIDENCE))


@inner
def exchange(sight, i, pair, view, own, gain):
    """Raise `gain` of track `i` and others to what is gained if they exchanged a detection."""
    for k in range(pair.shape[0]):
        if k != i and pair[k, 0] >= 0 and view[k, 0] == view[i, 0] and view[k, 1] == view[i, 1]:
            one = pair_score(sight, view[i], pair[i, 0], pair[k, 1])
            other = pair_score(sight, view[i], pair[k, 0], pair[i, 1])
            gain[i] = max(gain[i], one + other - own[i] - own[k])
            gain[k] = max(gain[k], one + other - own[i] - own[k])


@inner
def replaced(sight, held, pair, view):
    """Return how well a pair fits at best if a free detection took the place of one of its own."""
    best, offset = -math.inf, sight[3].offset
    for side in range(2):
        for d in range(offset[view[side]], offset[view[side] + 1]):
            if not held[d]:
                first, second = (d, pair[1]) if side == 0 else (pair[0], d)
                best = max(best, pair_score(sight, view, first, second))
    return best


@inner
def hold(match, held, pair, view):
    """Mark a track's detections in `held`; write them and their images down if they are two."""
    n = 0
    for v in range(match.shape[0]):
        if match[v] >= 0:
            held[match[v]] = 1
            if n < 2:
                pair[n], view[n] = match[v], v
            n += 1
    if n != 2:
        pair[0] = pair[1] = -1


@inner
def pair_score(sight, view, i, k):
    """Return how well detections of two images are one person, at least 0: as log ratio to chance.

    `sight` is what `note_swaps` knows of them, and room to work in; `view` are the images.
    """
    cameras, bones, noise, measured, (ray, x) = sight
    c, e = measured.cam[view[0]], measured.cam[view[1]]
    look(cameras.ray_of[c], measured.xy_px[i], ray[0])
    look(cameras.ray_of[e], measured.xy_px[k], ray[1])
    one = cameras.position_m[c], ray[0], measured.sigma_scale[i]
    other = cameras.position_m[e], ray[1], measured.sigma_scale[k]
    best = 0.0
    for f in range(2):
        total, close = meeting_score(one, other, f, noise, 0.0, x)
        if close >= PAIR_JOINTS:
            best = max(best, total + limb_score(x, bones))
    return best


@inner
def look(ray_of, xy_px, ray):
    """Write the directions of the rays of one detection to `ray` (joint, 3)."""
    for j in range(xy_px.shape[0]):
        u, v = xy_px[j, 0], xy_px[j, 1]
        length2 = 0.0
        for a in range(3):
            ray[j, a] = ray_of[a, 0] * u + ray_of[a, 1] * v + ray_of[a, 2]
            length2 += ray[j, a] ** 2
        for a in range(3):
            ray[j, a] /= math.sqrt(length2)


@inner
def note_redundant(cameras, measured, xyz_m, match, confirmed, looks):
    """Count the looks at which people are not needed to explain what the cameras see.

    Parameters
    ----------
    cameras, measured
        `Cameras` and `Measurements`.
    xyz_m
        Everybody's joints at each image's time, (view, track, joint, 3).
    match
        Detection of each track in each image or -1, (track, view).
    confirmed
        Who is known for sure, (track,).
    looks
        Per track, changed in place: one more where exactly two images show the person, and in
        each of them somebody known, whom nothing shows there, fits the detection about as well;
        else one less, at least 0.

    Notes
    -----
    Whoever was made of halves of people who were not there yet keeps their detections from them.
    """
    P, focal_px, cam, xy_px = cameras.P, cameras.focal_px, measured.cam, measured.xy_px
    for k in range(match.shape[0]):
        n = explained = 0
        for v in range(match.shape[1]):
            n += match[k, v] >= 0
        for v in range(match.shape[1]):
            if n == 2 and match[k, v] >= 0:
                explained += fits_another(
                    P, focal_px, cam[v], xyz_m[v], xy_px[match[k, v]], match[:, v], confirmed, k
                )
        looks[k] = looks[k] + 1.0 if explained == 2 else max(0.0, looks[k] - 1.0)


@inner
def fits_another(P, focal_px, c, xyz_m, xy_px, match, confirmed, k):
    """Return whether a detection of track `k` fits somebody whom nothing in the image shows.

    Track `k` itself must not fit clearly better: then the image shows its person.
    """
    most_m = min(FITS_M, away_m(P, focal_px[c], c, xyz_m[k], xy_px) + FITS_BETTER_M)
    for i in range(match.shape[0]):
        vacant = i != k and match[i] < 0 and confirmed[i]
        if vacant and away_m(P, focal_px[c], c, xyz_m[i], xy_px) < most_m:
            return True
    return False


@inner
def away_m(P, focal_px, c, xyz_m, xy_px):
    """Return how far key points lie from a person's joints on average, at its distance [m]."""
    total, n = 0.0, 0
    for j in range(xyz_m.shape[0]):
        w, u, v, _, _ = project(P, c, xyz_m[j, 0], xyz_m[j, 1], xyz_m[j, 2])
        if not math.isnan(xy_px[j, 0]) and w > NEAR_M:
            total += math.sqrt((u - xy_px[j, 0]) ** 2 + (v - xy_px[j, 1]) ** 2) * w / focal_px
            n += 1
    return total / n if n else math.inf
