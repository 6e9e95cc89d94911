"""Looks at an image: coarse or fine, upright or turned, for estimators that can choose."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float64, UInt8

from trecsim.estimators import Estimator2D
from trecsim.estimators.decode import Detections
from trecsim.values import Frame, Poses2D


@dataclass(frozen=True, slots=True)
class Look:
    """One look at an image.

    Attributes
    ----------
    long_side
        Longer side of the image as the network sees it [px].
    turns
        By how many quarter turns counter-clockwise the image is turned first, 0 to 3: networks
        that learnt from people who stand find people who lie when the image lies, too.

    Examples
    --------
    >>> image = np.zeros((2, 3, 3), np.uint8)
    >>> Look(256, turns=1).turned(image).shape
    (3, 2, 3)
    """

    long_side: int
    turns: int = 0

    def turned(self, image: UInt8[np.ndarray, "h w 3"]) -> UInt8[np.ndarray, "H W 3"]:
        """Return `image` as this look turns it."""
        return np.ascontiguousarray(np.rot90(image, self.turns)) if self.turns else image

    def turned_back(self, found: Detections, size_px: tuple[int, int]) -> Detections:
        """Return people found in the turned image where they are in the image.

        Parameters
        ----------
        found
            In pixels of the turned image.
        size_px
            Width and height of the image [px].
        """
        xy_px, corners = found.xy_px, found.box_px.reshape(-1, 2, 2)
        for turn in range(self.turns, 0, -1):
            width = size_px[0] if turn % 2 else size_px[1]  # of the image before this turn
            xy_px, corners = _turned_back(xy_px, width), _turned_back(corners, width)
        box_px = np.concatenate([corners.min(axis=1), corners.max(axis=1)], axis=1)
        return replace(found, xy_px=xy_px, box_px=box_px)


def _turned_back(
    xy_px: Float64[np.ndarray, "*batch 2"], width: int
) -> Float64[np.ndarray, "*batch 2"]:
    """Undo one counter-clockwise quarter turn of an image that was `width` wide before it."""
    return np.stack([width - 1 - xy_px[..., 1], xy_px[..., 0]], axis=-1)


@runtime_checkable
class Looker(Estimator2D, Protocol):
    """An estimator that can look at an image in several ways.

    Attributes
    ----------
    usual
        The looks that it takes when it is called with an image; the first finds most people.
    """

    usual: tuple[Look, ...]

    def look(self, frame: Frame, looks: Sequence[Look]) -> Poses2D:
        """Find the people in `frame`'s image, each of them once, the earlier looks first."""
        ...
