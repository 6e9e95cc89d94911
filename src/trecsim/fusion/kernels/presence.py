"""Who is supported by whom, who lives on, and who is too close to whom."""

import math

import numpy as np

from trecsim.compiler import inner, kernel
from trecsim.fusion.kernels.small_matrices import largest
from trecsim.fusion.tuning import (
    CROWDED,
    FEWEST_INLIERS,
    INLIER,
    LEAST_PATIENCE,
    LONGEST_OFFSET_S,
    LOOK_MISSES,
    LOOK_SEES,
    REDUNDANT_CHECKS,
    SURE_CAMERAS,
    TENTATIVE_S,
    USUAL_CAMERAS,
    VIEW_OFFSET_S,
)


@inner
def note_support(measured, mirror, taken, matches, fitted, sightings):
    """Write down, in place, which camera supports whom and which joint, and when.

    Parameters
    ----------
    measured, mirror
        `Measurements`, and each joint's left-right counterpart.
    taken, matches, fitted
        `Taken`, `Matches` and `Fitted`.
    sightings
        `Sightings`, of which what is known per camera changes.
    """
    match, last_s, joint_s = matches.match, sightings.camera_s, sightings.joint_s
    cam, inlier, t_s = measured.cam, fitted.inlier, taken.t_s
    for k in range(match.shape[0]):
        for v in range(match.shape[1]):
            note_key_points(measured, mirror, k, v, matches, fitted, sightings)
            if match[k, v] < 0:
                continue
            supported = 0
            for j in range(inlier.shape[2]):
                supported += inlier[k, v, j] > INLIER
            if supported < FEWEST_INLIERS:
                continue
            note_offset(k, v, cam[v], fitted, taken.since_s[v], sightings.view_off_px)
            last_s[k, cam[v]] = max(last_s[k, cam[v]], t_s[v])
            for j in range(inlier.shape[2]):
                if inlier[k, v, j] > INLIER:
                    joint_s[k, j, cam[v]] = max(joint_s[k, j, cam[v]], t_s[v])


@inner
def note_key_points(measured, mirror, k, v, matches, fitted, sightings):
    """Write down, in place, how far the key points of an image lie from the joints of a track."""
    c, d, flipped = measured.cam[v], matches.match[k, v], matches.flip[k, v]
    off_m2, quality, scale_m = sightings.joint_off_m2, sightings.joint_quality, fitted.m_per_px
    for j in range(mirror.shape[0]):
        off_m2[k, j, c] = quality[k, j, c] = 0.0
        if d >= 0 and scale_m[k, v, j] > 0.0:
            scale = measured.sigma_scale[d, mirror[j] if flipped else j]
            off_px = fitted.off_px[k, v, j]
            quality[k, j, c] = 1.0 / (scale * scale)
            off_m2[k, j, c] = (off_px[0] ** 2 + off_px[1] ** 2) * scale_m[k, v, j] ** 2


@inner
def note_offset(k, v, c, fitted, since_s, view_off_px):
    """Average the mean innovation of a track in the images of a camera over time, in place."""
    passed_s = min(max(since_s, 0.0), LONGEST_OFFSET_S)
    share = passed_s / (passed_s + VIEW_OFFSET_S)
    for a in range(2):
        total, n = 0.0, 0
        for j in range(fitted.inlier.shape[2]):
            if fitted.inlier[k, v, j] > INLIER:
                total += fitted.innovation_px[k, v, j, a]
                n += 1
        view_off_px[k, c, a] += share * (total / n - view_off_px[k, c, a])


@inner
def count_since(last_s, since_s, out):
    """Write how many of the last axis of `last_s` (track, joint, cam) are later to `out`."""
    for k in range(out.shape[0]):
        for j in range(out.shape[1]):
            n = 0
            for c in range(last_s.shape[2]):
                n += last_s[k, j, c] > since_s
            out[k, j] = n


@inner
def count_supported(last_s, now_s, look_back_s, out):
    """Write how many cameras support each joint now to `out` (track, joint).

    Parameters
    ----------
    last_s
        When each camera last supported each joint, (track, joint, cam) [s].
    now_s, look_back_s
        The time, and for how long each camera's support counts as now, (cam,) [s].
    """
    for k in range(out.shape[0]):
        for j in range(out.shape[1]):
            out[k, j] = supporting(last_s[k, j], now_s, look_back_s)


@inner
def count_unseen(last_s, now_s, out):
    """Write for how long no camera has supported each joint to `out` (track, joint) [s].

    `last_s` is when each camera last supported each joint, (track, joint, cam) [s].
    """
    for k in range(out.shape[0]):
        for j in range(out.shape[1]):
            out[k, j] = now_s - largest(last_s[k, j])


@inner(allocates=True)
def second_newest(camera_s):
    """Return until when two cameras have seen each track: the second newest time (track,) [s]."""
    out = np.empty(camera_s.shape[0])
    for k in range(out.shape[0]):
        out[k] = second_of(camera_s[k])
    return out


@inner
def second_of(last_s):
    """Return the second largest of some times; -inf where there is only one."""
    latest = second = -math.inf
    for c in range(last_s.shape[0]):
        second = max(second, min(latest, last_s[c]))
        latest = max(latest, last_s[c])
    return second


@inner
def count_supporting(sights, now_s, out):
    """Write how many cameras support each joint now to `out` (track, joint).

    A camera does, if its newest image does and its next one is not overdue. `sights` are `Sights`.
    """
    newest_s, look_back_s, joint_s = sights.newest_s, sights.look_back_s, sights.joint_s
    for k in range(out.shape[0]):
        for j in range(out.shape[1]):
            n = 0
            for c in range(newest_s.shape[0]):
                n += joint_s[k, j, c] >= newest_s[c] > now_s - look_back_s[c]
            out[k, j] = n


@inner
def age(sightings, matches, now, look_back_s, before_s):
    """Count the time for which people have been supported by two cameras, and read mirrored.

    Parameters
    ----------
    sightings
        `Sightings`, of which all but the times per camera change.
    matches
        `Matches`.
    now
        `Now`: the time of the frame set, and since the last one.
    look_back_s
        For how long each camera's support counts as now, (cam,) [s].
    before_s
        Until when two cameras had seen each track before this frame set, (track,) [s].

    Notes
    -----
    Support looks back, the duration of support does not: it grows by the time between two images
    in which two cameras did see the person. What two cameras see in one image each, and never
    again, is not confirmed by time that passes, however long the cameras' intervals are.

    Whoever began with both cameras seeing the back for the front has a mirrored body, and every
    later detection is read mirrored to fit it. One camera that errs now and then is outvoted.
    """
    match, flip = matches.match, matches.flip
    camera_s, two_view_s = sightings.camera_s, sightings.two_view_s
    two_view_duration_s = sightings.two_view_duration_s
    mirrored_s = sightings.mirrored_duration_s
    longest_s = largest(look_back_s)
    for k in range(match.shape[0]):
        if supporting(camera_s[k], now.t_s, look_back_s) >= 2:
            two_view_s[k] = now.t_s
        added_s = second_of(camera_s[k]) - before_s[k]
        if math.isfinite(added_s):
            two_view_duration_s[k] += min(added_s, longest_s)
        seen = votes = 0
        for v in range(match.shape[1]):
            if match[k, v] >= 0:
                seen += 1
                votes += 2 * flip[k, v] - 1
        if seen:
            mirrored_s[k] = max(0.0, mirrored_s[k] + votes / seen * now.elapsed_s)


@inner
def supporting(last_s, now_s, look_back_s):
    """Return how many cameras support a person or joint now; see `count_supported`."""
    n = 0
    for c in range(last_s.shape[0]):
        n += last_s[c] > now_s - look_back_s[c]
    return n


@inner
def confirm_all(camera_s, two_view_duration_s, missing, now_s, look_back_s, confirm_s, confirmed):
    """Confirm, in place, whom two cameras have supported long enough or three support now.

    Parameters
    ----------
    camera_s, two_view_duration_s
        As in `Sightings`.
    missing
        How many cameras look at each track's place and see nobody, (track,).
    now_s, look_back_s
        The time, and for how long each camera's support counts as now, (cam,) [s].
    confirm_s, confirmed
        See `FusionSettings`; who is confirmed, (track,).

    Notes
    -----
    `confirm_s` is long enough for two cameras that support a track while no other one looks. For
    others it is longer by the ratio of the log likelihood ratios to a phantom.
    """
    for k in range(camera_s.shape[0]):
        n = supporting(camera_s[k], now_s, look_back_s)
        worth = (n * LOOK_SEES - missing[k] * LOOK_MISSES) / (2.0 * LOOK_SEES)
        if two_view_duration_s[k] * min(worth, 1.0) >= confirm_s - 1e-9 or (
            worth >= 1.0 and n >= SURE_CAMERAS
        ):
            confirmed[k] = True


@inner
def any_close(x_m, torso, distance_m):
    """Return whether the torsos of any two people are closer than `distance_m`, on average."""
    for k in range(x_m.shape[0]):
        for i in range(k):
            total = 0.0
            for j in torso:
                total += math.sqrt(
                    (x_m[k, j, 0] - x_m[i, j, 0]) ** 2
                    + (x_m[k, j, 1] - x_m[i, j, 1]) ** 2
                    + (x_m[k, j, 2] - x_m[i, j, 2]) ** 2
                )
            if total < distance_m * torso.shape[0]:
                return True
    return False


@kernel(allocates=True)
def judge_all(
    sightings, who, doubts, missing, x_m, torso, n_compared, now_s, look_back_s, limits, asked,
    alive,
):  # fmt: skip
    """Confirm tracks, in place, and tell which live on, for which it matters who should see them.

    Parameters
    ----------
    sightings, who, doubts, missing, x_m
        The tracks: `Sightings`, `Who`, `Doubts`, how many cameras look at each and see nobody
        (track,), and joints.
    torso
        The joints that stand for a person.
    n_compared
        Only so many of the tracks, the first, are compared as possible duplicates.
    now_s, look_back_s, limits
        Time of the frame set, for how long each camera's support counts as now, (cam,) [s], and
        `Limits`.
    asked, alive
        Results, (track,): whether it decides over the track how many cameras should detect the
        person; whether it lives on if two should.

    Returns
    -------
    Whether any two tracks are close, any track is asked for, and all live on.
    """
    camera_s, duration_s = sightings.camera_s, sightings.two_view_duration_s
    confirm_all(camera_s, duration_s, missing, now_s, look_back_s, limits.confirm_s, who.confirmed)
    close = any_close(x_m[:n_compared], torso, limits.duplicate_m)
    some_asked = ask_all(sightings, now_s, limits, asked)
    n_track = camera_s.shape[0]
    expected, leaving = np.empty(n_track, np.int64), np.empty(n_track, np.bool_)
    for k in range(n_track):
        expected[k], leaving[k] = 2, False
    all_alive = survive_all(
        sightings, who, doubts, (expected, leaving), x_m, now_s, look_back_s, limits, alive
    )
    return close, some_asked, all_alive


@kernel
def survive_all(sightings, who, doubts, views, x_m, now_s, look_back_s, limits, alive):
    """Write who lives on to `alive` (track,), return whether all do; see `lifecycle.judge`.

    Parameters
    ----------
    sightings, who, doubts
        `Sightings`, `Who` and `Doubts`.
    views, x_m
        By how many cameras everybody is expected and who is about to leave, (track,), and joints.
    now_s, look_back_s, limits
        Time of the frame set, for how long each camera's support counts as now, (cam,) [s], and
        `Limits`.
    alive
        Result, (track,).
    """
    camera_s, two_view_s = sightings.camera_s, sightings.two_view_s
    death_s, single_view_death_s = limits.death_s, limits.single_view_death_s
    (expected, leaving), confirmed, all_alive = views, who.confirmed, True
    least_s = smallest(look_back_s)
    for k in range(camera_s.shape[0]):
        alone_s, seen_s = now_s - two_view_s[k], largest(camera_s[k])
        waits_s = min(death_s * patience(expected[k], leaving[k]), seen_s - who.born_s[k])
        alive[k] = (
            now_s - seen_s <= max(waits_s, least_s)
            and not (alone_s > single_view_death_s and expected[k] >= CROWDED)
            and (confirmed[k] or alone_s <= TENTATIVE_S)
            and finite(x_m[k])
            and doubts.redundant_count[k] < REDUNDANT_CHECKS
        )
        all_alive &= alive[k]
    return all_alive


@inner
def patience(expected, leaving):
    """Return the share of `death_s` to wait for somebody whom so many cameras should find."""
    if expected == 0 or leaving:
        return LEAST_PATIENCE
    return min(max(USUAL_CAMERAS / expected, LEAST_PATIENCE), 1.0) if expected > 0 else 1.0


@inner
def smallest(values):
    """Return the smallest of some values; infinite if there are none."""
    least = math.inf
    for i in range(values.shape[0]):
        least = min(least, values[i])
    return least


@inner
def ask_all(sightings, now_s, limits, asked):
    """Write whose life hangs on how many cameras should find them to `asked` (track,).

    Parameters as for `survive_all`.
    """
    camera_s, two_view_s = sightings.camera_s, sightings.two_view_s
    death_s, single_view_death_s = limits.death_s, limits.single_view_death_s
    any_ = False
    for k in range(camera_s.shape[0]):
        asked[k] = (
            now_s - largest(camera_s[k]) > LEAST_PATIENCE * death_s
            or now_s - two_view_s[k] > single_view_death_s
        )
        any_ |= asked[k]
    return any_


@inner
def finite(x_m):
    """Return whether all of one person's joints have a finite place."""
    total = 0.0  # a sum with a NaN or infinity in it is not finite
    for j in range(x_m.shape[0]):
        total += abs(x_m[j, 0]) + abs(x_m[j, 1]) + abs(x_m[j, 2])
    return math.isfinite(total)
