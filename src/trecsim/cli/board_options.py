"""Options of commands for the calibration board."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from trecsim.calibrating.boards import Board


@dataclass(frozen=True, slots=True, kw_only=True)
class BoardOptions:
    """The calibration board.

    Parameters
    ----------
    board
        Inner corners of the board, COLSxROWS: a board of 5 x 8 squares has 4x7.
    square_m
        Side of a square [m], measured on the print.
    charuco
        The board is a ChArUco board with markers of this dictionary, such as 5x5_250 (default: a
        checkerboard).
    marker_share
        Side of a marker of a ChArUco board, as a share of the side of a square.
    """

    board: str
    square_m: float
    charuco: str | None = None
    marker_share: float = 0.75

    def read(self) -> "Board":
        """Return the board."""
        from trecsim.calibrating.boards import Board, board_size

        columns, rows = board_size(self.board)
        return Board(columns, rows, self.square_m, self.charuco, self.marker_share)
