"""Fitting an image into the input of a network, and key points back into the image.

Pixel centres are at integers on both sides, so an image of width w covers -0.5 to w - 0.5.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Float64, UInt8

from trecsim.errors import SetupError
from trecsim.extras import install_command

Size = tuple[int, int]


@dataclass(frozen=True, slots=True)
class Letterbox:
    """Where the scaled image lies in the input of a network.

    Attributes
    ----------
    image_px
        (width, height) of the image.
    scaled_px
        (width, height) it is scaled to.
    input_px
        (width, height) of the input; what the image does not cover is padding.
    offset_px
        Left and top padding.

    Examples
    --------
    >>> box = Letterbox.within((1920, 1080), (640, 640))
    >>> box.scaled_px, box.offset_px
    ((640, 360), (0, 140))
    >>> box.to_image(np.array([[-0.5, 139.5], [639.5, 499.5]])).round(9).tolist()
    [[-0.5, -0.5], [1919.5, 1079.5]]
    """

    image_px: Size
    scaled_px: Size
    input_px: Size
    offset_px: Size = (0, 0)

    @classmethod
    def along(cls, image_px: Size, long_side: int, multiple: int) -> "Letterbox":
        """Scale the longer side to `long_side` and pad to the right and below.

        Parameters
        ----------
        image_px
            (width, height) of the image.
        long_side
            Of the scaled image [px].
        multiple
            Width and height of the input are the next multiples of this.
        """
        scaled_px = scaled_size(image_px, long_side)
        width, height = (-(-side // multiple) * multiple for side in scaled_px)
        return cls(image_px, scaled_px, (width, height))

    @classmethod
    def within(cls, image_px: Size, input_px: Size, *, centred: bool = True) -> "Letterbox":
        """Scale the image as large as `input_px` holds; pad around it, or right and below."""
        ratio = min(input_px[0] / image_px[0], input_px[1] / image_px[1])
        width, height = (max(1, round(side * ratio)) for side in image_px)
        spare = (input_px[0] - width, input_px[1] - height)
        offset_px = (spare[0] // 2, spare[1] // 2) if centred else (0, 0)
        return cls(image_px, (width, height), input_px, offset_px)

    def apply(self, image: UInt8[np.ndarray, "h w 3"], fill: int) -> UInt8[np.ndarray, "H W 3"]:
        """Scale `image` and pad it with grey of the value `fill`."""
        scaled = scale(image, self.scaled_px)
        if self.scaled_px == self.input_px:
            return scaled
        left, top = self.offset_px
        padded = np.full((self.input_px[1], self.input_px[0], 3), fill, np.uint8)
        padded[top : top + scaled.shape[0], left : left + scaled.shape[1]] = scaled
        return padded

    def to_image(self, xy_px: Float[np.ndarray, "*batch 2"]) -> Float64[np.ndarray, "*batch 2"]:
        """Turn pixels of the input into pixels of the image."""
        ratio = np.divide(self.image_px, self.scaled_px)
        xy: Float64[np.ndarray, "*batch 2"] = (
            np.asarray(xy_px, np.float64) - self.offset_px + 0.5
        ) * ratio - 0.5
        return xy

    def to_input(self, xy_px: Float[np.ndarray, "*batch 2"]) -> Float64[np.ndarray, "*batch 2"]:
        """Turn pixels of the image into pixels of the input."""
        ratio = np.divide(self.scaled_px, self.image_px)
        xy: Float64[np.ndarray, "*batch 2"] = (
            (np.asarray(xy_px, np.float64) + 0.5) * ratio - 0.5 + self.offset_px
        )
        return xy


def scaled_size(image_px: Size, long_side: int) -> Size:
    """Return the (width, height) with the longer side `long_side` and the same aspect."""
    ratio = long_side / max(image_px)
    return max(1, round(image_px[0] * ratio)), max(1, round(image_px[1] * ratio))


def scale(image: UInt8[np.ndarray, "h w 3"], size_px: Size) -> UInt8[np.ndarray, "H W 3"]:
    """Return `image` at the (width, height) `size_px`.

    Notes
    -----
    It averages over areas, so nothing aliases, just as video is scaled while it is decoded; the
    key points are the same either way.

    Raises
    ------
    SetupError
        When PyAV is not installed.
    """
    height, width, _ = image.shape
    if size_px == (width, height):
        return image
    try:
        import av
    except ImportError as error:
        raise SetupError(
            f"scaling images needs PyAV ({error}): {install_command('video')}"
        ) from error
    frame = av.VideoFrame.from_ndarray(np.ascontiguousarray(image), format="rgb24")
    kind = "AREA" if size_px[0] <= width and size_px[1] <= height else "BILINEAR"
    scaled = frame.reformat(width=size_px[0], height=size_px[1], interpolation=kind)
    array: UInt8[np.ndarray, "H W 3"] = scaled.to_ndarray()
    return array
