"""Who is supported by whom, who should be seen by whom, and who is too close to whom."""

import math
from typing import no_type_check

from numba import njit

# A camera supports a joint or person "now" if it did within this time [s].
SUPPORT_S = 0.12
# A key point supports its joint from this responsibility on; so many of them support a person.
INLIER, FEWEST_INLIERS = 0.5, 3
# A camera should see somebody of whose torso at least this share is before its image.
IN_VIEW = 0.5
# The share of `death_s` after which somebody is given up whom no camera should see, as people have
# left then, or whom three or more should: that all of them miss the same person is rare.
UNSEEN_PATIENCE, CROWDED_PATIENCE = 0.5, 0.7
# A body nearer than this to a camera's plane is not expected in the image [m].
AHEAD_M = 0.1


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def note_support(cam, t_s, match, inlier, camera_s, joint_s):
    """Write down, in place, which camera supports whom and which joint, and when.

    Parameters
    ----------
    cam, t_s
        Camera and time of each image, (view,).
    match
        Detection of each track in each image or -1, (track, view).
    inlier
        Responsibility of each joint for its key point, (track, view, joint).
    camera_s, joint_s
        When each camera last supported a person (track, cam) and a joint (track, joint, cam) [s].
    """
    for k in range(match.shape[0]):
        for v in range(match.shape[1]):
            if match[k, v] < 0:
                continue
            supported = 0
            for j in range(inlier.shape[2]):
                supported += inlier[k, v, j] > INLIER
            if supported < FEWEST_INLIERS:
                continue
            camera_s[k, cam[v]] = max(camera_s[k, cam[v]], t_s[v])
            for j in range(inlier.shape[2]):
                if inlier[k, v, j] > INLIER:
                    joint_s[k, j, cam[v]] = max(joint_s[k, j, cam[v]], t_s[v])


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def count_since(last_s, since_s, out):
    """Write how many of the last axis of `last_s` (track, joint, cam) are later to `out`."""
    for k in range(out.shape[0]):
        for j in range(out.shape[1]):
            n = 0
            for c in range(last_s.shape[2]):
                n += last_s[k, j, c] > since_s
            out[k, j] = n


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def age(camera_s, match, flip, now_s, elapsed_s, two_s, together_s, mirrored_s):
    """Count the time for which people have been supported by two cameras, and read mirrored.

    Parameters
    ----------
    camera_s, match, flip
        As for `note_support`; 1 where a detection is read mirrored, (track, view).
    now_s, elapsed_s
        Time of the frame set, and since the last one [s].
    two_s, together_s, mirrored_s
        Per track, changed in place: when two cameras last supported the person, for how long
        they have, for how long most cameras have read the person mirrored [s].

    Notes
    -----
    Whoever began with both cameras seeing the back for the front has a mirrored body, and every
    later detection is read mirrored to fit it. One camera that errs now and then is outvoted.
    """
    for k in range(camera_s.shape[0]):
        if supporting(camera_s[k], now_s) >= 2:
            two_s[k] = now_s
            together_s[k] += elapsed_s
        seen = votes = 0
        for v in range(match.shape[1]):
            if match[k, v] >= 0:
                seen += 1
                votes += 2 * flip[k, v] - 1
        if seen:
            mirrored_s[k] = max(0.0, mirrored_s[k] + votes / seen * elapsed_s)


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def supporting(camera_s, now_s):
    """Return how many cameras support a person now."""
    n = 0
    for c in range(camera_s.shape[0]):
        n += camera_s[c] > now_s - SUPPORT_S
    return n


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def confirm_all(camera_s, together_s, now_s, confirm_s, confirmed):
    """Confirm, in place, whom two cameras have supported long enough or three support now."""
    for k in range(camera_s.shape[0]):
        if together_s[k] >= confirm_s - 1e-9 or supporting(camera_s[k], now_s) >= 3:
            confirmed[k] = True


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def expect_all(P, size_px, looking, torso, x_m, expected):
    """Write in how many of the cameras that are looking each person should be to `expected`.

    `P` is (cam, 3, 4), `size_px` (cam, 2), `looking` (cam,), `x_m` (track, joint, 3); a person is
    where the joints `torso` are.
    """
    for k in range(x_m.shape[0]):
        expected[k] = 0
        for c in range(P.shape[0]):
            if not looking[c]:
                continue
            inside = 0
            for j in torso:
                inside += in_view(P[c], size_px[c], x_m[k, j])
            expected[k] += inside >= IN_VIEW * torso.shape[0]


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def in_view(P, size_px, x):
    """Return whether a camera's image contains the point `x`, as if nothing stood before it."""
    w = P[2, 0] * x[0] + P[2, 1] * x[1] + P[2, 2] * x[2] + P[2, 3]
    if not w > AHEAD_M:
        return False
    for i in range(2):
        h = (P[i, 0] * x[0] + P[i, 1] * x[1] + P[i, 2] * x[2] + P[i, 3]) / w
        if not (0.0 <= h < size_px[i]):
            return False
    return True


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
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


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def survive_all(
    camera_s, two_s, confirmed, expected, x_m, now_s, death_s, doubt_s, tentative_s, alive
):
    """Write who lives on to `alive` (track,); see `trecsim.fusion.lifecycle.survivors`."""
    for k in range(camera_s.shape[0]):
        last_s = -math.inf
        for c in range(camera_s.shape[1]):
            last_s = max(last_s, camera_s[k, c])
        alone_s = now_s - two_s[k]
        patience_s = death_s * patience(expected[k])
        alive[k] = (
            now_s - last_s <= patience_s
            and not (alone_s > doubt_s and expected[k] >= 3)
            and (confirmed[k] or alone_s <= tentative_s)
            and finite(x_m[k])
        )


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def patience(expected):
    """Return the share of `death_s` to wait for somebody whom so many cameras should see."""
    if expected == 0:
        return UNSEEN_PATIENCE
    return CROWDED_PATIENCE if expected >= 3 else 1.0


@njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
@no_type_check
def finite(x_m):
    """Return whether all of one person's joints have a finite place."""
    total = 0.0  # a sum with a NaN or infinity in it is not finite
    for j in range(x_m.shape[0]):
        total += abs(x_m[j, 0]) + abs(x_m[j, 1]) + abs(x_m[j, 2])
    return math.isfinite(total)
