"""Images and videos of a board, as grey pictures with a number or a time."""

import glob
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import UInt8

from trecsim.errors import InputError
from trecsim.extras import needed
from trecsim.sources.video import VideoFile, VideoInfo, probe

Grey = UInt8[np.ndarray, "h w"]

IMAGE_SUFFIXES = (".bmp", ".jpeg", ".jpg", ".png", ".tif", ".tiff", ".webp")
VIDEO_SUFFIXES = (
    ".avi", ".m2ts", ".m4v", ".mkv", ".mov", ".mp4", ".mpg", ".mts", ".ts", ".webm",
)  # fmt: skip


@dataclass(frozen=True, slots=True, eq=False)
class BoardImage:
    """One picture in which a board may be.

    Attributes
    ----------
    label
        What it is called in messages: the name of the file, or the time in the video.
    key
        What it has in common with the pictures of other cameras of the same moment: the last number
        in the name of the file, or its place where names have none. In a video the number of the
        image.
    t_s
        When it was taken [s]; NaN for images in files.
    grey
        Its pixels.
    """

    label: str
    key: int
    t_s: float
    grey: Grey


@dataclass(frozen=True, slots=True)
class BoardSource:
    """The images of one camera.

    Attributes
    ----------
    camera
        Name of the camera.
    files
        Images, or one video.
    video
        What is known of the video; None for images.
    """

    camera: str
    files: tuple[Path, ...]
    video: VideoInfo | None

    @property
    def about(self) -> str:
        """What it is, for messages."""
        if self.video is not None:
            return f"the video {self.files[0]}"
        return f"{len(self.files)} images"

    def images(self, step: int = 1) -> Iterator[BoardImage]:
        """Yield the images, of a video each `step`-th only.

        Raises
        ------
        InputError
            An image cannot be read.
        """
        if self.video is not None:
            yield from _video_images(self, step)
            return
        keys = _keys(self.files)
        for file, key in zip(self.files, keys, strict=True):
            yield BoardImage(file.name, key, float("nan"), read_grey(file))


def board_sources(given: Sequence[str]) -> tuple[BoardSource, ...]:
    """Return the sources of ``NAME=IMAGES_OR_VIDEO`` arguments, one per camera.

    Parameters
    ----------
    given
        Each names a camera and its images: a directory, a pattern such as ``cam1/*.jpg``, one
        image, or a video. A camera may be named more than once, with images each.

    Raises
    ------
    InputError
        A name or a file is missing, or a camera has images and a video.
    """
    if not given:
        raise InputError(
            "give the cameras as NAME=IMAGES_OR_VIDEO, such as north=board/north/*.jpg"
        )
    files: dict[str, list[Path]] = {}
    for text in given:
        name, sign, place = text.partition("=")
        if not sign or not name or not place:
            raise InputError(
                f"expected NAME=IMAGES_OR_VIDEO, such as north=board/north, got {text!r}"
            )
        files.setdefault(name, []).extend(_files(name, place))
    return tuple(_source(name, found) for name, found in files.items())


def read_grey(path: Path) -> Grey:
    """Return an image as grey values, upright if the file says how.

    Raises
    ------
    InputError
        It cannot be read.
    """
    cv2 = needed("reading images needs OpenCV", "calibrate", "cv2")
    try:
        data = np.fromfile(path, dtype=np.uint8)
    except OSError as error:
        raise InputError(f"cannot read image {path}: {error.strerror}") from None
    grey = cv2.imdecode(data, cv2.IMREAD_GRAYSCALE) if len(data) else None
    if grey is None:
        raise InputError(f"cannot read image {path}: it is no image, or damaged")
    return np.asarray(grey)


def _files(name: str, place: str) -> list[Path]:
    path = Path(place)
    if path.is_dir():
        found = sorted(p for p in path.iterdir() if p.suffix.lower() in IMAGE_SUFFIXES)
        if not found:
            raise InputError(
                f"camera {name!r}: the directory {path} has no images ({', '.join(IMAGE_SUFFIXES)})"
            )
        return _by_number(found)
    if path.exists():
        return [path]
    found = [Path(p) for p in glob.glob(place)]
    if not found:
        raise InputError(f"camera {name!r}: there is no file, directory or pattern {place}")
    return _by_number(found)


def _by_number(files: list[Path]) -> list[Path]:
    """Return files in the order of the numbers in their names, as people count."""
    return sorted(files, key=lambda p: [
        (0, int(part), "") if part.isdigit() else (1, 0, part)
        for part in re.split(r"(\d+)", p.name)
    ])  # fmt: skip


def _source(name: str, files: list[Path]) -> BoardSource:
    videos = [file for file in files if file.suffix.lower() in VIDEO_SUFFIXES]
    if videos and len(files) > 1:
        raise InputError(
            f"camera {name!r}: give images or one video, not {len(videos)} of videos among "
            f"{len(files)} files"
        )
    return BoardSource(name, tuple(files), probe(videos[0]) if videos else None)


def _keys(files: Sequence[Path]) -> list[int]:
    """Return the one number that differs between the names of the files, else their places."""
    numbers = [[int(n) for n in re.findall(r"\d+", file.stem)] for file in files]
    lengths = {len(found) for found in numbers}
    if len(lengths) == 1 and lengths != {0}:
        columns = np.array(numbers, dtype=object).T.tolist()
        unique = [column for column in columns if len(set(column)) == len(files)]
        if unique:
            return [int(n) for n in unique[-1]]
    return list(range(len(files)))


def _video_images(source: BoardSource, step: int) -> Iterator[BoardImage]:
    cv2: Any = needed("reading boards needs OpenCV", "calibrate", "cv2")
    for frame in VideoFile(source.files[0], source.camera):
        if frame.index % step == 0:
            grey = cv2.cvtColor(frame.image, cv2.COLOR_RGB2GRAY)
            yield BoardImage(f"{frame.t_s:.2f} s", frame.index, frame.t_s, np.asarray(grey))
