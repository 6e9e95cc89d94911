"""One connection to a live camera: a thread that decodes, and the newest image for who wants it.

The thread belongs to FFmpeg: it may hang there, whatever time limits say. So nobody waits for it;
a connection that is given up ends by itself when FFmpeg returns.
"""

import logging
import struct
import time
from collections.abc import Iterator
from dataclasses import dataclass
from threading import Condition, Thread
from typing import Any

import av
import numpy as np
from jaxtyping import UInt8

from trecsim.sources.streams.connection_faults import NO_VIDEO, explained, is_refusal
from trecsim.sources.streams.image_dates import ImageDate, ImageDates
from trecsim.sources.streams.stream_address import MAX_IMAGE_PX, Address
from trecsim.sources.streams.stream_counters import StreamCounters
from trecsim.sources.streams.wall_clock import WALL_CLOCK, WallClock

logger = logging.getLogger(__name__)

OPEN_S = 5.0  # a camera that does not answer within this is given up
SILENT_S = 3.0  # so is one that sends nothing for as long
NO_IMAGE_S = 10.0  # or nothing that can be decoded
NO_TIME_S = 5.0  # or only images that are late
LATE_S = 1.0  # an image that comes later than this after the soonest is left out
COUNTING = ("mpjpeg", "mjpeg", "h264", "hevc")  # formats without stamps: FFmpeg counts images
_EVERY_PX = 8
_TOLERATED_S = 1.0  # a time that falls back by more is a clock that was set, not a late image


@dataclass(frozen=True, slots=True)
class Taken:
    """An image as it was decoded.

    Attributes
    ----------
    picture
        PyAV's handle.
    t_s
        When it was taken, Unix time [s].
    """

    picture: Any
    t_s: float

    def brightness(self) -> UInt8[np.ndarray, "h w"]:
        """Return some of its pixels as they were decoded."""
        plane = self.picture.planes[0]
        rows = np.frombuffer(plane, np.uint8).reshape(plane.height, plane.line_size)
        return rows[::_EVERY_PX, : self.picture.width : _EVERY_PX]


class Connection:
    """Reads one stream until it ends, fails, falls silent or is closed.

    Parameters
    ----------
    address
        Of the camera.
    size_px
        The size that its images should have [px].
    counters
        Are kept up to date.
    dates
        Date the images.
    after_s
        Images that are not later than this are left out [s].
    wall_clock
        Unix time.

    Attributes
    ----------
    fault
        Why it ended; None while it goes on.
    refused
        Whether the camera refuses user or password.
    """

    def __init__(
        self,
        address: Address,
        size_px: tuple[int, int],
        counters: StreamCounters,
        dates: ImageDates,
        *,
        after_s: float,
        wall_clock: WallClock = WALL_CLOCK,
    ) -> None:
        self.fault: str | None = None
        self.refused = False
        self._address, self._size_px = address, size_px
        self._counters, self._dates, self._wall_clock = counters, dates, wall_clock
        self._settings = wall_clock.settings
        self._last_s = after_s
        self._changed = Condition()
        self._newest: Taken | None = None
        self._closed = False
        self._opened = self._has_decoded = False
        self._heard_s = self._decoded_s = self._opened_s = self._timely_s = time.monotonic()
        self._has_stamps = True
        self._decode_s = 0.0  # of the last image
        self._thread = Thread(target=self._run, name=f"camera-{counters.camera}", daemon=True)
        self._thread.start()

    @property
    def is_running(self) -> bool:
        """Whether its thread has not ended yet."""
        return self._thread.is_alive()

    @property
    def lasted_s(self) -> float:
        """For how long it delivered images [s]."""
        return self._decoded_s - self._opened_s if self._opened else 0.0

    def take(self, timeout_s: float) -> Taken | None:
        """Return the newest image; None where none came within `timeout_s`, or will come."""
        with self._changed:
            self._changed.wait_for(lambda: self._newest or self.fault or self._closed, timeout_s)
            newest, self._newest = self._newest, None
            if newest is None and self.fault is None and not self._closed:
                self.fault = self._silence(time.monotonic())
            return newest

    def close(self) -> None:
        """End it; does not wait for FFmpeg."""
        with self._changed:
            self._closed = True
            self._newest = None
            self._changed.notify_all()

    def _silence(self, now_s: float) -> str | None:
        """Return what is wrong with a stream that sends nothing, whatever FFmpeg says of it."""
        if not self._opened:
            late = now_s - self._heard_s > OPEN_S + SILENT_S
            return f"{self._address} does not answer" if late else None
        if now_s - self._heard_s > SILENT_S:
            return self._nothing_came()
        if self._decoded_s - self._timely_s > NO_TIME_S:
            return (
                f"the images of {self._address} come more than {LATE_S:.0f} s late all the time: "
                "the network or this machine is too slow for them; set a lower bit rate, fewer "
                "images per second or a smaller stream"
            )
        if now_s - self._decoded_s > NO_IMAGE_S:
            return (
                f"no image from {self._address} could be decoded for {NO_IMAGE_S:.0f} s; set the "
                "camera to H.264 with a key frame every second or two"
            )
        return None

    def _nothing_came(self) -> str:
        return f"nothing has come from {self._address} for {SILENT_S:.0f} s"

    def _run(self) -> None:
        try:
            fault = self._read()
        except (av.FFmpegError, OSError) as error:
            self.refused = is_refusal(error)
            waited_s = time.monotonic() - self._heard_s
            if self._opened and isinstance(error, av.ExitError):
                fault = self._nothing_came()
            else:
                waited = not self._opened and waited_s >= OPEN_S
                fault = explained(error, self._address, waited=waited)
        except Exception as error:  # the boundary of a camera: whatever it sends, it is told
            logger.debug("camera %r", self._counters.camera, exc_info=True)
            fault = f"{NO_VIDEO.format(address=self._address)} ({type(error).__name__})"
        with self._changed:
            self.fault = self.fault or fault
            self._changed.notify_all()

    def _read(self) -> str:
        opening = self._address.opening(self._size_px)
        with av.open(
            opening.name,
            format=opening.format,
            options=opening.options,
            timeout=(OPEN_S, SILENT_S),
            metadata_errors="ignore",
        ) as container:
            stream = _video_stream(container)
            if isinstance(stream, str):
                return f"{self._address}: {stream}"
            self._counters.codec = stream.codec_context.name
            with self._changed:
                self._opened = True
                self._has_stamps = container.format.name not in COUNTING
                self._heard_s = self._decoded_s = self._opened_s = time.monotonic()
                self._timely_s = self._heard_s
            for packet in container.demux(stream):
                if self._closed:
                    return "closed"
                self._heard_s = time.monotonic()
                self._take_report(packet)
                for picture in self._decoded(packet):
                    self._offer(picture)
        return f"the camera ended the stream {self._address}"

    def _take_report(self, packet: Any) -> None:
        if packet.pts is None or not packet.has_sidedata("prft"):
            return
        sent_us = struct.unpack_from("=q", bytes(packet.get_sidedata("prft")))[0]
        self._dates.report(float(packet.pts * packet.time_base), 1e-6 * sent_us)

    def _decoded(self, packet: Any) -> Iterator[Any]:
        """Yield the images in a packet; count what cannot be decoded."""
        began_s = time.perf_counter()
        try:
            pictures = packet.decode()
        except av.FFmpegError:
            self._counters.drop("decode")
            return
        self._decode_s = time.perf_counter() - began_s
        for picture in pictures:
            if picture.is_corrupt:
                if self._has_decoded:  # who comes into a stream cannot decode what came before
                    self._counters.drop("decode")
            else:
                self._has_decoded = True
                self._decoded_s = time.monotonic()
                yield picture

    def _offer(self, picture: Any) -> None:
        """Let an image wait in place of an older one, unless it is late."""
        date = self._date(picture)
        self._counters.clock, self._counters.delay_s = self._dates.clock, self._dates.delay_s
        self._counters.decoded(self._decode_s, self._wall_clock.now_s() - date.t_s)
        falls_back_s = self._last_s - date.t_s
        if date.late_s > LATE_S or 0.0 <= falls_back_s < _TOLERATED_S:
            self._counters.drop("late")
            return
        self._last_s, self._timely_s = date.t_s, self._decoded_s
        with self._changed:
            if self._newest is not None:
                self._counters.drop("late")
            self._newest = None if self._closed else Taken(picture, date.t_s)
            self._changed.notify_all()

    def _date(self, picture: Any) -> ImageDate:
        arrived_s = self._wall_clock.now_s()
        if self._wall_clock.settings != self._settings:
            self._settings = self._wall_clock.settings
            self._dates.clock_was_set()
        known = self._has_stamps and picture.pts is not None
        stamp_s = float(picture.pts * picture.time_base) if known else None
        return self._dates.date(stamp_s, arrived_s)


def _video_stream(container: Any) -> Any:
    """Return the stream of video in a container; a text that says what is wrong where none is."""
    streams = container.streams.video
    if not streams:
        return "there is no video in it"
    known = [stream for stream in streams if stream.codec_context is not None]
    if not known:
        return "its coding is not known here; set the camera to H.264"
    stream = max(known, key=lambda one: one.width * one.height)
    stream.codec_context.options = {"max_pixels": str(MAX_IMAGE_PX)}
    stream.codec_context.thread_type = "SLICE"  # whole images side by side would each wait
    stream.codec_context.thread_count = 1
    return stream
