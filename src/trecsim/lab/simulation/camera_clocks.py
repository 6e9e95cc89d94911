"""Clocks of cameras: times of images and their time stamps."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from trecsim.errors import InputError

FASTEST_FPS = 1000.0
LARGEST_DRIFT_PPM = 1e5  # a tenth; quartz drifts by 10 to 100 ppm
LONGEST_ERROR_S = 1e6
CLOSEST = 0.45  # largest jitter as a share of the frame period


@dataclass(frozen=True, slots=True)
class Clock:
    """Times of a camera's images, and their time stamps.

    Attributes
    ----------
    fps
        Images per second, by the camera's own clock.
    start_s
        Time of the first image [s].
    drift_ppm
        Clock drift; positive runs fast, so that images come early [ppm].
    jitter_s
        Standard deviation of the time of an image about the regular time; its stamp is right [s].
    dropped
        Share of lost images.
    stamp_error_s
        Error of all time stamps that the rig does not contain; positive is late [s].
    stamp_jitter_s
        Standard deviation of the error of each stamp, as of stamps set on arrival [s].
    """

    fps: float = 25.0
    start_s: float = 0.0
    drift_ppm: float = 0.0
    jitter_s: float = 0.0
    dropped: float = 0.0
    stamp_error_s: float = 0.0
    stamp_jitter_s: float = 0.0

    def __post_init__(self) -> None:
        if not (0 < self.fps <= FASTEST_FPS and 0 <= self.dropped <= 1 and self._calm):
            raise InputError(
                f"a clock needs an fps of at most {FASTEST_FPS:g}, a share of dropped images from "
                "0 to 1, no negative jitter, a drift of at most 100000 ppm and an error of at "
                f"most {LONGEST_ERROR_S:g} s, got {self}"
            )

    @property
    def _calm(self) -> bool:
        return (
            0 <= self.jitter_s < np.inf
            and 0 <= self.stamp_jitter_s < np.inf
            and abs(self.drift_ppm) <= LARGEST_DRIFT_PPM
            and max(abs(self.start_s), abs(self.stamp_error_s)) <= LONGEST_ERROR_S
        )

    def ticks(
        self, seconds: float, rng: np.random.Generator
    ) -> tuple[Float64[np.ndarray, " time"], Float64[np.ndarray, " time"]]:
        """Return the times of all images that arrive, and their stamps, both increasing [s].

        Examples
        --------
        >>> rng = np.random.default_rng(0)
        >>> taken_s, stamp_s = Clock(fps=2.0, drift_ppm=1000.0).ticks(1000.0, rng)
        >>> len(taken_s), round(float(stamp_s[-1] - taken_s[-1]), 3)
        (2002, 1.0)
        """
        rate = 1.0 + 1e-6 * self.drift_ppm
        fps = self.fps * rate
        turns = np.arange(int(np.ceil(max(seconds - self.start_s, 0.0) * fps)))
        # Jitter is limited so that images stay in order.
        jitter = np.clip(self.jitter_s * rng.standard_normal(len(turns)) * fps, -CLOSEST, CLOSEST)
        arrives = rng.uniform(size=len(turns)) >= self.dropped
        late = jitter
        if self.stamp_jitter_s > 0:
            late = jitter + self.stamp_jitter_s * rng.standard_normal(len(turns)) * fps
        taken_s = self.start_s + (turns + jitter) / fps
        stamp_s = self.start_s + (turns + np.clip(late, -CLOSEST, CLOSEST)) / fps
        return taken_s[arrives], (stamp_s * rate + self.stamp_error_s)[arrives]
