"""The command `trecsim calibrate board`: a board to print."""

from pathlib import Path

from trecsim.cli.board_options import BoardOptions
from trecsim.cli.terminal import counted, finish


def board(
    *,
    pdf: Path,
    board: str = "9x6",
    square_m: float | None = None,
    charuco: str | None = None,
    marker_share: float = 0.75,
    paper: str = "a4",
    boards: int = 1,
    json: bool = False,
) -> None:
    """Write a calibration board to print, in true size, as PDF.

    Parameters
    ----------
    pdf
        The file to write.
    board
        Inner corners, COLSxROWS: a board of 10 x 7 squares has 9x6.
    square_m
        Side of a square [m] (default: the largest whole millimetre that fits on the paper).
    charuco
        Make a ChArUco board with markers of this dictionary, such as 5x5_250: it is found when
        partly hidden, and may be one of several or double-sided.
    marker_share
        Side of a marker of a ChArUco board, as a share of the side of a square.
    paper
        a4, a3, a2, a1, a0 or letter.
    boards
        How many boards, one a page. ChArUco boards get markers of their own each, for several
        boards or for the two sides of one.
    json
        Print the summary as one JSON object.
    """
    from trecsim.calibrating.board_drawing import largest_square_m, write_board

    wanted = BoardOptions(
        board=board,
        square_m=square_m or largest_square_m(board, paper),
        charuco=charuco,
        marker_share=marker_share,
    ).read()
    sheet = write_board(wanted, pdf, paper, boards)
    summary = {
        "out": pdf,
        "board": f"{wanted.columns}x{wanted.rows}",
        "square_m": wanted.square_m,
        "charuco": wanted.charuco,
        "marker_share": wanted.marker_share if wanted.charuco else None,
        "paper": sheet.name,
        "boards": boards,
    }
    text = (
        f"{pdf}: {counted(boards, 'board')} on {sheet.name}: {wanted}\n"
        "  print at 100 %, check the ruler, measure ten squares, glue it onto something flat"
    )
    finish(summary, json, text)
