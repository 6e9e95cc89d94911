"""What formats without missing positions get instead: the last pose, hidden where they can."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Bool, Float32, Float64


def held(xyz_m: Float32[np.ndarray, "frame joint 3"]) -> Float32[np.ndarray, "frame joint 3"]:
    """Replace each missing position by the last known one, at the beginning by the first.

    A joint that is never known is at the mean of the others.
    """
    known = np.isfinite(xyz_m).all(axis=-1)
    if known.all():
        return xyz_m
    number = np.where(known, np.arange(len(xyz_m))[:, None], -1)
    last = np.maximum.accumulate(number, axis=0)
    first = np.argmax(known, axis=0)
    source = np.where(last >= 0, last, first)
    filled = np.take_along_axis(xyz_m, source[..., None], axis=0)
    never = ~known.any(axis=0)
    if never.any():
        others = filled[:, ~never].mean(axis=1, keepdims=True) if not never.all() else 0.0
        filled[:, never] = others
    return filled


def visible_changes(
    there: Bool[np.ndarray, " frame"], t_s: Float64[np.ndarray, " frame"], longest_step_s: float
) -> Iterator[tuple[float, bool]]:
    """Yield when something appears and disappears, for keys that hold until the next one.

    Parameters
    ----------
    there
        Whether it is known at each time.
    t_s
        The times [s]; further apart than `longest_step_s` they have a gap between them.
    longest_step_s
        See above [s]; NaN for a single time.
    """
    was = None
    for number in range(len(t_s)):
        now = bool(there[number])
        if now != was:
            yield float(t_s[number]), now
            was = now
        ends = number + 1 == len(t_s) or t_s[number + 1] - t_s[number] > longest_step_s
        if ends and was:
            after = longest_step_s / 1.5 if np.isfinite(longest_step_s) else 0.04
            yield float(t_s[number]) + after, False
            was = False
