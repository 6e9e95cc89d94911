"""Images of live cameras that become RGB only when somebody looks at them.

Where an estimator takes every second image, the others cost their decoding and nothing more.
"""

from collections.abc import Callable
from threading import Lock
from typing import Any

from trecsim.sources.image_sizes import fitted
from trecsim.sources.masks import Image, Mask
from trecsim.sources.orientation import Orientation
from trecsim.values import Frame


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
    mask
        Blanks parts of the images; None for none.
    """

    def __init__(self, limit_px: tuple[int, int] | None, mask: Mask | None = None) -> None:
        self._limit_px, self._mask = limit_px, mask
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
            image = self._converters[size_px](picture)
        return image if self._mask is None else self._mask(image)
