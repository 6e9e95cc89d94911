"""One camera's images that wait for those of the others, and the rhythm in which they come.

How much time passes is told by the cameras that agree about the time. A camera that does not agree
with the last that did has its own steps from image to image, and they are believed when no other
camera has delivered for half a second. So no clock that is wrong, or jumps, makes time fly.
"""

import math
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import NamedTuple

from trecsim.values import Poses2D

LEARN_INTERVALS = 16  # so many intervals, and the rhythm is known
REMEMBER_INTERVALS = 64
SILENT_S = 1.0  # after this a camera is not waited for until it delivers again
AGREE_S = 1.0  # cameras that tell times this close to each other agree
LEAD_S = 0.5  # a camera that does not agree is believed when the others are this far behind
PAUSE_PERIODS = 1.9  # a gap of this many periods: an image is missing
PATIENCE_PERIODS = 3.0  # a camera that has delivered nothing for so many is gone


class Waiting(NamedTuple):
    """An image that waits.

    Attributes
    ----------
    image
        The image.
    gap_s
        Time between the camera's last image and this one, as it tells [s].
    own_s
        Its place in the time that passes for all cameras [s].
    heard_s
        How much time had passed when it came [s].
    """

    image: Poses2D
    gap_s: float
    own_s: float
    heard_s: float


@dataclass(slots=True)
class CameraQueue:
    """Images of one camera that wait, in order of arrival, and what is known of its rhythm.

    Attributes
    ----------
    images
        Those that wait.
    intervals_s
        Between its last images [s].
    last_s, own_s, heard_s
        Of its last image: its time, its place in the time that passes for all cameras, and how
        much time had passed when it came [s].
    period_s
        Mean time between images, infinite while unknown [s].
    """

    images: deque[Waiting] = field(default_factory=deque)
    intervals_s: deque[float] = field(default_factory=lambda: deque(maxlen=REMEMBER_INTERVALS))
    last_s: float = -math.inf
    own_s: float = -math.inf
    heard_s: float = -math.inf
    period_s: float = math.inf

    def wrong_before(self, image: Poses2D) -> list[Poses2D]:
        """Take out waiting images whose clock had run ahead, as `image` is back in time.

        Of a clock that is set back, and stays there, nothing is taken out.
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

    def add(self, image: Poses2D, passed_s: float, newest_s: float) -> bool:
        """Let an image wait; return whether time passes with it.

        Parameters
        ----------
        image
            The image.
        passed_s
            How much time has passed for all cameras.
        newest_s
            The time of the image that told so.
        """
        gap_s, ahead_s = image.t_s - self.last_s, image.t_s - newest_s
        agrees = -AGREE_S <= ahead_s <= self._longest_step_s
        self.own_s = (
            passed_s + ahead_s
            if agrees
            else max(self.own_s + self._step_s(gap_s), passed_s - AGREE_S)
        )
        self.last_s = image.t_s
        self.heard_s = max(passed_s, self.own_s)
        self.images.append(Waiting(image, gap_s, self.own_s, self.heard_s))
        if 0.0 < gap_s < math.inf:
            self.intervals_s.append(gap_s)
            self.period_s = _mean_without_pauses(self.intervals_s)
        return self.own_s >= passed_s + (0.0 if agrees else LEAD_S)

    def _step_s(self, gap_s: float) -> float:
        """Return how much time a gap counts that no other camera confirms [s]."""
        if gap_s > self._longest_step_s:
            return self.period_s if len(self.intervals_s) >= LEARN_INTERVALS else 0.0
        return max(gap_s, 0.0)

    @property
    def _longest_step_s(self) -> float:
        """The longest way from one image to the next that is no jump [s]."""
        known = len(self.intervals_s) >= LEARN_INTERVALS
        return PATIENCE_PERIODS * self.period_s if known else AGREE_S

    @property
    def patience_s(self) -> float:
        """How long it may deliver nothing and still be alive [s]."""
        return max(SILENT_S, PATIENCE_PERIODS * self.period_s if self.intervals_s else 0.0)

    def is_alive(self, passed_s: float) -> bool:
        """Return whether it has delivered lately."""
        return passed_s - self.heard_s <= self.patience_s

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
    """Return the mean interval; of jitter, unlike of pauses and jumps, nothing is left in it."""
    kept = sorted(intervals_s)
    limit_s = 2.5 * kept[(3 * len(kept)) // 4]
    kept = [interval_s for interval_s in kept if interval_s <= limit_s]
    return sum(kept) / len(kept)
