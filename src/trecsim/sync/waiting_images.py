"""Images of all cameras that wait, and which of them belong into one frame set."""

import math
from itertools import islice
from statistics import median

from trecsim.sync.camera_queue import LEARN_INTERVALS, CameraQueue, Waiting
from trecsim.sync.stream_time import StreamTime

WINDOW_PERIODS = 0.9  # below 1, so that an image never falls together with its successor's peers
NEAREST_PERIODS = 0.55  # join the nearest set if within this; slightly above half a period
OTHER_RATE = 1.5  # ratio of two cameras' periods from which on they do not run in step
FALLBACK_WINDOW_S = 0.02  # where no camera delivered twice


class WaitingImages:
    """Images of all cameras that wait for those that belong into the same frame set.

    Parameters
    ----------
    time
        Tells which cameras are silent.
    window_s, max_delay_s
        As for `trecsim.sync.frame_sets`.

    Attributes
    ----------
    cameras
        The images of each camera.
    """

    def __init__(self, time: StreamTime[str], window_s: float | None, max_delay_s: float) -> None:
        self.cameras: dict[str, CameraQueue] = {}
        self._time = time
        self._window_s = window_s
        self._max_delay_s = max_delay_s

    def of(self, camera: str) -> CameraQueue:
        """Return the images of a camera."""
        return self.cameras.setdefault(camera, CameraQueue())

    @property
    def patience_s(self) -> float:
        """How long a set waits for cameras that are not silent [s]."""
        return self._window() + self._max_delay_s

    def can_close(self) -> bool:
        """Tell whether the oldest set is complete, or has waited long enough."""
        if self._overdue():
            return True
        oldest = self._oldest()
        return not any(
            self._may_still_deliver(name, camera, oldest) for name, camera in self.cameras.items()
        )

    def take(self) -> list[Waiting]:
        """Remove and return the images of the oldest set, or of one far ahead, in order of time."""
        window_s = self._window()
        opener = self._far_ahead(window_s) or self._oldest()
        limit_s = NEAREST_PERIODS * self._period()
        members = [
            camera
            for camera in self.cameras.values()
            if camera is opener
            or (
                camera.images
                and 0.0 <= camera.head_s - opener.head_s <= window_s
                and _in_phase(camera, opener, limit_s)
            )
        ]
        return sorted(
            (camera.images.popleft() for camera in members),
            key=lambda one: (one.image.t_s, one.image.camera),
        )

    def _oldest(self) -> CameraQueue:
        return min(
            (camera for camera in self.cameras.values() if camera.images),
            key=lambda camera: camera.head_s,
        )

    def _far_ahead(self, window_s: float) -> CameraQueue | None:
        """Return a camera whose image is later than the oldest's set, and waits in vain."""
        end_s = self._oldest().head_s + window_s
        told_s = min(
            camera.last_s
            for name, camera in self.cameras.items()
            if camera.images or not self._is_silent(name)
        )
        late_s = max(end_s, told_s)
        return next((camera for camera in self._overdue() if camera.head_s > late_s), None)

    def _overdue(self) -> list[CameraQueue]:
        """Return the cameras whose oldest image has waited long enough for the others."""
        since_s = self._time.elapsed_s - self.patience_s
        return [
            camera
            for camera in self.cameras.values()
            if camera.images and camera.images[0].own_s < since_s
        ]

    def _may_still_deliver(self, name: str, camera: CameraQueue, oldest: CameraQueue) -> bool:
        """Tell whether a camera may still deliver what belongs to the oldest image's set."""
        if camera.images or self._is_silent(name):
            return False
        time = self._time.heard(name)
        if time.heard_s <= oldest.images[0].heard_s:  # nothing since then
            return True
        return oldest.head_s - camera.last_s <= self._max_delay_s + time.silent_after_s

    def _is_silent(self, name: str) -> bool:
        return self._time.is_silent(self._time.heard(name), self._max_delay_s)

    def _period(self) -> float:
        """Return the fastest camera's mean period [s]; infinite if no camera delivered twice."""
        return min(
            (
                camera.period_s
                for name, camera in self.cameras.items()
                if camera.images or not self._is_silent(name)
            ),
            default=math.inf,
        )

    def _window(self) -> float:
        if self._window_s is not None:
            return self._window_s
        period_s = self._period()
        return WINDOW_PERIODS * period_s if period_s < math.inf else FALLBACK_WINDOW_S


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
