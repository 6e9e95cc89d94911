"""The seam behind the fusion: what takes snapshots, step timings or 2D poses."""

import logging
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

from trecsim.errors import Error
from trecsim.store.timing_csv import StepTiming
from trecsim.values import Poses2D, Snapshot

logger = logging.getLogger(__name__)

RETRY_S = 10.0
"""A sink that failed is tried again this long afterwards [s]."""

Item_contra = TypeVar("Item_contra", contravariant=True)


class Sink(Protocol[Item_contra]):
    """Takes one result after the other, in the order of time.

    What has to be opened and closed is a context manager as well, and whoever made it closes it.
    """

    def write(self, item: Item_contra, /) -> None:
        """Take one more.

        Raises
        ------
        Error
            It cannot take any more, as when the disk is full; the pipeline ends with it.
        """
        ...


Item = TypeVar("Item")


@dataclass(frozen=True, slots=True)
class Taken(Generic[Item]):
    """A function as a sink.

    Attributes
    ----------
    by
        Takes each item.
    """

    by: Callable[[Item], None]

    def write(self, item: Item, /) -> None:
        """Take one more."""
        self.by(item)


class Forgiving(Generic[Item]):
    """A sink that stops nobody: when it cannot take any more, that is logged, and tried again.

    Parameters
    ----------
    sink
        The sink.
    clock
        Returns the time [s].
    """

    def __init__(self, sink: Sink[Item], clock: Callable[[], float] = time.monotonic) -> None:
        self._sink = sink
        self._clock = clock
        self._failed_s: float | None = None

    def write(self, item: Item, /) -> None:
        """Take one more, if it can; after a failure, one every `RETRY_S` until it can."""
        if self._failed_s is not None and self._clock() - self._failed_s < RETRY_S:
            return
        try:
            self._sink.write(item)
        except Error as error:
            if self._failed_s is None:
                logger.error(  # noqa: TRY400
                    "%s; it is tried again every %g s, and what comes in between is left out",
                    error, RETRY_S,
                )  # fmt: skip
            self._failed_s = self._clock()
            return
        if self._failed_s is not None:
            logger.warning("%s can write again", type(self._sink).__name__)
            self._failed_s = None


def _as_it_is(snapshot: Snapshot) -> Snapshot:
    return snapshot


@dataclass(frozen=True, slots=True)
class Sinks:
    """Who takes what of a pipeline.

    Attributes
    ----------
    snapshots
        Take where everybody is.
    steps
        Take what each frame set cost.
    poses
        Take the 2D poses, as they enter the fusion.
    rounding
        Rounds each snapshot once, before anybody takes it.
    """

    snapshots: Sequence[Sink[Snapshot]] = ()
    steps: Sequence[Sink[StepTiming]] = ()
    poses: Sequence[Sink[Poses2D]] = ()
    rounding: Callable[[Snapshot], Snapshot] = _as_it_is

    def take(self, snapshots: Iterable[Snapshot]) -> None:
        """Hand snapshots to all who take them."""
        for snapshot in snapshots:
            same = self.rounding(snapshot)
            for sink in self.snapshots:
                sink.write(same)

    def take_step(self, step: StepTiming) -> None:
        """Hand what a frame set cost to all who take it."""
        for sink in self.steps:
            sink.write(step)

    def take_poses(self, poses: Poses2D) -> None:
        """Hand the 2D poses of an image to all who take them."""
        for sink in self.poses:
            sink.write(poses)


NOBODY = Sinks()
"""Nobody takes anything."""
