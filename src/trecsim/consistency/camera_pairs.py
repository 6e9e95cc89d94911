"""Whether two cameras can see the same bodies: where the rays of two torsos meet."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64

Torsos = Float64[np.ndarray, "moment detection 4 3"]

MEET_M = 0.15  # rays that pass further from each other do not meet [m]
FEWEST = 3  # joints of a torso that must meet
NEAREST_M = 0.3  # before a camera
LEAST_SINE2 = 0.01  # of the angle between two rays: 6 degrees
TRUNK_M = (0.3, 0.75)  # shoulder to hip
SHOULDERS_M = (0.15, 0.6)
HIPS_M = (0.05, 0.5)


@dataclass(frozen=True, slots=True, eq=False)
class Eye:
    """What one camera saw, through one calibration.

    Attributes
    ----------
    origin_m
        Where it stands [m].
    ray
        Unit directions through left and right shoulder, left and right hip; NaN where unseen.
    """

    origin_m: Float64[np.ndarray, " 3"]
    ray: Torsos

    def seeing(self) -> Bool[np.ndarray, "moment detection"]:
        """Return which detections show enough of a torso."""
        return np.asarray(np.isfinite(self.ray[..., 0]).sum(axis=-1) >= FEWEST)


def agreement(one: Eye, other: Eye) -> tuple[int, int]:
    """Return in how many cases a body fits two cameras' detections, and in how many it might.

    Of each moment as many bodies may fit as the camera with fewer detections has.
    """
    tried = np.minimum(one.seeing().sum(axis=1), other.seeing().sum(axis=1))
    if not tried.any():
        return 0, 0
    fits = _fits(one, other) | _fits(one, Eye(other.origin_m, other.ray[:, :, [1, 0, 3, 2]]))
    agreed = np.minimum(fits.any(axis=2).sum(axis=1), fits.any(axis=1).sum(axis=1))
    return int(agreed.sum()), int(tried.sum())


def _fits(one: Eye, other: Eye) -> Bool[np.ndarray, "moment detection other"]:
    """Return which detections of two cameras meet in what may be a torso."""
    a, b = one.ray[:, :, None], other.ray[:, None]
    between_m = other.origin_m - one.origin_m
    with np.errstate(all="ignore"):
        cosine = (a * b).sum(axis=-1)
        along_a, along_b = a @ between_m, b @ between_m
        sine2 = 1.0 - cosine**2
        s = (along_a - cosine * along_b) / sine2
        t = (cosine * along_a - along_b) / sine2
        on_a = s[..., None] * a
        apart = between_m + t[..., None] * b - on_a
        meets = (
            ((apart**2).sum(axis=-1) < MEET_M**2)
            & (s > NEAREST_M)
            & (t > NEAREST_M)
            & (sine2 > LEAST_SINE2)
        )
        place_m = np.where(meets[..., None], on_a + 0.5 * apart, np.nan)
        return np.asarray((meets.sum(axis=-1) >= FEWEST) & _is_torso(place_m))


def _is_torso(
    place_m: Float64[np.ndarray, "*batch 4 3"],
) -> Bool[np.ndarray, "*batch"]:
    good = np.ones(place_m.shape[:-2], bool)
    for i, j, (least_m, most_m) in (
        (0, 2, TRUNK_M),
        (1, 3, TRUNK_M),
        (0, 1, SHOULDERS_M),
        (2, 3, HIPS_M),
    ):
        length_m = np.linalg.norm(place_m[..., i, :] - place_m[..., j, :], axis=-1)
        good &= ~((length_m < least_m) | (length_m > most_m))  # NaN is no objection
    return good
