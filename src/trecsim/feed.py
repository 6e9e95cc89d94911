"""Live 2D poses: sources side by side, and the estimator that their images go through."""

import logging
from collections import Counter
from collections.abc import Iterator, Sequence
from typing import cast

from trecsim.errors import Error
from trecsim.estimators import Estimator2D
from trecsim.sources.base import Arrival, Source
from trecsim.sources.camera_mailbox import Fault, Mailbox, deliver
from trecsim.values import Frame, Poses2D

logger = logging.getLogger(__name__)


class CrashError(Error):
    """Something failed in a way that nobody foresaw, as its cause says; the work goes on."""


def log_fault(error: Exception) -> None:
    """Log what is wrong with a source, an image or the fusion; of a crash, where it happened."""
    crash = error.__cause__ if isinstance(error, CrashError) else None
    logger.error("%s", error, exc_info=crash)


class Feed:
    """Live 2D poses: sources side by side, and the estimator if they deliver images.

    Nothing is read before `arrivals` is.

    Parameters
    ----------
    sources
        Each is read in a thread of its own.
    estimator
        Finds the 2D poses if the sources deliver images.
    fault
        Is told what ended a source or failed on an image, in another thread; logged if None.

    Attributes
    ----------
    restarts
        How often the fusion of these poses failed and began anew.
    is_read
        Whether the sources are read now.
    """

    def __init__(
        self,
        sources: Sequence[Source[Poses2D]] | Sequence[Source[Frame]],
        estimator: Estimator2D | None = None,
        fault: Fault | None = None,
    ) -> None:
        self.fault = fault or log_fault
        self.restarts = 0
        self.is_read = False
        self._sources, self._estimator = sources, estimator
        self._boxes: list[Mailbox[Poses2D] | Mailbox[Frame]] = []

    @property
    def dropped(self) -> Counter[str]:
        """How many images of each camera were dropped, as nobody had time for them."""
        return sum((Counter(box.dropped) for box in self._boxes), Counter())

    def arrivals(self) -> Iterator[Arrival[Poses2D]]:
        """Begin to read the sources; yield 2D poses as they come, and that none comes."""
        self.is_read = True
        if self._estimator is None:
            poses: Mailbox[Poses2D] = Mailbox(depth=16)
            self._boxes = [poses]
            deliver(cast(Sequence[Source[Poses2D]], self._sources), poses, self.fault)
            return poses.arrivals()
        from trecsim.estimators.live_images import estimate_live

        frames: Mailbox[Frame] = Mailbox(depth=1)  # an image that waits only gets older
        deliver(cast(Sequence[Source[Frame]], self._sources), frames, self.fault)
        poses = estimate_live(frames, self._estimator, self.fault)
        self._boxes = [frames, poses]
        return poses.arrivals()
