"""Pairs of detections of two cameras that may be one person nobody knows yet."""

import math

import numpy as np

from trecsim.compiler import inner, kernel
from trecsim.fusion.kernels.mixture import NEAR_M, project

# Rays whose angle has a smaller squared sine than this (below 2 degrees) do not meet anywhere.
_PARALLEL = 1e-3
# Nobody is met nearer to a camera than this [m].
_TOO_CLOSE_M = 0.2
# So many joints at least must meet; of three, any two strangers have as many by chance.
_FEWEST = 4
# Rays that pass further from each other than so many standard deviations show different points.
_GATE = 3.0
# Log likelihood ratio of a limb's length: a body's spread, of about a third, against any length at
# all; whatever the length, it weighs no more than an outlier.
_LIMB_BEST, _LIMB_CURVE, _LIMB_WORST = 1.3, 4.0, -4.0
_SHORTEST_M = 1e-3
# A detection whose key points lie so near on average shows the person, at its distance [m].
_FITS_M = 0.12
_SQRT_2_PI = math.sqrt(2.0 * math.pi)


@inner
def ray_midpoint(p, u, q, v, out):
    """Write the point halfway between two rays to `out`; return their distance there [m].

    NaN where a ray is missing, they are nearly parallel, or meet behind a camera.
    """
    if math.isnan(u[0]) or math.isnan(v[0]):
        return math.nan
    b = u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
    den = 1.0 - b * b
    if den < _PARALLEL:
        return math.nan
    du = dv = 0.0
    for a in range(3):
        du += (q[a] - p[a]) * u[a]
        dv += (q[a] - p[a]) * v[a]
    s = (du - b * dv) / den
    t = (b * du - dv) / den
    if s < _TOO_CLOSE_M or t < _TOO_CLOSE_M:
        return math.nan
    gap = 0.0
    for a in range(3):
        first, second = p[a] + s * u[a], q[a] + t * v[a]
        out[a] = 0.5 * (first + second)
        gap += (first - second) ** 2
    return math.sqrt(gap)


@kernel
def midpoints(p, u, q, v, most_m, out):
    """Write the points halfway between the rays of two detections to `out`; count them.

    Parameters
    ----------
    p, u, q, v
        Where the rays start, (3,), and their directions, (joint, 3).
    most_m
        Rays that pass further from each other do not meet [m].
    out
        Result, (joint, 3); NaN where rays do not meet.
    """
    n = 0
    for j in range(u.shape[0]):
        meet = ray_midpoint(p, u[j], q, v[j], out[j]) < most_m
        n += meet
        if not meet:
            for a in range(3):
                out[j, a] = math.nan
    return n


@inner
def meeting_score(i, k, flipped, origin_m, ray, sigma_scale, noise, x):
    """Return how well the rays of detections `i` and `k` meet, and how many joints do.

    The points halfway are written to `x` (joint, 3), NaN where the rays miss each other.
    """
    total = noise.log_flip if flipped else 0.0
    close = 0
    for j in range(ray.shape[1]):
        m = noise.mirror[j] if flipped else j
        gap = ray_midpoint(origin_m[i], ray[i, j], origin_m[k], ray[k, m], x[j])
        if math.isnan(gap):
            x[j, 0] = math.nan
            continue
        sigma = noise.sigma_m[j] * math.sqrt(sigma_scale[i, j] ** 2 + sigma_scale[k, m] ** 2)
        gauss = math.exp(-0.5 * (gap / sigma) ** 2) / (sigma * _SQRT_2_PI)
        total += math.log((1.0 - noise.outlier_share) * gauss + noise.outlier_share)
        if gap < _GATE * sigma:
            close += 1
        else:
            x[j, 0] = math.nan
    return total, close


@inner
def limb_score(x, limbs, limb_m):
    """Return how much the limbs of the joints `x` (joint, 3) have the lengths of a body."""
    total = 0.0
    for b in range(limbs.shape[0]):
        p, q = x[limbs[b, 0]], x[limbs[b, 1]]
        if math.isnan(p[0]) or math.isnan(q[0]):
            continue
        length = math.sqrt((p[0] - q[0]) ** 2 + (p[1] - q[1]) ** 2 + (p[2] - q[2]) ** 2)
        ratio = math.log(max(length, _SHORTEST_M) / limb_m[b])
        total += max(_LIMB_BEST - _LIMB_CURVE * ratio * ratio, _LIMB_WORST)
    return total


@kernel(allocates=True)
def pair_scores(cam, origin_m, ray, sigma_scale, limbs, limb_m, noise, out, flip):
    """Score how well any two detections of different cameras are one person.

    Parameters
    ----------
    cam
        Camera of each detection, (person,).
    origin_m, ray
        Where its viewing rays start (person, 3) and their unit directions (person, joint, 3),
        NaN where the key point is missing.
    sigma_scale
        By how much each key point is less certain than a good one, (person, joint).
    limbs, limb_m
        Joints of each limb (limb, 2) and its usual length (limb,) [m].
    noise
        The detector's `Noise`.
    out, flip
        Results, (person, person), upper triangle: log ratio to chance; 1 where the two disagree
        about left and right.

    Notes
    -----
    Two rays of the same joint pass close to each other; the points halfway between them make a
    body of human size. Both are log likelihood ratios against rays and lengths at random.
    """
    x = np.empty((ray.shape[1], 3))
    for i in range(ray.shape[0]):
        for k in range(i + 1, ray.shape[0]):
            out[i, k] = -math.inf
            flip[i, k] = 0
            if cam[i] == cam[k]:
                continue
            for f in range(2):
                total, close = meeting_score(i, k, f, origin_m, ray, sigma_scale, noise, x)
                if close < _FEWEST:
                    continue
                total += limb_score(x, limbs, limb_m)
                if total > out[i, k]:
                    out[i, k] = total
                    flip[i, k] = f


@kernel(allocates=True)
def note_swaps(
    cam, offset, xy_px, sigma_scale, match, ray_of, position_m, limbs, limb_m, noise, clear, most,
    evidence,
):  # fmt: skip
    """Gather evidence that people are two people: another one in each of two images.

    Parameters
    ----------
    cam, offset
        Camera of each image, and where its detections begin.
    xy_px, sigma_scale
        Undistorted key points of all detections and their factors of uncertainty.
    match
        Detection of each track in each image or -1, (track, view). Only tracks with exactly two
        are looked at: a third camera would not agree with a wrong pair.
    ray_of, position_m
        Per camera, what turns a pixel into the direction of its viewing ray, and where that begins.
    limbs, limb_m, noise
        As for `pair_scores`.
    clear
        Tracks whose own pair fits so well are looked at only as partners of others.
    most
        One look changes the evidence by no more than this.
    evidence
        Per track, changed in place, at least 0: it grows by what the log ratios would gain if the
        track gave one of its detections for a free one, or exchanged it with another track.

    Notes
    -----
    Where two people stand on one plane with both cameras, each can be taken for the other in one
    image. The two bodies that this makes persist, as every image shows what they predict, but rays
    and limbs of the right ones fit better.
    """
    n_track, n_joint = match.shape[0], xy_px.shape[1]
    room = (
        np.empty((2, 3)),
        np.empty((2, n_joint, 3)),
        np.empty((2, n_joint)),
        np.empty((n_joint, 3)),
    )
    sight = cam, xy_px, sigma_scale, ray_of, position_m, limbs, limb_m, noise, room
    # Filled in loops: `np.zeros` and `np.full` would be compiled for each type and shape.
    held, own, gain = np.empty(xy_px.shape[0], np.int64), np.empty(n_track), np.empty(n_track)
    pair, view = np.empty((n_track, 2), np.int64), np.empty((n_track, 2), np.int64)
    for d in range(held.shape[0]):
        held[d] = 0
    for k in range(n_track):
        gain[k] = -most
        hold(match[k], held, pair[k], view[k])
        if pair[k, 0] >= 0:
            own[k] = pair_score(sight, view[k], pair[k, 0], pair[k, 1])
    for k in range(n_track):
        if pair[k, 0] >= 0 and own[k] < clear:
            exchange(sight, k, pair, view, own, gain)
            swapped = replaced(sight, offset, held, pair[k], view[k])
            gain[k] = max(gain[k], swapped - own[k])
    for k in range(n_track):
        evidence[k] = max(0.0, evidence[k] + min(gain[k], most))


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
def replaced(sight, offset, held, pair, view):
    """Return how well a pair fits at best if a free detection took the place of one of its own."""
    best = -math.inf
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
    cam, xy_px, sigma_scale, ray_of, position_m, limbs, limb_m, noise, room = sight
    origin_m, ray, pair_scale, x = room
    one, other = np.int64(0), np.int64(1)  # typed: nothing is compiled for 0 and 1 as well
    look(one, i, cam[view[0]], xy_px, sigma_scale, ray_of, position_m, origin_m, ray, pair_scale)
    look(other, k, cam[view[1]], xy_px, sigma_scale, ray_of, position_m, origin_m, ray, pair_scale)
    best = 0.0
    for f in range(2):
        total, close = meeting_score(one, other, f, origin_m, ray, pair_scale, noise, x)
        if close >= _FEWEST:
            best = max(best, total + limb_score(x, limbs, limb_m))
    return best


@inner
def look(row, d, c, xy_px, sigma_scale, ray_of, position_m, origin_m, ray, pair_scale):
    """Write where the rays of detection `d` of camera `c` begin and go to, and its factors."""
    for a in range(3):
        origin_m[row, a] = position_m[c, a]
    for j in range(xy_px.shape[1]):
        u, v = xy_px[d, j, 0], xy_px[d, j, 1]
        pair_scale[row, j] = sigma_scale[d, j]
        length2 = 0.0
        for a in range(3):
            ray[row, j, a] = ray_of[c, a, 0] * u + ray_of[c, a, 1] * v + ray_of[c, a, 2]
            length2 += ray[row, j, a] ** 2
        for a in range(3):
            ray[row, j, a] /= math.sqrt(length2)


@kernel
def note_redundant(P, focal_px, cam, xyz_m, xy_px, match, confirmed, looks):
    """Count the looks at which people are not needed to explain what the cameras see.

    Parameters
    ----------
    P, focal_px
        All cameras: projections (cam, 3, 4) and mean focal lengths (cam,) [px].
    cam
        Camera of each image, (view,).
    xyz_m
        Everybody's joints at each image's time, (view, track, joint, 3).
    xy_px, match
        Undistorted key points of all detections; detection of each track in each image or -1.
    confirmed
        Who is known for sure, (track,).
    looks
        Per track, changed in place: one more where exactly two images show the person, and in
        each of them somebody known, whom nothing shows there, fits the detection too; else one
        less, at least 0.

    Notes
    -----
    Whoever was made of halves of people who were not there yet keeps their detections from them.
    """
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
    """Return whether a detection of track `k` fits somebody whom nothing in the image shows."""
    for i in range(match.shape[0]):
        vacant = i != k and match[i] < 0 and confirmed[i]
        if vacant and away_m(P, focal_px[c], c, xyz_m[i], xy_px) < _FITS_M:
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
