"""A live camera as a source of images; it never ends by itself."""

import logging
import time
from collections.abc import Iterator, Sequence
from functools import partial
from threading import Event
from typing import TYPE_CHECKING

from trecsim.errors import SetupError
from trecsim.extras import install_command
from trecsim.sources.image_sizes import is_cut
from trecsim.sources.masks import Mask, Polygon
from trecsim.sources.streams.frozen_image import FROZEN_S, FrozenImage
from trecsim.sources.streams.image_dates import DELAY_S, ImageDates
from trecsim.sources.streams.live_frame import Developer, LiveFrame
from trecsim.sources.streams.retrying import Retrying
from trecsim.sources.streams.stream_address import Address
from trecsim.sources.streams.stream_counters import StreamCounters
from trecsim.values import Frame

if TYPE_CHECKING:
    from trecsim.sources.streams.connection import Connection

logger = logging.getLogger(__name__)

_LOOK_S = 0.2  # so often a source that gets nothing looks whether it is to end
_STEADY_S = 2.0  # a stream that lasted for longer was there, and is tried again at once
_GIVEN_UP = 3  # connections that FFmpeg does not end; no more are begun


class StreamSource:
    """The images of one live camera, the newest first of all: what is late is left out.

    A stream that ends, fails or falls silent is connected again, for ever. Nothing that the camera
    does ends the iteration; `close` does. Images of a size for which the camera is not calibrated
    are left out. Only one iteration at a time.

    Parameters
    ----------
    camera
        Its name in the rig.
    address
        Where it is.
    size_px
        Width and height of the images for which it is calibrated [px].
    limit_px
        Width and height that the images must fit into [px]; larger ones are made smaller. None
        keeps their size.
    mask_px
        Polygons of the camera's image that are blanked in every image, see `Mask`.

    Attributes
    ----------
    counters
        What it tells about itself, readable at any time from any thread.

    Raises
    ------
    SetupError
        When PyAV is not installed.
    """

    def __init__(
        self,
        camera: str,
        address: Address,
        size_px: tuple[int, int],
        limit_px: tuple[int, int] | None = None,
        mask_px: Sequence[Polygon] = (),
    ) -> None:
        try:
            from trecsim.sources.streams import connection  # noqa: F401
        except ImportError as error:
            raise SetupError(
                f"live cameras need PyAV: {install_command('video')} ({error})"
            ) from error
        self.camera = camera
        self.counters = StreamCounters(camera)
        self._address, self._size_px, self._limit_px = address, size_px, limit_px
        self._mask = Mask(mask_px, size_px) if mask_px else None
        self._closing = Event()
        self._retrying = Retrying(camera)
        self._given_up: list[Connection] = []
        self._told: str | None = None
        self._delay_s = DELAY_S
        self._last_s = float("-inf")

    def __repr__(self) -> str:
        return f"<StreamSource of {self.camera!r}: {self._address}>"

    @property
    def readings(self) -> tuple[StreamCounters, ...]:
        """What it tells about itself, for each of its cameras."""
        return (self.counters,)

    def close(self) -> None:
        """End the iteration; does not wait for the camera."""
        self._closing.set()

    def __iter__(self) -> Iterator[Frame]:
        from trecsim.sources.streams.connection import Connection

        while not self._closing.is_set():
            dates = ImageDates(self._delay_s)
            connection = Connection(
                self._address, self._size_px, self.counters, dates, after_s=self._last_s
            )
            try:
                yield from self._frames(connection, dates)
            finally:
                connection.close()
                self.counters.connected = False
            self._delay_s = dates.delay_s
            self._given_up.append(connection)
            if connection.lasted_s > _STEADY_S:
                self._retrying.connected()
            self._tell(connection.fault)
            self._wait(self._retrying.delay_s(time.monotonic(), refused=connection.refused))
            self.counters.reconnects += 1

    def _frames(self, connection: "Connection", dates: ImageDates) -> Iterator[Frame]:
        """Yield the images of one connection until it ends."""
        developer, frozen = Developer(self._limit_px, self._mask), FrozenImage()
        while connection.fault is None and not self._closing.is_set():
            taken = connection.take(_LOOK_S)
            if taken is None:
                continue
            size_px = (taken.picture.width, taken.picture.height)
            self.counters.size_px = size_px
            if size_px != self._size_px and not is_cut(size_px, self._size_px):
                self.counters.drop("size")
                self._tell(_wrong_size(size_px, self._size_px))
                continue
            now_s = time.monotonic()
            self._tell(_FROZEN if frozen.is_frozen(taken.brightness(), now_s) else dates.remark)
            self._last_s = taken.t_s
            self.counters.connected = True
            self.counters.deliver(now_s)
            yield LiveFrame(
                self.camera,
                self.counters.frames - 1,
                taken.t_s,
                size_px if developer.size_px(size_px) != size_px else None,
                partial(developer, taken.picture),
            )

    def _tell(self, fault: str | None) -> None:
        """Show what is wrong now; log it once."""
        self.counters.fault = fault
        if fault == self._told:
            return
        if fault is None:
            logger.warning("camera %r is well again", self.camera)
        else:
            logger.warning("camera %r: %s", self.camera, fault)
        self._told = fault

    def _wait(self, wait_s: float) -> None:
        """Wait for the next try; while FFmpeg holds on to too many connections, for one of them."""
        self._closing.wait(wait_s)
        while not self._closing.is_set():
            self._given_up = [one for one in self._given_up if one.is_running]
            if len(self._given_up) < _GIVEN_UP:
                return
            self._closing.wait(_LOOK_S)


_FROZEN = (
    f"it has shown the same image for {FROZEN_S:.0f} s; is something in front of it, or does the "
    "camera have to be started again?"
)


def _wrong_size(found_px: tuple[int, int], expected_px: tuple[int, int]) -> str:
    return (
        f"its images are {found_px[0]} x {found_px[1]} px, but it is calibrated for "
        f"{expected_px[0]} x {expected_px[1]} px; they are left out. Set the stream to that size, "
        "or calibrate the camera for the other"
    )
