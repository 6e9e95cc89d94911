"""Who is who in every image: likelihoods of all pairs, assignment, responsibilities."""

import math

import numpy as np

from trecsim.compiler import inner
from trecsim.fusion.kernels.linear_assignment import assign
from trecsim.fusion.kernels.mixture import image_covariance, inlier_odds, project, widened
from trecsim.fusion.tuning import NEAR_M, TEMPER

# A detection that belongs to nobody, and one whose track two cameras support.
FREE, TAKEN = -1, -2


@inner
def project_person(P, focal_px, cam, xyz_m, cov_m2, slack, uv, S, depth_m):
    """Write a person's projected joints, their covariances (uu, uv, vv) and depths."""
    for j in range(xyz_m.shape[0]):
        w, u, v, du, dv = project(P, cam, xyz_m[j, 0], xyz_m[j, 1], xyz_m[j, 2])
        depth_m[j], uv[j, 0], uv[j, 1] = w, u, v
        spread = image_covariance(du, dv, cov_m2[j])
        S[j, 0], S[j, 1], S[j, 2] = widened(*spread, w / focal_px[cam], slack)


@inner
def mean_distance_m(uv, depth_m, focal_px, xy_px):
    """Return the mean distance between joints and key points at the person's distance [m]."""
    total, n = 0.0, 0
    for j in range(uv.shape[0]):
        if math.isnan(xy_px[j, 0]) or not depth_m[j] > NEAR_M:
            continue
        dx, dy = xy_px[j, 0] - uv[j, 0], xy_px[j, 1] - uv[j, 1]
        total += math.sqrt(dx * dx + dy * dy) * depth_m[j] / focal_px
        n += 1
    return total / n if n else math.inf


@inner
def person_log_ratio(uv, S, depth_m, camera, xy_px, sigma_scale, noise, flipped):
    """Return the log likelihood ratio of one detection and one person to clutter."""
    focal_px, error_px2 = camera
    sigma_m, mirror = noise.sigma_m, noise.mirror
    total = noise.log_flip if flipped else 0.0
    # A product of a few factors at a time: logarithms cost more than all the rest.
    product, least_px2 = 1.0, noise.floor_px * noise.floor_px + error_px2
    for j in range(uv.shape[0]):
        m = mirror[j] if flipped else j
        if math.isnan(xy_px[m, 0]) or not depth_m[j] > NEAR_M:
            continue
        m_per_px = depth_m[j] / focal_px
        sigma = sigma_m[j] / m_per_px * sigma_scale[m]
        var = sigma * sigma + least_px2
        odds = inlier_odds(
            xy_px[m, 0] - uv[j, 0], xy_px[m, 1] - uv[j, 1],
            S[j, 0] + var, S[j, 1], S[j, 2] + var, m_per_px, noise.odds_m2,
        )  # fmt: skip
        product *= noise.outlier_share * (1.0 + odds)
        if not 1e-100 < product < 1e100:
            total += math.log(product)
            product = 1.0
    return total + math.log(product)


@inner
def box_of(uv, box):
    """Write the bounds of the points that are known to `box`: least u, v, greatest u, v."""
    box[0] = box[1] = math.inf
    box[2] = box[3] = -math.inf
    for j in range(uv.shape[0]):
        if math.isnan(uv[j, 0]):
            continue
        box[0], box[1] = min(box[0], uv[j, 0]), min(box[1], uv[j, 1])
        box[2], box[3] = max(box[2], uv[j, 0]), max(box[3], uv[j, 1])


@inner
def gap_px(box, other):
    """Return how far two boxes are apart at least, 0 where they overlap [px]."""
    across = max(0.0, box[0] - other[2], other[0] - box[2])
    down = max(0.0, box[1] - other[3], other[1] - box[3])
    return max(across, down)


@inner(allocates=True)
def score_view(cameras, noise, cam, people, points, reach_m, scores):
    """Score every detection of one image against every track: log likelihood ratio to clutter.

    Parameters
    ----------
    cameras, noise
        `Cameras` and `Noise`.
    cam
        The camera that took the image.
    people
        Tracks at the image's time: joints (track, joint, 3), NaN where one is not known,
        covariances (track, joint, 3, 3), and slack, (track,), as for `widened`.
    points
        Undistorted key points (person, joint, 2), NaN where not to be used, and by how much each
        is less certain than a good one.
    reach_m
        Detections whose key points lie further away on average are not scored (-inf).
    scores
        Results, (track, person): log ratio; 1 where the exchanged reading is likelier.
    """
    (xyz_m, cov_m2, slack), (xy_px, sigma_scale), (out, flip) = people, points, scores
    P, focal_px = cameras.P, cameras.focal_px
    n_joint = xyz_m.shape[1]
    uv, S, depth_m = np.empty((n_joint, 2)), np.empty((n_joint, 3)), np.empty(n_joint)
    camera = focal_px[cam], cameras.error_px2[cam]
    mine, boxes = np.empty(4), np.empty((xy_px.shape[0], 4))
    for d in range(xy_px.shape[0]):
        box_of(xy_px[d], boxes[d])
    for k in range(xyz_m.shape[0]):
        project_person(P, focal_px, cam, xyz_m[k], cov_m2[k], slack[k], uv, S, depth_m)
        box_of(uv, mine)
        least_m = nearest_m(depth_m)
        for d in range(xy_px.shape[0]):
            out[k, d] = -math.inf
            flip[k, d] = 0
            # Boxes so far apart say the same as the mean distance, at a fraction of the cost.
            if gap_px(mine, boxes[d]) * least_m <= reach_m * camera[0]:
                out[k, d], flip[k, d] = pair_log_ratio(
                    uv, S, depth_m, camera, xy_px[d], sigma_scale[d], noise, reach_m
                )


@inner
def pair_log_ratio(uv, S, depth_m, camera, xy_px, sigma_scale, noise, reach_m):
    """Return the log likelihood ratio of one detection and one person, and the likelier reading.

    The ratio is -inf where the key points lie further away than `reach_m` on average. The reading
    is 1 with left and right exchanged, else 0. Other parameters as for `person_log_ratio`.
    """
    best, flipped = -math.inf, 0
    if mean_distance_m(uv, depth_m, camera[0], xy_px) <= reach_m:
        for f in range(2):
            ratio = person_log_ratio(uv, S, depth_m, camera, xy_px, sigma_scale, noise, f)
            if ratio > best:
                best, flipped = ratio, f
    return best, flipped


@inner
def nearest_m(depth_m):
    """Return the least depth of the joints before the camera; infinite if there is none [m]."""
    least = math.inf
    for j in range(depth_m.shape[0]):
        if depth_m[j] > NEAR_M:
            least = min(least, depth_m[j])
    return least


@inner(allocates=True)
def match_view(ratio, best):
    """Write for each track the detection that makes the sum of log ratios largest, or -1.

    `ratio` is (track, person), `best` (track,). Only where claims meet is there anything to weigh.
    """
    n_track, n_person = ratio.shape
    claims, claimed = np.empty(n_track, np.int64), np.empty(n_person, np.int64)
    for d in range(n_person):
        claimed[d] = 0
    for k in range(n_track):
        best[k] = -1
        claims[k] = 0
        for d in range(n_person):
            if ratio[k, d] > 0.0:
                claims[k] += 1
                claimed[d] += 1
                best[k] = d
    contested = 0
    for k in range(n_track):
        if claims[k] and (claims[k] > 1 or claimed[best[k]] > 1):
            contested += 1
            claims[k] = -1
    if contested:
        settle(ratio, claims, best)


@inner(allocates=True)
def settle(ratio, claims, best):
    """Assign the tracks marked by negative `claims` among the detections that any of them wants."""
    n_track, n_person = ratio.shape
    row, column = np.empty(n_track, np.int64), np.empty(n_person, np.int64)
    n = m = 0
    for k in range(n_track):
        if claims[k] < 0:
            row[n] = k
            n += 1
    for d in range(n_person):
        for i in range(n):
            if ratio[row[i], d] > 0.0:
                column[m] = d
                m += 1
                break
    part, found = np.empty((n, m)), np.empty(n, np.int64)
    for i in range(n):
        for d in range(m):
            part[i, d] = ratio[row[i], column[d]]
    assign(part, found)
    for i in range(n):
        best[row[i]] = column[found[i]] if found[i] >= 0 else -1


@inner
def responsibility(ratio, track, person, temper):
    """Return a track's responsibility for a detection, next to the others and clutter.

    Notes
    -----
    Thesis eq. 33 by log-sum-exp (eq. 25-26); the log ratio of clutter is 0.
    """
    top = 0.0
    for k in range(ratio.shape[0]):
        top = max(top, ratio[k, person])
    total = math.exp(-top / temper)
    for k in range(ratio.shape[0]):
        total += math.exp((ratio[k, person] - top) / temper)
    return math.exp((ratio[track, person] - top) / temper) / total


@inner(allocates=True)
def associate_all(cameras, noise, measured, prediction, reach_m, matches):
    """Assign the detections of every image to the tracks.

    Parameters
    ----------
    cameras, noise, measured, prediction
        `Cameras`, `Noise`, `Measurements` and `Prediction`.
    reach_m
        As for `score_view`.
    matches
        Result: `Matches`.
    """
    match, flip, sure = matches
    cam, offset, xy_px, sigma_scale = measured
    xyz_m, cov_m2 = prediction.xyz_m, prediction.cov_m2
    n_track = cov_m2.shape[0]
    best = np.empty(n_track, np.int64)
    for v in range(cam.shape[0]):
        first, last = offset[v], offset[v + 1]
        for k in range(n_track):
            match[k, v] = -1
            flip[k, v] = 0
            sure[k, v] = 0.0
        if first == last:
            continue
        ratio = np.empty((n_track, last - first))
        mirrored = np.empty((n_track, last - first), np.int64)
        score_view(
            cameras, noise, cam[v], (xyz_m[v], cov_m2, prediction.slack[v]),
            (xy_px[first:last], sigma_scale[first:last]), reach_m, (ratio, mirrored),
        )  # fmt: skip
        match_view(ratio, best)
        for k in range(n_track):
            if best[k] >= 0:
                match[k, v] = first + best[k]
                flip[k, v] = mirrored[k, best[k]]
                sure[k, v] = responsibility(ratio, k, best[k], TEMPER)


@inner
def owners(match, last_two_view_s, now_s, lately_s, owner):
    """Write to whom each detection belongs, if anybody; return how many may begin somebody new.

    Parameters
    ----------
    match
        Detection of each track in each image or -1, (track, view).
    last_two_view_s, now_s, lately_s
        When two cameras last supported each track (track,), the time now, and what is lately [s].
    owner
        Result, (person,): the track where two cameras have not supported it lately, `TAKEN` where
        they have, `FREE` for a detection that is nobody's.
    """
    for d in range(owner.shape[0]):
        owner[d] = FREE
    free = owner.shape[0]
    for k in range(match.shape[0]):
        lonely = now_s - last_two_view_s[k] > lately_s
        for v in range(match.shape[1]):
            if match[k, v] >= 0:
                owner[match[k, v]] = k if lonely else TAKEN
                free -= not lonely
    return free
