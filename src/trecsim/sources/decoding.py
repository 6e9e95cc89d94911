"""Decode video files with PyAV: the one module that knows it (import it only when needed)."""

import struct
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from fractions import Fraction
from heapq import heappop, heappush
from pathlib import Path
from typing import Any

import av
import numpy as np
from av.sidedata.sidedata import Type as SideDataType
from av.video.reformatter import VideoReformatter
from jaxtyping import UInt8

from trecsim.errors import InputError
from trecsim.redaction import address, is_address
from trecsim.sources.orientation import Orientation, from_display_matrix

MAX_IMAGE_PX = 2**26  # 8192 x 8192, 200 MB as RGB
MAX_FPS = 1000.0  # beyond, it is the clock of the container and not a rate
# Recordings only: a playlist or a script would make the decoder open other files and addresses.
CONTAINERS = (
    "mov,matroska,avi,mpegts,mpeg,mpegvideo,h264,hevc,obu,ivf,m4v,mjpeg,flv,ogg,asf,mxf,dv,nut,"
    "yuv4mpegpipe,rm,wtv,vc1"
)
IMAGES = {".jpg", ".jpeg", ".png", ".bmp", ".tif", ".tiff", ".gif", ".webp", ".heic"}
LIVE = "it is a live camera; `trecsim run` reads those, with a site file"
_OPTIONS = {
    "format_whitelist": CONTAINERS,
    "protocol_whitelist": "file",
    "max_pixels": str(MAX_IMAGE_PX),
}


@dataclass(frozen=True, slots=True)
class NotDecoded:
    """Stands for an image that was not decoded, as nobody needs it.

    Attributes
    ----------
    pts, time_base
        Its presentation time, as of PyAV's frames.
    """

    pts: int
    time_base: Fraction


@dataclass(slots=True)
class OpenVideo:
    """A container that is being read.

    Attributes
    ----------
    path
        The file.
    container, stream
        PyAV's handles.
    damaged
        Packets and images that could not be decoded so far.
    """

    path: Path
    container: Any
    stream: Any
    damaged: int = field(default=0)

    @property
    def fps(self) -> float | None:
        """Mean frame rate [1/s]; the nominal one if the container has no duration."""
        rates = [self.stream.average_rate, self.stream.guessed_rate]
        if self.stream.duration is None and self.container.duration is None:
            rates.reverse()
        known = [float(rate) for rate in rates if rate and 0 < rate <= MAX_FPS]
        return known[0] if known else None

    @property
    def frame_count(self) -> int | None:
        """Number of images, if the container has it."""
        return self.stream.frames or None

    @property
    def duration_s(self) -> float | None:
        """Length of the video [s], if the container has it."""
        if self.stream.duration is not None:
            return float(self.stream.duration * self.stream.time_base)
        if self.container.duration is not None and len(self.container.streams) == 1:
            return float(Fraction(self.container.duration, av.time_base))
        return None

    @property
    def other_sizes_px(self) -> tuple[tuple[int, int], ...]:
        """Widths and heights of the other video tracks, which are not read."""
        return tuple(
            (stream.width, stream.height)
            for stream in self.container.streams.video
            if stream.index != self.stream.index and not _is_cover(stream)
        )

    @property
    def keeps_no_time(self) -> bool:
        """Whether the time stamps only count images in the order of coding."""
        reordered = bool(self.stream.codec_context.has_b_frames)
        return reordered and self.container.format.name == "avi"

    def seek(self, t_s: float) -> None:
        """Go to the last key frame up to a time [s], where the container knows it."""
        try:
            offset = int(t_s / self.stream.time_base)
            self.container.seek(offset, stream=self.stream, backward=True)
        except av.FFmpegError:  # files that cannot seek stay where they are
            return

    def pictures(self, needed_from: Callable[[], float] | None = None) -> Iterator[Any]:
        """Yield the images that can be decoded, in display order; count the others in `damaged`.

        Parameters
        ----------
        needed_from
            Images before this time [s] are not needed, and it never falls. Those of them that no
            other image is decoded from are left out of decoding; a `NotDecoded` comes instead.
        """
        left_out: list[int] = []
        for packet in self._packets():
            early = needed_from is not None and _time_s(packet) < needed_from()
            if early:
                heappush(left_out, packet.pts)
            for picture in self._decoded(packet, early=early):
                while left_out and picture.pts is not None and left_out[0] <= picture.pts:
                    if (pts := heappop(left_out)) != picture.pts:
                        yield NotDecoded(pts, picture.time_base)
                yield picture
        while left_out:
            yield NotDecoded(heappop(left_out), self.stream.time_base)

    def _packets(self) -> Iterator[Any]:
        packets = self.container.demux(self.stream)
        while True:
            try:
                packet = next(packets, None)
            except av.FFmpegError:
                self.damaged += 1
                continue  # after an error of the container itself, `packets` is at its end
            if packet is None:
                return
            yield packet

    def _decoded(self, packet: Any, *, early: bool) -> Iterator[Any]:
        """Yield the images that a packet completes; of an `early` one only if others need it."""
        context = self.stream.codec_context
        if early and context.codec.intra_only:
            return
        context.skip_frame = "NONREF" if early else "DEFAULT"
        try:
            decoded = packet.decode()
        except av.FFmpegError:
            self.damaged += 1
            return
        for picture in decoded:
            if picture.is_corrupt:
                self.damaged += 1
            else:
                yield picture


@contextmanager
def opened(path: Path, threads: int | None) -> Iterator[OpenVideo]:
    """Open a video file.

    Parameters
    ----------
    path
        The file.
    threads
        Decoding threads; None uses one per processor.

    Raises
    ------
    InputError
        When it is missing, empty, no video, or cannot be decoded here.
    """
    _check_place(path)
    if path.stat().st_size == 0:
        raise InputError(f"cannot read video {path}: the file is empty")
    try:
        container = av.open(f"file:{path}", options=_OPTIONS, metadata_errors="ignore")
    except av.FFmpegError as error:
        raise InputError(_unreadable(path, error)) from error
    with container:
        yield OpenVideo(path, container, _video_stream(path, container, threads))


def _check_place(path: Path) -> None:
    if not path.is_file():
        if is_address(str(path)):
            raise InputError(f"cannot read video {address(str(path))}: {LIVE}")
        found = "it is a folder" if path.is_dir() else "no such file"
        raise InputError(f"cannot read video {path}: {found}")
    if path.suffix.lower() in IMAGES:
        raise InputError(
            f"cannot read video {path}: it is an image and no video; "
            "sequences of images are not read: make a video of them, for example with ffmpeg"
        )


def _unreadable(path: Path, error: Exception) -> str:
    if isinstance(error, OSError):
        return f"cannot read video {path}: {error.strerror}"
    return (
        f"cannot read video {path}: it is no video (expected mp4, mov, mkv, avi, ts or the like), "
        "or it is damaged, or its recording was cut off before the file was complete"
    )


def _is_cover(stream: Any) -> bool:
    return bool(stream.disposition & av.stream.Disposition.attached_pic)


def _video_stream(path: Path, container: Any, threads: int | None) -> Any:
    streams = [stream for stream in container.streams.video if not _is_cover(stream)]
    if not streams:
        kinds = ", ".join(sorted({stream.type for stream in container.streams})) or "nothing"
        raise InputError(f"cannot read video {path}: there is no video in it, only {kinds}")
    known = [stream for stream in streams if stream.codec_context is not None]
    if not known:
        raise InputError(
            f"cannot read video {path}: its coding is not known here; convert it, for example to "
            "H.264"
        )
    largest = max(known, key=lambda stream: stream.width * stream.height)
    context = largest.codec_context
    check_size(path, context.width, context.height)
    context.options = {"max_pixels": str(MAX_IMAGE_PX)}
    context.thread_count = threads or 0
    context.thread_type = "AUTO"
    return largest


def check_size(path: Path, width: int, height: int) -> None:
    """Refuse images that would not fit into memory.

    Raises
    ------
    InputError
        When there are more than `MAX_IMAGE_PX` pixels.
    """
    if width * height > MAX_IMAGE_PX:
        raise InputError(
            f"cannot read video {path}: its images are said to be {width} x {height} px, the "
            f"most that is read are {MAX_IMAGE_PX} px"
        )


def _time_s(packet: Any) -> float:
    """Return the presentation time of a packet [s]; NaN if it has none."""
    return float("nan") if packet.pts is None else float(packet.pts * packet.time_base)


def brightness(picture: Any) -> UInt8[np.ndarray, "h w"]:
    """Return the brightness of the pixels: as they were decoded, where they have 8 bits."""
    kind = picture.format
    is_alone = len(kind.components) == 1 and not kind.has_palette
    if kind.components[0].bits != 8 or not (kind.is_planar or is_alone):
        picture = picture.reformat(format="gray")
    plane = picture.planes[0]
    rows = np.frombuffer(plane, np.uint8).reshape(plane.height, plane.line_size)
    return rows[:, : picture.width]


def time_s(picture: Any) -> float | None:
    """Return the presentation time of `picture` [s], if the container has it."""
    return None if picture.pts is None else float(picture.pts * picture.time_base)


def orientation(picture: Any) -> Orientation:
    """Return the rotation that makes `picture` upright."""
    for data in picture.side_data:
        if data.type == SideDataType.DISPLAYMATRIX:
            return from_display_matrix(np.array(struct.unpack("=9i", bytes(data)[:36]), np.int32))
    return Orientation()


class RgbConverter:
    """Turns decoded pictures into upright RGB images of one size.

    Parameters
    ----------
    size_px
        Width and height of the upright image.
    turn
        How the coded picture has to be turned.
    """

    def __init__(self, size_px: tuple[int, int], turn: Orientation) -> None:
        self._width, self._height = turn.size(size_px)
        self._turn = turn
        self._reformatter = VideoReformatter()

    def __call__(self, picture: Any) -> UInt8[np.ndarray, "h w 3"]:
        """Return the image; averages over areas where it makes it smaller."""
        scaled = self._reformatter.reformat(
            picture,
            width=self._width,
            height=self._height,
            format="rgb24",
            interpolation="AREA",
            threads=1,
        )
        return self._turn.upright(scaled.to_ndarray())
