"""Adds images without people to results that have entries for detections only."""

import math
from collections import deque
from collections.abc import Iterator, Mapping

import numpy as np

from trecsim.skeleton import COCO17
from trecsim.values import Poses2D

LOOK_AHEAD = 32  # images, from which the step of a camera's frame numbers is learnt


def with_empty_images(cameras: Mapping[str, Iterator[Poses2D]], fps: float) -> Iterator[Poses2D]:
    """Merge the images of cameras by time; add the images without a detection.

    COCO results cover every image of a video but have no entry for an image without people. So if
    one camera has an entry for a frame, every other camera whose results continue after that frame
    has an image of it too, without people. Nothing is added before the first or after the last
    entry of a camera, nor between its frames if it uses only every n-th frame.

    Parameters
    ----------
    cameras
        The images of each camera, in the order of time.
    fps
        Frames per second: times are whole numbers of frames.
    """
    heads = [_Head(camera, images, fps) for camera, images in cameras.items()]
    while waiting := [head for head in heads if head.ahead]:
        frame = min(head.frame for head in waiting)
        t_s = next(head.ahead[0].t_s for head in waiting if head.frame == frame)
        for head in waiting:
            if head.frame == frame:
                yield head.pop()
            elif head.covers(frame):
                yield _empty(head.camera, t_s)


class _Head:
    """The next images of one camera, and what its frame numbers were so far."""

    def __init__(self, camera: str, images: Iterator[Poses2D], fps: float) -> None:
        self.camera = camera
        self.ahead: deque[Poses2D] = deque()
        self._images = images
        self._fps = fps
        self._step = 0
        self._newest: int | None = None
        self._last: int | None = None
        for _ in range(LOOK_AHEAD):
            self._read()

    @property
    def frame(self) -> int:
        """Frame number of the next image."""
        return round(self.ahead[0].t_s * self._fps)

    def covers(self, frame: int) -> bool:
        """Tell whether a frame between two of the camera's images is one that it took."""
        return self._last is not None and (frame - self._last) % max(self._step, 1) == 0

    def pop(self) -> Poses2D:
        """Return the next image."""
        self._last = self.frame
        image = self.ahead.popleft()
        self._read()
        return image

    def _read(self) -> None:
        image = next(self._images, None)
        if image is None:
            return
        self.ahead.append(image)
        number = round(image.t_s * self._fps)
        if self._newest is not None:
            self._step = math.gcd(self._step, number - self._newest)
        self._newest = number


def _empty(camera: str, t_s: float) -> Poses2D:
    joints = len(COCO17.joints)
    return Poses2D(camera, t_s, np.empty((0, joints, 2)), np.empty((0, joints)), np.empty(0))
