"""Pictures of the cameras for those who look at them now, and for nobody else.

Nothing is kept but the newest image of a camera that somebody looks at. Images are encoded in a
thread of their own with low priority, so neither the cameras nor the fusion wait for it.
"""

import logging
import os
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from typing import Self

from trecsim.sources.base import Source
from trecsim.values import Frame

logger = logging.getLogger(__name__)

EVERY_S = 0.5  # one picture of a camera at most in this time
LOOKS_S = 3.0  # who has asked for a picture looks for so long
LIMIT_PX = (640, 640)
_LOW_PRIORITY = 10

Encode = Callable[[Frame], bytes]
Show = Callable[[str, float, bytes], None]


class PictureMaker:
    """Makes pictures of the cameras at which somebody looks, twice a second at most.

    Parameters
    ----------
    encode
        Returns a picture of an image.
    show
        Takes the camera, the time of the image [s] and its picture.
    clock
        A steady clock [s].
    """

    def __init__(
        self, encode: Encode, show: Show, *, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._encode, self._show, self._clock = encode, show, clock
        self._until_s: dict[str, float] = {}  # somebody looks at a camera until then
        self._newest: dict[str, Frame] = {}
        self._ending = threading.Event()
        self._thread = threading.Thread(target=self._run, name="pictures", daemon=True)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *ending: object) -> None:
        self._ending.set()
        self._thread.join()

    def look(self, camera: str) -> None:
        """Take note that somebody looks at a camera."""
        self._until_s[camera] = self._clock() + LOOKS_S

    def take(self, frame: Frame) -> None:
        """Take an image; it is kept only while somebody looks at its camera."""
        if self._until_s.get(frame.camera, 0.0) > self._clock():
            self._newest[frame.camera] = frame

    def make(self) -> None:
        """Make a picture of the newest image of each camera that has one, and forget it."""
        for camera in list(self._newest):
            frame = self._newest.pop(camera)
            if self._until_s.get(camera, 0.0) > self._clock():
                self._show(camera, frame.t_s, self._encode(frame))

    def _run(self) -> None:
        with suppress(OSError, AttributeError):
            os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), _LOW_PRIORITY)
        while not self._ending.wait(EVERY_S):
            try:
                self.make()
            except Exception:  # the boundary: no picture must stop the others
                logger.exception("a picture of a camera cannot be made")


class Watched:
    """A source whose images a picture maker may take.

    Parameters
    ----------
    source
        The source.
    take
        Is given each image before it goes on.
    """

    def __init__(self, source: Source[Frame], take: Callable[[Frame], None]) -> None:
        self._source, self._take = source, take

    def __iter__(self) -> Iterator[Frame]:
        for frame in self._source:
            self._take(frame)
            yield frame


def jpeg(frame: Frame) -> bytes:
    """Return an image as JPEG, no larger than `LIMIT_PX`."""
    from trecsim.sources.jpeg import jpeg_of

    return jpeg_of(frame.image, LIMIT_PX)
