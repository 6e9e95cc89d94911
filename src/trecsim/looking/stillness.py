"""Whether anything moves before a camera: a cheap test on the brightness of its images."""

from collections.abc import Iterable

import numpy as np
from jaxtyping import Float64, UInt8

from trecsim.sources.video import Picture

STILL_S = 1.0
"""A camera before which nothing moves is looked at so often [s]."""
_EVERY_PX = 2
_BLOCK = 8  # of those, along either side
# Means of 64 pixels differ by less from image to image, unless something moved: noise of 5 grey
# levels a pixel moves them by 0.9, and the most out of 8000 of them by 4.
_MOVED = 6.0

_Shown = tuple[float, Float64[np.ndarray, "H W"]]  # when [s], and what


def blocks(brightness: UInt8[np.ndarray, "h w"]) -> Float64[np.ndarray, "H W"]:
    """Return the mean brightness of blocks of 16 pixels; what is left at the edges counts not.

    Images smaller than that are one block.
    """
    some = brightness[::_EVERY_PX, ::_EVERY_PX]
    rows, columns = (side // _BLOCK for side in some.shape)
    if not (rows and columns):
        return np.full((1, 1), some.mean())
    whole = some[: rows * _BLOCK, : columns * _BLOCK].reshape(rows, _BLOCK, columns, _BLOCK)
    sums = whole.sum(axis=3, dtype=np.uint16).sum(axis=1, dtype=np.uint16)
    mean: Float64[np.ndarray, "H W"] = sums / float(_BLOCK**2)
    return mean


def has_moved(
    now: Float64[np.ndarray, "H W"], before: Float64[np.ndarray, "rows columns"] | None
) -> bool:
    """Return whether anything differs between two images of a camera, given as `blocks`."""
    if before is None or now.shape != before.shape:
        return True
    return bool(np.abs(now - before).max() > _MOVED)


class StillCameras:
    """Before which cameras nothing has moved since they were looked at."""

    def __init__(self) -> None:
        self._now: dict[str, _Shown] = {}
        self._looked: dict[str, _Shown] = {}

    def still_s(self, pictures: Iterable[Picture]) -> dict[str, float]:
        """Return for how long the cameras that are still have not been looked at [s]."""
        self._now = {
            one.camera: (one.t_s, blocks(one.brightness()))
            for one in pictures
            if one.brightness is not None
        }
        out = {}
        for camera, (t_s, shown) in self._now.items():
            before_s, before = self._looked.get(camera, (t_s, None))
            if not has_moved(shown, before):
                out[camera] = t_s - before_s
        return out

    def note(self, cameras: Iterable[str]) -> None:
        """Note which cameras are looked at."""
        self._looked.update({name: self._now[name] for name in cameras if name in self._now})
