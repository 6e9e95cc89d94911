"""Images of live cameras that become RGB only when somebody looks at them.

Where an estimator takes every second image, the others cost their decoding and nothing more.
"""

from collections.abc import Callable
from threading import Lock
from typing import Any

import numpy as np
from jaxtyping import UInt8

from trecsim.sources.image_sizes import fitted
from trecsim.sources.orientation import Orientation
from trecsim.values import Frame

Image = UInt8[np.ndarray, "h w 3"]


class LiveFrame(Frame):
    """A frame whose image is made when it is first asked for.

    Parameters
    ----------
    camera, index, t_s, size_px
        As of `Frame`.
    make
        Returns the image.
    """

    __slots__ = ("_image", "_make")
    _image: Image | None
    _make: Callable[[], Image] | None

    def __init__(
        self,
        camera: str,
        index: int,
        t_s: float,
        size_px: tuple[int, int] | None,
        make: Callable[[], Image],
    ) -> None:
        for name, value in (
            ("camera", camera), ("index", index), ("t_s", t_s), ("size_px", size_px),
            ("_image", None), ("_make", make),
        ):  # fmt: skip
            object.__setattr__(self, name, value)  # it is frozen

    @property
    def image(self) -> Image:
        """Pixels, RGB."""
        make = self._make
        if make is not None:
            object.__setattr__(self, "_image", make())
            object.__setattr__(self, "_make", None)  # and with it what the decoder made
        assert self._image is not None
        return self._image


class Developer:
    """Turns decoded pictures of one camera into RGB images that fit into a limit.

    Parameters
    ----------
    limit_px
        Width and height; None keeps the size.
    """

    def __init__(self, limit_px: tuple[int, int] | None) -> None:
        self._limit_px = limit_px
        self._lock = Lock()  # FFmpeg's converter does one picture at a time
        self._converters: dict[tuple[int, int], Callable[[Any], Image]] = {}

    def size_px(self, found_px: tuple[int, int]) -> tuple[int, int]:
        """Return the size of the image that is made of a picture."""
        return fitted(found_px, self._limit_px or found_px)

    def __call__(self, picture: Any) -> Image:
        """Return the image."""
        from trecsim.sources.decoding import RgbConverter

        size_px = self.size_px((picture.width, picture.height))
        with self._lock:
            if size_px not in self._converters:
                self._converters = {size_px: RgbConverter(size_px, Orientation())}
            return self._converters[size_px](picture)
