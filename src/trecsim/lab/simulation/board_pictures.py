"""Pictures of a calibration board as a camera would take them: distortion, blur and noise."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, UInt8

from trecsim.calibrating.board_drawing import rectangles_mm
from trecsim.calibrating.boards import Board
from trecsim.geometry.camera import Camera
from trecsim.geometry.rigid import RigidMotion, inverse
from trecsim.geometry.view import rays

PIXELS_PER_SQUARE = 64
BORDER_SQUARES = 1.0  # of white paper around
SUPERSAMPLED = 3  # rays along each side of a pixel
BLACK, WHITE = 25.0, 225.0
FLOOR = (95.0, 135.0)  # grey of the background, from left to right

Grey = UInt8[np.ndarray, "h w"]


@dataclass(frozen=True, slots=True, eq=False)
class BoardPrint:
    """A printed board as a texture.

    Attributes
    ----------
    board
        The board.
    grey
        Its paper, from black to white, `PIXELS_PER_SQUARE` to the side of a square.
    """

    board: Board
    grey: Float64[np.ndarray, "y x"]


def printed(board: Board) -> BoardPrint:
    """Return the print of a board with a white border."""
    across, down = board.squares
    border = round(BORDER_SQUARES * PIXELS_PER_SQUARE)
    shape = (down * PIXELS_PER_SQUARE + 2 * border, across * PIXELS_PER_SQUARE + 2 * border)
    grey = np.full(shape, WHITE)
    per_mm = PIXELS_PER_SQUARE / (1e3 * board.square_m)
    for left, top, width, height in rectangles_mm(board):
        x, y = (round(v * per_mm) + border for v in (left, top))
        x_end, y_end = (round(v * per_mm) + border for v in (left + width, top + height))
        grey[y:y_end, x:x_end] = BLACK
    return BoardPrint(board, grey)


def picture(
    camera: Camera, paper: BoardPrint, T_world_board: RigidMotion, rng: np.random.Generator,
    *, noise: float = 2.0, blur_px: float = 0.6,
) -> Grey:  # fmt: skip
    """Return the picture that a camera takes of a board in front of an empty wall.

    Parameters
    ----------
    camera
        The camera.
    paper
        The print of the board.
    T_world_board
        Pose of the board.
    rng
        Source of chance.
    noise
        Standard deviation of the grey values.
    blur_px
        Standard deviation of the blur [px].
    """
    width, height = camera.size_px
    image = np.tile(np.linspace(*FLOOR, width), (height, 1))
    box = _box(camera, paper.board, T_world_board)
    if box is not None:
        left, right, top, low = box
        image[top:low, left:right] = _seen(camera, paper, T_world_board, box, image)
    image = _blurred(image, blur_px) + rng.normal(0, noise, image.shape)
    return np.clip(np.rint(image), 0, 255).astype(np.uint8)


def _box(
    camera: Camera, board: Board, T_world_board: RigidMotion
) -> tuple[int, int, int, int] | None:
    """Return the part of the image in which the paper is."""
    reach = (1 + BORDER_SQUARES) * board.square_m
    last_x, last_y = (board.columns - 1) * board.square_m, (board.rows - 1) * board.square_m
    x, y = np.meshgrid(
        np.linspace(-reach, last_x + reach, 25), np.linspace(-reach, last_y + reach, 25)
    )
    points = np.stack((x, y, np.zeros_like(x)), axis=-1).reshape(-1, 3)
    pixels = camera.project(points @ T_world_board[:3, :3].T + T_world_board[:3, 3])
    known = pixels[np.isfinite(pixels).all(axis=1)]
    if not len(known):
        return None
    width, height = camera.size_px
    (left, top), (right, low) = np.floor(known.min(axis=0)) - 3, np.ceil(known.max(axis=0)) + 4
    left, right = int(max(left, 0)), int(min(right, width))
    top, low = int(max(top, 0)), int(min(low, height))
    return (left, right, top, low) if left < right and top < low else None


def _seen(
    camera: Camera, paper: BoardPrint, T_world_board: RigidMotion,
    box: tuple[int, int, int, int], behind: Float64[np.ndarray, "h w"],
) -> Float64[np.ndarray, "y x"]:  # fmt: skip
    left, right, top, low = box
    T_board_world = inverse(T_world_board)
    origin = T_board_world[:3, :3] @ camera.position_m + T_board_world[:3, 3]
    steps = (np.arange(SUPERSAMPLED) + 0.5) / SUPERSAMPLED - 0.5
    total = np.zeros((low - top, right - left))
    x, y = np.meshgrid(np.arange(left, right), np.arange(top, low))
    for shift_x in steps:
        for shift_y in steps:
            pixels = np.stack((x + shift_x, y + shift_y), axis=-1).astype(np.float64)
            directions = rays(camera, pixels) @ T_board_world[:3, :3].T
            with np.errstate(all="ignore"):
                along = -origin[2] / directions[..., 2]
                on_board = origin[:2] + along[..., None] * directions[..., :2]
            shown = _looked_up(paper, on_board)
            hidden = np.isnan(shown) | ~(along > 0) | (origin[2] > 0)
            total += np.where(hidden, behind[top:low, left:right], shown)
    return total / SUPERSAMPLED**2


def _looked_up(
    paper: BoardPrint, on_board: Float64[np.ndarray, "y x 2"]
) -> Float64[np.ndarray, "y x"]:
    """Return the grey of the paper at places on the board [m]; NaN beside it."""
    scale = PIXELS_PER_SQUARE / paper.board.square_m
    place = on_board * scale + (1 + BORDER_SQUARES) * PIXELS_PER_SQUARE
    column, row = np.floor(np.nan_to_num(place, nan=-1.0)).astype(np.int64).transpose(2, 0, 1)
    height, width = paper.grey.shape
    inside = (column >= 0) & (row >= 0) & (column < width) & (row < height)
    values = paper.grey[np.clip(row, 0, height - 1), np.clip(column, 0, width - 1)]
    return np.where(inside, values, np.nan)


def _blurred(image: Float64[np.ndarray, "h w"], blur_px: float) -> Float64[np.ndarray, "h w"]:
    reach = max(int(np.ceil(3 * blur_px)), 1)
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) / max(blur_px, 1e-6)) ** 2)
    kernel /= kernel.sum()
    for axis in (0, 1):
        width = [(reach, reach) if a == axis else (0, 0) for a in (0, 1)]
        padded = np.pad(image, width, mode="edge")
        size = image.shape[axis]
        image = sum(
            (weight * np.take(padded, range(shift, shift + size), axis=axis)
             for shift, weight in enumerate(kernel)), start=np.zeros_like(image),
        )  # fmt: skip
    return image
