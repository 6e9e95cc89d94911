"""Finds the corners of a board in a picture, and tells how sharp they are."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float64, Int64

from trecsim.calibrating.board_images import Grey
from trecsim.calibrating.boards import Board, opencv_board
from trecsim.extras import needed

SEARCHED_PX, SMALL_PX, LARGE_PX = 800, 400, 1280  # longer sides of the pictures searched
SMOOTHED_PX = 1.2
WINDOW_SHARE = 0.35  # of the distance of corners: what is used to refine one
CHARUCO_WINDOW_SHARE = 0.12  # there, markers begin at an eighth, and their edges would pull
LARGEST_WINDOW_PX = 11
REFINED = (3, 60, 1e-3)  # OpenCV's criterion: both, steps, px
LEAST_CHARUCO = 6  # corners of a partly seen board that are worth using
PROFILE = np.linspace(-1.0, 1.0, 17)
PROFILE_SHARE = 0.12  # of the distance of corners: a ChArUco board is white that far at least


@dataclass(frozen=True, slots=True, eq=False)
class SeenBoard:
    """A board in a picture.

    Attributes
    ----------
    ids
        Which corners are seen, in the numbering of `Board.points_m`.
    xy_px
        Where.
    edge_px
        Width of the edges between black and white, from the steepest slope: below 2 px in a sharp
        picture [px].
    """

    ids: Int64[np.ndarray, " corner"]
    xy_px: Float64[np.ndarray, "corner 2"]
    edge_px: float

    def __len__(self) -> int:
        return len(self.ids)


class BoardFinder:
    """Finds one board in pictures.

    Parameters
    ----------
    board
        The board.
    thorough
        Whether to search with a second, slower method where the first finds nothing.
    """

    def __init__(self, board: Board, *, thorough: bool = True) -> None:
        self.board = board
        self._cv2: Any = needed("finding boards needs OpenCV", "calibrate", "cv2")
        self._thorough = thorough
        self._charuco: Any = (
            self._cv2.aruco.CharucoDetector(opencv_board(board, self._cv2))
            if board.charuco
            else None
        )

    def find(self, grey: Grey) -> SeenBoard | None:
        """Return the board; None where it is not found as a whole (ChArUco: hardly at all)."""
        found = self._find_charuco(grey) if self._charuco else self._find_checkerboard(grey)
        if found is None:
            return None
        ids, xy = found
        return SeenBoard(ids, xy, edge_width_px(grey, self.board, ids, xy))

    def _find_charuco(
        self, grey: Grey
    ) -> tuple[Int64[np.ndarray, " corner"], Float64[np.ndarray, "corner 2"]] | None:
        corners, ids, _, _ = self._charuco.detectBoard(grey)
        if ids is None or len(ids) < LEAST_CHARUCO:
            return None
        ids = ids.ravel().astype(np.int64)
        if (
            len({int(i) // self.board.columns for i in ids}) < 2
            or len({int(i) % self.board.columns for i in ids}) < 2
        ):
            return None  # on one line they tell no pose
        xy = self._refined(grey, ids, corners.reshape(-1, 2))
        return ids, xy

    def _find_checkerboard(
        self, grey: Grey
    ) -> tuple[Int64[np.ndarray, " corner"], Float64[np.ndarray, "corner 2"]] | None:
        xy = self._searched(grey)
        if xy is None:
            return None
        ids = np.arange(len(xy))
        xy = self._refined(grey, ids, xy)
        if not np.isfinite(xy).all():
            return None
        return ids, facing(grey, self.board, xy)

    def _searched(self, grey: Grey) -> Float64[np.ndarray, "corner 2"] | None:
        """Return the corners of a checkerboard in pixels, by the quickest way that finds them."""
        cv2 = self._cv2
        size = (self.board.columns, self.board.rows)
        quick = cv2.CALIB_CB_ADAPTIVE_THRESH | cv2.CALIB_CB_NORMALIZE_IMAGE
        quick |= cv2.CALIB_CB_FAST_CHECK
        sector = cv2.CALIB_CB_NORMALIZE_IMAGE
        ways = [(SEARCHED_PX, False), (SEARCHED_PX, True)]
        ways += [(SMALL_PX, True), (LARGE_PX, False), (LARGE_PX, True)] if self._thorough else []
        for long_side, by_sectors in ways:
            scale = min(1.0, long_side / max(grey.shape))
            small = cv2.resize(grey, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
            if by_sectors:
                found, corners = cv2.findChessboardCornersSB(small, size, flags=sector)
            else:  # noise would make it slow
                smooth = cv2.GaussianBlur(small, (0, 0), SMOOTHED_PX)
                found, corners = cv2.findChessboardCorners(smooth, size, flags=quick)
            if found and corners is not None:
                xy = corners.reshape(-1, 2).astype(np.float64)
                pixels: Float64[np.ndarray, "corner 2"] = (xy + 0.5) / scale - 0.5
                return pixels
        return None

    def _refined(
        self,
        grey: Grey,
        ids: Int64[np.ndarray, " corner"],
        xy: Float64[np.ndarray, "corner 2"],
    ) -> Float64[np.ndarray, "corner 2"]:
        """Return the corners to a fraction of a pixel, none further than its neighbours allow."""
        starts, ends = neighbours(self.board, ids)
        if not len(starts):
            return xy.astype(np.float64)
        apart = float(np.quantile(np.linalg.norm(xy[starts] - xy[ends], axis=1), 0.1))
        share = CHARUCO_WINDOW_SHARE if self.board.charuco else WINDOW_SHARE
        window = int(np.clip(share * apart, 2, LARGEST_WINDOW_PX))
        given = np.array(xy, dtype=np.float32).reshape(-1, 1, 2)
        refined = self._cv2.cornerSubPix(grey, given, (window, window), (-1, -1), REFINED)
        return np.asarray(refined, dtype=np.float64).reshape(-1, 2)


def neighbours(
    board: Board, ids: Int64[np.ndarray, " corner"]
) -> tuple[Int64[np.ndarray, " edge"], Int64[np.ndarray, " edge"]]:
    """Return the places in `ids` of pairs of corners that are next to each other on the board."""
    place = np.full(board.columns * board.rows, -1)
    place[ids] = np.arange(len(ids))
    grid = place.reshape(board.rows, board.columns)
    pairs = np.concatenate((
        np.stack((grid[:, :-1].ravel(), grid[:, 1:].ravel()), axis=1),
        np.stack((grid[:-1].ravel(), grid[1:].ravel()), axis=1),
    ))  # fmt: skip
    pairs = pairs[(pairs >= 0).all(axis=1)]
    return pairs[:, 0], pairs[:, 1]


def facing(
    grey: Grey, board: Board, xy: Float64[np.ndarray, "corner 2"]
) -> Float64[np.ndarray, "corner 2"]:
    """Return the corners of a whole checkerboard in the order in which it is printed.

    The order is that of somebody who reads the front: rows to the right, columns down, the square
    between the first four corners black. Where half a turn looks alike, either is returned.
    """
    grid = xy.reshape(board.rows, board.columns, 2)
    right, down = grid[0, -1] - grid[0, 0], grid[-1, 0] - grid[0, 0]
    if right[0] * down[1] - right[1] * down[0] < 0:  # read from behind
        grid = grid[:, ::-1]
    odd_square = board.columns == board.rows and board.rows % 2 == 1
    if (board.has_a_top or odd_square) and _first_is_white(grey, grid):
        grid = np.rot90(grid) if odd_square else grid[::-1, ::-1]
    return grid.reshape(-1, 2)


def edge_width_px(
    grey: Grey,
    board: Board,
    ids: Int64[np.ndarray, " corner"],
    xy: Float64[np.ndarray, "corner 2"],
) -> float:
    """Return the typical width of the edges between black and white squares [px].

    Notes
    -----
    The grey values across the middle of each edge; the width is their range over the steepest
    slope, a median over the edges.
    """
    starts, ends = neighbours(board, ids)
    if not len(starts):
        return float("nan")
    along = xy[ends] - xy[starts]
    length = np.linalg.norm(along, axis=1)
    across = np.stack((-along[:, 1], along[:, 0]), axis=1) / length[:, None]
    reach = np.maximum(PROFILE_SHARE * length, 1.5)
    middle = (xy[starts] + xy[ends]) / 2
    places = middle[:, None] + across[:, None] * (reach[:, None] * PROFILE)[..., None]
    values = _sampled(grey, places)
    step = reach * (PROFILE[1] - PROFILE[0])
    steepest = np.abs(np.diff(values, axis=1)).max(axis=1) / step
    black, white = np.quantile(values, (0.05, 0.95))
    with np.errstate(divide="ignore"):
        return float(np.median(max(white - black, 1.0) / np.maximum(steepest, 1e-6)))


def _first_is_white(grey: Grey, grid: Float64[np.ndarray, "row column 2"]) -> bool:
    middles = (grid[:-1, :-1] + grid[1:, 1:]) / 2
    values = _sampled(grey, middles)
    odd = np.add.outer(np.arange(values.shape[0]), np.arange(values.shape[1])) % 2 == 1
    return bool(values[~odd].mean() > values[odd].mean())


def _sampled(grey: Grey, xy: Float64[np.ndarray, "*batch 2"]) -> Float64[np.ndarray, "*batch"]:
    """Return grey values between pixels, those of the border outside."""
    x = np.clip(xy[..., 0], 0, grey.shape[1] - 1.001)
    y = np.clip(xy[..., 1], 0, grey.shape[0] - 1.001)
    left, top = x.astype(np.int64), y.astype(np.int64)
    u, v = x - left, y - top
    right, low = np.minimum(left + 1, grey.shape[1] - 1), np.minimum(top + 1, grey.shape[0] - 1)
    values: Float64[np.ndarray, "*batch"] = (1 - v) * (
        (1 - u) * grey[top, left] + u * grey[top, right]
    ) + v * ((1 - u) * grey[low, left] + u * grey[low, right])
    return values
