"""A camera that shows the same image again and again."""

import math
from zlib import crc32

import numpy as np
from jaxtyping import UInt8

FROZEN_S = 10.0  # coders repeat the image of a still scene up to the next key frame, not longer


class FrozenImage:
    """Tells since when a camera has shown the same image."""

    def __init__(self) -> None:
        self._shown = 0
        self._since_s = math.nan

    def is_frozen(self, pixels: UInt8[np.ndarray, "h w"], now_s: float) -> bool:
        """Take in an image; tell whether it has been the same for `FROZEN_S`.

        Parameters
        ----------
        pixels
            Some of its pixels.
        now_s
            When, by a steady clock [s].
        """
        shown = crc32(pixels.tobytes())
        if shown != self._shown or math.isnan(self._since_s):
            self._shown, self._since_s = shown, now_s
        return now_s - self._since_s >= FROZEN_S
