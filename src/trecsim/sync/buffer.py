"""Which images belong together: cameras of any number, rate and phase into frame sets.

Nothing is resampled and nothing waits for a common clock: a frame set is only the portion in which
images reach the fusion, where each enters at its own time.
"""

import logging
import math
from collections import deque
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from itertools import islice
from statistics import median

from trecsim.errors import Error
from trecsim.sync.camera_queue import AGREE_S, LEARN_INTERVALS, SILENT_S, CameraQueue
from trecsim.values import FrameSet, Poses2D

logger = logging.getLogger(__name__)

LEARN_S = 1.0  # so long the rhythm is learnt, or for LEARN_INTERVALS, if that comes first
WINDOW_PERIODS = 0.9  # below 1, so that an image never falls together with its successor's peers
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


class _WaitingRoom:
    """Where images wait for the others of their set.

    How much time passes is counted by each camera's own steps from image to image, of which none
    counts for more than three of its periods. So no clock that is wrong, or jumps, makes time fly.
    """

    def __init__(self, window_s: float | None, max_delay_s: float) -> None:
        self.count = 0
        self._window_s = window_s
        self._max_delay_s = max_delay_s
        self._cameras: dict[str, CameraQueue] = {}
        self._passed_s = 0.0
        self._newest_s = math.nan  # of the image that told so
        self._apart: deque[Poses2D] = deque()  # single images with a wrong time
        self._given_s = -math.inf
        self._learning = True
        self._remarked: set[str] = set()

    def add(self, image: Poses2D) -> None:
        """Let one more image wait."""
        self._warn_if_late(image)
        camera = self._cameras.setdefault(image.camera, CameraQueue())
        self._apart.extend(camera.wrong_before(image))
        if math.isnan(self._newest_s):
            self._newest_s = image.t_s
        if camera.add(image, self._passed_s, self._newest_s):
            self._passed_s, self._newest_s = camera.own_s, image.t_s
        self.count += 1
        if self._learning:
            rhythm_known = len(camera.intervals_s) >= LEARN_INTERVALS or self._passed_s >= LEARN_S
            self._learning = not rhythm_known or self._passed_s < self._max_delay_s

    def can_close(self) -> bool:
        """Tell whether no image is missing in the oldest set, or none is worth waiting for."""
        if self._apart:
            return True
        if not self.count or (self._learning and self.count < MAX_WAITING):
            return False
        if self.count >= MAX_WAITING or self._overdue():
            return True
        oldest = self._oldest()
        return not any(self._is_missed(camera, oldest) for camera in self._cameras.values())

    def take(self) -> FrameSet:
        """Return the oldest set, complete or not, or images that are far ahead of the others."""
        if self._apart:
            self.count -= 1
            return FrameSet(self._apart[0].t_s, (self._apart.popleft(),))
        window_s = self._window()
        opener = self._far_ahead(window_s) or self._oldest()
        limit_s = NEAREST_PERIODS * self._period()
        members = [
            camera
            for camera in self._cameras.values()
            if camera is opener
            or (
                camera.images
                and 0.0 <= camera.head_s - opener.head_s <= window_s
                and _in_phase(camera, opener, limit_s)
            )
        ]
        views = sorted(
            (camera.images.popleft().image for camera in members),
            key=lambda view: (view.t_s, view.camera),
        )
        self.count -= len(views)
        if views[0].t_s - self._newest_s > AGREE_S and 2 * len(views) <= len(self._cameras):
            self._warn_of_early(views[0])
            return FrameSet(views[-1].t_s, tuple(views))
        return FrameSet(self._time_of(views[-1].t_s), tuple(views))

    def _time_of(self, newest_s: float) -> float:
        """Return a set's time: not before the last one's, unless a clock has jumped."""
        if not 0.0 < self._given_s - newest_s <= self._patience() + SILENT_S:
            self._given_s = newest_s
        return self._given_s

    def _oldest(self) -> CameraQueue:
        return min(
            (camera for camera in self._cameras.values() if camera.images),
            key=lambda camera: camera.head_s,
        )

    def _far_ahead(self, window_s: float) -> CameraQueue | None:
        """Return a camera whose image is later than the oldest's set, and waits in vain."""
        cameras, end_s = self._cameras.values(), self._oldest().head_s + window_s
        told_s = min(one.last_s for one in cameras if one.images or one.is_alive(self._passed_s))
        late_s = max(end_s, told_s)
        return next((camera for camera in self._overdue() if camera.head_s > late_s), None)

    def _overdue(self) -> list[CameraQueue]:
        """Return the cameras whose oldest image has waited long enough for the others."""
        since_s = self._passed_s - self._patience()
        return [
            camera
            for camera in self._cameras.values()
            if camera.images and camera.images[0].own_s < since_s
        ]

    def _is_missed(self, camera: CameraQueue, oldest: CameraQueue) -> bool:
        """Tell whether a camera may still deliver what belongs to the oldest image's set."""
        if camera.images or not camera.is_alive(self._passed_s):
            return False
        if camera.heard_s <= oldest.images[0].heard_s:  # nothing since then
            return True
        return oldest.head_s - camera.last_s <= self._max_delay_s + camera.patience_s

    def _patience(self) -> float:
        """Return how long a set waits for cameras that are alive [s]."""
        return self._window() + self._max_delay_s

    def _period(self) -> float:
        """Return the fastest camera's mean period [s]; infinite if no camera delivered twice."""
        return min(
            (
                camera.period_s
                for camera in self._cameras.values()
                if camera.images or camera.is_alive(self._passed_s)
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
        if late_s > max(SILENT_S, self._max_delay_s) and image.camera not in self._remarked:
            self._remarked.add(image.camera)
            logger.warning(
                "camera %r delivers %.3g s late: the other cameras' images of that time are gone. "
                "Are the cameras in time order in the file, and their time offsets right?",
                image.camera,
                late_s,
            )

    def _warn_of_early(self, image: Poses2D) -> None:
        if image.camera not in self._remarked:
            self._remarked.add(image.camera)
            logger.warning(
                "camera %r tells times %.3g s ahead of the other cameras': its images are not put "
                "together with theirs. Are its clock and its time offset right?",
                image.camera,
                image.t_s - self._newest_s,
            )


def _in_phase(camera: CameraQueue, opener: CameraQueue, limit_s: float) -> bool:
    """Tell whether an image within the window belongs to this set rather than to the next.

    Cameras that run in step do, however their clocks jitter. One that begins, resumes or has
    another rate goes where it is nearest; at the beginning, as far as one can see ahead.
    """
    lags_s = [
        one.image.t_s - opening.image.t_s
        for one, opening in islice(zip(camera.images, opener.images, strict=False), LEARN_INTERVALS)
    ]
    if not 1.0 / OTHER_RATE < camera.period_s / opener.period_s < OTHER_RATE:
        return lags_s[0] <= limit_s
    if camera.resumes or opener.resumes:
        return min(lags_s[0], abs(median(lags_s))) <= limit_s
    return True
