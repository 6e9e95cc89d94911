"""Feet that stand: an ankle that rests is held where it rests, so that it does not slide.

An ankle rests from the moment it is slow for as long as it stays within a small distance of its
mean place. It is then held above that place, with an even transition at both ends. Its height is
left as it is: a straight leg that is forced to be a little shorter would bend its knee a lot.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

Vectors = Float64[np.ndarray, "frame 3"]
Shares = Float64[np.ndarray, " frame"]

SLOW_MPS = 0.25
"""An ankle that is slower may rest; in a swing it moves at twice the speed of walking."""
AWAY_M = 0.025
"""It rests no more when it is further from its mean place: twice the noise of good tracks."""
LEAST_S, EVEN_S = 0.15, 0.08
_SPEED_OVER_S = 0.1
_UP = 1


@dataclass(frozen=True, slots=True, eq=False)
class Resting:
    """An ankle over time.

    Attributes
    ----------
    place_m
        Where it is [m].
    share
        How much of that is the place where it rests, 0 to 1.
    """

    place_m: Vectors
    share: Shares


def rested(ankle_m: Vectors, rate_hz: float) -> Resting:
    """Hold an ankle where it rests.

    Parameters
    ----------
    ankle_m
        Its positions over time, y up [m].
    rate_hz
        Frames per second.
    """
    place_m, share = ankle_m.copy(), np.zeros(len(ankle_m))
    ramp = max(round(EVEN_S * rate_hz), 1)
    for start, stop in _rests(ankle_m, rate_hz):
        length = stop - start
        at = np.minimum(np.arange(1, length + 1), np.arange(length, 0, -1))
        held = np.clip(at / (ramp + 1), 0.0, 1.0)
        held = held * held * (3.0 - 2.0 * held)
        away_m = ankle_m[start:stop] - ankle_m[start:stop].mean(axis=0)
        away_m[:, _UP] = 0.0
        place_m[start:stop] -= held[:, None] * away_m
        share[start:stop] = held
    return Resting(place_m, share)


def _rests(ankle_m: Vectors, rate_hz: float) -> list[tuple[int, int]]:
    """Return where an ankle rests: first frame, and the one after the last."""
    span = max(round(_SPEED_OVER_S * rate_hz / 2), 1)
    padded = np.pad(ankle_m, ((span, span), (0, 0)), mode="edge")
    speed = np.linalg.norm(padded[2 * span :] - padded[: -2 * span], axis=1) * rate_hz / (2 * span)
    slow = (speed < SLOW_MPS).tolist()
    least = max(round(LEAST_S * rate_hz), 2)
    found, frame, points = [], 0, ankle_m.tolist()
    while frame < len(points):
        if not slow[frame]:
            frame += 1
            continue
        stop = _until(points, slow, frame)
        if stop - frame >= least:
            found.append((frame, stop))
        frame = stop
    return found


def _until(points: list[list[float]], slow: list[bool], start: int) -> int:
    """Return the first frame at which what rests from `start` on no longer does."""
    x, y, z = points[start]
    count = 1
    for frame in range(start + 1, len(points)):
        a, b, c = points[frame]
        away2 = (a - x) ** 2 + (b - y) ** 2 + (c - z) ** 2
        if not slow[frame] or away2 > AWAY_M**2:
            return frame
        count += 1
        x, y, z = x + (a - x) / count, y + (b - y) / count, z + (c - z) / count
    return len(points)
