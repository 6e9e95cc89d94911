"""Images as JPEG, with PyAV (import it only when needed)."""

from fractions import Fraction

import av
import numpy as np
from jaxtyping import UInt8

from trecsim.sources.image_sizes import fitted

_QUALITY = 5  # of FFmpeg's 2 (best) to 31


def jpeg_of(image: UInt8[np.ndarray, "h w 3"], limit_px: tuple[int, int]) -> bytes:
    """Return an image as JPEG.

    Parameters
    ----------
    image
        Pixels, RGB.
    limit_px
        Width and height that it must fit into; it is made smaller where it does not.
    """
    height, width = image.shape[:2]
    width_px, height_px = (max(2, size // 2 * 2) for size in fitted((width, height), limit_px))
    picture = av.VideoFrame.from_ndarray(np.ascontiguousarray(image), "rgb24")
    encoder = av.CodecContext.create("mjpeg", "w")
    encoder.width, encoder.height = width_px, height_px
    encoder.pix_fmt = "yuvj420p"
    encoder.time_base = Fraction(1, 1)
    encoder.qmin = encoder.qmax = _QUALITY
    small = picture.reformat(width_px, height_px, "yuvj420p")
    packets = [*encoder.encode(small), *encoder.encode(None)]
    return b"".join(map(bytes, packets))
