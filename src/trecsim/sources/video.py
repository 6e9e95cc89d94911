"""Video files as streams of frames with the time stamps of the file."""

import logging
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from jaxtyping import Float64, UInt8

from trecsim.errors import InputError, SetupError
from trecsim.extras import install_command
from trecsim.sources.image_sizes import fitted, original_px
from trecsim.sources.masks import Image, Mask, Polygon
from trecsim.sources.orientation import Orientation
from trecsim.values import Frame

logger = logging.getLogger(__name__)

FALLBACK_FPS = 25.0
MISSED_S = 0.5  # an end earlier than announced by less is not worth a warning,
_WORTH_SEEKING_S = 5.0
MISSED_PERIODS = 1.5  # nor by fewer periods: the last image lasts one


@dataclass(frozen=True, slots=True)
class VideoInfo:
    """The properties of a video file.

    Attributes
    ----------
    size_px
        Width and height of the upright images [px].
    fps
        Mean frame rate [1/s], if known.
    frame_count
        Number of images, if the file has it.
    start_s
        Time of the first image [s].
    duration_s
        From the start of the first to the end of the last image [s], if the file has it.
    codec
        Name of the codec, such as ``"h264"``.
    orientation
        Rotation that makes the coded images upright.
    other_sizes_px
        Sizes of further video tracks in the file; the largest track is the one that is read.
    """

    size_px: tuple[int, int]
    fps: float | None
    frame_count: int | None
    start_s: float
    duration_s: float | None
    codec: str
    orientation: Orientation
    other_sizes_px: tuple[tuple[int, int], ...] = ()

    def remark(self, path: Path) -> str | None:
        """Return what to say about the file at `path` before it is read; None if nothing."""
        if not self.other_sizes_px:
            return None
        others = ", ".join(f"{width} x {height}" for width, height in self.other_sizes_px)
        width, height = self.size_px
        return (
            f"video {path} has several video tracks: the largest, {width} x {height} px, is read, "
            f"not {others}"
        )

    @property
    def expected_frames(self) -> int | None:
        """Number of images; estimated from duration and rate if the file does not have it."""
        if self.frame_count is None and self.fps is not None and self.duration_s is not None:
            return round(self.fps * self.duration_s)
        return self.frame_count


def probe(path: Path) -> VideoInfo:
    """Return the properties of a video file; decodes its first image.

    Raises
    ------
    InputError
        When the file is missing, empty, no video, or holds no image that can be decoded.
    SetupError
        When PyAV is not installed.
    """
    decode = _decoding()
    with decode.opened(path, threads=1) as video:
        picture = next(video.pictures(), None)
        if picture is None:
            raise InputError(f"cannot read video {path}: no image in it can be decoded")
        decode.check_size(path, picture.width, picture.height)
        turn = decode.orientation(picture)
        return VideoInfo(
            turn.size((picture.width, picture.height)),
            video.fps,
            video.frame_count,
            0.0 if video.keeps_no_time else decode.time_s(picture) or 0.0,
            video.duration_s,
            video.stream.codec_context.name,
            turn,
            video.other_sizes_px,
        )


def _decoding() -> ModuleType:
    try:
        from trecsim.sources import decoding
    except ImportError as error:
        raise SetupError(
            f"reading video needs PyAV: {install_command('video')} ({error})"
        ) from error
    return decoding


def log_remark(text: str) -> None:
    """Log a remark on a file."""
    logger.warning("%s", text)


class VideoFile:
    """The frames of a video file, decoded while iterating.

    Time stamps are those of the file: if the container starts at 10 s, so do the frames, and a
    variable frame rate is kept. Images without a time stamp continue at the mean rate, images whose
    time does not advance are left out, damaged images are skipped; each of these is logged once at
    the end. Of several video tracks the largest is read. Images are rotated upright if the file
    says how. Each iteration starts from the beginning; several may run at once.

    Parameters
    ----------
    path
        The file.
    camera
        Name of the camera.
    decode_size_px
        Width and height that the images must fit into [px]; they keep their shape and are never
        enlarged. None keeps their size. Cheaper than scaling them later.
    threads
        Decoding threads; None uses one per processor. Use 1 if several videos are read at once.
    remark
        Is told what is odd about the file as a whole; logged if not given.
    mask_px
        Polygons of the upright original that are blanked in every image, see `Mask`.

    Attributes
    ----------
    path, camera, info
        The arguments, and the properties of the file.
    size_px
        Width and height of the upright original [px], to which the calibration refers.
    decoded_size_px
        Width and height of the frames [px].

    Raises
    ------
    InputError
        When the file is missing, empty, no video, or holds no image that can be decoded.
    SetupError
        When PyAV is not installed.
    """

    def __init__(
        self,
        path: Path,
        camera: str,
        *,
        decode_size_px: tuple[int, int] | None = None,
        threads: int | None = None,
        remark: Callable[[str], None] = log_remark,
        mask_px: Sequence[Polygon] = (),
    ) -> None:
        self.path = path
        self.camera = camera
        self.info = probe(path)
        self.size_px = self.info.size_px
        self.decoded_size_px = fitted(self.size_px, decode_size_px or self.size_px)
        self._threads = threads
        self._mask = Mask(mask_px, self.size_px) if mask_px else None
        text = self.info.remark(path)
        if text is not None:
            remark(text)

    def original_px(
        self, xy_px: Float64[np.ndarray, "*batch 2"]
    ) -> Float64[np.ndarray, "*batch 2"]:
        """Return the positions in the original image of points in a decoded one [px]."""
        return original_px(xy_px, self.decoded_size_px, self.size_px)

    def __iter__(self) -> Iterator[Frame]:
        return (picture.frame() for picture in self.pictures())

    def pictures(
        self, from_s: float = 0.0, needed_from: Callable[[], float] | None = None
    ) -> Iterator["Picture"]:
        """Yield the same images, decoded but not yet turned into RGB.

        That takes most of the time, and is saved for those that nobody looks at.

        Parameters
        ----------
        from_s
            What is earlier may be left out; it is where the file has an index [s].
        needed_from
            Images before this time [s], which never falls, are not needed. Those that no other
            image depends on are not decoded: they come without pixels.
        """
        decode = _decoding()
        begins_s = self._key_frame_s(from_s) if from_s > _WORTH_SEEKING_S else None
        with decode.opened(self.path, self._threads) as video:
            if begins_s is not None:
                video.seek(begins_s)
            clock = _Clock(self.info.fps or FALLBACK_FPS, counts_only=video.keeps_no_time)
            to_rgb = decode.RgbConverter(self.decoded_size_px, self.info.orientation)
            index = 0
            for picture in video.pictures(None if video.keeps_no_time else needed_from):
                is_decoded = not isinstance(picture, decode.NotDecoded)
                if is_decoded:
                    self._check_size(picture)
                t_s = clock(decode.time_s(picture))
                if t_s is not None:
                    make = partial(_masked, to_rgb, picture, self._mask) if is_decoded else None
                    luma = partial(decode.brightness, picture) if is_decoded else None
                    yield Picture(self.camera, index, t_s, make, luma)
                    index += 1
            if begins_s is None:
                self._warn(index, video.damaged, clock)

    def _key_frame_s(self, from_s: float) -> float | None:
        """Return the time of a key frame before a time [s]; None to read from the beginning."""
        decode = _decoding()
        with decode.opened(self.path, threads=1) as video:
            if video.keeps_no_time:
                return None
            video.seek(from_s)
            picture = next(video.pictures(), None)
            t_s = None if picture is None else decode.time_s(picture)
        return t_s if t_s is not None and self.info.start_s < t_s <= from_s else None

    def _check_size(self, picture: Any) -> None:
        expected = self.info.orientation.size(self.size_px)
        if (picture.width, picture.height) != expected:
            raise InputError(
                f"video {self.path}: the size of the images changes from "
                f"{expected[0]} x {expected[1]} to {picture.width} x {picture.height} px; one "
                "calibration cannot fit both: cut the video there"
            )

    def _warn(self, frames: int, damaged: int, clock: "_Clock") -> None:
        count = self.info.frame_count
        missing = count is not None and frames + clock.left_out < 0.98 * count
        end_s = self.info.start_s + (self.info.duration_s or 0.0)
        missed_s = max(MISSED_S, MISSED_PERIODS * clock.period_s)
        if damaged or (clock.last_s < end_s - missed_s and (missing or count is None)):
            logger.warning(
                "video %s is damaged or cut off: %d%s frames could be read, up to %.3f s; they "
                "are used",
                self.path,
                frames,
                f" of {count}" if count else "",
                clock.last_s,
            )
        if clock.guessed:
            logger.warning(
                "video %s: %d frames carry no time; assumed %g frames per second for them",
                self.path,
                clock.guessed,
                clock.fps,
            )
        if clock.left_out:
            logger.warning(
                "video %s: %d frames are left out because their time does not advance; if it is "
                "put together from several recordings, give each as a file of its own",
                self.path,
                clock.left_out,
            )


@dataclass(frozen=True, slots=True, eq=False)
class Picture:
    """An image of a video that can be had as RGB.

    Attributes
    ----------
    camera, index, t_s
        As of `Frame`.
    to_rgb
        Returns the pixels; in one thread at a time for the pictures of one video. None if it was
        not decoded, as nobody needed it.
    brightness
        Returns the brightness of its pixels as they were decoded, not turned upright or blanked.
    """

    camera: str
    index: int
    t_s: float
    to_rgb: Callable[[], Image] | None
    brightness: Callable[[], UInt8[np.ndarray, "h w"]] | None = None

    def frame(self) -> Frame:
        """Return the image in RGB."""
        assert self.to_rgb is not None, "it was said not to be needed"
        return Frame(self.camera, self.index, self.t_s, self.to_rgb())


def _masked(to_rgb: Callable[[Any], Image], picture: Any, mask: Mask | None) -> Image:
    image = to_rgb(picture)
    return image if mask is None else mask(image)


class _Clock:
    """Assigns each image its time; the times always increase."""

    def __init__(self, fps: float, *, counts_only: bool) -> None:
        self.fps = fps
        self.last_s = -1.0 / fps
        self.guessed = 0
        self.left_out = 0
        self._started = False
        self._steps = 0
        self._advanced_s = 0.0
        self._counts_only = counts_only

    def __call__(self, stamp_s: float | None) -> float | None:
        """Return the time of the next image [s]; None to leave it out."""
        t_s = self.last_s + 1.0 / self.fps if stamp_s is None or self._counts_only else stamp_s
        if self._started and t_s <= self.last_s:
            self.left_out += 1
            return None
        self.guessed += stamp_s is None
        if self._started:
            self._steps += 1
            self._advanced_s += t_s - self.last_s
        self.last_s, self._started = t_s, True
        return t_s

    @property
    def period_s(self) -> float:
        """Mean time between images [s]."""
        return self._advanced_s / self._steps if self._steps else 1.0 / self.fps
