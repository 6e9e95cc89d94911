"""Lines, discs and text on images of pixels, with OpenCV; coordinates may be fractions."""

from collections.abc import Sequence
from functools import cache
from types import ModuleType
from typing import Any

import numpy as np
from jaxtyping import Float64, UInt8

from trecsim.extras import needed

Image = UInt8[np.ndarray, "h w 3"]
Colour = tuple[int, int, int]
_BITS = 4  # of the fraction of a coordinate
_FAR = 30_000.0  # coordinates beyond are cut: OpenCV counts in 16 bits

INK, FAINT, EDGE = (20, 24, 27), (91, 101, 110), (124, 135, 144)
PAPER, FLOOR, GRID = (247, 248, 249), (235, 238, 240), (211, 216, 220)
_WIDTHS: dict[tuple[str, int], float] = {}
_MOST_WIDTHS = 10_000
ALARM, WARNING = (198, 43, 31), (242, 178, 51)


def hex_colour(text: str) -> Colour:
    """Return the colour of a text like ``#0072b2``.

    Examples
    --------
    >>> hex_colour("#0072b2")
    (0, 114, 178)
    """
    red, green, blue = (int(text[at : at + 2], 16) for at in (1, 3, 5))
    return red, green, blue


def opencv() -> ModuleType:
    """Return OpenCV.

    Raises
    ------
    SetupError
        It is not installed.
    """
    return needed("films and pictures need OpenCV", "render", "cv2")


def blank(width: int, height: int, colour: Colour = PAPER) -> Image:
    """Return an image of one colour."""
    return np.full((height, width, 3), colour, np.uint8)


class Pen:
    """Draws on one image."""

    def __init__(self, image: Image) -> None:
        self.image = image
        self._cv = opencv()
        self._face = _face(self._cv)

    def line(self, points: Float64[np.ndarray, "point 2"], colour: Colour, width: float) -> None:
        """Draw a line through points; a point that is NaN interrupts it."""
        known = np.isfinite(points).all(axis=1)
        if known.all() and len(points) > 1:
            self._cv.polylines(
                self.image, [_fixed(points)], False, colour, max(1, round(width)),
                self._cv.LINE_AA, _BITS,
            )  # fmt: skip
            return
        for part in np.split(np.arange(len(points)), np.flatnonzero(~known)):
            which = part[known[part]]
            if len(which) > 1:
                self._cv.polylines(
                    self.image, [_fixed(points[which])], False, colour, max(1, round(width)),
                    self._cv.LINE_AA, _BITS,
                )  # fmt: skip

    def segments(
        self, ends: Float64[np.ndarray, "segment 2 2"], colour: Colour, width: float
    ) -> None:
        """Draw straight lines, all at once; those with an end that is NaN are left out."""
        known = ends[np.isfinite(ends).all(axis=(1, 2))]
        if len(known):
            self._cv.polylines(
                self.image, list(_fixed(known)), False, colour, max(1, round(width)),
                self._cv.LINE_AA, _BITS,
            )  # fmt: skip

    def area(
        self, points: Float64[np.ndarray, "point 2"], colour: Colour, share: float = 1.0
    ) -> None:
        """Fill a polygon; `share` of the colour covers what is there."""
        if not np.isfinite(points).all():
            return
        if share >= 1.0:
            self._cv.fillPoly(self.image, [_fixed(points)], colour, self._cv.LINE_AA, _BITS)
            return
        height, width = self.image.shape[:2]
        left, top = np.clip(np.floor(points.min(axis=0)), 0, [width, height]).astype(int)
        right, bottom = np.clip(np.ceil(points.max(axis=0)) + 1, 0, [width, height]).astype(int)
        if right <= left or bottom <= top:
            return
        under = self.image[top:bottom, left:right]
        over = under.copy()
        moved = points - [left, top]
        self._cv.fillPoly(over, [_fixed(moved)], colour, self._cv.LINE_AA, _BITS)
        self._cv.addWeighted(over, share, under, 1.0 - share, 0.0, under)

    def disc(self, at: Float64[np.ndarray, " 2"], radius: float, colour: Colour) -> None:
        """Fill a circle."""
        if np.isfinite(at).all():
            x, y = _fixed(at[None])[0].tolist()
            self._cv.circle(
                self.image, (x, y), round(radius * (1 << _BITS)), colour, -1,
                self._cv.LINE_AA, _BITS,
            )  # fmt: skip

    def ring(
        self, at: Float64[np.ndarray, " 2"], radius: float, colour: Colour, width: int
    ) -> None:
        """Draw a circle."""
        if np.isfinite(at).all():
            x, y = _fixed(at[None])[0].tolist()
            self._cv.circle(
                self.image, (x, y), round(radius * (1 << _BITS)), colour, width,
                self._cv.LINE_AA, _BITS,
            )  # fmt: skip

    def text(
        self, text: str, at: Sequence[float], size: float, colour: Colour, anchor: str = "left"
    ) -> None:
        """Write text with its base line at a point; `anchor` is left, middle or right."""
        if not np.isfinite(np.asarray(at, float)).all():
            return
        width = self.width_of(text, size)
        shift = {"left": 0.0, "middle": 0.5, "right": 1.0}[anchor] * width
        where = (round(at[0] - shift), round(at[1]))
        if self._face is not None:
            self._cv.putText(self.image, text, where, colour, self._face, round(size), 500)
        else:
            scale = size / 30.0
            font = self._cv.FONT_HERSHEY_SIMPLEX
            self._cv.putText(self.image, text, where, font, scale, colour, 1, self._cv.LINE_AA)

    def width_of(self, text: str, size: float) -> float:
        """Return the width of a text [px]."""
        key = (text, round(size))
        if key not in _WIDTHS:
            if len(_WIDTHS) > _MOST_WIDTHS:
                _WIDTHS.clear()
            _WIDTHS[key] = self._measured(text, size)
        return _WIDTHS[key]

    def _measured(self, text: str, size: float) -> float:
        if self._face is not None:
            box = self._cv.getTextSize((0, 0), text, (0, 0), self._face, round(size), 500)
            return float(box[2])
        (width, _), _ = self._cv.getTextSize(text, self._cv.FONT_HERSHEY_SIMPLEX, size / 30.0, 1)
        return float(width)

    def label(self, text: str, at: Float64[np.ndarray, " 2"], size: float, colour: Colour) -> None:
        """Write text in white on a rounded piece of colour, with its middle at a point."""
        if not np.isfinite(at).all():
            return
        half = np.array([max(self.width_of(text, size) / 2 + 0.35 * size, 0.6 * size), 0.65 * size])
        low, high = at - half, at + half
        box = np.array([low, [high[0], low[1]], high, [low[0], high[1]]])
        self.area(box, colour)
        self.text(text, (at[0], at[1] + 0.36 * size), size, (255, 255, 255), "middle")


def scaled(image: Image, width: int, height: int) -> Image:
    """Return an image in another size."""
    if image.shape[:2] == (height, width):
        return image.copy()
    cv = opencv()
    return np.asarray(cv.resize(image, (width, height), interpolation=cv.INTER_AREA))


@cache
def _face(cv: Any) -> Any:
    return cv.FontFace("sans") if hasattr(cv, "FontFace") else None  # from OpenCV 5 on


def _fixed(points: Float64[np.ndarray, "*point 2"]) -> np.ndarray:
    fixed = np.rint(np.clip(points, -_FAR, _FAR) * (1 << _BITS))
    return np.asarray(fixed, np.int32)
