"""Which images belong together: cameras of any number, rate and phase into frame sets.

Nothing is resampled and nothing waits for a common clock: a frame set is only the portion in which
images reach the fusion, where each enters at its own time.
"""

import logging
import math
from collections import deque
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import islice
from statistics import median

from trecsim.errors import Error
from trecsim.types import FrameSet, Poses2D

logger = logging.getLogger(__name__)

LEARN_INTERVALS = 16  # of the fastest camera, to know the rhythm ...
LEARN_S = 1.0  # ... or this much time, if that comes first
REMEMBER_INTERVALS = 64
SILENT_S = 1.0  # after this a camera is not waited for until it delivers again
WINDOW_PERIODS = 0.9  # below 1, so that an image never falls together with its successor's peers
PAUSE_PERIODS = 1.9  # a gap of this many periods: an image is missing
NEAREST_PERIODS = 0.55  # no further away than this is nearest; in the middle is near enough
OTHER_RATE = 1.5  # ratio of two cameras' periods from which on they do not run in step
FALLBACK_WINDOW_S = 0.02  # where no camera delivered twice
MAX_WAITING = 4096  # images; a camera that floods us cannot fill the memory


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
    when every camera that is alive has delivered, for this set or a later one, or when time, as
    the images tell it, has gone beyond the window and `max_delay_s`. No image is lost, doubled or
    overtaken by a later one of its camera.

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
        Its time is that of the newest image in it, but never before that of an earlier set.

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
    offsets_s = offsets_s or {}
    if max_delay_s > 0.0 and offsets_s:  # offsets disturb the order that a recording came in
        max_delay_s += max(0.0, *offsets_s.values()) - min(0.0, *offsets_s.values())
    waiting = _WaitingRoom(window_s, max_delay_s)
    fault: Error | None = None
    try:
        for image in poses:
            offset_s = offsets_s.get(image.camera, 0.0)
            waiting.add(replace(image, t_s=image.t_s + offset_s) if offset_s else image)
            while waiting.can_close():
                yield waiting.take()
    except Error as error:  # what came before it is good, and is given first
        fault = error
    while waiting.count:
        yield waiting.take()
    if fault is not None:
        raise fault


@dataclass(slots=True)
class _Camera:
    """One camera's images that wait, and what is known of its rhythm."""

    images: deque[tuple[Poses2D, float]] = field(default_factory=deque)  # with the gap before
    intervals_s: deque[float] = field(default_factory=lambda: deque(maxlen=REMEMBER_INTERVALS))
    last_s: float = -math.inf
    heard_s: float = -math.inf  # how late it was, as all images tell it, at its last image
    period_s: float = math.inf

    def add(self, image: Poses2D, now_s: float) -> None:
        gap_s = image.t_s - self.last_s
        self.images.append((image, gap_s))
        self.last_s, self.heard_s = image.t_s, now_s
        if 0.0 < gap_s < math.inf:
            self.intervals_s.append(gap_s)
            self.period_s = _mean_without_pauses(self.intervals_s)

    def is_alive(self, now_s: float) -> bool:
        patience_s = max(SILENT_S, 3.0 * self.period_s if self.intervals_s else 0.0)
        return now_s - self.heard_s <= patience_s

    @property
    def head_s(self) -> float:
        """Time of its oldest waiting image [s]."""
        return self.images[0][0].t_s

    @property
    def resumes(self) -> bool:
        """Whether its oldest waiting image is its first, or its first after a pause."""
        gap_s = self.images[0][1]
        return gap_s == math.inf or gap_s > PAUSE_PERIODS * self.period_s


def _mean_without_pauses(intervals_s: Iterable[float]) -> float:
    """Return the mean interval; of jitter, unlike of pauses, nothing is left in it."""
    kept = list(intervals_s)
    limit_s = 2.5 * sum(kept) / len(kept)
    kept = [interval_s for interval_s in kept if interval_s <= limit_s]
    return sum(kept) / len(kept)


class _WaitingRoom:
    """Where images wait for the others of their set."""

    def __init__(self, window_s: float | None, max_delay_s: float) -> None:
        self.count = 0
        self._window_s = window_s
        self._max_delay_s = max_delay_s
        self._cameras: dict[str, _Camera] = {}
        self._first_s = math.inf
        self._now_s = -math.inf  # the newest time any image told
        self._given_s = -math.inf
        self._learning = True
        self._late: set[str] = set()

    def add(self, image: Poses2D) -> None:
        """Let one more image wait."""
        self._warn_if_late(image)
        self._first_s = min(self._first_s, image.t_s)
        self._now_s = max(self._now_s, image.t_s)
        camera = self._cameras.setdefault(image.camera, _Camera())
        camera.add(image, self._now_s)
        self.count += 1
        if self._learning:
            passed_s = self._now_s - self._first_s
            rhythm_known = len(camera.intervals_s) >= LEARN_INTERVALS or passed_s >= LEARN_S
            self._learning = not rhythm_known or passed_s < self._max_delay_s

    def can_close(self) -> bool:
        """Tell whether no image is missing in the oldest set, or none is worth waiting for."""
        if not self.count or (self._learning and self.count < MAX_WAITING):
            return False
        if all(
            camera.images or not camera.is_alive(self._now_s) for camera in self._cameras.values()
        ):
            return True
        patience_s = self._window() + self._max_delay_s
        return self.count >= MAX_WAITING or self._now_s > self._opener().head_s + patience_s

    def take(self) -> FrameSet:
        """Return the oldest set, complete or not."""
        opener = self._opener()
        end_s = opener.head_s + self._window()
        limit_s = NEAREST_PERIODS * self._period()
        members = [
            camera
            for camera in self._cameras.values()
            if camera is opener
            or (camera.images and camera.head_s <= end_s and _in_phase(camera, opener, limit_s))
        ]
        views = sorted(
            (camera.images.popleft()[0] for camera in members),
            key=lambda view: (view.t_s, view.camera),
        )
        self.count -= len(views)
        self._given_s = max(self._given_s, views[-1].t_s)
        return FrameSet(self._given_s, tuple(views))

    def _opener(self) -> _Camera:
        return min(
            (camera for camera in self._cameras.values() if camera.images),
            key=lambda camera: camera.head_s,
        )

    def _period(self) -> float:
        """Return the fastest camera's mean period [s]; infinite if no camera delivered twice."""
        return min(
            (
                camera.period_s
                for camera in self._cameras.values()
                if camera.images or camera.is_alive(self._now_s)
            ),
            default=math.inf,
        )

    def _window(self) -> float:
        if self._window_s is not None:
            return self._window_s
        period_s = self._period()
        return WINDOW_PERIODS * period_s if period_s < math.inf else FALLBACK_WINDOW_S

    def _warn_if_late(self, image: Poses2D) -> None:
        late_s = self._given_s - image.t_s
        if late_s > max(SILENT_S, self._max_delay_s) and image.camera not in self._late:
            self._late.add(image.camera)
            logger.warning(
                "camera %r delivers %.3g s late: the other cameras' images of that time are gone. "
                "Are the cameras in time order in the file, and their time offsets right?",
                image.camera,
                late_s,
            )


def _in_phase(camera: _Camera, opener: _Camera, limit_s: float) -> bool:
    """Tell whether an image within the window belongs to this set rather than to the next.

    Cameras that run in step do, however their clocks jitter. One that begins, resumes or has
    another rate goes where it is nearest; at the beginning, as far as one can see ahead.
    """
    lags_s = [
        image.t_s - opening.t_s
        for (image, _), (opening, _) in islice(
            zip(camera.images, opener.images, strict=False), LEARN_INTERVALS
        )
    ]
    if not 1.0 / OTHER_RATE < camera.period_s / opener.period_s < OTHER_RATE:
        return lags_s[0] <= limit_s
    if camera.resumes or opener.resumes:
        return min(lags_s[0], abs(median(lags_s))) <= limit_s
    return True
