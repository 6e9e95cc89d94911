"""Motions that are known at equidistant times: cheap to look up, at any time between."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, Float64

Weights = Float64[np.ndarray, "tap time"]


@dataclass(frozen=True, slots=True, eq=False)
class Sampled:
    """A motion by its joints at equidistant times.

    Attributes
    ----------
    enter_s
        When the person appears; time of the first sample [s].
    step_s
        Between two samples [s].
    xyz_m
        COCO-17 joints [m].
    leave_s
        When the person is gone [s].
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
        xyz_m = np.full((len(t_s), 17, 3), np.nan)
        here = (t_s >= self.enter_s) & (t_s <= self.leave_s)
        xyz_m[here] = between(self.xyz_m, (t_s[here] - self.enter_s) / self.step_s)
        return xyz_m


def between(
    samples: Float64[np.ndarray, "step *batch"] | Float32[np.ndarray, "step *batch"],
    entry: Float64[np.ndarray, " time"],
) -> Float64[np.ndarray, "time *batch"]:
    """Return values between equidistant samples, smooth through all of them.

    Parameters
    ----------
    samples
        One row per step.
    entry
        Where to look, in steps from the first row.

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
    value = np.zeros((len(entry), *samples.shape[1:]))
    for tap, weight in zip((-1, 0, 1, 2), weights, strict=True):
        row = np.clip(left + tap, 0, last)
        value += weight.reshape(-1, *[1] * (samples.ndim - 1)) * samples[row]
    return value
