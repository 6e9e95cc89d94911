"""Calibration boards: checkerboards, and ChArUco boards whose corners have names."""

import re
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.errors import ConfigError

DICTIONARIES = ("4x4", "5x5", "6x6", "7x7")
MARKERS = (50, 100, 250, 1000)
MARKER_SHARE = 0.75  # of the side of a square
LEAST_CORNERS, MOST_CORNERS = 3, 40  # along a side
LONGEST_SQUARE_M = 2.0


@lru_cache(maxsize=16)
def _points_m(columns: int, rows: int, square_m: float) -> Float64[np.ndarray, "corner 3"]:
    x, y = np.meshgrid(np.arange(columns), np.arange(rows))
    flat = np.stack((x, y, np.zeros_like(x)), axis=-1).reshape(-1, 3)
    points_m: Float64[np.ndarray, "corner 3"] = square_m * flat.astype(np.float64)
    points_m.setflags(write=False)
    return points_m


@dataclass(frozen=True, slots=True)
class Board:
    """A calibration board.

    Attributes
    ----------
    columns, rows
        Inner corners along the two sides: a board of 5 x 8 squares has 4 x 7.
    square_m
        Side of a square [m].
    charuco
        Name of the dictionary of its markers, such as ``"5x5_250"``; None for a checkerboard.
    marker_share
        Side of a marker, as a share of the side of a square.
    first_marker
        Number of its first marker; each board of several has markers of its own.
    """

    columns: int
    rows: int
    square_m: float
    charuco: str | None = None
    marker_share: float = MARKER_SHARE
    first_marker: int = 0

    def __post_init__(self) -> None:
        if not all(LEAST_CORNERS <= n <= MOST_CORNERS for n in (self.columns, self.rows)):
            raise ConfigError(
                f"the board must have {LEAST_CORNERS} to {MOST_CORNERS} inner corners along each "
                f"side, got {self.columns}x{self.rows}; count the points where four squares meet"
            )
        if not 0 < self.square_m <= LONGEST_SQUARE_M:
            raise ConfigError(
                f"the side of a square must be in metres, up to {LONGEST_SQUARE_M:g}, got "
                f"{self.square_m:g}; 30 mm are --square-m 0.03"
            )
        if not 0.3 <= self.marker_share < 1:
            raise ConfigError(
                f"the markers' side must be 0.3 to 1 of that of a square, got {self.marker_share:g}"
            )
        if self.charuco is not None:
            dictionary_name(self.charuco)

    @property
    def squares(self) -> tuple[int, int]:
        """Squares along the two sides."""
        return self.columns + 1, self.rows + 1

    @property
    def marker_count(self) -> int:
        """Markers on it: one in each white square."""
        across, down = self.squares
        return (across * down) // 2 if self.charuco else 0

    @property
    def has_a_top(self) -> bool:
        """Whether half a turn changes the picture: ChArUco, or corners odd in one direction."""
        return self.charuco is not None or (self.columns + self.rows) % 2 == 1

    @property
    def points_m(self) -> Float64[np.ndarray, "corner 3"]:
        """Where its corners lie, row by row, on the board: z = 0, from the first corner [m]."""
        return _points_m(self.columns, self.rows, self.square_m)

    @property
    def symmetries(self) -> list[Int64[np.ndarray, " corner"]]:
        """Which corner each corner becomes, for every turn after which the board looks the same.

        The first is no turn at all. A checkerboard with a top, and a ChArUco board, have no other.
        """
        numbers = np.arange(self.columns * self.rows).reshape(self.rows, self.columns)
        if self.has_a_top:
            return [numbers.ravel()]
        quarters = (0, 1, 2, 3) if self.columns == self.rows and self.rows % 2 == 0 else (0, 2)
        return [np.rot90(numbers, quarter).ravel() for quarter in quarters]

    def on_side(self, number: int) -> "Board":
        """Return the board with this number, of several alike with markers that follow on."""
        first = self.first_marker + number * self.marker_count
        return Board(self.columns, self.rows, self.square_m, self.charuco, self.marker_share, first)

    def __str__(self) -> str:
        kind = f"ChArUco board ({self.charuco})" if self.charuco else "checkerboard"
        square_mm = 1e3 * self.square_m
        return f"{kind} of {self.columns}x{self.rows} inner corners, {square_mm:g} mm squares"


def board_size(text: str) -> tuple[int, int]:
    """Return the inner corners of ``COLSxROWS``.

    Raises
    ------
    ConfigError
        The text is something else.

    Examples
    --------
    >>> board_size("9x6")
    (9, 6)
    """
    found = re.fullmatch(r"\s*(\d{1,3})\s*[xX×]\s*(\d{1,3})\s*", text)
    if found is None:
        raise ConfigError(
            f"the board must be COLSxROWS inner corners, as 9x6, got {text!r}; count the points "
            "where four squares meet, not the squares"
        )
    return int(found[1]), int(found[2])


def dictionary_name(text: str) -> str:
    """Return OpenCV's name of a dictionary of markers, such as ``5x5_250``.

    Raises
    ------
    ConfigError
        There is no such dictionary.

    Examples
    --------
    >>> dictionary_name("5x5_250")
    'DICT_5X5_250'
    """
    bits, _, count = text.lower().removeprefix("dict_").partition("_")
    if bits not in DICTIONARIES or count not in map(str, MARKERS):
        known = f"{'|'.join(DICTIONARIES)}_{'|'.join(map(str, MARKERS))}"
        raise ConfigError(f"there is no dictionary of markers called {text!r}; known: {known}")
    return f"DICT_{bits.upper()}_{count}"


def opencv_board(board: Board, cv2: Any) -> Any:
    """Return OpenCV's description of a ChArUco board.

    Raises
    ------
    ConfigError
        The dictionary has fewer markers than the board needs.
    """
    dictionary = cv2.aruco.getPredefinedDictionary(
        getattr(cv2.aruco, dictionary_name(board.charuco or "5x5_250"))
    )
    last = board.first_marker + board.marker_count
    available = len(dictionary.bytesList)
    if last > available:
        raise ConfigError(
            f"the board needs markers up to number {last - 1}, but {board.charuco} has "
            f"{available}; take a larger dictionary, such as 5x5_1000"
        )
    return cv2.aruco.CharucoBoard(
        board.squares,
        board.square_m,
        board.marker_share * board.square_m,
        dictionary,
        np.arange(board.first_marker, last),
    )
