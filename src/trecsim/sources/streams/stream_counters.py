"""What a live source tells about itself."""

import math
import time
from collections import Counter
from collections.abc import Mapping
from threading import Lock

from trecsim.health import Clock
from trecsim.recent import Recent


class StreamCounters:
    """Counts of one live camera; written by its source, readable at any time from any thread.

    Attributes
    ----------
    camera
        The camera.
    frames
        Images, or 2D poses, that were delivered.
    last_image_s
        When the last one was, by `time.monotonic` [s]; None before the first.
    connected
        Whether the camera delivers.
    clock
        Whose clock dates the images.
    delay_s
        From taking an image to its arrival [s]; None while unknown.
    fault
        What is wrong now; None where nothing is.
    reconnects
        How often it was connected again.
    ended
        Whether it was a recording that has come to its end.
    decoding
        How long it took to decode each image, and how old it was then [ms].
    codec, size_px
        Coding of the stream, and width and height of its images [px]; None before the first.
    """

    def __init__(self, camera: str) -> None:
        self.camera = camera
        self.frames = 0
        self.last_image_s: float | None = None
        self.connected = False
        self.clock: Clock = "arrival"
        self.delay_s: float | None = None
        self.fault: str | None = None
        self.reconnects = 0
        self.ended = False
        self.decoding = Recent()
        self.codec: str | None = None
        self.size_px: tuple[int, int] | None = None
        self._dropped: Counter[str] = Counter()
        self._lock = Lock()

    def __repr__(self) -> str:
        return f"<StreamCounters of {self.camera!r}: {self.frames} images>"

    @property
    def dropped(self) -> Mapping[str, int]:
        """Number of images that were left out, by reason: "decode", "size" or "late"."""
        with self._lock:
            return dict(self._dropped)

    def drop(self, reason: str, count: int = 1) -> None:
        """Count images that were left out."""
        with self._lock:
            self._dropped[reason] += count

    def deliver(self, now_s: float) -> None:
        """Count an image that is delivered now, by `time.monotonic` [s]."""
        self.frames += 1
        self.last_image_s = now_s

    def decoded(self, took_s: float, age_s: float = math.nan) -> None:
        """Note how long it took to decode an image, and how old it was then [s]."""
        self.decoding.add(time.monotonic(), 1e3 * took_s, 1e3 * age_s)
