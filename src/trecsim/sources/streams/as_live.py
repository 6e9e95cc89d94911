"""Recordings played as if they were live: at their own pace, dated from now on."""

import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from threading import Event, Lock

from trecsim.errors import Error
from trecsim.sources.streams.stream_counters import StreamCounters
from trecsim.sources.streams.wall_clock import WALL_CLOCK, WallClock
from trecsim.sources.video import VideoFile
from trecsim.values import Frame, Poses2D

LATE_S = 1.0  # an image that is ready so much later than it was due is left out


class Pace:
    """The time of recordings that are played together; it begins with the first image.

    Parameters
    ----------
    first_s
        Time in the recordings at which to begin [s].
    wall_clock
        Unix time.
    """

    def __init__(self, first_s: float, wall_clock: WallClock = WALL_CLOCK) -> None:
        self._first_s = first_s
        self._wall_clock = wall_clock
        self._lock = Lock()
        self._began: tuple[float, float] | None = None  # Unix time, and the steady clock [s]

    def live_s(self, t_s: float) -> float:
        """Return when an image of the recordings is taken, Unix time [s]."""
        return self._beginning()[0] + t_s - self._first_s

    def late_s(self, t_s: float) -> float:
        """Return how long ago an image was due [s]; negative while it is to come."""
        return time.monotonic() - self._beginning()[1] - (t_s - self._first_s)

    def _beginning(self) -> tuple[float, float]:
        with self._lock:
            if self._began is None:
                self._began = self._wall_clock.now_s(), time.monotonic()
            return self._began


class RecordedStream:
    """The images of a video file, played as those of a live camera.

    Parameters
    ----------
    video
        The recording.
    pace
        Shared by all recordings that are played together.

    Attributes
    ----------
    camera, counters
        The camera, and what is told about it.
    """

    def __init__(self, video: VideoFile, pace: Pace) -> None:
        self.camera = video.camera
        self.counters = StreamCounters(video.camera)
        self.counters.codec, self.counters.size_px = video.info.codec, video.size_px
        self._video, self._pace = video, pace
        self._closing = Event()

    @property
    def readings(self) -> tuple[StreamCounters, ...]:
        """What it tells about itself, for each of its cameras."""
        return (self.counters,)

    def close(self) -> None:
        """End the iteration."""
        self._closing.set()

    def __iter__(self) -> Iterator[Frame]:
        smaller = self._video.decoded_size_px != self._video.size_px
        original_px = self._video.size_px if smaller else None
        with _playing(self.readings):
            for frame in self._decoded():
                if self._pace.late_s(frame.t_s) > LATE_S:
                    self.counters.drop("late")
                    continue
                if self._closing.wait(max(0.0, -self._pace.late_s(frame.t_s))):
                    return
                self.counters.deliver(time.monotonic())
                yield replace(frame, t_s=self._pace.live_s(frame.t_s), size_px=original_px)

    def _decoded(self) -> Iterator[Frame]:
        """Yield the images, and note how long each took."""
        images = iter(self._video)
        while True:
            began_s = time.perf_counter()
            frame = next(images, None)
            if frame is None:
                return
            took_s = time.perf_counter() - began_s
            self.counters.decoded(took_s)
            yield frame


class PosesStream:
    """Recorded or simulated 2D poses of several cameras, played as live ones.

    Parameters
    ----------
    poses
        In the order of their times.
    cameras
        Their names.
    pace
        Shared by all recordings that are played together; None begins with the first image.
    """

    def __init__(
        self, poses: Iterable[Poses2D], cameras: Sequence[str], pace: Pace | None = None
    ) -> None:
        self._poses, self._pace = poses, pace
        self._counters = {name: StreamCounters(name) for name in cameras}
        self._closing = Event()

    @property
    def readings(self) -> tuple[StreamCounters, ...]:
        """What it tells about itself, for each of its cameras."""
        return tuple(self._counters.values())

    def close(self) -> None:
        """End the iteration."""
        self._closing.set()

    def __iter__(self) -> Iterator[Poses2D]:
        pace = self._pace
        with _playing(self.readings):
            for poses in self._poses:
                pace = pace or Pace(poses.t_s)
                if self._closing.wait(max(0.0, -pace.late_s(poses.t_s))):
                    return
                counters = self._counters.get(poses.camera)
                if counters is not None:
                    counters.deliver(time.monotonic())
                yield replace(poses, t_s=pace.live_s(poses.t_s))


@contextmanager
def _playing(readings: Sequence[StreamCounters]) -> Iterator[None]:
    """Tell of recordings that they have ended, and what was wrong with them."""
    for counters in readings:
        counters.connected = True
    try:
        yield
    except Error as error:
        for counters in readings:
            counters.fault = str(error)
        raise
    finally:
        for counters in readings:
            counters.connected, counters.ended = False, True
