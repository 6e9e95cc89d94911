"""Which images belong together: cameras of any number, rate and phase into frame sets.

Nothing is resampled and nothing waits for a common clock: a frame set is only the portion in which
images reach the fusion, where each enters at its own time.
"""

import logging
import math
from collections import deque
from collections.abc import Iterable, Iterator, Mapping, Set
from dataclasses import replace

from trecsim.callbacks import Remark
from trecsim.errors import Error
from trecsim.sync.camera_queue import LEARN_INTERVALS
from trecsim.sync.stream_remarks import LATE_S, StreamRemarks
from trecsim.sync.stream_time import StreamTime
from trecsim.sync.waiting_images import WaitingImages
from trecsim.values import FrameSet, Poses2D

logger = logging.getLogger(__name__)

LEARN_S = 1.0  # so long the periods are learnt, or for LEARN_INTERVALS, if that comes first
MAX_WAITING = 4096  # images; a camera that floods us cannot fill the memory
LOOK_EVERY_S = 0.02  # so often live cameras are looked at for silence
EMPTY_EVERY_S = 0.1  # of live cameras that are all silent, an empty set tells so often


def frame_sets(
    poses: Iterable[Poses2D],
    *,
    offsets_s: Mapping[str, float] | None = None,
    window_s: float | None = None,
    max_delay_s: float = 1.0,
) -> Iterator[FrameSet]:
    """Group images into frame sets, one after the other as soon as each is known.

    The oldest image that waits opens a set, and every other camera's oldest image joins if it is
    not younger by more than the window; so a camera stands in a set at most once, cameras in step
    give one set for each instant, and a slower camera is in some of the sets. The set is closed
    when every camera that is alive has delivered, for this set or a later one, or when it has
    waited, as the images' times tell, for the window and `max_delay_s`. No image is lost, doubled
    or overtaken by a later one of its camera. A camera whose clock jumps neither holds up the
    others nor tears their sets: its images come in sets of their own.

    Before the first set, up to a second of images (and not less than `max_delay_s`) is read to
    meet the cameras and their rates.
    A camera that begins or resumes joins in the phase that puts it nearest to the others.

    Parameters
    ----------
    poses
        Images in order of arrival; each camera's in the order of their times.
    offsets_s
        Added to the time stamps of the cameras named.
    window_s
        Largest difference of time within a set [s]; 0.9 of the fastest camera's mean period,
        which is learnt on the way, if None.
    max_delay_s
        How far out of order the cameras may arrive [s], beyond what `offsets_s` explains: so
        long a set waits for a camera that is alive but late. 0 in live operation: never wait
        beyond the window.

    Yields
    ------
    FrameSet
        Its time is that of the newest image in it, but not before that of an earlier set, unless
        clocks have jumped.

    Examples
    --------
    >>> import numpy as np
    >>> def image(camera, t_s):
    ...     return Poses2D(camera, t_s, np.empty((0, 17, 2)), np.empty((0, 17)), np.empty(0))
    >>> images = [image("north", 0.00), image("south", 0.01), image("north", 0.04),
    ...           image("north", 0.08), image("south", 0.09)]
    >>> for frame_set in frame_sets(images):
    ...     print(frame_set.t_s, [view.camera for view in frame_set.views])
    0.01 ['north', 'south']
    0.04 ['north']
    0.09 ['north', 'south']
    """
    buffer = FrameSetBuffer(offsets_s, window_s, max_delay_s)
    fault: Error | None = None
    try:
        for image in poses:
            yield from buffer.add(image)
    except Error as error:  # what came before it is good, and is given first
        fault = error
    yield from buffer.flush()
    if fault is not None:
        raise fault


class FrameSetBuffer:
    """Images in, as they arrive; frame sets out, as soon as each is complete or waits in vain.

    `frame_sets` does the same for a recording. Live, tell the time of arrival with each image, and
    call `poll` when nothing arrives: then a stalled camera holds no set up for longer than the
    window and `max_delay_s`, and when all cameras are silent, empty sets tell that time passes.

    Parameters
    ----------
    offsets_s, window_s, max_delay_s
        As for `frame_sets`.
    remark
        Is told, once for each camera, that its images are late or ahead of the others'.
    silence
        Whether to log that a camera is silent; not where somebody else watches the cameras.

    Examples
    --------
    >>> import numpy as np
    >>> def image(camera, t_s):
    ...     return Poses2D(camera, t_s, np.empty((0, 17, 2)), np.empty((0, 17)), np.empty(0))
    >>> buffer = FrameSetBuffer(max_delay_s=0.1)
    >>> for n in range(50):  # Unix time on the images, any steady clock for their arrival
    ...     sets = list(buffer.add(image("north", 1.7e9 + 0.04 * n), 7.0 + 0.04 * n))
    >>> [round(one.t_s - 1.7e9, 2) for one in buffer.poll(10.0)]
    [3.0]
    """

    def __init__(
        self,
        offsets_s: Mapping[str, float] | None = None,
        window_s: float | None = None,
        max_delay_s: float = 1.0,
        *,
        remark: Remark = logger.warning,
        silence: bool = True,
    ) -> None:
        self._offsets_s = offsets_s or {}
        if max_delay_s > 0.0 and self._offsets_s:  # they disturb the order a recording came in
            values_s = self._offsets_s.values()
            max_delay_s += max(0.0, *values_s) - min(0.0, *values_s)
        self._max_delay_s = max_delay_s
        self._count = 0
        self._time: StreamTime[str] = StreamTime()
        self._waiting = WaitingImages(self._time, window_s, max_delay_s)
        self._apart: deque[Poses2D] = deque()
        self._newest: tuple[float, float] | None = None  # stamp of the newest set, and its arrival
        self._given_s = -math.inf
        self._looked_s = -math.inf
        self._learning = True
        self._remarks = StreamRemarks(remark, silence=silence)

    @property
    def misdated(self) -> Set[str]:
        """Cameras whose images were late or ahead of the others'."""
        return self._remarks.misdated

    def add(self, image: Poses2D, arrived_s: float | None = None) -> Iterator[FrameSet]:
        """Take in one image; yield the sets that are closed now.

        Parameters
        ----------
        image
            The image.
        arrived_s
            When it arrived, by one steady clock for all cameras [s]; None in a recording.
        """
        offset_s = self._offsets_s.get(image.camera, 0.0)
        self._add(replace(image, t_s=image.t_s + offset_s) if offset_s else image, arrived_s)
        yield from self._closed()

    def poll(self, arrived_s: float) -> Iterator[FrameSet]:
        """Let time pass without an image; yield the sets that have waited long enough.

        When all cameras are silent, an empty set follows; its time is the present, in the time of
        the cameras' stamps.

        Parameters
        ----------
        arrived_s
            The present, by the clock of arrivals [s].
        """
        self._time.move_on(arrived_s)
        self._look_for_silence()
        yield from self._closed()
        if self._newest is None or self._count or not self._time.all_silent():
            return
        stamp_s, stamped_s = self._newest
        now_s = stamp_s + self._time.elapsed_s - stamped_s
        if now_s - self._given_s >= EMPTY_EVERY_S:
            self._given_s = now_s
            yield FrameSet(now_s, ())

    def flush(self) -> Iterator[FrameSet]:
        """Yield what still waits; no image will come any more."""
        while self._count:
            yield self._take()

    def _closed(self) -> Iterator[FrameSet]:
        while self._can_close():
            yield self._take()

    def _add(self, image: Poses2D, arrived_s: float | None) -> None:
        late_s = self._given_s - image.t_s
        is_late = late_s > max(LATE_S, self._max_delay_s)
        self._remarks.delivers(image.camera, late_s if is_late else None)
        camera = self._waiting.of(image.camera)
        self._apart.extend(camera.pop_misdated(image))
        time = self._time.note(image.camera, image.t_s, arrived_s)
        camera.add(image, time.own_s, time.heard_s)
        self._count += 1
        if arrived_s is not None:
            self._look_for_silence()
        if self._learning:
            elapsed_s = self._time.elapsed_s
            known = len(camera.intervals_s) >= LEARN_INTERVALS or elapsed_s >= LEARN_S
            self._learning = not known or elapsed_s < self._max_delay_s

    def _look_for_silence(self) -> None:
        if self._time.elapsed_s - self._looked_s >= LOOK_EVERY_S:
            self._looked_s = self._time.elapsed_s
            self._remarks.silence(self._waiting.cameras, self._time, self._max_delay_s)

    def _can_close(self) -> bool:
        """Tell whether no image is missing in the oldest set, or none is worth waiting for."""
        if self._apart:
            return True
        if not self._count or (self._learning and self._count < MAX_WAITING):
            return False
        return self._count >= MAX_WAITING or self._waiting.can_close()

    def _take(self) -> FrameSet:
        """Return the oldest set, complete or not, or images that are far ahead of the others."""
        if self._apart:
            self._count -= 1
            return FrameSet(self._apart[0].t_s, (self._apart.popleft(),))
        taken = self._waiting.take()
        self._count -= len(taken)
        views = tuple(one.image for one in taken)
        if self._are_ahead(views):
            self._remarks.ahead(views[0].camera, self._lead_s(views))
            return FrameSet(views[-1].t_s, views)
        self._newest = views[-1].t_s, taken[-1].heard_s
        return FrameSet(self._time_of(views[-1].t_s), views)

    def _lead_s(self, views: tuple[Poses2D, ...]) -> float:
        """Return how far ahead of the newest set, or else of the other cameras, images are [s]."""
        if math.isfinite(self._given_s):
            return views[0].t_s - self._given_s
        own = {view.camera for view in views}
        others = self._waiting.cameras.items()
        return views[0].t_s - max(one.last_s for name, one in others if name not in own)

    def _are_ahead(self, views: tuple[Poses2D, ...]) -> bool:
        """Tell whether these images' cameras run further ahead than late images explain."""
        if views[0].t_s - self._given_s <= self._waiting.patience_s + LATE_S:
            return False
        names, stamps_s = [view.camera for view in views], [view.t_s for view in views]
        ahead = self._time.ahead(names, stamps_s, tolerance_s=self._max_delay_s + LATE_S)
        return len(ahead) == len(views)

    def _time_of(self, newest_s: float) -> float:
        """Return a set's time: not before the last one's, unless a clock has jumped."""
        if not 0.0 < self._given_s - newest_s <= self._waiting.patience_s + LATE_S:
            self._given_s = newest_s
        return self._given_s
