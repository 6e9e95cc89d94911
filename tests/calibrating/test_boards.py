import json

import cv2
import numpy as np
import pytest

from trecsim.calibrating.board_drawing import rectangles_mm, sheet_for, write_board
from trecsim.calibrating.boards import Board, board_size, opencv_board
from trecsim.cli import main
from trecsim.errors import ConfigError

PIXELS_PER_MM = 4
CHECKERBOARD = Board(9, 6, 0.02)
CHARUCO = Board(5, 7, 0.028, "5x5_250")


def drawn(board, margin_mm=20.0):
    """Return the picture of the printed board."""
    across, down = (1e3 * board.square_m * n for n in board.squares)
    width, height = (round(PIXELS_PER_MM * (side + 2 * margin_mm)) for side in (across, down))
    image = np.full((height, width), 255, np.uint8)
    for x, y, w, h in rectangles_mm(board):
        edges = [round(PIXELS_PER_MM * (v + margin_mm)) for v in (x, x + w, y, y + h)]
        image[edges[2] : edges[3], edges[0] : edges[1]] = 0
    return image


def test_the_printed_checkerboard_has_the_corners_that_were_asked_for():
    found, corners = cv2.findChessboardCorners(drawn(CHECKERBOARD), (9, 6))
    assert found
    apart_px = np.linalg.norm(np.diff(corners.reshape(6, 9, 2), axis=1), axis=2)
    np.testing.assert_allclose(apart_px, 20.0 * PIXELS_PER_MM, atol=0.6)


@pytest.mark.parametrize("number", [0, 1])
def test_the_printed_charuco_board_is_read_as_the_one_that_was_asked_for(number):
    board = CHARUCO.on_side(number)
    detector = cv2.aruco.CharucoDetector(opencv_board(board, cv2))
    corners, ids, _, markers = detector.detectBoard(drawn(board))
    assert ids.ravel().tolist() == list(range(35))
    assert sorted(markers.ravel()) == list(range(24 * number, 24 * number + 24))
    apart_px = np.linalg.norm(np.diff(corners.reshape(7, 5, 2), axis=1), axis=2)
    np.testing.assert_allclose(apart_px, 28.0 * PIXELS_PER_MM, atol=0.6)
    expected = PIXELS_PER_MM * (1e3 * board.points_m[:, :2] + 28.0 + 20.0) - 0.5
    np.testing.assert_allclose(corners.reshape(-1, 2), expected, atol=0.6)


def test_a_pdf_has_the_size_of_the_paper_and_a_page_for_each_board(tmp_path):
    write_board(CHARUCO, tmp_path / "board.pdf", "a3", count=2)
    text = (tmp_path / "board.pdf").read_bytes()
    points = [round(mm / 25.4 * 72, 2) for mm in (297.0, 420.0)]
    assert text.count(b"/Type /Page ") == 2
    sizes = text.split(b"/MediaBox [ 0 0 ")[1].split(b" ]")[0].split()
    np.testing.assert_allclose([float(size) for size in sizes], points, atol=0.1)


def test_a_board_that_does_not_fit_is_told_with_the_largest_square_that_does():
    with pytest.raises(ConfigError, match=r"does not fit on A4.*--square-m 0\.025.*larger paper"):
        sheet_for(Board(9, 6, 0.05), "a4")


@pytest.mark.parametrize("text", ["9", "9x", "x6", "9,6", "9x6x2", "-9x6"])
def test_what_is_no_size_of_a_board_is_told(text):
    with pytest.raises(ConfigError, match="COLSxROWS inner corners"):
        board_size(text)


@pytest.mark.parametrize(
    ("values", "says"),
    [
        ((1, 6, 0.03), "3 to 40 inner corners"),
        ((9, 6, 30.0), "30 mm are --square-m 0.03"),
        ((9, 6, 0.03, "9x9_10"), "no dictionary of markers called '9x9_10'"),
        ((9, 6, 0.03, "5x5_50", 1.5), "0.3 to 1"),
    ],
)
def test_boards_that_cannot_be_are_told(values, says):
    with pytest.raises(ConfigError, match=says):
        Board(*values)


def test_a_dictionary_with_too_few_markers_is_told():
    with pytest.raises(ConfigError, match="markers up to number 69, but 5x5_50 has 50"):
        opencv_board(Board(9, 6, 0.03, "5x5_50").on_side(1), cv2)


def test_half_a_turn_changes_the_picture_of_a_board_with_a_top_only():
    assert Board(4, 7, 0.06).has_a_top
    assert not Board(9, 7, 0.06).has_a_top
    for board in (Board(4, 7, 0.02), Board(9, 7, 0.02)):
        image = drawn(board)
        assert (not np.array_equal(image, image[::-1, ::-1])) == board.has_a_top


def test_the_command_takes_the_largest_square_that_fits(tmp_path, capsys):
    with pytest.raises(SystemExit, match="0"):
        main(["calibrate", "board", "--pdf", str(tmp_path / "b.pdf"), "--board", "5x8", "--json"])
    summary = json.loads(capsys.readouterr().out)
    assert summary["square_m"] == 0.029
    assert (tmp_path / "b.pdf").read_bytes().startswith(b"%PDF")
