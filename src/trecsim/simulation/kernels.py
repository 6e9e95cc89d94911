"""Compiled kernels of the simulation; each has a slow, obvious twin in the tests.

Arrays are C-contiguous float64.
"""

import math
from typing import no_type_check

import numpy as np
from numba import njit

# A body blocks the view like these capsules: ends (means of two joints each) and radius [m].
# Trunk, neck and head (the ears are in its middle), thighs, shanks.
_ENDS = np.array(
    [
        [11, 12, 5, 6],
        [5, 6, 3, 4],
        [11, 11, 13, 13],
        [12, 12, 14, 14],
        [13, 13, 15, 15],
        [14, 14, 16, 16],
    ]
)
_RADIUS_M = np.array([0.16, 0.11, 0.09, 0.09, 0.06, 0.06])
_WIDEST_M = 0.16


@njit(cache=True, nogil=True)
@no_type_check
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


@njit(cache=True, nogil=True)
@no_type_check
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
    people = xyz_m.shape[1]
    middle_m, ball = np.empty((people, 3)), np.empty((people, 4))
    for time in range(xyz_m.shape[0]):
        for person in range(people):
            _enclose(xyz_m[time, person], position_m, middle_m[person], ball[person])
        for person in range(people):
            for other in range(people):
                if person != other and _may_hide(
                    middle_m[other], ball[other], middle_m[person], ball[person]
                ):
                    _hide(
                        position_m,
                        xyz_m[time, person],
                        xyz_m[time, other],
                        middle_m[other],
                        ball[other, 1],
                        hidden[time, person],
                    )


@njit(cache=True, nogil=True)
@no_type_check
def _enclose(xyz_m, position_m, middle_m, ball):
    """Find a ball about a body.

    Parameters
    ----------
    middle_m
        Result: its middle, seen from the camera; NaN while absent, (3) [m].
    ball
        Result: distance and radius [m], sine and cosine of half the angle under which it is seen.
    """
    for axis in range(3):
        middle_m[axis] = 0.25 * (
            xyz_m[11, axis] + xyz_m[12, axis] + xyz_m[5, axis] + xyz_m[6, axis]
        )
    furthest_m2 = 0.0
    for joint in range(17):
        furthest_m2 = max(furthest_m2, _distance_m2(xyz_m[joint], middle_m))
    for axis in range(3):
        middle_m[axis] -= position_m[axis]
    ball[0] = math.sqrt(_dot(middle_m, middle_m))
    ball[1] = math.sqrt(furthest_m2) + _WIDEST_M
    ball[2] = min(ball[1] / max(ball[0], 1e-9), 1.0)
    ball[3] = math.sqrt(1.0 - ball[2] ** 2)


@njit(cache=True, nogil=True)
@no_type_check
def _distance_m2(a, b):
    return (a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2 + (a[2] - b[2]) ** 2


@njit(cache=True, nogil=True)
@no_type_check
def _may_hide(other_m, other, person_m, person):
    """Return whether a ball is not behind another and touches its cone; false for NaN."""
    if not other[0] - other[1] < person[0] + person[1]:
        return False
    if other[2] == 1.0 or person[2] == 1.0:
        return True
    least = person[3] * other[3] - person[2] * other[2]  # cosine of the sum of both angles
    return _dot(other_m, person_m) > least * other[0] * person[0]


@njit(cache=True, nogil=True)
@no_type_check
def _hide(position_m, person_m, other_m, other_middle_m, other_radius_m, hidden):
    """Mark the joints of one person that the body of another hides."""
    ray_m, to_m = np.empty(3), np.empty(3)
    low_m, high_m = np.empty(3), np.empty(3)
    for joint in range(17):
        if hidden[joint]:
            continue
        for axis in range(3):
            ray_m[axis] = person_m[joint, axis] - position_m[axis]
        if _to_ray_m2(ray_m, other_middle_m) > other_radius_m**2:
            continue
        for part in range(_ENDS.shape[0]):
            for axis in range(3):
                low_m[axis] = 0.5 * (other_m[_ENDS[part, 0], axis] + other_m[_ENDS[part, 1], axis])
                high_m[axis] = 0.5 * (other_m[_ENDS[part, 2], axis] + other_m[_ENDS[part, 3], axis])
                low_m[axis] -= position_m[axis]
                high_m[axis] -= low_m[axis] + position_m[axis]
                to_m[axis] = ray_m[axis] - low_m[axis]
            radius_m2 = _RADIUS_M[part] ** 2
            # A joint within the other's body is in front of it as often as behind.
            if _to_ray_m2(high_m, to_m) > radius_m2 >= _gap_m2(ray_m, low_m, high_m):
                hidden[joint] = True
                break


@njit(cache=True, nogil=True)
@no_type_check
def _dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit(cache=True, nogil=True)
@no_type_check
def _to_ray_m2(ray_m, point_m):
    """Return the squared distance of a point from the segment from the origin to `ray_m`."""
    length_m2 = max(_dot(ray_m, ray_m), 1e-18)
    share = min(max(_dot(ray_m, point_m) / length_m2, 0.0), 1.0)
    return (
        (point_m[0] - share * ray_m[0]) ** 2
        + (point_m[1] - share * ray_m[1]) ** 2
        + (point_m[2] - share * ray_m[2]) ** 2
    )


@njit(cache=True, nogil=True)
@no_type_check
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
