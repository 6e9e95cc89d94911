"""Where the parts of a film are: cameras on top, 3D view and plan below."""

import math
from dataclasses import dataclass

_BAR = 30  # height of the line with time and events [px]
_WORTH_A_ROW = 1.5  # rows of tiles take room from the views below
_UPPER_SHARE = 0.7  # of the 3D view above the plan
_TILES_SHARE = 0.55  # of the height, at most


@dataclass(frozen=True, slots=True)
class Box:
    """A part of the image [px]."""

    left: int
    top: int
    width: int
    height: int

    @property
    def slices(self) -> tuple[slice, slice]:
        """Rows and columns."""
        return (
            slice(self.top, self.top + self.height),
            slice(self.left, self.left + self.width),
        )


@dataclass(frozen=True, slots=True)
class Layout:
    """The parts of a film: one box per camera, the 3D view, the plan, and a line of text."""

    tiles: tuple[Box, ...]
    scene: Box
    plan: Box
    bar: Box


def layout(width: int, height: int, aspects: list[float], *, stacked: bool = False) -> Layout:
    """Divide an image.

    Parameters
    ----------
    width, height
        Size of the image [px].
    aspects
        Width by height of each camera's images.
    stacked
        Whether the plan is below the 3D view instead of beside it.

    Examples
    --------
    >>> parts = layout(1280, 720, [16 / 9] * 4)
    >>> parts.tiles[1], parts.scene
    (Box(left=320, top=0, width=320, height=180), Box(left=0, top=180, width=832, height=510))
    """
    tiles, top = _tiles(width, height, aspects)
    bottom = height - _BAR
    if stacked:
        split = top + round(_UPPER_SHARE * (bottom - top))
        upper, lower = Box(0, top, width, split - top), Box(0, split, width, bottom - split)
        return Layout(tiles, upper, lower, Box(0, bottom, width, _BAR))
    split = round(0.65 * width)
    return Layout(
        tiles,
        Box(0, top, split, bottom - top),
        Box(split, top, width - split, bottom - top),
        Box(0, bottom, width, _BAR),
    )


def _tiles(width: int, height: int, aspects: list[float]) -> tuple[tuple[Box, ...], int]:
    """Return the tiles, in several rows only where that makes them much larger, and their end."""
    best: tuple[Box, ...] = ()
    for rows in range(1, len(aspects) + 1):
        columns = math.ceil(len(aspects) / rows)
        wide = width / columns
        high = min(wide / min(aspects), _TILES_SHARE * height / rows)
        boxes = []
        for number, aspect in enumerate(aspects):
            row, column = divmod(number, columns)
            size = (min(wide, high * aspect), min(high, wide / aspect))
            left = column * wide + (wide - size[0]) / 2
            boxes.append(Box(round(left), round(row * high), int(size[0]), int(size[1])))
        if not best or _area(boxes) > _WORTH_A_ROW * _area(best):
            best = tuple(boxes)
    return best, max((box.top + box.height for box in best), default=0)


def _area(boxes: "list[Box] | tuple[Box, ...]") -> int:
    return sum(box.width * box.height for box in boxes)
