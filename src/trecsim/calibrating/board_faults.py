"""Why no board was found in the images of a camera: one sentence that says what to change."""

from collections import Counter
from collections.abc import Iterable
from typing import Any

import numpy as np

from trecsim.calibrating.board_images import BoardSource, Grey
from trecsim.calibrating.boards import Board, opencv_board
from trecsim.calibrating.corners import BoardFinder
from trecsim.extras import needed

TRIED = 6  # images in which other boards are searched
SEARCHED_PX = 800


def why_no_board(source: BoardSource, board: Board) -> str:
    """Return what to do about images in which the board was not found."""
    start = f"camera {source.camera!r}: the {board} was found in none of {source.about}"
    images = _some_images(source)
    if board.charuco is not None:
        if any(BoardFinder(board).find(np.ascontiguousarray(grey[:, ::-1])) for grey in images):
            return f"{start}, but in their mirror images: turn off mirroring in the camera"
        markers = _markers(images, board)
        if markers:
            return (
                f"{start}; markers of {board.charuco} were seen ({markers}), so --board COLSxROWS "
                "(inner corners), or the order of the squares, is not that of the print"
            )
        return (
            f"{start}; no marker of {board.charuco} was seen either: name the dictionary of the "
            "print, bring the board nearer, or avoid blur and glare"
        )
    other = _other_size(images, board)
    if other is not None:
        return (
            f"{start}, but a board of {other[0]}x{other[1]} inner corners was: give --board "
            f"{other[0]}x{other[1]}"
        )
    return (
        f"{start}; the whole board with a white border must be visible, sharp and without glare "
        "(a ChArUco board may be partly hidden)"
    )


def _some_images(source: BoardSource) -> list[Grey]:
    step = 1
    if source.video is not None:
        step = max((source.video.expected_frames or 100) // TRIED, 1)
    found = []
    for number, image in enumerate(source.images(step)):
        if source.video is not None or number % max(len(source.files) // TRIED, 1) == 0:
            found.append(image.grey)
        if len(found) == TRIED:
            break
    return found


def _markers(images: Iterable[Grey], board: Board) -> int:
    cv2: Any = needed("finding boards needs OpenCV", "calibrate", "cv2")
    detector = cv2.aruco.ArucoDetector(opencv_board(board, cv2).getDictionary())
    most = 0
    for grey in images:
        _, ids, _ = detector.detectMarkers(grey)
        most = max(most, 0 if ids is None else len(ids))
    return most


def _other_size(images: Iterable[Grey], board: Board) -> tuple[int, int] | None:
    """Return the size of the checkerboard that most images show instead."""
    cv2: Any = needed("finding boards needs OpenCV", "calibrate", "cv2")
    flags = cv2.CALIB_CB_LARGER | cv2.CALIB_CB_NORMALIZE_IMAGE
    sizes: Counter[tuple[int, int]] = Counter()
    for grey in images:
        scale = min(1.0, SEARCHED_PX / max(grey.shape))
        small = cv2.resize(grey, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
        found, _, squares = cv2.findChessboardCornersSBWithMeta(small, (3, 3), flags)
        if found:
            rows, columns = sorted(squares.shape)
            sizes[columns, rows] += 1
    sizes.pop((max(board.columns, board.rows), min(board.columns, board.rows)), None)
    return max(sizes, key=lambda size: (sizes[size], size)) if sizes else None
