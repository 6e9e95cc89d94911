"""A board to print: its squares in their true size, what it is, and a ruler to check the print."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from trecsim.calibrating.boards import Board, board_size, opencv_board
from trecsim.errors import ConfigError
from trecsim.extras import needed
from trecsim.store.atomic import atomic_write

if TYPE_CHECKING:
    from matplotlib.axes import Axes

PAPERS_MM = {
    "a4": (210.0, 297.0),
    "a3": (297.0, 420.0),
    "a2": (420.0, 594.0),
    "a1": (594.0, 841.0),
    "a0": (841.0, 1189.0),
    "letter": (215.9, 279.4),
}
MARGIN_MM = 8.0  # printers leave it white
TEXT_MM = 14.0  # below the board: its name and the ruler
MM_PER_INCH = 25.4
Rectangle = tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class Sheet:
    """A sheet of paper, in the orientation in which the board fits.

    Attributes
    ----------
    name
        Its format.
    width_mm, height_mm
        Its sides [mm].
    """

    name: str
    width_mm: float
    height_mm: float


def sheet_for(board: Board, paper: str) -> Sheet:
    """Return the paper on which the board fits, upright or lying.

    Raises
    ------
    ConfigError
        There is no such paper, or the board does not fit.
    """
    across, down = (1e3 * board.square_m * n for n in board.squares)
    for width, height in _both_ways(paper):
        if across + 2 * MARGIN_MM <= width and down + 2 * MARGIN_MM + TEXT_MM <= height:
            return Sheet(paper.upper(), width, height)
    largest_m = largest_square_m(f"{board.columns}x{board.rows}", paper)
    raise ConfigError(
        f"the board is {across:g} x {down:g} mm and does not fit on {paper.upper()}; the largest "
        f"square there has --square-m {largest_m:g}; or take larger paper: {', '.join(PAPERS_MM)}"
    )


def largest_square_m(size: str, paper: str) -> float:
    """Return the largest side of a square, in whole millimetres, with which a board fits [m].

    Examples
    --------
    >>> largest_square_m("9x6", "a4")
    0.025
    """
    columns, rows = board_size(size)
    sides_mm = [
        min((w - 2 * MARGIN_MM) / (columns + 1), (h - 2 * MARGIN_MM - TEXT_MM) / (rows + 1))
        for w, h in _both_ways(paper)
    ]
    return max(float(np.floor(max(sides_mm))), 1.0) / 1e3


def _both_ways(paper: str) -> tuple[tuple[float, float], tuple[float, float]]:
    if paper.lower() not in PAPERS_MM:
        raise ConfigError(f"there is no paper {paper!r}; known: {', '.join(PAPERS_MM)}")
    short, long = PAPERS_MM[paper.lower()]
    return (short, long), (long, short)


def rectangles_mm(board: Board) -> Iterator[Rectangle]:
    """Yield what is black: left, top, width and height of each rectangle [mm].

    The first inner corner lies between the squares at the upper left. As in OpenCV, the square at
    the upper left is black.
    """
    side = 1e3 * board.square_m
    across, down = board.squares
    for row in range(down):
        for column in range(across):
            if (row + column) % 2 == 0:
                yield side * column, side * row, side, side
    if board.charuco is not None:
        yield from _markers_mm(board)


def _markers_mm(board: Board) -> Iterator[Rectangle]:
    cv2 = needed("ChArUco boards need OpenCV", "calibrate", "cv2")
    drawn = opencv_board(board, cv2)
    dictionary = drawn.getDictionary()
    bits = dictionary.markerSize + 2
    for number, corners in zip(drawn.getIds().ravel(), drawn.getObjPoints(), strict=True):
        left, top = 1e3 * np.min(np.asarray(corners)[:, :2], axis=0)
        cell = 1e3 * board.marker_share * board.square_m / bits
        black = cv2.aruco.generateImageMarker(dictionary, int(number), bits) < 128
        for row, line in enumerate(black):
            for start, end in _runs(line.tolist()):
                yield left + start * cell, top + row * cell, (end - start) * cell, cell


def _runs(line: list[bool]) -> Iterator[tuple[int, int]]:
    start = None
    for place, black in enumerate([*line, False]):
        if black and start is None:
            start = place
        elif not black and start is not None:
            yield start, place
            start = None


def write_board(board: Board, path: Path, paper: str = "a4", count: int = 1) -> Sheet:
    """Write boards to print as a PDF, one a page, in their true size.

    Parameters
    ----------
    board
        The first board.
    path
        The PDF.
    paper
        Format of the paper.
    count
        How many boards; each ChArUco board has markers of its own.

    Raises
    ------
    ConfigError
        The board does not fit on the paper.
    SetupError
        Matplotlib is not installed.
    """
    sheet = sheet_for(board, paper)
    needed("a board to print needs Matplotlib", "calibrate", "matplotlib")
    from matplotlib.backends.backend_pdf import PdfPages
    from matplotlib.figure import Figure

    size = (sheet.width_mm / MM_PER_INCH, sheet.height_mm / MM_PER_INCH)
    with atomic_write(path, "wb") as file, PdfPages(file) as pages:
        for number in range(count):
            page = Figure(figsize=size)
            axes = page.add_axes((0.0, 0.0, 1.0, 1.0))
            axes.set(xlim=(0, sheet.width_mm), ylim=(sheet.height_mm, 0))
            axes.set_axis_off()
            _draw(axes, board.on_side(number), sheet, number, count)
            pages.savefig(page)
    return sheet


def _draw(axes: "Axes", board: Board, sheet: Sheet, number: int, count: int) -> None:
    from matplotlib.collections import PatchCollection
    from matplotlib.patches import Rectangle as Patch

    across, down = (1e3 * board.square_m * n for n in board.squares)
    left = (sheet.width_mm - across) / 2
    top = (sheet.height_mm - TEXT_MM - down) / 2
    patches = [Patch((left + x, top + y), w, h) for x, y, w, h in rectangles_mm(board)]
    axes.add_collection(PatchCollection(patches, facecolor="black", edgecolor="none", linewidth=0))
    base = sheet.height_mm - MARGIN_MM
    _ruler(axes, MARGIN_MM, base)
    which = f", board {number + 1} of {count}" if count > 1 else ""
    options = f"--board {board.columns}x{board.rows} --square-m {board.square_m:g}"
    options += f" --charuco {board.charuco}" if board.charuco else ""
    text = (
        f"trecsim {board}{which}\n{options}\nPrint at 100 %, not 'fit to page'; the ruler must be "
        "100 mm. Measure ten squares and glue the sheet onto something flat and stiff."
    )
    axes.text(MARGIN_MM + 106, base, text, fontsize=5.2, va="bottom", linespacing=1.25)


def _ruler(axes: "Axes", left: float, base: float) -> None:
    axes.plot([left, left + 100], [base, base], color="black", linewidth=0.5)
    for mm in range(0, 101):
        height = 4.0 if mm % 10 == 0 else 2.8 if mm % 5 == 0 else 1.6
        axes.plot([left + mm] * 2, [base, base - height], color="black", linewidth=0.25)
    for mm in range(0, 101, 10):
        label = f"{mm} mm" if mm == 100 else str(mm)
        axes.text(left + mm, base - 4.4, label, fontsize=4.5, ha="center", va="bottom")
