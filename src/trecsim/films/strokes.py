"""Lines, discs and text on images of pixels, with OpenCV; coordinates may be fractions."""

import math
from collections.abc import Sequence
from functools import cache
from types import ModuleType
from typing import Any

import numpy as np
from jaxtyping import Float64, Int32, UInt8

from trecsim.extras import needed

Image = UInt8[np.ndarray, "h w 3"]
Colour = tuple[int, int, int]
_BITS = 4  # of the fraction of a coordinate
_ONE = 1 << _BITS
_FAR = 30_000.0  # coordinates beyond are cut: OpenCV counts in 16 bits

INK, FAINT, EDGE = (20, 24, 27), (91, 101, 110), (124, 135, 144)
PAPER, FLOOR, GRID = (247, 248, 249), (235, 238, 240), (211, 216, 220)
WHITE = (255, 255, 255)
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


def fixed(points: Float64[np.ndarray, "*point 2"]) -> Int32[np.ndarray, "*point 2"]:
    """Return coordinates in sixteenths of a pixel, as OpenCV takes them; none may be NaN."""
    cut = np.minimum(np.maximum(points, -_FAR), _FAR)
    return np.asarray(np.rint(cut * _ONE), np.int32)


class Pen:
    """Draws on one image, which may be a part of a larger one."""

    def __init__(self, image: Image) -> None:
        self.image = image
        self._cv = opencv()
        self._face = _face(self._cv)

    def line(self, points: Float64[np.ndarray, "point 2"], colour: Colour, width: float) -> None:
        """Draw a line through points; a point that is NaN interrupts it."""
        known = np.isfinite(points).all(axis=1)
        if known.all():
            self.strokes([fixed(points)] if len(points) > 1 else [], colour, width)
            return
        parts = np.split(np.arange(len(points)), np.flatnonzero(~known))
        kept = [part[known[part]] for part in parts]
        self.strokes([fixed(points[part]) for part in kept if len(part) > 1], colour, width)

    def strokes(
        self, strokes: Sequence[Int32[np.ndarray, "point 2"]], colour: Colour, width: float
    ) -> None:
        """Draw lines through points of :func:`fixed`, all at once."""
        if len(strokes):
            self._cv.polylines(
                self.image, strokes, False, colour, max(1, round(width)), self._cv.LINE_AA, _BITS
            )

    def area(
        self, points: Float64[np.ndarray, "point 2"], colour: Colour, share: float = 1.0
    ) -> None:
        """Fill a polygon; `share` of the colour covers what is there."""
        if np.isfinite(points).all():
            self.fill(fixed(points), colour, share)

    def fill(
        self, points: Int32[np.ndarray, "point 2"], colour: Colour, share: float = 1.0
    ) -> None:
        """Fill a polygon of :func:`fixed`; `share` of the colour covers what is there."""
        if share >= 1.0:
            self._cv.fillPoly(self.image, [points], colour, self._cv.LINE_AA, _BITS)
            return
        left, top, width, height = self._cv.boundingRect(points)
        rows, columns = self.image.shape[:2]
        right, bottom = (left + width) // _ONE + 2, (top + height) // _ONE + 2
        left, top = max(left // _ONE, 0), max(top // _ONE, 0)
        under = self.image[top : min(bottom, rows), left : min(right, columns)]
        if under.size == 0 or right <= 0 or bottom <= 0:
            return
        over = under.copy()
        moved = points - np.array([left * _ONE, top * _ONE], np.int32)
        self._cv.fillPoly(over, [moved], colour, self._cv.LINE_AA, _BITS)
        self._cv.addWeighted(over, share, under, 1.0 - share, 0.0, under)

    def disc(self, at: Sequence[float], radius: float, colour: Colour) -> None:
        """Fill a circle."""
        self._circle(at, radius, colour, -1)

    def ring(self, at: Sequence[float], radius: float, colour: Colour, width: int) -> None:
        """Draw a circle."""
        self._circle(at, radius, colour, width)

    def _circle(self, at: Sequence[float], radius: float, colour: Colour, width: int) -> None:
        x, y = float(at[0]), float(at[1])
        if abs(x) < _FAR and abs(y) < _FAR:  # false for NaN
            place = (round(x * _ONE), round(y * _ONE))
            size = round(radius * _ONE)
            self._cv.circle(self.image, place, size, colour, width, self._cv.LINE_AA, _BITS)

    def text(
        self, text: str, at: Sequence[float], size: float, colour: Colour, anchor: str = "left"
    ) -> None:
        """Write text with its base line at a point; `anchor` is left, middle or right."""
        x, y = float(at[0]), float(at[1])
        if not (math.isfinite(x) and math.isfinite(y)):
            return
        shift = {"left": 0.0, "middle": 0.5, "right": 1.0}[anchor]
        where = (round(x - shift * self.width_of(text, size)), round(y))
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

    def label(self, text: str, at: Sequence[float], size: float, colour: Colour) -> None:
        """Write text in white on a piece of colour, with its middle at a point."""
        x, y = float(at[0]), float(at[1])
        if not (abs(x) < _FAR and abs(y) < _FAR):
            return
        wide, high = max(self.width_of(text, size) / 2 + 0.35 * size, 0.6 * size), 0.65 * size
        low, far = (round(x - wide), round(y - high)), (round(x + wide), round(y + high))
        self._cv.rectangle(self.image, low, far, colour, -1)
        self.text(text, (x, y + 0.36 * size), size, WHITE, "middle")


def fit_into(image: Image, into: Image) -> None:
    """Copy an image into another one, in its size."""
    height, width = into.shape[:2]
    if image.shape != into.shape:
        cv = opencv()
        image = cv.resize(image, (width, height), interpolation=cv.INTER_AREA)
    into[...] = image


@cache
def _face(cv: Any) -> Any:
    return cv.FontFace("sans") if hasattr(cv, "FontFace") else None  # from OpenCV 5 on
