"""Correlated noise and mutual occlusion of people.

Arrays are C-contiguous float64.
"""

import math

import numpy as np

from trecsim.compiler import inner, kernel
from trecsim.lab.simulation.kernels.body_volume import ENDS, RADIUS_M, WIDEST_M


@kernel
def remember(values, keep, fresh):
    """Turn independent numbers into processes, in place: ``x = keep * last x + fresh * number``.

    Parameters
    ----------
    values
        Independent numbers of unit variance, (time, process).
    keep, fresh
        Shares per step, (time - 1).
    """
    for step in range(1, values.shape[0]):
        for process in range(values.shape[1]):
            values[step, process] = (
                fresh[step - 1] * values[step, process] + keep[step - 1] * values[step - 1, process]
            )


@kernel(allocates=True)
def hidden_by_bodies(position_m, xyz_m, hidden):
    """Find the joints that somebody else's body hides from a camera.

    Parameters
    ----------
    position_m
        Of the camera, (3) [m].
    xyz_m
        Joints, NaN while absent, (time, person, 17, 3) [m].
    hidden
        Result, (time, person, 17).
    """
    people, parts = xyz_m.shape[1], ENDS.shape[0]
    seen_m, length_m = np.empty((people, 17, 3)), np.empty((people, 17))  # from the camera
    ball, balls = np.empty((people, 7)), np.empty((people, parts, 7))
    start_m, along_m = np.empty((people, parts, 3)), np.empty((people, parts, 3))
    for time in range(xyz_m.shape[0]):
        for person in range(people):
            for joint in range(17):
                for axis in range(3):
                    seen_m[person, joint, axis] = (
                        xyz_m[time, person, joint, axis] - position_m[axis]
                    )
                length_m[person, joint] = math.sqrt(
                    _dot(seen_m[person, joint], seen_m[person, joint])
                )
            _enclose_body(seen_m[person], ball[person])
            _place_parts(seen_m[person], start_m[person], along_m[person], balls[person])
        for person in range(people):
            for other in range(people):
                if person != other and _may_hide(ball[other], ball[person]):
                    _hide(
                        seen_m[person],
                        length_m[person],
                        start_m[other],
                        along_m[other],
                        balls[other],
                        hidden[time, person],
                    )


@inner
def _place_parts(seen_m, start_m, along_m, balls):
    """Find where capsules start, the ways to their other ends, and balls about them."""
    for part in range(ENDS.shape[0]):
        first, second, third, fourth = ENDS[part]
        for axis in range(3):
            start = 0.5 * (seen_m[first, axis] + seen_m[second, axis])
            end = 0.5 * (seen_m[third, axis] + seen_m[fourth, axis])
            start_m[part, axis], along_m[part, axis] = start, end - start
            balls[part, axis] = 0.5 * (start + end)
        half_m = 0.5 * math.sqrt(_dot(along_m[part], along_m[part]))
        _look_at_ball(balls[part], half_m + RADIUS_M[part])


@inner
def _enclose_body(seen_m, ball):
    """Find a ball about all of a body's joints, and all of its parts."""
    for axis in range(3):
        low = high = seen_m[0, axis]
        for joint in range(1, 17):
            low, high = min(low, seen_m[joint, axis]), max(high, seen_m[joint, axis])
        ball[axis] = 0.5 * (low + high)
    furthest_m2 = 0.0
    for joint in range(17):
        far_m2 = 0.0
        for axis in range(3):
            far_m2 += (seen_m[joint, axis] - ball[axis]) ** 2
        furthest_m2 = max(furthest_m2, far_m2)
    _look_at_ball(ball, math.sqrt(furthest_m2) + WIDEST_M)


@inner
def _look_at_ball(ball, radius_m):
    """Complete a ball: middle, distance, radius [m], sine and cosine of half its angle of view."""
    ball[3] = math.sqrt(_dot(ball, ball))
    ball[4] = radius_m
    ball[5] = min(radius_m / max(ball[3], 1e-9), 1.0)
    ball[6] = math.sqrt(1.0 - ball[5] ** 2)


@inner
def _may_hide(other, person):
    """Return whether a ball is not behind another and touches its cone; false for NaN."""
    if not other[3] - other[4] < person[3] + person[4]:
        return False
    if other[5] == 1.0 or person[5] == 1.0:
        return True
    least = person[6] * other[6] - person[5] * other[5]  # cosine of the sum of both angles
    return _dot(other, person) > least * other[3] * person[3]


@inner(allocates=True)
def _hide(seen_m, length_m, start_m, along_m, balls, hidden):
    """Mark the joints behind the capsules of one body."""
    to_m = np.empty(3)
    for part in range(ENDS.shape[0]):
        ball, radius_m2 = balls[part], RADIUS_M[part] ** 2
        least = ball[6] * ball[3] if ball[5] < 1.0 else -np.inf
        for joint in range(17):
            if hidden[joint] or _dot(seen_m[joint], ball) < least * length_m[joint]:
                continue
            if _gap_m2(seen_m[joint], start_m[part], along_m[part]) <= radius_m2:
                for axis in range(3):
                    to_m[axis] = seen_m[joint, axis] - start_m[part, axis]
                # A joint within the other's body is in front of it as often as behind.
                hidden[joint] = _to_segment_m2(along_m[part], to_m) > radius_m2


@inner
def _dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inner
def _to_segment_m2(ray_m, point_m):
    """Return the squared distance of a point from the segment between the origin and `ray_m`."""
    length_m2 = max(_dot(ray_m, ray_m), 1e-18)
    share = min(max(_dot(ray_m, point_m) / length_m2, 0.0), 1.0)
    return (
        (point_m[0] - share * ray_m[0]) ** 2
        + (point_m[1] - share * ray_m[1]) ** 2
        + (point_m[2] - share * ray_m[2]) ** 2
    )


@inner
def _gap_m2(ray_m, start_m, along_m):
    """Return the squared distance of two segments: origin to `ray_m`; `start_m` on `along_m`."""
    a, b, c = _dot(ray_m, ray_m), _dot(ray_m, along_m), _dot(along_m, along_m)
    d, e = _dot(ray_m, start_m), _dot(along_m, start_m)
    between = a * c - b * b
    # Nearest points of the two lines, then clamped one after the other.
    s = min(max((d * c - b * e) / between, 0.0), 1.0) if between > 1e-12 * a * c else 0.0
    t = min(max((b * s - e) / max(c, 1e-18), 0.0), 1.0)
    s = min(max((b * t + d) / max(a, 1e-18), 0.0), 1.0)
    gap_m2 = 0.0
    for axis in range(3):
        gap_m2 += (s * ray_m[axis] - start_m[axis] - t * along_m[axis]) ** 2
    return gap_m2
