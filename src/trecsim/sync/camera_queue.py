"""Images of one camera that wait for those of the others, and the camera's mean period."""

import math
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import NamedTuple

from trecsim.values import Poses2D

LEARN_INTERVALS = 16  # so many intervals, and the period is known
REMEMBER_INTERVALS = 64
PAUSE_PERIODS = 1.9  # a gap of this many periods: an image is missing


class Waiting(NamedTuple):
    """An image that waits.

    Attributes
    ----------
    image
        The image.
    gap_s
        Time between the camera's last image and this one, by its stamps [s].
    own_s
        When it was taken, on the axis of elapsed time [s].
    heard_s
        Elapsed time when it came [s].
    """

    image: Poses2D
    gap_s: float
    own_s: float
    heard_s: float


@dataclass(slots=True)
class CameraQueue:
    """Images of one camera that wait, in order of arrival.

    Attributes
    ----------
    images
        Those that wait.
    intervals_s
        Between its last images [s].
    last_s
        Stamp of its last image that is believed [s].
    period_s
        Mean time between images, infinite while unknown [s].
    """

    images: deque[Waiting] = field(default_factory=deque)
    intervals_s: deque[float] = field(default_factory=lambda: deque(maxlen=REMEMBER_INTERVALS))
    last_s: float = -math.inf
    period_s: float = math.inf

    def pop_misdated(self, image: Poses2D) -> list[Poses2D]:
        """Remove and return waiting images whose stamps ran ahead, as `image` shows.

        Of a clock that is set back and stays there, nothing is removed.
        """
        count, before_s = 0, self.last_s
        for one in reversed(self.images):
            if before_s <= image.t_s:
                break
            count, before_s = count + 1, one.image.t_s - one.gap_s
        if not count or not -math.inf < before_s <= image.t_s:
            return []
        self.last_s = before_s
        return [self.images.pop().image for _ in range(count)][::-1]

    def add(self, image: Poses2D, own_s: float, heard_s: float) -> None:
        """Let an image wait that was taken at `own_s` and came at `heard_s` of elapsed time."""
        gap_s = image.t_s - self.last_s
        self.last_s = image.t_s
        self.images.append(Waiting(image, gap_s, own_s, heard_s))
        if 0.0 < gap_s < math.inf:
            self.intervals_s.append(gap_s)
            self.period_s = _mean_without_pauses(self.intervals_s)

    @property
    def head_s(self) -> float:
        """Time of its oldest waiting image [s]."""
        return self.images[0].image.t_s

    @property
    def resumes(self) -> bool:
        """Whether its oldest waiting image is its first, or its first after a pause."""
        gap_s = self.images[0].gap_s
        return gap_s == math.inf or gap_s > PAUSE_PERIODS * self.period_s


def _mean_without_pauses(intervals_s: Iterable[float]) -> float:
    """Return the mean interval; jitter averages out, pauses and jumps are left out."""
    kept = sorted(intervals_s)
    limit_s = 2.5 * kept[(3 * len(kept)) // 4]
    kept = [interval_s for interval_s in kept if interval_s <= limit_s]
    return sum(kept) / len(kept)
