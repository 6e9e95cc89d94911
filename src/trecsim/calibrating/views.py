"""Views of a board: a picture in which it was found, and which of many are worth using."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from trecsim.calibrating.board_images import BoardSource
from trecsim.calibrating.boards import Board
from trecsim.calibrating.corners import BoardFinder, SeenBoard
from trecsim.callbacks import Progress
from trecsim.errors import InputError

MOST_LOOKED_AT = 240  # images of a video in which a board is searched
BLURRED_TIMES = 2.5  # wider edges than that of the typical view
BLURRED_PX = 5.0  # and wider than this: what is sharper is never left out


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """A picture with a board.

    Attributes
    ----------
    label, key, t_s
        As in `BoardImage`.
    seen
        The corners.
    """

    label: str
    key: int
    t_s: float
    seen: SeenBoard


@dataclass(frozen=True, slots=True, eq=False)
class CameraViews:
    """All views of one camera.

    Attributes
    ----------
    camera
        Its name.
    size_px
        Width and height of its images [px].
    views
        Pictures with the board.
    without
        Labels of pictures in which it was not found.
    """

    camera: str
    size_px: tuple[int, int]
    views: tuple[View, ...]
    without: tuple[str, ...]


def look(
    source: BoardSource,
    board: Board,
    *,
    most: int = MOST_LOOKED_AT,
    progress: Progress | None = None,
) -> CameraViews:
    """Return the views of a board in the images of a camera.

    Parameters
    ----------
    source
        The images; of a long video only some are looked at, evenly spread.
    board
        The board.
    most
        How many images of a video to look at.
    progress
        Called with the number of images so far.

    Raises
    ------
    InputError
        The images have different sizes, or an image cannot be read.
    """
    video = source.video
    finder = BoardFinder(board, thorough=video is None)
    count = (video.expected_frames or most) if video else len(source.files)
    step = max(-(-count // most), 1) if video else 1
    size: tuple[int, int] | None = None
    views, without = [], []
    for number, image in enumerate(source.images(step)):
        height, width = image.grey.shape
        if size is not None and size != (width, height):
            raise InputError(
                f"camera {source.camera!r}: {image.label} is {width} x {height} px, the images "
                f"before are {size[0]} x {size[1]}; all must be as the camera takes them"
            )
        size = (width, height)
        seen = finder.find(image.grey)
        if seen is None:
            without.append(image.label)
        else:
            views.append(View(image.label, image.key, image.t_s, seen))
        if progress is not None:
            progress(number + 1, -(-count // step))
    return CameraViews(source.camera, size or (0, 0), tuple(views), tuple(without))


def sharp_views(views: Sequence[View]) -> tuple[list[View], list[View]]:
    """Return the views that are sharp enough, and those that are blurred."""
    if not views:
        return [], []
    widths = np.array([view.seen.edge_px for view in views])
    limit = max(BLURRED_PX, BLURRED_TIMES * float(np.median(widths)))
    sharp = [view for view, width in zip(views, widths, strict=True) if width <= limit]
    return sharp, [view for view, width in zip(views, widths, strict=True) if width > limit]


def spread_views(
    views: Sequence[View], board: Board, size_px: tuple[int, int], most: int
) -> list[View]:
    """Return at most so many views, as different from each other as can be, the sharpest first.

    Notes
    -----
    A view is described by where the board is in the image, how large it is, and how it is tilted;
    each further view is the one that differs most from those already chosen, blur being held
    against it.
    """
    if len(views) <= most:
        return list(views)
    kinds = np.array([_kind(view, board, size_px) for view in views])
    widths = np.array([view.seen.edge_px for view in views])
    penalty = np.minimum(1.0, (float(np.quantile(widths, 0.3)) / widths) ** 0.5)
    chosen = [int(np.argmin(widths))]
    away = np.linalg.norm(kinds - kinds[chosen[0]], axis=1)
    while len(chosen) < most:
        following = int(np.argmax(away * penalty))
        chosen.append(following)
        away = np.minimum(away, np.linalg.norm(kinds - kinds[following], axis=1))
    return [views[number] for number in sorted(chosen)]


def _kind(view: View, board: Board, size_px: tuple[int, int]) -> Float64[np.ndarray, " 5"]:
    """Return what distinguishes a view: place, size and tilt of the board."""
    outline = corners_of_outline(view.seen, board)
    long_side = max(size_px)
    x, y = outline.mean(axis=0) / long_side
    sides = np.linalg.norm(outline - np.roll(outline, -1, axis=0), axis=1)
    across, down = np.log(sides[0] / sides[2]), np.log(sides[1] / sides[3])
    size = np.log(max(sides.mean() / long_side, 1e-3))
    return np.array([2 * x, 2 * y, 0.6 * size, 1.5 * across, 1.5 * down])


def corners_of_outline(seen: SeenBoard, board: Board) -> Float64[np.ndarray, "4 2"]:
    """Return where the four outermost corners of the board appear, by a homography [px]."""
    flat = board.points_m[:, :2] / board.square_m
    H = homography(flat[seen.ids], seen.xy_px)
    last_x, last_y = board.columns - 1.0, board.rows - 1.0
    outline = np.array([[0.0, 0, 1], [last_x, 0, 1], [last_x, last_y, 1], [0, last_y, 1]])
    mapped = outline @ H.T
    shown: Float64[np.ndarray, "4 2"] = mapped[:, :2] / mapped[:, 2:]
    return shown


def homography(
    flat: Float64[np.ndarray, "corner 2"], xy: Float64[np.ndarray, "corner 2"]
) -> Float64[np.ndarray, "3 3"]:
    """Return the projective map that takes one set of points to the other (direct linear)."""
    to_flat, to_xy = _normalising(flat), _normalising(xy)
    a = np.column_stack((flat, np.ones(len(flat)))) @ to_flat.T
    b = np.column_stack((xy, np.ones(len(xy)))) @ to_xy.T
    zero = np.zeros_like(a)
    rows = np.concatenate((
        np.concatenate((a, zero, -b[:, :1] * a), axis=1),
        np.concatenate((zero, a, -b[:, 1:2] * a), axis=1),
    ))  # fmt: skip
    H = np.linalg.svd(rows)[2][-1].reshape(3, 3)
    found: Float64[np.ndarray, "3 3"] = np.linalg.inv(to_xy) @ H @ to_flat
    return found


def _normalising(points: Float64[np.ndarray, "corner 2"]) -> Float64[np.ndarray, "3 3"]:
    centre = points.mean(axis=0)
    scale = np.sqrt(2) / max(float(np.linalg.norm(points - centre, axis=1).mean()), 1e-12)
    return np.array([[scale, 0, -scale * centre[0]], [0, scale, -scale * centre[1]], [0, 0, 1]])
