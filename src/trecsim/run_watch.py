"""How far a run is: counts images and snapshots, and ends it on request."""

import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from trecsim.callbacks import Progress
from trecsim.errors import InputError
from trecsim.run_summary import Ended, RunSummary
from trecsim.store.recordings import Stored
from trecsim.tracking import Tally
from trecsim.values import Poses2D, Snapshot

TELL_EVERY_S = 60.0


@dataclass(slots=True)
class RunWatch:
    """Counts images and snapshots, tells how far the run is, and ends it on request.

    Attributes
    ----------
    progress
        Told the number of images done and, if it is known, of all images.
    stop
        Tells whether to end the run.
    tell
        Is called once a minute with how far the fusion is.
    image_count
        Number of all images, if it is known.
    seconds
        The run ends so long after `is_over` is asked first [s]; never if None.
    folder
        Of the recording.
    tally
        What the fusion has done.
    stopped
        Whether `stop` has ended the run.
    done
        Number of images that reached the fusion.
    first_s, last_s
        Times of the first and last snapshot [s].
    stored
        What the recording held before.
    gaps_s
        Where it was continued: the last time before and the first time after, each [s].
    began_s
        When `is_over` was asked first, by a steady clock [s].
    told_s
        When `tell` was called last, by a steady clock [s].
    """

    progress: Progress | None
    stop: Callable[[], bool]
    tell: Callable[[Tally], None]
    image_count: int | None
    seconds: float | None = None
    folder: Path = Path()
    tally: Tally = field(default_factory=Tally)
    stopped: bool = False
    done: int = 0
    first_s: float | None = None
    last_s: float | None = None
    stored: Stored = field(default_factory=Stored)
    gaps_s: tuple[tuple[float, float], ...] = ()
    began_s: float | None = None
    told_s: float = field(default_factory=time.monotonic)

    def until_stopped(self, poses: Iterable[Poses2D]) -> Iterator[Poses2D]:
        """Yield 2D poses until the run is over."""
        for one in poses:
            yield one
            if self.is_over():
                return

    def is_stopped(self) -> bool:
        """Tell whether `stop` ends the run; once a minute, say how far it is."""
        if time.monotonic() - self.told_s >= TELL_EVERY_S:
            self.told_s = time.monotonic()
            self.tell(self.tally)
        self.stopped = self.stopped or self.stop()
        return self.stopped

    def is_over(self) -> bool:
        """Tell whether the run ends, as it is stopped or its time is over."""
        now_s = time.monotonic()
        if self.began_s is None:
            self.began_s = now_s
        timed_out = self.seconds is not None and now_s - self.began_s >= self.seconds
        return self.is_stopped() or timed_out

    def count(self, poses: Poses2D) -> None:
        """Count an image that reaches the fusion."""
        self.done += 1
        if self.progress is not None:
            self.progress(self.done, self.image_count)

    @property
    def resumed(self) -> bool:
        """Whether a recording is continued."""
        return self.stored.last_s is not None

    @property
    def nothing_new(self) -> bool:
        """Whether the recording held everything before."""
        return self.resumed and not self.done

    def write(self, snapshot: Snapshot, /) -> None:
        """Take where everybody is."""
        if self.stored.last_s is not None and snapshot.t_s <= self.stored.last_s:
            return
        self.last_s = snapshot.t_s
        if self.first_s is None:
            self.first_s = snapshot.t_s
            if self.stored.last_s is not None:
                self.gaps_s = (*self.gaps_s, (self.stored.last_s, snapshot.t_s))

    def summary(self, site: str, out: Path, began_s: float, fault: InputError | None) -> RunSummary:
        """Return what came of the run."""
        ended: Ended = "failed" if fault else "stopped" if self.stopped else "complete"
        return RunSummary(
            site=site,
            out=out,
            ended=ended,
            fault=str(fault) if fault else None,
            images=self.done,
            frame_sets=self.tally.frame_sets,
            people=self.tally.people,
            first_s=self.first_s,
            last_s=self.last_s,
            wall_s=time.monotonic() - began_s,
            fusion_ms=self.tally.fusion_ms(),
            remarks=tuple(self.tally.remarks),
            gaps_s=self.gaps_s,
        )
