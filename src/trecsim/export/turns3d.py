"""Rotation matrices of bones: from axes, from directions, and as angles that do not jump."""

from itertools import permutations

import numpy as np
from jaxtyping import Float64

from trecsim.export.cubic import solve_tridiagonal

Vectors = Float64[np.ndarray, "frame 3"]
Rotations = Float64[np.ndarray, "frame 3 3"]

_TINY = 1e-9


def unit(vectors: Vectors) -> Vectors:
    """Return vectors of length one; of no length they stay zero."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.asarray(vectors / np.maximum(length, _TINY))


def across(vectors: Vectors, axis: Vectors) -> Vectors:
    """Return the unit vectors of what is left of `vectors` across the unit vectors `axis`."""
    return unit(vectors - np.sum(vectors * axis, axis=-1, keepdims=True) * axis)


def frame_of(left: Vectors, up: Vectors) -> Rotations:
    """Return rotations whose x axis is `left` and whose y axis is nearest to `up`."""
    x = unit(left)
    y = across(up, x)
    return np.stack([x, y, np.cross(x, y)], axis=-1)


def swing(rest: Float64[np.ndarray, " 3"], towards: Vectors) -> Rotations:
    """Return the shortest rotations that turn the unit vector `rest` to unit vectors.

    Notes
    -----
    With ``v = rest x towards`` and ``c = rest . towards`` it is ``1 + [v] + [v]^2 / (1 + c)``
    (Rodrigues). Exactly opposite to `rest` the axis is not defined; no limb gets there.

    Examples
    --------
    >>> turn = swing(np.array([0.0, -1.0, 0.0]), np.array([[0.0, 0.0, 1.0]]))
    >>> (turn[0] @ [0.0, -1.0, 0.0]).round(9).tolist()
    [0.0, 0.0, 1.0]
    """
    v = np.cross(rest, towards)
    c = towards @ rest
    cross = np.zeros((len(v), 3, 3))
    cross[:, 0, 1], cross[:, 0, 2], cross[:, 1, 2] = -v[:, 2], v[:, 1], -v[:, 0]
    cross -= cross.transpose(0, 2, 1)
    return np.asarray(np.eye(3) + cross + cross @ cross / np.maximum(1.0 + c, 1e-6)[:, None, None])


def twist(axis: Float64[np.ndarray, " 3"], angle: Float64[np.ndarray, " frame"]) -> Rotations:
    """Return the rotations about one unit axis by angles [rad]."""
    cross = np.cross(np.eye(3), axis)
    around = np.sin(angle)[:, None, None] * cross
    return np.asarray(np.eye(3) + around + (1 - np.cos(angle))[:, None, None] * (cross @ cross))


def steady_twist(
    axis: Float64[np.ndarray, " 3"], bend: Float64[np.ndarray, " 3"], lower: Vectors
) -> Float64[np.ndarray, " frame"]:
    """Return by how much an upper limb twists so that the lower one bends towards `bend` [rad].

    Parameters
    ----------
    axis
        Direction of the upper limb.
    bend
        The way a joint bends that is not twisted; at right angles to `axis`.
    lower
        Directions of the lower limb over time, seen from the upper one without twist.

    Notes
    -----
    A limb that is bent by theta tells the twist with weight ``sin(theta)^2``, a straight one not at
    all. The twist minimises ``sum w (phi - phi_seen)^2 + S sum (phi - phi_before)^2 +
    R sum phi^2``: where the limb is straight it moves evenly from one known value to the next.
    """
    side = np.cross(axis, bend)
    along, aside = lower @ bend, lower @ side
    weight = along**2 + aside**2
    seen = _unwrapped(np.arctan2(aside, along), weight)
    if len(seen) < 2:
        return seen
    step = np.full(len(seen), -_STEADY)
    diagonal = weight + 2.0 * _STEADY + _REST
    diagonal[[0, -1]] -= _STEADY
    return np.asarray(solve_tridiagonal(step, diagonal, step, (weight * seen)[:, None])[:, 0])


_STEADY, _REST = 0.1, 1e-4  # S and R


def _unwrapped(
    angles: Float64[np.ndarray, " frame"], weight: Float64[np.ndarray, " frame"]
) -> Float64[np.ndarray, " frame"]:
    """Add whole turns, so that each angle is near to those before it that were surely known."""
    out = np.empty(len(angles))
    now = 0.0
    for frame, (angle, sure) in enumerate(zip(angles.tolist(), weight.tolist(), strict=True)):
        near = angle - 2.0 * np.pi * round((angle - now) / (2.0 * np.pi))
        out[frame] = near
        now += sure / (sure + _STEADY) * (near - now)
    return out


def best_rotation(
    rest: Float64[np.ndarray, "point 3"], points: Float64[np.ndarray, "frame point 3"]
) -> Rotations:
    """Return the rotations of `rest` that fit points best, both about the origin.

    Notes
    -----
    Kabsch (1976): with ``U S V' = svd(points' rest)``, ``R = U diag(1, 1, det(U V')) V'``.
    """
    u, _, vt = np.linalg.svd(points.transpose(0, 2, 1) @ rest)
    u[:, :, 2] *= np.linalg.det(u @ vt)[:, None]
    return np.asarray(u @ vt)


def calm_order(turns: Rotations, usual: str) -> str:
    """Return the order in which the angles of moving bones stay farthest from gimbal lock.

    Notes
    -----
    Where the middle angle is b, a rotation by d moves the other two by up to ``d / cos(b)``. The
    order with the smallest such step is chosen; the usual one where it exceeds none by a quarter.

    Examples
    --------
    >>> x = np.array([1.0, 0.0, 0.0])
    >>> calm_order(twist(x, np.radians([0.0, 45.0, 90.0, 135.0])), "YXZ")
    'XYZ'
    """
    steps = turned(turns)
    if not len(steps):
        return usual
    orders = sorted("".join(order) for order in permutations("XYZ"))
    best = min(orders, key=lambda order: _largest_step(turns, steps, order))
    good_enough = 1.25 * _largest_step(turns, steps, best)
    return usual if _largest_step(turns, steps, usual) <= good_enough else best


def turned(turns: Rotations) -> Float64[np.ndarray, " step"]:
    """Return the angle from each rotation to the next [rad]."""
    cosine = (np.einsum("fij,fij->f", turns[:-1], turns[1:]) - 1.0) / 2.0
    return np.asarray(np.arccos(np.clip(cosine, -1.0, 1.0)))


def _largest_step(turns: Rotations, steps: Float64[np.ndarray, " step"], order: str) -> float:
    sine = turns[:, "XYZ".index(order[0]), "XYZ".index(order[2])]
    cosine = np.sqrt(np.maximum(1.0 - sine**2, 1e-4))
    return round(float((steps / np.minimum(cosine[:-1], cosine[1:])).max()), 9)


def steady_angles(turns: Rotations, order: str) -> Float64[np.ndarray, "frame 3"]:
    """Return rotations as three angles [rad] that never jump where the rotation does not.

    Parameters
    ----------
    turns
        Rotations over time.
    order
        Axes in the order of the product, as ``"ZXY"`` for ``Rz Rx Ry``.

    Notes
    -----
    Each rotation has two sets of angles, ``(a, b, c)`` and ``(a + pi, pi - b, c + pi)``, each up
    to whole turns; the one nearest to the frame before is taken.
    """
    i, j, k = ("XYZ".index(axis) for axis in order)
    sign = 1.0 if (j - i) % 3 == 1 else -1.0
    first = np.stack(
        [
            np.arctan2(-sign * turns[:, j, k], turns[:, k, k]),
            np.arcsin(np.clip(sign * turns[:, i, k], -1.0, 1.0)),
            np.arctan2(-sign * turns[:, i, j], turns[:, i, i]),
        ],
        axis=-1,
    )
    second = np.stack([first[:, 0] + np.pi, np.pi - first[:, 1], first[:, 2] + np.pi], axis=-1)
    return _continued(np.stack([first, second], axis=1))


def _continued(choices: Float64[np.ndarray, "frame 2 3"]) -> Float64[np.ndarray, "frame 3"]:
    """Choose one of the two sets at each frame, the nearest to the one before, and unwrap.

    The sets change roles alike: from the first to the first is as far as from the second to the
    second. So whether to change over is known of each step alone.
    """
    same = _apart(choices[1:, 0], choices[:-1, 0])
    crossed = _apart(choices[1:, 1], choices[:-1, 0])
    start = int(_apart(choices[:1, 1], 0.0)[0] < _apart(choices[:1, 0], 0.0)[0])
    chosen = (start + np.concatenate([[0], np.cumsum(crossed < same)])) % 2
    angles = choices[np.arange(len(choices)), chosen]
    whole = 2.0 * np.pi
    angles -= whole * np.round(angles[:1] / whole)
    return np.asarray(np.unwrap(angles, axis=0))


def _apart(
    a: Float64[np.ndarray, "frame 3"], b: "Float64[np.ndarray, 'frame 3'] | float"
) -> Float64[np.ndarray, " frame"]:
    """Return how far sets of angles are apart, whole turns aside [rad]."""
    whole = 2.0 * np.pi
    steps = a - b
    return np.asarray(np.abs(steps - whole * np.round(steps / whole)).sum(axis=1))
