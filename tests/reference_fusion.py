"""Slow and obvious twins of the fusion's kernels, for tests to hold the two together."""

from itertools import pairwise

import numpy as np
from scipy.optimize import linear_sum_assignment
from scipy.stats import multivariate_normal


def log_ratio(e, C, m_per_px, outlier_share, outlier_area_m2):
    """Compare a key point's mixture density with clutter's, in metres; also the responsibility."""
    inlier = multivariate_normal(np.zeros(2), C * m_per_px**2).pdf(e * m_per_px)
    clutter = 1.0 / outlier_area_m2
    density = (1 - outlier_share) * inlier + outlier_share * clutter
    return np.log(density / clutter), (1 - outlier_share) * inlier / density


def project(P, x):
    h = P @ np.append(x, 1.0)
    return h[:2] / h[2]


def jacobian(P, x, step=1e-6):
    return np.stack(
        [(project(P, x + d) - project(P, x - d)) / (2 * step) for d in step * np.eye(3)], axis=1
    )


def exact_jacobian(P, x):
    """Differentiate `project` by the quotient rule."""
    u, v, w = P @ np.append(x, 1.0)
    return np.stack([P[0, :3] * w - u * P[2, :3], P[1, :3] * w - v * P[2, :3]]) / w**2


def depth(P, x):
    return P[2] @ np.append(x, 1.0)


def factor(score, good_score):
    return min(max(1.0, (good_score / score) ** 1.7), 6.0)


def widened(S_px2, m_per_px, leeway=12.0, leeway_m=0.06):
    """Widen a prediction's covariance in the image, as people may turn at once."""
    most = 2.0 * (leeway_m / m_per_px) ** 2 / np.trace(S_px2)
    return (1.0 + min(leeway, most)) * S_px2


def score_pair(
    P, focal_px, xyz_m, cov_m2, xy_px, trust, noise, error_px2, outlier_share, outlier_area_m2,
    flipped, slack=1.0,
):  # fmt: skip
    """Sum the log ratios of all joints of one detection under one person."""
    total = noise.log_flip if flipped else 0.0
    for j in range(len(xyz_m)):
        m = noise.mirror[j] if flipped else j
        w = depth(P, xyz_m[j])
        if np.isnan(xy_px[m, 0]) or not w > 0.05:
            continue
        J = jacobian(P, xyz_m[j])
        sigma = noise.sigma_m[j] * focal_px / w * trust[m]
        C = widened(J @ cov_m2[j] @ J.T, w / focal_px, 12.0 * slack**2, 0.06 * slack)
        C += (sigma**2 + noise.floor_px**2 + error_px2) * np.eye(2)
        e = xy_px[m] - project(P, xyz_m[j])
        total += log_ratio(e, C, w / focal_px, outlier_share, outlier_area_m2)[0]
    return total


def responsibility(ratio, temper):
    """Share every detection between the tracks and clutter, whose log ratio is 0."""
    weight = np.exp(ratio / temper)
    return weight / (weight.sum(axis=0) + 1.0)


def associate(ratio):
    """Assign every track of an image by SciPy; pairs below 0 are worth nothing."""
    return assign(np.maximum(ratio, -1.0))


def prefilter(xy_px, score, min_score, good_score):
    """Blot out key points one by one; the factors of the others."""
    xy_px, trust = xy_px.copy(), np.full(score.shape, 6.0)
    for place in np.ndindex(score.shape):
        if score[place] >= min_score and np.isfinite(xy_px[place]).all():
            trust[place] = factor(score[place], good_score)
        else:
            xy_px[place] = np.nan
    return xy_px, trust


def in_image(camera, x):
    """Project into the raw picture; pixel centres lie at integers."""
    if not (camera.T_cam_world[:3] @ np.append(x, 1.0))[2] > 0.1:
        return False
    u, v = camera.project(x)
    width, height = camera.size_px
    return bool(-0.5 <= u < width - 0.5 and -0.5 <= v < height - 0.5)


def gap_m(ray, start, end, points=201):
    """Least distance from points on one segment to the segment between the origin and `ray`."""
    on = start + np.linspace(0, 1, points)[:, None] * (end - start)
    share = np.clip(on @ ray / (ray @ ray), 0, 1)
    return np.linalg.norm(on - share[:, None] * ray, axis=1).min()


def hidden_share(eye_m, silhouette, torso, x_m, k, wider_m):
    """Count the joints behind anybody nearer, with all bodies wider by so much."""
    far_m = np.linalg.norm(x_m[k][torso].mean(axis=0) - eye_m)
    hidden = np.zeros(x_m.shape[1], bool)
    for other in np.delete(x_m, k, axis=0):
        if np.linalg.norm(other[torso].mean(axis=0) - eye_m) > far_m - 0.2:
            continue
        for (a, b, c, d), radius in zip(silhouette.ends, silhouette.radius_m, strict=True):
            start, end = (other[a] + other[b]) / 2 - eye_m, (other[c] + other[d]) / 2 - eye_m
            hidden |= [gap_m(x - eye_m, start, end) < radius + wider_m for x in x_m[k]]
    return hidden.mean()


def expected(rig, silhouette, looking, torso, x_m):
    """Count the cameras that look, have half of the torso in view and half of the joints free.

    At least and at most: bodies a centimetre wider, and narrower.
    """
    count = np.zeros((2, len(x_m)), int)
    for k, joints in enumerate(x_m):
        for camera, looks in zip(rig, looking, strict=True):
            if looks and np.mean([in_image(camera, x) for x in joints[torso]]) >= 0.5:
                for row, wider_m in zip(count, (0.01, -0.01), strict=True):
                    share = hidden_share(camera.position_m, silhouette, torso, x_m, k, wider_m)
                    row[k] += share < 0.5
    return count


def assign(gain):
    """Assign by SciPy, with one private empty column per row."""
    n_row, n_column = gain.shape
    padded = np.concatenate([np.maximum(gain, 0.0), np.zeros((n_row, n_row))], axis=1)
    row, column = linear_sum_assignment(padded, maximize=True)
    best = np.full(n_row, -1)
    for r, c in zip(row, column, strict=True):
        if c < n_column and gain[r, c] > 0:
            best[r] = c
    return best


def basis_rows(times, origin_s, knot_s, n_point):
    """Evaluate all cubic B-splines of a uniform grid by SciPy, (time, control point)."""
    from scipy.interpolate import BSpline

    knots = origin_s + knot_s * np.arange(-3, n_point + 1)
    return BSpline.design_matrix(np.asarray(times), knots, 3).toarray()


def smoothing_rows(n_point, stiffness, memory, drift):
    """Return rows and right-hand sides of the motion prior for one axis, start excluded."""
    rows, rhs = [], []
    for p in range(n_point - 2):
        row = np.zeros(n_point)
        row[p : p + 3] = memory, -(1 + memory), 1.0
        rows.append(stiffness * row)
        rhs.append(stiffness * (1 - memory) * drift)
    return np.array(rows), np.array(rhs)


def midpoint(p, u, q, v):
    """Minimise the distance between two rays by least squares."""
    (s, t), *_ = np.linalg.lstsq(np.stack([u, -v], axis=1), q - p, rcond=None)
    a, b = p + s * u, q + t * v
    return (a + b) / 2, np.linalg.norm(a - b)


def bias_information(model, j, x, last_s, quality, now_s):
    """Information on a joint whose key points all err for good, and what calibrations add."""
    info, of_cameras = np.zeros((3, 3)), np.zeros((3, 3))
    for c in np.flatnonzero(last_s > now_s - 0.12):
        sigma_px = model.noise.sigma_m[j] * model.cameras.focal_px[c] / depth(model.cameras.P[c], x)
        sigma_px /= np.sqrt(min(quality[c], 1.0) if quality[c] > 0 else 0.2)
        J = exact_jacobian(model.cameras.P[c], x)
        var = model.noise.bias_share * (sigma_px**2 + model.noise.floor_px**2)
        info += J.T @ J / var
        of_cameras += J.T @ J * model.cameras.error_px2[c] / var**2
    return info, of_cameras


def lasting_m2(model, j, x, last_s, quality, now_s):
    """Covariance of the lasting error of a joint's position."""
    two_s = np.sort(last_s)[-2]
    off_m = 0.1 + 0.1 * np.clip(now_s - 0.12 - two_s, 0.0, 5.0)
    info, of_cameras = bias_information(model, j, x, last_s, quality, now_s)
    own_m2 = np.linalg.inv(info + np.eye(3) / off_m**2)
    return own_m2 + own_m2 @ of_cameras @ own_m2


def wandering_m2ps2(model, j, x, last_s, quality, now_s):
    """Covariance of the error of a joint's velocity that lasting errors cause as they wander."""
    info, _ = bias_information(model, j, x, last_s, quality, now_s)
    return np.linalg.inv(info / 5.0**2 + np.eye(3) / 0.2**2)


def velocity(R, c, place, knot_s):
    """Velocity of one joint and its covariance, from the derivatives of SciPy's splines."""
    from scipy.interpolate import BSpline

    n_point = len(c) // 3
    knots = np.arange(-3.0, n_point + 1)
    row = BSpline(knots, np.eye(n_point), 3).derivative()(place) / knot_s
    B = np.kron(row, np.eye(3))
    return B @ c, B @ np.linalg.inv(R.T @ R) @ B.T


def spread_over(span, weights, n):
    """Return the rows that pick one point of a curve out of its `n` control values, (3, n)."""
    B = np.zeros((3, n))
    for m in range(4):
        B[:, 3 * (span + m) : 3 * (span + m) + 3] = weights[m] * np.eye(3)
    return B


def banded(rng, n=24):
    """Draw a square-root information as the kernels keep it: upper triangular, four points wide."""
    R = np.triu(rng.normal(0, 0.2, (n, n)))  # small beside the diagonal: it can be inverted
    for i in range(n):
        R[i, (i // 3) * 3 + 12 :] = 0.0
    R[np.diag_indices(n)] = rng.uniform(0.5, 2.0, n)
    return R


def marginalised(information, vector, first):
    """Take the first unknowns out of a Gaussian in information form (Schur complement)."""
    a, b = slice(first), slice(first, None)
    gain = information[b, a] @ np.linalg.inv(information[a, a])
    return information[b, b] - gain @ information[a, b], vector[b] - gain @ vector[a]


def motion_rows(n, stiffness, memory, drift_m):
    """Return rows and right-hand sides that tie the newest of the control points to two before."""
    rows = np.zeros((3, n))
    for a in range(3):
        rows[a, n - 9 + a] = memory * stiffness
        rows[a, n - 6 + a] = -(1.0 + memory) * stiffness
        rows[a, n - 3 + a] = stiffness
    return rows, (1.0 - memory) * stiffness * np.asarray(drift_m)


def learnt(length_m, length_m2, measured_m, measured_m2, share):
    """Combine a length with a measurement of it as two Gaussians, by precision."""
    precision = 1.0 / length_m2 + share / measured_m2
    mean = (length_m / length_m2 + share * measured_m / measured_m2) / precision
    return mean, max(1.0 / precision, 0.005**2)


def ground_rise(x, cov_m2, contact_m, level):
    """Return the lowest joint, how far it must rise to rest, and the variance; None if it jumps."""
    j = int(np.argmin(x[:, 2] - contact_m))
    rise_m, var = level[0] + contact_m[j] - x[j, 2], level[1] + 0.03**2
    return None if rise_m**2 > 9 * (var + cov_m2[j, 2, 2]) else (j, rise_m, var)


def levelled(level, x, cov_m2, n_seen, contact_m, elapsed_s):
    """Learn the height of the ground under one person from the lowest joint."""
    mean, var = level[0], level[1] + 0.02**2 * elapsed_s
    j = int(np.argmin(x[:, 2] - contact_m))
    measured, noise = x[j, 2] - contact_m[j], cov_m2[j, 2, 2] + 0.03**2
    if n_seen[j] < 2:
        return mean, var
    if (measured - mean) ** 2 > 9 * (var + noise):
        return mean, var + 0.15**2 * elapsed_s
    noise *= max(1.0, 0.5 / elapsed_s)
    return (mean * noise + measured * var) / (var + noise), var * noise / (var + noise)


def body_normal_equations(x, d, before_m2, weak, limbs, body):
    """Return information matrix and vector of the shifts of all joints."""
    n = len(x)
    A, b = np.zeros((3 * n, 3 * n)), np.zeros(3 * n)
    for j in range(n):
        A[3 * j : 3 * j + 3, 3 * j : 3 * j + 3] = np.linalg.inv(before_m2[j]) + np.eye(3) / 0.3**2
    for i, (j, k) in enumerate(limbs.joints):
        if not (weak[j] or weak[k]):
            continue
        u = x[k] + d[k] - x[j] - d[j]
        length = np.linalg.norm(u)
        u = u / length
        var = body.limb_m2[i] + limbs.slack_m2[i] + 0.01**2
        var += sum(u @ before_m2[m] @ u for m in (j, k) if not weak[m])
        row = np.zeros(3 * n)
        row[3 * k : 3 * k + 3], row[3 * j : 3 * j + 3] = u, -u
        A += np.outer(row, row) / var
        b += row * (body.limb_m[i] - length + u @ (d[k] - d[j])) / var
    return A, b


def usual_direction(x, postures, i):
    """Return the mean direction of a limb in the world, times its concentration."""
    _, near, before = postures.joints[i]
    hips, shoulders = x[postures.trunk[:2]], x[postures.trunk[2:]]
    up = shoulders.sum(axis=0) - hips.sum(axis=0)
    up /= np.linalg.norm(up)
    left, right = x[postures.trunk[postures.pair[i] : postures.pair[i] + 2]]
    aside = (left - right) - (left - right) @ up * up
    aside /= np.linalg.norm(aside)
    axes = np.stack([np.cross(aside, up), aside * postures.side[i], up])
    upper = x[near] - x[before]
    upper = upper / max(np.linalg.norm(upper), 1e-6)
    return axes.T @ (postures.mean[i] + postures.mean_by_upper[i] @ axes @ upper)


def directed(A, b, x, d, postures, unseen_s):
    """Add what is usual of limbs to normal equations, for ends that have not been seen for long."""
    for i, (far, near, _) in enumerate(postures.joints):
        share = np.clip((unseen_s[far] - 0.2) / 0.2, 0.0, 1.0)
        mean = usual_direction(x, postures, i)
        kappa, length_m = np.linalg.norm(mean), np.linalg.norm(x[far] - x[near])
        wanted_m = x[near] + d[near] + length_m * mean / kappa
        rows = slice(3 * far, 3 * far + 3)
        A[rows, rows] += share * kappa / length_m**2 * np.eye(3)
        b[rows] += share * kappa / length_m**2 * (wanted_m - x[far])


def relaxed(person, body, sights, limbs, postures, place, white_share, new_share):
    """Hold one person's weak joints by limbs and ground, with dense matrices throughout.

    `person` is trajectories and joints after the fit, `sights` how many cameras see each joint and
    for how long none has, `place` the rows (3, n) that pick the time of the frame set out of a
    trajectory. Return information matrices, control points, joints and
    covariances after that.
    """
    (R, _, c, x, cov_m2), (n_seen, unseen_s) = person, sights
    information = R.swapaxes(1, 2) @ R
    c, x, cov_m2 = c.copy(), x.copy(), cov_m2.copy()
    before_m2 = cov_m2 / white_share
    weak = (np.asarray(n_seen) < 2) | (np.trace(before_m2, axis1=1, axis2=2) > 0.2**2)
    if not weak.any():
        return information, c, x, cov_m2
    resting = ground_rise(x, before_m2, limbs.contact_height_m, body.level)
    d, free = np.zeros_like(x), np.repeat(weak, 3)
    for _ in range(3):
        A, b = body_normal_equations(x, d, before_m2, weak, limbs, body)
        directed(A, b, x, d, postures, unseen_s)
        if resting is not None and weak[resting[0]]:
            A[3 * resting[0] + 2, 3 * resting[0] + 2] += 1 / resting[2]
            b[3 * resting[0] + 2] += resting[1] / resting[2]
        A, b = A[np.ix_(free, free)], b[free]
        d[weak] = np.linalg.solve(A, b).reshape(-1, 3)
    held = np.linalg.inv(A)
    for i, j in enumerate(np.flatnonzero(weak)):
        told = np.linalg.inv(held[3 * i : 3 * i + 3, 3 * i : 3 * i + 3]) - np.eye(3) / 0.3**2
        C = np.linalg.inv(information[j])
        c[j] += C @ place.T @ np.linalg.solve(place @ C @ place.T, d[j])
        x[j], cov_m2[j] = place @ c[j], np.linalg.inv(told)
        new = new_share / white_share * (told - np.linalg.inv(before_m2[j]))
        information[j] += place.T @ new @ place
    return information, c, x, cov_m2


def log_mixture(P, focal_px, seen, noise, prior_m2, shift_m):
    """Return the log density of a joint's key points under the mixture, and of its shift."""
    total = -0.5 * shift_m @ np.linalg.solve(prior_m2, shift_m)
    for v, cam in enumerate(seen.cam):
        x = seen.xyz_m[v] + shift_m
        m_per_px = depth(P[cam], x) / focal_px[cam]
        e = seen.xy_px[v] - project(P[cam], x)
        var = (seen.sigma_m[v] / m_per_px) ** 2 + noise.floor_px**2
        student = (1.0 + e @ e / var / noise.tail) ** (-(noise.tail + 2.0) / 2.0)
        total += (
            seen.credit[v]
            / noise.white_share
            * np.log1p(noise.odds_m2 / (m_per_px**2 * var) * student)
        )
    return total


def ray(camera, xy_px):
    """Direction from a camera through a pixel of its ideal image."""
    R = camera.T_cam_world[:3, :3]
    direction = R.T @ np.linalg.solve(camera.K, np.append(xy_px, 1.0))
    return direction / np.linalg.norm(direction)


def met(eyes, xy_px):
    """Where the rays of two cameras through one pixel each meet, and how far apart they pass."""
    if np.isnan(xy_px).any():
        return np.full(3, np.nan), np.nan
    u, v = (ray(camera, xy) for camera, xy in zip(eyes, xy_px, strict=True))
    p, q = (camera.position_m for camera in eyes)
    point, gap = midpoint(p, u, q, v)
    near = min((point - p) @ u, (point - q) @ v) < 0.2
    return (point, np.nan) if near or 1 - (u @ v) ** 2 < 1e-3 else (point, gap)


def pair_readings(eyes, xy_px, trust, bones, bone_m, noise):
    """Compare two detections of two cameras with chance: rays that meet, limbs of human length.

    `xy_px` (2, joint, 2) is undistorted. Return the log ratio of both readings of left and right,
    -inf where fewer than four joints meet.
    """
    found = []
    for flipped, other in enumerate((np.arange(len(noise.mirror)), noise.mirror)):
        total, points = flipped * noise.log_flip, np.full((len(other), 3), np.nan)
        for j, m in enumerate(other):
            point, gap = met(eyes, (xy_px[0, j], xy_px[1, m]))
            if np.isnan(gap):
                continue
            sigma = noise.sigma_m[j] * np.hypot(trust[0, j], trust[1, m])
            inlier = multivariate_normal(0, sigma**2).pdf(gap)
            total += np.log((1 - noise.outlier_share) * inlier + noise.outlier_share)
            if gap < 3 * sigma:
                points[j] = point
        for (a, b), usual in zip(bones, bone_m, strict=True):
            length = np.linalg.norm(points[a] - points[b])
            if np.isfinite(length):
                total += max(1.3 - 4 * np.log(length / usual) ** 2, -4.0)
        found.append(total if np.isfinite(points[:, 0]).sum() >= 4 else -np.inf)
    return found


def pair_score(eyes, xy_px, trust, bones, bone_m, noise):
    """Return the better of both readings of two detections as one person, at least 0."""
    return max(0.0, *pair_readings(eyes, xy_px, trust, bones, bone_m, noise))


def exchange_gains(match, view_of, score, clear):
    """Try every other pair of detections for every track that has exactly two, one by one.

    `score(i, k)` says how well two detections fit each other.
    """
    gains = np.full(len(match), -np.inf)
    pairs = [tuple(row[row >= 0]) for row in match]
    held = {d for pair in pairs for d in pair}
    for k, own in enumerate(pairs):
        if len(own) != 2 or score(*own) >= clear:
            continue
        views = [view_of[d] for d in own]
        for n, other in enumerate(pairs):
            if n != k and len(other) == 2 and [view_of[d] for d in other] == views:
                both = score(own[0], other[1]) + score(other[0], own[1])
                gain = both - score(*own) - score(*other)
                gains[[k, n]] = np.maximum(gains[[k, n]], gain)
        for d in set(range(len(view_of))) - held:
            if view_of[d] == views[0]:
                gains[k] = max(gains[k], score(d, own[1]) - score(*own))
            if view_of[d] == views[1]:
                gains[k] = max(gains[k], score(own[0], d) - score(*own))
    return gains


def needless(P, focal_px, xyz_m, xy_px, match, confirmed):
    """Whose detections, if exactly two, all fit somebody confirmed without one in the image.

    Another one fits if it is within 12 cm, and not 5 cm worse than the track itself.
    """

    def away_m(v, i, d):
        return np.nanmean(
            [
                np.linalg.norm(project(P[v], x) - m) * depth(P[v], x) / focal_px[v]
                for x, m in zip(xyz_m[v, i], xy_px[d], strict=True)
            ]
        )

    out = []
    for k, row in enumerate(match):
        fits = [
            [
                away_m(v, i, row[v]) < min(0.12, away_m(v, k, row[v]) + 0.05)
                for i in range(len(match))
                if match[i, v] < 0 and confirmed[i]
            ]
            for v in np.flatnonzero(row >= 0)
        ]
        out.append(len(fits) == 2 and all(any(fit) for fit in fits))
    return np.array(out)


def stays_of_twins(offset, xy_px, factor):
    """Return which detections stay when of every two twins in an image the better one does."""
    known = np.isfinite(xy_px[..., 0])
    credit = (known / factor).sum(axis=1)
    stays = known.any(axis=1)
    for first, last in pairwise(offset):
        for d in range(first, last):
            box = xy_px[d][known[d]]
            for e in range(d + 1, last):
                both = known[d] & known[e]
                if not (stays[d] and stays[e] and both.any()):
                    continue
                apart = np.abs(xy_px[d, both] - xy_px[e, both]).max()
                if apart <= 0.03 * (box.max(axis=0) - box.min(axis=0)).max():
                    stays[d if credit[e] > credit[d] else e] = False
    return stays


def log_posture(postures, x, i):
    """Return the log density, up to a constant, of the direction of limb `i` of joints `x`."""
    far, near, _ = postures.joints[i]
    limb = x[far] - x[near]
    return usual_direction(x, postures, i) @ limb / np.linalg.norm(limb)
