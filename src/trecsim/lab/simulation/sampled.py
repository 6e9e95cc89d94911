"""Motions sampled at equidistant times and interpolated between them."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, Float64

from trecsim.lab.simulation.body_shape import JOINTS
from trecsim.lab.simulation.paths import STEP_S
from trecsim.lab.simulation.walkers import Walker

Weights = Float64[np.ndarray, "tap time"]


@dataclass(frozen=True, slots=True, eq=False)
class Sampled:
    """A motion given by joints at equidistant times.

    Attributes
    ----------
    enter_s
        Time at which the person appears, and of the first sample [s].
    step_s
        Between two samples [s].
    xyz_m
        COCO-17 joints [m].
    leave_s
        Time at which the person disappears [s].
    """

    enter_s: float
    step_s: float
    xyz_m: Float32[np.ndarray, "step 17 3"]
    leave_s: float

    def __call__(self, t_s: Float64[np.ndarray, " time"]) -> Float64[np.ndarray, "time 17 3"]:
        """Return the COCO-17 joints [m] at the times `t_s`; NaN while the person is absent.

        Notes
        -----
        Cubic between the samples (Catmull and Rom): limbs that turn about a joint keep their
        lengths far better than on straight lines.
        """
        xyz_m = np.full((len(t_s), JOINTS, 3), np.nan)
        here = (t_s >= self.enter_s) & (t_s <= self.leave_s)
        xyz_m[here] = between(self.xyz_m, (t_s[here] - self.enter_s) / self.step_s)
        return xyz_m


def sampled(walker: Walker) -> Sampled:
    """Return the same motion, sampled once for all cameras."""
    enter_s, leave_s = walker.path.enter_s, walker.path.leave_s
    steps = max(int(np.ceil((leave_s - enter_s) / STEP_S)), 1)
    t_s = np.linspace(enter_s, leave_s, steps + 1)
    return Sampled(enter_s, (leave_s - enter_s) / steps, walker(t_s).astype(np.float32), leave_s)


def between(
    samples: Float64[np.ndarray, "step *batch"] | Float32[np.ndarray, "step *batch"],
    entry: Float64[np.ndarray, " time"],
) -> Float64[np.ndarray, "time *batch"]:
    """Return values between equidistant samples, smooth through all of them.

    `entry` counts in steps from the first row.

    Examples
    --------
    >>> between(np.array([0.0, 1.0, 4.0, 9.0]), np.array([1.0, 1.5])).tolist()
    [1.0, 2.25]
    """
    last = len(samples) - 1
    left = np.clip(np.floor(entry), 0, max(last - 1, 0)).astype(int)
    u = entry - left
    weights = 0.5 * np.stack(
        [
            -u + 2 * u**2 - u**3,
            2 - 5 * u**2 + 3 * u**3,
            u + 4 * u**2 - 3 * u**3,
            -(u**2) + u**3,
        ]
    )
    _go_straight(weights, left == 0, (0, 1, 2))
    _go_straight(weights, left + 1 >= last, (3, 2, 1))
    value = np.zeros((len(entry), *samples.shape[1:]))
    for tap, weight in zip((-1, 0, 1, 2), weights, strict=True):
        row = np.clip(left + tap, 0, last)
        value += weight.reshape(-1, *[1] * (samples.ndim - 1)) * samples[row]
    return value


def _go_straight(weights: Weights, there: np.ndarray, taps: tuple[int, int, int]) -> None:
    """Let the values go on straight beyond an end: the first tap is missing there."""
    missing, end, inner = taps
    weights[end, there] += 2 * weights[missing, there]
    weights[inner, there] -= weights[missing, there]
    weights[missing, there] = 0.0
