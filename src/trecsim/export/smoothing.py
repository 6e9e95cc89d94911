"""Smoothing of motion at a fixed rate, by name; gaps are kept and nothing is smoothed across one.

Both filters work forwards and backwards in time, so neither delays anything: their phase is zero.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float64

from trecsim.errors import InputError
from trecsim.export.motions import Motion, PersonMotion

Columns = Float64[np.ndarray, "frame column"]


@dataclass(frozen=True, slots=True)
class Smoothing:
    """A filter.

    Attributes
    ----------
    lag_s
        Each position becomes that of the parabola through all that are at most this long before
        and after it [s]; a program that does the same while it records is this much late.
    butterworth_hz
        Cut-off frequency of a Butterworth filter of order 4, of which half runs forwards and half
        backwards [Hz]; at that frequency 70.7 % of a movement are left.
    """

    lag_s: float | None = None
    butterworth_hz: float | None = None

    def __str__(self) -> str:
        if self.butterworth_hz is not None:
            return (
                f"Butterworth, order 4, {self.butterworth_hz:g} Hz, forwards and backwards "
                "(zero phase)"
            )
        if self.lag_s is not None:
            return f"parabola over {self.lag_s:g} s before and after (zero phase)"
        return "none"

    def checked(self, rate_hz: float) -> "Smoothing":
        """Return itself where it is possible at this rate.

        Raises
        ------
        InputError
            When it is not.
        """
        cut = self.butterworth_hz
        if cut is not None and self.lag_s is not None:
            raise InputError("give --lag-s or --butterworth-hz, not both: each is a smoothing")
        if cut is not None and not 0.0 < cut < 0.4 * rate_hz:
            raise InputError(
                f"--butterworth-hz {cut:g}: expected more than 0 and less than {0.4 * rate_hz:g}, "
                f"which is 0.4 of the rate of {rate_hz:g} frames per second"
            )
        if self.lag_s is not None and not 1.0 / rate_hz <= self.lag_s <= _LONGEST_LAG_S:
            raise InputError(
                f"--lag-s {self.lag_s:g}: expected {1.0 / rate_hz:.3g} s, which is one frame, to "
                f"{_LONGEST_LAG_S:g} s"
            )
        return self


NO_SMOOTHING = Smoothing()
_LONGEST_LAG_S = 5.0


def smoothed(motion: Motion, smoothing: Smoothing) -> Motion:
    """Return motion at a fixed rate with smoothed positions."""
    rate_hz = motion.rate_hz
    if rate_hz is None or (smoothing.lag_s is None and smoothing.butterworth_hz is None):
        return motion
    if smoothing.butterworth_hz is not None:
        cut_hz = smoothing.butterworth_hz

        def smooth(run: Columns) -> Columns:
            return butterworth(run, cut_hz / rate_hz)

    else:
        frames = round((smoothing.lag_s or 0.0) * rate_hz)

        def smooth(run: Columns) -> Columns:
            return local_parabola(run, frames)

    return replace(motion, people=tuple(_person(one, smooth) for one in motion.people))


def _person(one: PersonMotion, smooth: Callable[[Columns], Columns]) -> PersonMotion:
    xyz_m = one.xyz_m.copy()
    for joint in range(xyz_m.shape[1]):
        for run in _runs(one.known[:, joint]):
            if run.stop - run.start > 2:
                xyz_m[run, joint] = smooth(xyz_m[run, joint].astype(np.float64))
    return replace(one, xyz_m=xyz_m)


def _runs(known: np.ndarray) -> Iterator[slice]:
    edges = np.flatnonzero(np.diff(known.astype(np.int8), prepend=0, append=0))
    for start, stop in edges.reshape(-1, 2).tolist():
        yield slice(start, stop)


def butterworth(values: Columns, cut: float) -> Columns:
    """Filter forwards and backwards with a Butterworth filter of order 2.

    Parameters
    ----------
    values
        Samples over time.
    cut
        Cut-off frequency by the sampling frequency.

    Notes
    -----
    Two passes leave half the power at the corner of one, so the corner is moved by
    ``(sqrt(2) - 1)^(-1/4)`` (Winter 2009, section 2.2.4.4). Bilinear transform with
    ``w = tan(pi f)``; ends are continued by reflection about the first and the last sample.
    """
    w = math.tan(math.pi * min(cut / (math.sqrt(2.0) - 1.0) ** 0.25, 0.499))
    scale = 1.0 + math.sqrt(2.0) * w + w * w
    gain = w * w / scale
    first = 2.0 * (w * w - 1.0) / scale
    second = (1.0 - math.sqrt(2.0) * w + w * w) / scale
    pad = min(len(values) - 1, max(3, math.ceil(2.0 / cut)))
    before = 2.0 * values[0] - values[pad:0:-1]
    after = 2.0 * values[-1] - values[-2 : -pad - 2 : -1]
    padded = np.concatenate([before, values, after])
    once = _recursive(padded, gain, first, second)
    twice = _recursive(once[::-1], gain, first, second)[::-1]
    return twice[pad : pad + len(values)]


def _recursive(values: Columns, gain: float, first: float, second: float) -> Columns:
    out = np.empty_like(values)
    for column in range(values.shape[1]):
        x = values[:, column].tolist()
        x1 = x2 = y1 = y2 = x[0]
        found = []
        for x0 in x:
            y0 = gain * (x0 + 2.0 * x1 + x2) - first * y1 - second * y2
            x2, x1, y2, y1 = x1, x0, y1, y0
            found.append(y0)
        out[:, column] = found
    return out


def local_parabola(values: Columns, half: int) -> Columns:
    """Fit a parabola to the `half` samples before and after each one (Savitzky and Golay 1964).

    Near the ends the parabola is that of the nearest complete window.

    Examples
    --------
    >>> x = np.arange(9.0)[:, None]
    >>> bool(np.allclose(local_parabola(x**2, 2), x**2))
    True
    """
    half = min(half, (len(values) - 1) // 2)
    if half < 1:
        return values
    at = np.arange(-half, half + 1.0)
    powers = np.stack([np.ones_like(at), at, at**2], axis=1)
    hat = powers @ np.linalg.pinv(powers)
    out = np.empty_like(values)
    window = np.lib.stride_tricks.sliding_window_view(values, 2 * half + 1, axis=0)
    out[half : len(values) - half] = window @ hat[half]
    out[:half] = hat[:half] @ values[: 2 * half + 1]
    out[len(values) - half :] = hat[half + 1 :] @ values[-2 * half - 1 :]
    return out
